#include "files/gltf_read_nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/gtc/type_ptr.hpp>

#include "files/gltf_read_container.h"
#include "files/gltf_read_values.h"

namespace goldthread {
namespace {

constexpr const char* kExportAgain = "export the file again";

std::string node_place(size_t node) {
  return fmt::format("node {}", node);
}

/// Node to parent: its matrix, or translation * rotation * scale.
Result<glm::dmat4> local_matrix(const tinygltf::Node& node, size_t index, const std::string& file) {
  const auto wrong = [](const std::vector<double>& values, size_t size) {
    return !values.empty() && values.size() != size;
  };
  if (wrong(node.matrix, 16) || wrong(node.translation, 3) || wrong(node.rotation, 4) || wrong(node.scale, 3))
    return bad_input(file, node_place(index), "its transform has the wrong number of numbers", kExportAgain);
  if (!node.matrix.empty()) return glm::dmat4(glm::make_mat4(node.matrix.data()));
  glm::dmat4 local(1);
  if (!node.translation.empty())
    local[3] = glm::dvec4(node.translation[0], node.translation[1], node.translation[2], 1);
  if (!node.rotation.empty()) {
    const std::vector<double>& r = node.rotation;  // x, y, z, w
    const glm::dquat rotation(r[3], r[0], r[1], r[2]);
    const double size = glm::length(rotation);
    if (size > 0) local *= glm::mat4_cast(rotation / size);
  }
  if (!node.scale.empty())
    for (int axis = 0; axis < 3; ++axis) local[axis] *= node.scale[size_t(axis)];
  return local;
}

/// Each node's parent or -1.
Result<std::vector<int>> find_parents(const tinygltf::Model& model, const std::string& file) {
  std::vector<int> parents(model.nodes.size(), -1);
  for (size_t i = 0; i < model.nodes.size(); ++i)
    for (const int child : model.nodes[i].children) {
      if (size_t(child) >= model.nodes.size())
        return bad_input(file, node_place(i), fmt::format("there is no node {}", child), kExportAgain);
      int& parent = parents[size_t(child)];
      if (parent != -1)
        return bad_input(file, node_place(size_t(child)),
                         fmt::format("it is a child of node {} and again of node {}", parent, i),
                         kExportAgain);
      parent = int(i);
    }
  return parents;
}

/// All nodes, parents before children. Nodes on a cycle have no root above them and are never reached.
Result<std::vector<size_t>> order_from_roots(const tinygltf::Model& model, const std::vector<int>& parents,
                                             const std::string& file) {
  std::vector<size_t> order;
  order.reserve(parents.size());
  for (size_t i = 0; i < parents.size(); ++i)
    if (parents[i] == -1) order.push_back(i);
  for (size_t next = 0; next < order.size(); ++next)
    for (const int child : model.nodes[order[next]].children) order.push_back(size_t(child));
  if (order.size() == parents.size()) return order;
  std::vector<bool> reached(parents.size(), false);
  for (const size_t node : order) reached[node] = true;
  const auto lost = std::find(reached.begin(), reached.end(), false);
  return bad_input(file, node_place(size_t(lost - reached.begin())), "it is its own ancestor", kExportAgain);
}

/// Marks the roots that the scene names.
Status mark_scene_roots(const tinygltf::Model& model, const std::string& file,
                        const std::vector<int>& parents, std::vector<bool>& shown) {
  if (model.scenes.empty() && model.defaultScene == -1) {
    for (size_t i = 0; i < parents.size(); ++i) shown[i] = parents[i] == -1;
    return Nothing{};
  }
  const size_t index = model.defaultScene == -1 ? 0 : size_t(model.defaultScene);
  if (index >= model.scenes.size())
    return bad_input(file, fmt::format("scene {}", model.defaultScene), "there is no such scene",
                     kExportAgain);
  for (const int root : model.scenes[index].nodes) {
    if (size_t(root) >= model.nodes.size())
      return bad_input(file, fmt::format("scene {}", index), fmt::format("there is no node {}", root),
                       kExportAgain);
    shown[size_t(root)] = true;
  }
  return Nothing{};
}

vec3 direction(const glm::dmat4& world, const glm::dvec3& local, const vec3& otherwise) {
  return normalize_or(vec3(glm::dmat3(world) * local), otherwise);
}

Camera convert_camera(const tinygltf::Camera& source, const glm::dmat4& world) {
  Camera camera;
  camera.position = vec3(world[3]);
  camera.forward = direction(world, {0, 0, -1}, vec3(0, 0, -1));
  const vec3 up = direction(world, {0, 1, 0}, vec3(0, 1, 0));
  // A sheared node bends the axes; up is kept square to forward.
  camera.up = normalize_or(up - dot(up, camera.forward) * camera.forward, up);
  if (source.type == "orthographic") {
    const float width = std::abs(float(source.orthographic.xmag)),
                height = std::abs(float(source.orthographic.ymag));
    camera.vertical_fov = 0;
    camera.orthographic_height = 2 * height;
    camera.aspect = height > 0 ? width / height : 0;
  } else {
    if (source.perspective.yfov > 0) camera.vertical_fov = std::min(float(source.perspective.yfov), 3.1f);
    camera.aspect = std::max(float(source.perspective.aspectRatio), 0.0f);
  }
  return camera;
}

}  // namespace

Result<NodePlacements> place_nodes(const tinygltf::Model& model, const std::string& file) {
  const Result<std::vector<int>> parents = find_parents(model, file);
  if (!parents) return parents.error();
  const Result<std::vector<size_t>> order = order_from_roots(model, *parents, file);
  if (!order) return order.error();
  NodePlacements nodes;
  nodes.world.resize(model.nodes.size(), glm::dmat4(1));
  nodes.shown.resize(model.nodes.size(), false);
  if (Status status = mark_scene_roots(model, file, *parents, nodes.shown); !status) return status.error();
  for (const size_t node : *order) {
    const Result<glm::dmat4> local = local_matrix(model.nodes[node], node, file);
    if (!local) return local.error();
    const int parent = (*parents)[node];
    nodes.world[node] = parent == -1 ? *local : nodes.world[size_t(parent)] * *local;
    if (parent != -1 && nodes.shown[size_t(parent)]) nodes.shown[node] = true;
  }
  return nodes;
}

Status read_gltf_cameras(const tinygltf::Model& model, const std::string& file, const NodePlacements& nodes,
                         Scene& scene) {
  for (size_t i = 0; i < model.nodes.size(); ++i) {
    const int index = model.nodes[i].camera;
    if (!nodes.shown[i] || index == -1) continue;
    if (size_t(index) >= model.cameras.size())
      return bad_input(file, node_place(i), fmt::format("there is no camera {}", index), kExportAgain);
    Camera camera = convert_camera(model.cameras[size_t(index)], nodes.world[i]);
    const std::string& name = model.cameras[size_t(index)].name;
    camera.name = name.empty() ? model.nodes[i].name : name;
    scene.cameras.push_back(std::move(camera));
  }
  return Nothing{};
}

}  // namespace goldthread
