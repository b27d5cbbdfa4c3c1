// Cutting triangles and patches in two (thesis 4.4): along a plane that is asked for, where light jumps; else
// across the longer side of the minimum-area rectangle, snapped to corners and T-vertices nearby so that few
// new ones arise.
#include <algorithm>

#include "element/element_pool.h"
#include "mesh/min_rectangle.h"

namespace goldthread {
namespace {

// How far, as a share of half the rectangle's length, the cut may move to meet a vertex.
constexpr float kSnap = 0.2f;

// The same where a plane is asked for: a vertex that a neighbour's cut along the same plane has made is met,
// but the cut is where it should be. A piece that is all within this of the plane is none.
constexpr float kTouch = 1e-3f;

// An orthonormal frame whose third axis is `n`.
void plane_axes(const vec3& n, vec3& u, vec3& v) {
  u = normalize(std::abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0) : vec3(0, n.z, -n.y));
  v = cross(n, u);
}

// The loop of a face as half-edges, and each corner's signed distance from the cut.
struct CutFace {
  std::vector<uint32_t> edges;
  std::vector<float> distance;
  float half_length = 0;
};

CutFace measure(const LeafMesh& mesh, uint32_t face) {
  CutFace cut;
  uint32_t edge = mesh.first_edge(face);
  do {
    cut.edges.push_back(edge);
    edge = mesh.next(edge);
  } while (edge != mesh.first_edge(face));
  const std::vector<vec3>& p = mesh.positions();
  const vec3& origin = p[mesh.origin(cut.edges[0])];
  vec3 sum(0);
  for (size_t i = 1; i + 1 < cut.edges.size(); ++i)
    sum += cross(p[mesh.origin(cut.edges[i])] - origin, p[mesh.origin(cut.edges[i + 1])] - origin);
  vec3 u, v;
  plane_axes(normalize_or(sum, vec3(0, 1, 0)), u, v);
  std::vector<vec2> flat;
  for (const uint32_t e : cut.edges) {
    const vec3 d = p[mesh.origin(e)] - origin;
    flat.push_back({dot(d, u), dot(d, v)});
  }
  const MinRectangle rectangle = min_rectangle(flat);
  cut.half_length = rectangle.half.x;
  for (const vec2& q : flat) cut.distance.push_back(glm::dot(q - rectangle.centre, rectangle.u));
  return cut;
}

// The same with distances from a plane; false where it does not clearly part the face.
bool part_by(const LeafMesh& mesh, const CutPlane& plane, CutFace& cut) {
  float low = 0, high = 0;
  for (size_t i = 0; i < cut.edges.size(); ++i) {
    float& d = cut.distance[i];
    d = dot(plane.normal, mesh.positions()[mesh.origin(cut.edges[i])]) - plane.offset;
    low = std::min(low, d);
    high = std::max(high, d);
  }
  return -low > 2 * kTouch * cut.half_length && high > 2 * kTouch * cut.half_length;
}

// Where the cut's line leaves the face: the loop position of an edge from which it crosses, going one way.
size_t find_crossing(const CutFace& cut, bool rising) {
  const size_t count = cut.edges.size();
  for (size_t i = 0; i < count; ++i) {
    const float here = cut.distance[i], there = cut.distance[(i + 1) % count];
    if (rising ? (here < 0 && there >= 0) : (here >= 0 && there < 0)) return i;
  }
  return count;
}

// The half-edge that starts at the cut's end on edge `i`: an existing corner within `reach` of the line if
// there is one, else a new vertex.
uint32_t make_end(LeafMesh& mesh, const CutFace& cut, size_t i, float reach) {
  const size_t next = (i + 1) % cut.edges.size();
  const float here = std::abs(cut.distance[i]), there = std::abs(cut.distance[next]);
  if (std::min(here, there) <= reach) return cut.edges[here < there ? i : next];
  const vec3 a = mesh.positions()[mesh.origin(cut.edges[i])],
             b = mesh.positions()[mesh.origin(cut.edges[next])];
  mesh.split_edge(cut.edges[i], a + (here / (here + there)) * (b - a));
  return mesh.next(cut.edges[i]);
}

// Whether two snapped ends would be neighbours in the loop and so cut nothing off.
bool would_degenerate(const CutFace& cut, size_t i, size_t j) {
  const size_t count = cut.edges.size();
  const auto snapped = [&](size_t k) -> size_t {
    const size_t next = (k + 1) % count;
    const float here = std::abs(cut.distance[k]), there = std::abs(cut.distance[next]);
    if (std::min(here, there) > kSnap * cut.half_length) return count;
    return here < there ? k : next;
  };
  const size_t a = snapped(i), b = snapped(j);
  // A straight run of T-vertices between the ends cuts nothing off either; a snapped end stays only when some
  // corner on each side is clearly away from the line.
  float below = 0, above = 0;
  for (size_t k = 0; k < count; ++k) {
    if (k == a || k == b) continue;
    below = std::min(below, cut.distance[k]);
    above = std::max(above, cut.distance[k]);
  }
  if (below > -0.5f * cut.half_length || above < 0.5f * cut.half_length) return true;
  return a < count && b < count && (a == b || (a + 1) % count == b || (b + 1) % count == a);
}

}  // namespace

uint32_t ElementPool::patch_of_triangle(uint32_t part, uint32_t triangle) {
  std::vector<uint32_t>& roots = triangle_patches_[part];
  if (!leaf_meshes_[part]) {
    const TriangleMesh& mesh = set_->tree(set_->parts[part]).mesh;
    leaf_meshes_[part] = std::make_unique<LeafMesh>(set_->parts[part], mesh);
    roots.assign(mesh.triangles.size(), kNoElement);
  }
  if (roots[triangle] == kNoElement) {
    roots[triangle] = static_cast<uint32_t>(patches_.size());
    Patch patch;
    patch.part = part;
    patch.face = patch.triangle = triangle;
    patches_.push_back(patch);
  }
  return roots[triangle];
}

void ElementPool::store_polygon(Patch& patch) {
  const LeafMesh& mesh = *leaf_meshes_[patch.part];
  std::vector<uint32_t> loop;
  mesh.loop(patch.face, loop);
  const std::vector<vec3>& p = mesh.positions();
  float largest = 0;
  for (const uint32_t v : loop) largest = std::max(largest, dot(p[v] - p[loop[0]], p[v] - p[loop[0]]));
  patch.first_corner = static_cast<uint32_t>(corners_.size());
  // T-vertices add nothing to the shape. The first try drops just them; a polygon that is still too large
  // (rounding can bend a straight run) loses its flattest corners.
  std::vector<vec3> kept;
  for (float tolerance = 1e-5f; kept.size() < 3 || kept.size() > kMaxPolygon - 2; tolerance *= 4) {
    kept.clear();
    for (size_t i = 0; i < loop.size(); ++i) {
      const vec3& before = p[loop[(i + loop.size() - 1) % loop.size()]];
      const vec3& here = p[loop[i]];
      const vec3& after = p[loop[(i + 1) % loop.size()]];
      if (length(cross(here - before, after - here)) > tolerance * largest) kept.push_back(here);
    }
    // A sliver has no corner that stands out: any three of it will do.
    if (kept.size() < 3) kept.assign({p[loop[0]], p[loop[loop.size() / 3]], p[loop[2 * loop.size() / 3]]});
  }
  corners_.insert(corners_.end(), kept.begin(), kept.end());
  patch.corners = static_cast<uint32_t>(kept.size());
}

bool ElementPool::split_patch(uint32_t number, const CutPlane& plane) {
  if (patches_[number].first_child != kNoElement) return true;  // the other side has cut it already
  const Patch parent = patches_[number];
  LeafMesh& mesh = *leaf_meshes_[parent.part];
  CutFace cut = measure(mesh, parent.face);
  const CutFace regular = cut;
  const bool by_plane = plane.present() && part_by(mesh, plane, cut);
  if (!by_plane) cut = regular;
  const size_t i = find_crossing(cut, true), j = find_crossing(cut, false);
  const size_t count = cut.edges.size();
  if (i == count || j == count || !(cut.half_length > 0)) return false;
  // Float coordinates cannot tell the corners of a smaller patch apart.
  float magnitude = 0;
  for (const uint32_t e : cut.edges) {
    const vec3 p = glm::abs(mesh.positions()[mesh.origin(e)]);
    magnitude = std::max({magnitude, p.x, p.y, p.z});
  }
  if (cut.half_length < 1e-5f * magnitude) return false;
  const float reach = (by_plane ? kTouch : would_degenerate(cut, i, j) ? 0.0f : kSnap) * cut.half_length;
  const uint32_t from = make_end(mesh, cut, i, reach);
  const uint32_t to = make_end(mesh, cut, j, reach);
  if (from == to || mesh.next(from) == to || mesh.next(to) == from) return false;
  const uint32_t new_face = mesh.split_face(from, to, by_plane ? plane.seam : Seam::kNone);
  Patch a = parent, b = parent;
  a.first_child = b.first_child = kNoElement;
  b.face = new_face;
  store_polygon(a);
  store_polygon(b);
  patches_[number].first_child = static_cast<uint32_t>(patches_.size());
  patches_.push_back(a);
  patches_.push_back(b);
  return true;
}

}  // namespace goldthread
