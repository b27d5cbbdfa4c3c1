// Scenes in the formats that assimp reads: OBJ, PLY, STL, FBX and Collada.
#pragma once
#include <string>

#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// Reads the file through assimp: metres and Y up where the format says what its units and axes are (FBX,
/// Collada), triangulated, equal vertices joined. One glTF-like material for each of the file's: diffuse
/// colour and texture as they stand, emission as nits, not metallic unless the file has a number for that.
/// Vertex colours are taken as sRGB, as exporters write them. Objects that an FBX hides are left out.
/// Instance::source_node is the running number of the instance; source_primitive is always 0. Lights carry
/// the file's own numbers as candela or lux, with a warning: these formats know no photometric units.
Result<Scene> read_mesh_file(const std::string& file);

}  // namespace goldthread
