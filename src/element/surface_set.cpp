#include "element/surface_set.h"

#include <algorithm>
#include <map>

#include "base/parallel.h"
#include "element/paint.h"

namespace goldthread {
namespace {

// Whether `m` keeps angles: its columns orthogonal and of one length.
bool is_similarity(const mat3& m) {
  const float a = dot(m[0], m[0]), b = dot(m[1], m[1]), c = dot(m[2], m[2]);
  const float most = std::max({a, b, c});
  const float tolerance = 1e-4f * most;
  return std::abs(a - b) < tolerance && std::abs(b - c) < tolerance &&
         std::abs(dot(m[0], m[1])) < tolerance && std::abs(dot(m[1], m[2])) < tolerance &&
         std::abs(dot(m[2], m[0])) < tolerance;
}

std::vector<vec3> transformed(const std::vector<vec3>& positions, const mat4& m) {
  std::vector<vec3> out(positions.size());
  parallel_for(
      positions.size(), [&](size_t i) { out[i] = vec3(m * vec4(positions[i], 1)); }, 4096);
  return out;
}

// What is to be clustered: one mesh primitive, or a bent copy of it for one instance.
struct TreeJob {
  const Primitive* primitive;
  bool bend = false;
  mat4 transform{1};
};

// Lists the parts of the scene, and the trees they need.
std::vector<TreeJob> list_parts(const Scene& scene, SurfaceSet& set) {
  std::vector<TreeJob> jobs;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> shared;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const mat3 linear(instance.transform);
    const bool bend = !is_similarity(linear);
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      Part part;
      part.instance = i;
      part.primitive = p;
      part.material = mesh.primitives[p].material;
      const bool mirrored = glm::determinant(linear) < 0;
      part.winding = mirrored ? -1.0f : 1.0f;
      if (bend) {
        part.tree = static_cast<uint32_t>(jobs.size());
        part.area_map = mat3(part.winding);
        jobs.push_back({&mesh.primitives[p], true, instance.transform});
      } else {
        const auto [entry, added] =
            shared.try_emplace({instance.mesh, p}, static_cast<uint32_t>(jobs.size()));
        if (added) jobs.push_back({&mesh.primitives[p]});
        part.tree = entry->second;
        part.to_world = instance.transform;
        part.scale = std::sqrt(std::cbrt(
            std::abs(dot(linear[0], linear[0]) * dot(linear[1], linear[1]) * dot(linear[2], linear[2]))));
        part.area_map = part.winding * area_vector_transform(linear);
      }
      set.parts.push_back(std::move(part));
    }
  }
  return jobs;
}

uint32_t count_clamped(const Scene& scene) {
  uint32_t clamped = 0;
  for (const Material& m : scene.materials) {
    const vec3 reflectance = m.base_colour * (1 - m.metallic) * (1 - m.transmission);
    if (std::max({reflectance.x, reflectance.y, reflectance.z}) > kMaxReflectance) ++clamped;
  }
  return clamped;
}

void list_surfaces(SurfaceSet& set) {
  for (uint32_t p = 0; p < set.parts.size(); ++p) {
    Part& part = set.parts[p];
    part.first_triangle = set.triangles;
    const FaceClusterTree& tree = set.tree(part);
    set.triangles += static_cast<uint32_t>(tree.mesh.triangles.size());
    set.skipped.degenerate += tree.mesh.skipped.degenerate;
    set.skipped.not_finite += tree.mesh.skipped.not_finite;
    set.skipped.duplicate += tree.mesh.skipped.duplicate;
    for (const ClusterRef root : tree.roots) {
      if (is_triangle(root)) {
        const UVec3& c = tree.mesh.triangles[triangle_of(root)];
        set.area += static_cast<double>(
            length(area_vector(part.positions[c.x], part.positions[c.y], part.positions[c.z])));
      } else {
        set.area += static_cast<double>(tree.nodes[root].area * part.scale * part.scale);
      }
    }
    const Material& material = set.scene->materials[part.material];
    if (material.unlit) continue;
    for (const ClusterRef root : tree.roots) {
      set.surfaces.push_back({p, root, false});
      if (material.lit_behind()) set.surfaces.push_back({p, root, true});
    }
  }
}

}  // namespace

SurfaceSet build_surfaces(const Scene& scene, const CancelToken& cancel) {
  SurfaceSet set;
  set.scene = &scene;
  const std::vector<TreeJob> jobs = list_parts(scene, set);
  set.trees.resize(jobs.size());
  parallel_for(jobs.size(), [&](size_t j) {
    if (cancel.cancelled()) return;
    const Primitive& primitive = *jobs[j].primitive;
    TriangleMesh mesh = jobs[j].bend
                            ? weld(transformed(primitive.positions, jobs[j].transform), primitive.indices)
                            : weld(primitive.positions, primitive.indices);
    set.trees[j] = build_face_clusters(std::move(mesh));
  });
  for (const FaceClusterTree& tree : set.trees) set.face_clusters += tree.nodes.size();
  parallel_for(set.parts.size(), [&](size_t p) {
    Part& part = set.parts[p];
    part.positions = transformed(set.tree(part).mesh.positions, part.to_world);
    if (!cancel.cancelled()) paint_part(set, part);
  });
  list_surfaces(set);
  for (const Part& part : set.parts) {
    set.has_glass |= scene.materials[part.material].is_glass();
    set.has_translucent |= scene.materials[part.material].is_translucent();
  }
  set.clamped_materials = count_clamped(scene);
  return set;
}

namespace {

// 2 where light that goes through may change its colour, 1 where it goes through unchanged but for its
// strength.
uint8_t see_through_mark(const SurfaceSet& set, const Part& part) {
  const Material& m = set.scene->materials[part.material];
  if (!m.is_see_through()) return 0;
  const Primitive& primitive =
      set.scene->meshes[set.scene->instances[part.instance].mesh].primitives[part.primitive];
  return m.is_glass() && (m.is_coloured() || !primitive.colours.empty()) ? 2 : 1;
}

}  // namespace

WorldTriangles world_triangles(const SurfaceSet& set) {
  WorldTriangles world;
  size_t vertices = 0;
  for (const Part& part : set.parts) vertices += part.positions.size();
  world.positions.reserve(vertices);
  world.triangles.reserve(set.triangles);
  bool see_through = false;
  std::vector<uint8_t> marks;
  for (const Part& part : set.parts) {
    const auto offset = static_cast<uint32_t>(world.positions.size());
    world.positions.insert(world.positions.end(), part.positions.begin(), part.positions.end());
    const Material& material = set.scene->materials[part.material];
    see_through |= material.is_see_through();
    for (const UVec3& t : set.tree(part).mesh.triangles) world.triangles.push_back(t + UVec3(offset));
    marks.resize(world.triangles.size(), see_through_mark(set, part));
  }
  if (see_through) world.see_through = std::move(marks);
  return world;
}

const Part& part_of_triangle(const SurfaceSet& set, uint32_t triangle) {
  const auto after = std::upper_bound(set.parts.begin(), set.parts.end(), triangle,
                                      [](uint32_t t, const Part& part) { return t < part.first_triangle; });
  return *(after - 1);
}

TriangleRange triangles_of(const SurfaceSet& set, const Surface& surface) {
  if (is_triangle(surface.root)) return {triangle_of(surface.root), 1};
  const FaceCluster& node = set.tree(set.parts[surface.part]).nodes[surface.root];
  return {node.first, node.count};
}

Box box_of(const SurfaceSet& set, const Surface& surface) {
  const Part& part = set.parts[surface.part];
  const TriangleRange range = triangles_of(set, surface);
  Box box;
  for (uint32_t t = range.first; t < range.first + range.count; ++t)
    for (int k = 0; k < 3; ++k) box.add(part.positions[set.tree(part).mesh.triangles[t][k]]);
  return box;
}

}  // namespace goldthread
