// The node hierarchy of a glTF file, and the cameras that hang in it.
#pragma once
#include <string>
#include <vector>

#include "files/gltf_load.h"
#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// Every node's placement, and which of them the file's scene shows.
struct NodePlacements {
  std::vector<glm::dmat4> world;  ///< node to world
  std::vector<bool> shown;        ///< under a root of the scene
};

/// Walks the hierarchy without recursion. The scene is the default one, else the first, else all root nodes.
/// Nodes that form a cycle, have two parents or do not exist are an Error.
Result<NodePlacements> place_nodes(const tinygltf::Model& model, const std::string& file);

/// Appends the cameras of all shown nodes, in the order of the nodes.
Status read_gltf_cameras(const tinygltf::Model& model, const std::string& file, const NodePlacements& nodes,
                         Scene& scene);

}  // namespace goldthread
