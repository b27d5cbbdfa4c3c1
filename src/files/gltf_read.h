// A glTF or GLB file as a scene.
#pragma once
#include <cstdint>
#include <string>

#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// Whether normal textures, and the tangents that belong to them, are read. Their pictures are as large as
/// any, and only who measures light at places of surfaces has a use for them. Other formats' are never read.
enum class NormalTextures : uint8_t { kLeftOut, kRead };

/// Reads the file's scene. Instances are in the order of the file's nodes; nodes with the same mesh share it
/// here too, unless their morph weights or skins differ. With EXT_mesh_gpu_instancing a node gives several
/// instances of the same source_node.
Result<Scene> read_gltf(const std::string& file, NormalTextures normals);

}  // namespace goldthread
