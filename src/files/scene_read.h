// One door for all scene files: the extension and the first bytes decide the reader.
#pragma once
#include <string>

#include "files/gltf_read.h"
#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// Reads .gltf/.glb (tinygltf) or .obj/.ply/.stl/.fbx/.dae (assimp). Errors name file, place and cure.
/// Every index in the returned Scene is in range; counts in the file are checked before anything is
/// allocated.
Result<Scene> read_scene(const std::string& file, NormalTextures normals = NormalTextures::kLeftOut);

}  // namespace goldthread
