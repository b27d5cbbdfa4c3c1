// A glTF or GLB file as a scene.
#pragma once
#include <string>

#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// Reads the file's scene. Instances are in the order of the file's nodes; nodes with the same mesh share it
/// here too, unless their morph weights or skins differ. With EXT_mesh_gpu_instancing a node gives several
/// instances of the same source_node.
Result<Scene> read_gltf(const std::string& file);

}  // namespace goldthread
