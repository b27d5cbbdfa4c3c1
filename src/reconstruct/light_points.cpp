#include "reconstruct/light_points.h"

#include <algorithm>
#include <unordered_map>

#include "reconstruct/triangulate.h"

namespace goldthread {
namespace {

const Primitive& primitive_of(const SurfaceSet& set, const Part& part) {
  return set.scene->meshes[set.scene->instances[part.instance].mesh].primitives[part.primitive];
}

// The leaf faces of a part, whether or not it has been cut.
struct LeafView {
  const SurfaceSet& set;
  const Part& part;
  const TriangleMesh& mesh;
  const LeafMesh* leaves;

  LeafView(const ElementPool& pool, uint32_t number)
      : set(pool.surfaces()),
        part(set.parts[number]),
        mesh(set.tree(part).mesh),
        leaves(pool.leaf_mesh(number)) {}

  uint32_t face_count() const {
    return leaves != nullptr ? leaves->face_count() : static_cast<uint32_t>(mesh.triangles.size());
  }
  uint32_t triangle(uint32_t face) const { return leaves != nullptr ? leaves->triangle_of_face(face) : face; }
  const vec3& position(uint32_t vertex) const {
    return leaves != nullptr ? leaves->positions()[vertex] : part.positions[vertex];
  }
  uint32_t vertex_count() const {
    return static_cast<uint32_t>(leaves != nullptr ? leaves->positions().size() : part.positions.size());
  }
  void loop(uint32_t face, std::vector<uint32_t>& out) const {
    if (leaves != nullptr) {
      leaves->loop(face, out);
    } else {
      const UVec3& t = mesh.triangles[face];
      out.assign({t.x, t.y, t.z});
    }
  }

  // Barycentric weights of corners 1 and 2 of a tree triangle; exactly 0 or 1 at its corners.
  vec2 weights(uint32_t t, uint32_t vertex) const {
    const UVec3& c = mesh.triangles[t];
    if (vertex == c.x) return {0, 0};
    if (vertex == c.y) return {1, 0};
    if (vertex == c.z) return {0, 1};
    const dvec3 a = part.positions[c.x], e1 = dvec3(part.positions[c.y]) - a,
                e2 = dvec3(part.positions[c.z]) - a, p = dvec3(position(vertex)) - a;
    const dvec3 n = glm::cross(e1, e2);
    const double scale = 1 / std::max(glm::dot(n, n), 1e-300);
    dvec2 w(glm::dot(glm::cross(p, e2), n) * scale, glm::dot(glm::cross(e1, p), n) * scale);
    w = glm::clamp(w, dvec2(0), dvec2(1));
    if (w.x + w.y > 1) w /= w.x + w.y;
    return vec2(w);
  }
};

struct NormalSource {
  const LeafView& view;
  mat3 to_world;

  explicit NormalSource(const LeafView& v) : view(v) {
    const mat3 linear(v.set.scene->instances[v.part.instance].transform);
    to_world = v.part.winding * area_vector_transform(linear);
  }

  vec3 geometric(uint32_t t) const {
    const UVec3& c = view.mesh.triangles[t];
    const std::vector<vec3>& p = view.part.positions;
    return normalize_or(view.part.winding * area_vector(p[c.x], p[c.y], p[c.z]), vec3(0, 1, 0));
  }

  // The normal that light falls on at a corner: interpolated where the source gives good ones, flat
  // otherwise.
  vec3 at(uint32_t t, const vec3& flat, vec2 w) const {
    const Primitive& primitive = primitive_of(view.set, view.part);
    if (primitive.normals.empty()) return flat;
    const uint32_t* corner = &primitive.indices[3 * size_t{view.mesh.source_triangles[t]}];
    const vec3 n = (1 - w.x - w.y) * primitive.normals[corner[0]] + w.x * primitive.normals[corner[1]] +
                   w.y * primitive.normals[corner[2]];
    const vec3 world = normalize_or(to_world * n, flat);
    // A normal that leans far from its face, or against it, is an exporter's mistake.
    return is_finite(world) && dot(world, flat) > 0.3f ? world : flat;
  }
};

}  // namespace

namespace {

// Seams that are this near to parallel, as a sine, are one line that goes on.
constexpr float kSameSeam = 1e-3f;
constexpr size_t kMostSeams = 32;  // bits

void note_seam(SeamsAtVertex& seams, const vec3& normal, Seam seam) {
  seams.gap |= seam == Seam::kGap;
  for (const vec3& other : seams.normals)
    if (length(cross(other, normal)) < kSameSeam) return;
  if (seams.normals.size() < kMostSeams) seams.normals.push_back(normal);
}

void collect_seams(const LeafView& view, const NormalSource& normals, PartPoints& out) {
  if (view.leaves == nullptr || !view.leaves->has_seams()) return;
  const LeafMesh& mesh = *view.leaves;
  for (uint32_t f = 0; f < mesh.face_count(); ++f) {
    const uint32_t first = mesh.first_edge(f);
    uint32_t edge = first;
    do {
      const uint32_t next = mesh.next(edge);
      if (mesh.seam(edge) != Seam::kNone) {
        const uint32_t a = mesh.origin(edge), b = mesh.origin(next);
        const vec3 along = mesh.positions()[b] - mesh.positions()[a];
        const vec3 n = normalize_or(cross(along, normals.geometric(view.triangle(f))), vec3(0));
        if (n != vec3(0))
          for (const uint32_t v : {a, b}) note_seam(out.seams[v], n, mesh.seam(edge));
      }
      edge = next;
    } while (edge != first);
  }
}

}  // namespace

uint32_t PartPoints::sides_of(uint32_t vertex, const vec3& position, const vec3& place) const {
  const auto found = seams.find(vertex);
  if (found == seams.end()) return 0;
  uint32_t sides = 0;
  for (size_t i = 0; i < found->second.normals.size(); ++i)
    if (dot(found->second.normals[i], place - position) > 0) sides |= 1u << i;
  return sides;
}

PartPoints collect_light_points(const ElementPool& pool, uint32_t part, float normal_agreement) {
  const LeafView view(pool, part);
  const NormalSource normals(view);
  PartPoints out;
  collect_seams(view, normals, out);
  std::vector<uint32_t> first_at(view.vertex_count(), kNoPoint);  // points at a vertex, as chains
  std::vector<uint32_t> next_at;
  std::vector<float> smallest;
  std::vector<uint32_t> loop;
  out.corner_first.reserve(view.face_count() + 1);
  for (uint32_t f = 0; f < view.face_count(); ++f) {
    out.corner_first.push_back(static_cast<uint32_t>(out.corners.size()));
    view.loop(f, loop);
    const uint32_t t = view.triangle(f);
    const vec3 flat = normals.geometric(t);
    vec3 sum(0), centre(0);
    for (size_t i = 1; i + 1 < loop.size(); ++i)
      sum += area_vector(view.position(loop[0]), view.position(loop[i]), view.position(loop[i + 1]));
    for (const uint32_t v : loop) centre += view.position(v) / static_cast<float>(loop.size());
    out.face_centres.push_back(centre);
    out.face_normals.push_back(flat);
    const float area = length(sum);
    for (const uint32_t v : loop) {
      const vec3 n = normals.at(t, flat, view.weights(t, v));
      const uint32_t sides = out.sides_of(v, view.position(v), centre);
      uint32_t point = first_at[v];
      while (point != kNoPoint &&
             (dot(out.points[point].normal, n) < normal_agreement || out.points[point].sides != sides))
        point = next_at[point];
      if (point == kNoPoint) {
        point = static_cast<uint32_t>(out.points.size());
        out.points.push_back({view.position(v), n, f, v, sides});
        next_at.push_back(first_at[v]);
        smallest.push_back(area);
        first_at[v] = point;
      } else if (area < smallest[point]) {
        smallest[point] = area;
        out.points[point].face = f;
      }
      out.corners.push_back(point);
    }
  }
  out.corner_first.push_back(static_cast<uint32_t>(out.corners.size()));
  return out;
}

namespace {

// Light per source vertex, if every source vertex takes the light of one point only.
bool keep_source_mesh(const LeafView& view, const Primitive& primitive, const PartPoints& points,
                      std::vector<uint32_t>& point_of_vertex) {
  if (view.leaves != nullptr) return false;
  point_of_vertex.assign(primitive.positions.size(), kNoPoint);
  const auto take = [&](uint32_t source, uint32_t face, uint32_t turn) {
    for (uint32_t k = 0; k < 3; ++k) {
      uint32_t& point = point_of_vertex[primitive.indices[3 * size_t{source} + k]];
      const uint32_t wanted = points.corners[points.corner_first[face] + (k + turn) % 3];
      if (point != kNoPoint && point != wanted) return false;
      point = wanted;
    }
    return true;
  };
  for (uint32_t f = 0; f < view.face_count(); ++f)
    if (!take(view.mesh.source_triangles[f], f, 0)) return false;
  // A triangle that lies there twice is drawn twice.
  for (const DuplicateTriangle& d : view.mesh.duplicates)
    if (!take(d.source, d.twin, d.turn)) return false;
  return true;
}

uint64_t key(uint32_t a, uint32_t b) {
  return uint64_t{a} << 32 | b;
}

}  // namespace

LitPrimitive build_output_mesh(const ElementPool& pool, uint32_t part, const PartPoints& points,
                               std::vector<uint32_t>& point_of_vertex) {
  const LeafView view(pool, part);
  const Primitive& primitive = primitive_of(view.set, view.part);
  LitPrimitive out;
  out.instance = view.part.instance;
  out.primitive = view.part.primitive;
  out.source_mesh = keep_source_mesh(view, primitive, points, point_of_vertex);
  if (out.source_mesh) return out;
  point_of_vertex.clear();
  // A corner of the source is one vertex for each light there; a new vertex is one for each source triangle
  // it is cut from, since attributes may jump between them.
  std::unordered_map<uint64_t, uint32_t> of_source, of_new;
  std::vector<uint32_t> loop, local;
  std::vector<vec3> places;
  std::vector<UVec3> triangles;
  for (uint32_t f = 0; f < view.face_count(); ++f) {
    view.loop(f, loop);
    const uint32_t t = view.triangle(f);
    const uint32_t source = view.mesh.source_triangles[t];
    local.clear();
    places.clear();
    triangles.clear();
    for (size_t i = 0; i < loop.size(); ++i) {
      const uint32_t point = points.corners[points.corner_first[f] + i];
      const vec2 w = view.weights(t, loop[i]);
      const bool corner = w == vec2(0, 0) || w == vec2(1, 0) || w == vec2(0, 1);
      const uint32_t number = w.y == 1.0f ? 2u : w.x == 1.0f ? 1u : 0u;
      auto& map = corner ? of_source : of_new;
      const uint64_t k = corner ? key(primitive.indices[3 * size_t{source} + number], point) : key(t, point);
      const auto [entry, added] = map.try_emplace(k, static_cast<uint32_t>(out.origins.size()));
      if (added) {
        out.origins.push_back({source, w});
        point_of_vertex.push_back(point);
      }
      local.push_back(entry->second);
      places.push_back(view.position(loop[i]));
    }
    triangulate_face(places, triangles);
    for (const UVec3& tri : triangles) {
      const UVec3 face(local[tri.x], local[tri.y], local[tri.z]);
      if (face.x == face.y || face.y == face.z || face.z == face.x) continue;
      out.faces.push_back(face);
      out.face_parents.push_back(source);
    }
  }
  return out;
}

}  // namespace goldthread
