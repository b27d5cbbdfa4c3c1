// Which node gets which mesh once instances of one mesh are lit differently.
#pragma once
#include <vector>

#include "files/gltf_light.h"

namespace goldthread {

/// Instances of one file mesh on which the light is the same: they share one mesh in the output.
struct LitGroup {
  uint32_t mesh = 0;                ///< of the file
  std::vector<uint32_t> instances;  ///< Scene::instances
  Json lit_mesh;                    ///< what that mesh becomes
};

/// Puts every group's mesh into the document and makes the nodes refer to it. A mesh that nobody would use
/// any more is replaced in place. A node with EXT_mesh_gpu_instancing whose copies differ becomes a parent of
/// plain nodes.
Status assign_meshes(GltfDocument& document, const DocumentMap& map, const std::vector<LitGroup>& groups,
                     const SourceReader& read, const std::string& file);

}  // namespace goldthread
