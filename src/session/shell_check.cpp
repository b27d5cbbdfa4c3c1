#include "session/shell_check.h"

#include "mesh/dual_graph.h"

namespace goldthread {
namespace {

bool contains(const Box& box, const vec3& p) {
  return glm::all(glm::greaterThanEqual(p, box.low)) && glm::all(glm::lessThanEqual(p, box.high));
}

Box placed(const Box& box, const mat4& transform) {
  Box out;
  if (box.empty()) return out;
  for (int corner = 0; corner < 8; ++corner) {
    const vec3 p(corner & 1 ? box.high.x : box.low.x, corner & 2 ? box.high.y : box.low.y,
                 corner & 4 ? box.high.z : box.low.z);
    out.add(vec3(transform * vec4(p, 1)));
  }
  return out;
}

Box bounds_of(const Mesh& mesh) {
  Box box;
  for (const Primitive& primitive : mesh.primitives)
    for (const vec3& p : primitive.positions)
      if (is_finite(p)) box.add(p);
  return box;
}

}  // namespace

JoinedMesh join_primitives(const Mesh& mesh) {
  std::vector<vec3> positions;
  std::vector<uint32_t> indices;
  JoinedMesh joined;
  for (const Primitive& primitive : mesh.primitives) {
    const auto first = static_cast<uint32_t>(positions.size());
    joined.first_triangle.push_back(static_cast<uint32_t>(indices.size() / 3));
    positions.insert(positions.end(), primitive.positions.begin(), primitive.positions.end());
    for (uint32_t index : primitive.indices) indices.push_back(first + index);
  }
  joined.mesh = weld(positions, indices);
  joined.twins = find_twins(joined.mesh);
  return joined;
}

ShellCheck::ShellCheck(const Scene& scene) : scene_(scene) {
  std::vector<Box> mesh_boxes;
  for (const Mesh& mesh : scene.meshes) mesh_boxes.push_back(bounds_of(mesh));
  for (const Instance& instance : scene.instances) {
    uint64_t triangles = 0;
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives)
      triangles += primitive.triangle_count();
    instance_boxes_.push_back(placed(mesh_boxes[instance.mesh], instance.transform));
    instance_triangles_.push_back(triangles);
    triangles_ += triangles;
  }
}

std::vector<uint8_t> ShellCheck::find_rooms(uint32_t mesh, const Winding& winding) const {
  std::vector<uint8_t> rooms(winding.shells.size(), 0);
  for (size_t s = 0; s < rooms.size(); ++s)
    rooms[s] = winding.shells[s].faces_inwards() && is_room(winding.shells[s].box, mesh);
  return rooms;
}

bool ShellCheck::is_room(const Box& box, uint32_t mesh) const {
  for (size_t i = 0; i < scene_.instances.size(); ++i) {
    if (scene_.instances[i].mesh != mesh) continue;
    const Box room = placed(box, scene_.instances[i].transform);
    for (const Camera& camera : scene_.cameras)
      if (contains(room, camera.position)) return true;
    uint64_t others = 0, inside = 0;
    for (size_t j = 0; j < scene_.instances.size(); ++j) {
      if (j == i) continue;
      others += instance_triangles_[j];
      if (contains(room, instance_boxes_[j].low) && contains(room, instance_boxes_[j].high))
        inside += instance_triangles_[j];
    }
    if (others > 0 && 2 * inside > others) return true;
  }
  return false;
}

}  // namespace goldthread
