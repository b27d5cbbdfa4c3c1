#include "session/fix_normals.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "session/light_setup.h"
#include "session/shell_check.h"

namespace goldthread {
namespace {

bool is_two_sided(const Scene& scene, const Mesh& mesh) {
  return std::all_of(mesh.primitives.begin(), mesh.primitives.end(),
                     [&](const Primitive& p) { return scene.materials[p.material].double_sided; });
}

/// A vertex normal is turned with most of the triangles at it.
void turn_normals(Primitive& primitive, const std::vector<uint8_t>& turned) {
  if (primitive.normals.empty()) return;
  std::vector<int32_t> balance(primitive.positions.size(), 0);
  for (size_t i = 0; i < primitive.indices.size(); ++i)
    balance[primitive.indices[i]] += turned[i / 3] ? 1 : -1;
  for (size_t v = 0; v < balance.size(); ++v)
    if (balance[v] > 0) {
      primitive.normals[v] = -primitive.normals[v];
      // The bitangent w cross(normal, tangent) stays where it was.
      if (!primitive.tangents.empty()) primitive.tangents[v].w *= -1;
    }
}

void turn_triangles(Primitive& primitive, const std::vector<uint8_t>& turned) {
  turn_normals(primitive, turned);
  for (size_t t = 0; t < turned.size(); ++t)
    if (turned[t]) std::swap(primitive.indices[3 * t + 1], primitive.indices[3 * t + 2]);
}

FixedNormals fix_mesh(Mesh& mesh, const JoinedMesh& joined, const Winding& winding,
                      const std::vector<uint8_t>& turn) {
  FixedNormals fixed;
  std::vector<std::vector<uint8_t>> turned;
  for (const Primitive& primitive : mesh.primitives)
    turned.emplace_back(primitive.triangle_count(), uint8_t{0});
  std::vector<uint8_t> touched(winding.shells.size(), 0);
  const auto mark = [&](uint32_t source) {
    const auto after = std::upper_bound(joined.first_triangle.begin(), joined.first_triangle.end(), source);
    const auto primitive = static_cast<size_t>(after - joined.first_triangle.begin()) - 1;
    turned[primitive][source - joined.first_triangle[primitive]] = 1;
    ++fixed.triangles;
  };
  for (size_t t = 0; t < turn.size(); ++t) {
    if (!turn[t]) continue;
    mark(joined.mesh.source_triangles[t]);
    touched[winding.shell_of_triangle[t]] = 1;
  }
  for (const DuplicateTriangle& duplicate : joined.mesh.duplicates)
    if (turn[duplicate.twin]) mark(duplicate.source);
  if (fixed.triangles == 0) return fixed;
  for (size_t p = 0; p < turned.size(); ++p) turn_triangles(mesh.primitives[p], turned[p]);
  fixed.shells = static_cast<uint32_t>(std::count(touched.begin(), touched.end(), 1));
  return fixed;
}

}  // namespace

FixedNormals fix_normals(Scene& scene) {
  const ShellCheck check(scene);
  FixedNormals all;
  for (uint32_t m = 0; m < scene.meshes.size(); ++m) {
    if (is_two_sided(scene, scene.meshes[m])) continue;
    const JoinedMesh joined = join_primitives(scene.meshes[m]);
    const Winding winding = find_winding(joined.mesh, joined.twins);
    const std::vector<uint8_t> turn = triangles_to_turn(winding, check.find_rooms(m, winding));
    const FixedNormals fixed = fix_mesh(scene.meshes[m], joined, winding, turn);
    all.triangles += fixed.triangles;
    all.shells += fixed.shells;
  }
  return all;
}

std::string fix_scene_normals(Scene& scene) {
  const FixedNormals fixed = fix_normals(scene);
  if (fixed.triangles == 0) return {};
  return fmt::format("turned {} triangles of {} shells that were wound the wrong way", fixed.triangles,
                     fixed.shells);
}

}  // namespace goldthread
