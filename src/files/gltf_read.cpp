#include "files/gltf_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "files/gltf_load.h"
#include "files/gltf_read_accessors.h"
#include "files/gltf_read_container.h"
#include "files/gltf_read_lights.h"
#include "files/gltf_read_materials.h"
#include "files/gltf_read_nodes.h"
#include "files/gltf_read_primitives.h"
#include "files/gltf_read_surroundings.h"
#include "files/gltf_read_values.h"

namespace goldthread {
namespace {

constexpr const char* kExportAgain = "export the file again";

/// Puts instances of the model's meshes into the scene.
class InstanceReader {
 public:
  InstanceReader(const tinygltf::Model& model, const std::string& file, const NodePlacements& nodes,
                 Scene& scene)
      : model_(model), file_(file), nodes_(nodes), scene_(scene), accessors_(model, file) {}

  Status read(size_t node_index) {
    const tinygltf::Node& node = model_.nodes[node_index];
    if (node.mesh == -1) return Nothing{};
    place_ = fmt::format("node {}", node_index);
    if (size_t(node.mesh) >= model_.meshes.size())
      return bad_input(file_, place_, fmt::format("there is no mesh {}", node.mesh), kExportAgain);
    const Result<uint32_t> mesh = node.skin == -1 ? shared_mesh(node) : skinned_mesh(node, node_index);
    if (!mesh) return mesh.error();
    Instance instance;
    instance.mesh = *mesh;
    instance.source_node = uint32_t(node_index);
    instance.name = node.name.empty() ? model_.meshes[size_t(node.mesh)].name : node.name;
    if (node.skin == -1) instance.transform = mat4(nodes_.world[node_index]);
    const auto* instancing = find_extension(node.extensions, "EXT_mesh_gpu_instancing");
    if (instancing && node.skin == -1)
      return place_instances(*instancing, nodes_.world[node_index], instance);
    scene_.instances.push_back(std::move(instance));
    return Nothing{};
  }

 private:
  const std::vector<double>& morph_weights(const tinygltf::Node& node) const {
    return node.weights.empty() ? model_.meshes[size_t(node.mesh)].weights : node.weights;
  }

  Result<uint32_t> append_mesh(const tinygltf::Node& node, const MeshPose& pose) {
    Result<Mesh> mesh = read_gltf_mesh(accessors_, size_t(node.mesh), pose, scene_);
    if (!mesh) return mesh.error();
    scene_.meshes.push_back(*std::move(mesh));
    return uint32_t(scene_.meshes.size() - 1);
  }

  Result<uint32_t> shared_mesh(const tinygltf::Node& node) {
    MeshPose pose;
    pose.weights = morph_weights(node);
    const auto key = std::make_pair(node.mesh, pose.weights);
    const auto known = shared_.find(key);
    if (known != shared_.end()) return known->second;
    Result<uint32_t> mesh = append_mesh(node, pose);
    if (mesh) shared_.emplace(key, *mesh);
    return mesh;
  }

  Result<uint32_t> skinned_mesh(const tinygltf::Node& node, size_t node_index) {
    if (size_t(node.skin) >= model_.skins.size())
      return bad_input(file_, place_, fmt::format("there is no skin {}", node.skin), kExportAgain);
    MeshPose pose;
    pose.weights = morph_weights(node);
    pose.skinned = true;
    pose.node = mat4(nodes_.world[node_index]);
    if (Status status = read_joints(size_t(node.skin), pose.joints); !status) return status.error();
    return append_mesh(node, pose);
  }

  /// Joint to world times inverse bind matrix, for each joint (glTF 2.0 section 3.7.3.3).
  Status read_joints(size_t skin_index, std::vector<mat4>& joints) {
    const tinygltf::Skin& skin = model_.skins[skin_index];
    const std::string skin_place = fmt::format("skin {}", skin_index);
    std::vector<mat4> inverse_bind(skin.joints.size(), mat4(1));
    if (skin.inverseBindMatrices != -1) {
      Result<std::vector<mat4>> matrices = accessors_.mat4s(skin.inverseBindMatrices);
      if (!matrices) return matrices.error();
      if (matrices->size() < skin.joints.size())
        return bad_input(
            file_, skin_place,
            fmt::format("{} inverse bind matrices for {} joints", matrices->size(), skin.joints.size()),
            kExportAgain);
      inverse_bind = *std::move(matrices);
    }
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      const int joint = skin.joints[j];
      if (size_t(joint) >= nodes_.world.size())
        return bad_input(file_, skin_place, fmt::format("there is no node {}", joint), kExportAgain);
      joints.push_back(mat4(nodes_.world[size_t(joint)] * glm::dmat4(inverse_bind[j])));
    }
    return Nothing{};
  }

  /// An attribute of EXT_mesh_gpu_instancing as floats, empty if absent.
  Result<std::vector<float>> instancing_attribute(const tinygltf::Value& extension, const char* name,
                                                  int components) {
    const tinygltf::Value* attributes = object_member(extension, "attributes");
    const std::optional<int> accessor = attributes ? int_member(*attributes, name) : std::nullopt;
    return accessor ? accessors_.floats(*accessor, components) : std::vector<float>();
  }

  Status place_instances(const tinygltf::Value& extension, const glm::dmat4& world,
                         const Instance& prototype) {
    const Result<std::vector<float>> moved = instancing_attribute(extension, "TRANSLATION", 3);
    if (!moved) return moved.error();
    const Result<std::vector<float>> turned = instancing_attribute(extension, "ROTATION", 4);
    if (!turned) return turned.error();
    const Result<std::vector<float>> scaled = instancing_attribute(extension, "SCALE", 3);
    if (!scaled) return scaled.error();
    const size_t count = std::max({moved->size() / 3, turned->size() / 4, scaled->size() / 3});
    const auto fits = [count](size_t size, size_t components) {
      return size == 0 || size == count * components;
    };
    if (!fits(moved->size(), 3) || !fits(turned->size(), 4) || !fits(scaled->size(), 3))
      return bad_input(file_, place_, "its instancing attributes differ in length", kExportAgain);
    if (Status status = accessors_.spend(count * sizeof(Instance), place_); !status) return status;
    for (size_t i = 0; i < count; ++i) {
      glm::dmat4 local(1);
      if (!moved->empty())
        local[3] = glm::dvec4((*moved)[3 * i], (*moved)[3 * i + 1], (*moved)[3 * i + 2], 1);
      if (!turned->empty()) {
        const float* q = &(*turned)[4 * i];
        local *= glm::mat4_cast(
            glm::normalize(glm::dquat(double(q[3]), double(q[0]), double(q[1]), double(q[2]))));
      }
      if (!scaled->empty())
        for (int axis = 0; axis < 3; ++axis) local[axis] *= double((*scaled)[3 * i + size_t(axis)]);
      scene_.instances.push_back(prototype);
      scene_.instances.back().transform = mat4(world * local);
    }
    return Nothing{};
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  const NodePlacements& nodes_;
  Scene& scene_;
  AccessorReader accessors_;
  std::string place_;
  std::map<std::pair<int, std::vector<double>>, uint32_t> shared_;  ///< mesh and weights -> Scene::meshes
};

Result<Scene> read(const std::string& file, NormalTextures normals) {
  const Result<tinygltf::Model> model = load_gltf_model(file);
  if (!model) return model.error();
  Scene scene;
  scene.file = file;
  for (const std::string& name : model->extensionsRequired)
    if (!is_known_extension(name))
      scene.warnings.push_back(fmt::format("the file requires {}, which is unknown; read without it", name));
  if (Status status = read_gltf_materials(*model, file, normals, scene); !status) return status.error();
  const Result<NodePlacements> nodes = place_nodes(*model, file);
  if (!nodes) return nodes.error();
  InstanceReader instances(*model, file, *nodes, scene);
  for (size_t i = 0; i < model->nodes.size(); ++i)
    if (nodes->shown[i])
      if (Status status = instances.read(i); !status) return status.error();
  if (Status status = read_gltf_lights(*model, file, *nodes, scene); !status) return status.error();
  read_gltf_surroundings(*model, scene);
  if (Status status = read_gltf_cameras(*model, file, *nodes, scene); !status) return status.error();
  return scene;
}

}  // namespace

Result<Scene> read_gltf(const std::string& file, NormalTextures normals) {
  try {
    return read(file, normals);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::kLimit, "out of memory while reading", file, "", "close other programs"};
  } catch (const std::exception& problem) {
    return bad_input(file, "", problem.what(), kExportAgain);
  }
}

}  // namespace goldthread
