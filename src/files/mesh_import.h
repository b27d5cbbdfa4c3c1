// What assimp makes of a file, checked before anything trusts it.
#pragma once
#include <assimp/Importer.hpp>
#include <cstdint>
#include <string>

#include "goldthread/error.h"

struct aiScene;

namespace goldthread {

enum class MeshFormat : uint8_t { kObj, kPly, kStl, kFbx, kCollada };

/// The format that the file's ending names, in either case; kObj for endings of none.
MeshFormat mesh_format(const std::string& file);

/// Reads the file into `importer`, which owns the scene: triangles only, equal vertices joined, metres where
/// the format knows its unit. Every index of its faces is in range. An Error (kBadInput) for files that
/// cannot be opened, are empty, are of another format than their name says, are cut off, or that assimp
/// refuses. A file without meshes is a scene without meshes.
Result<const aiScene*> import_mesh_file(const std::string& file, Assimp::Importer& importer);

/// Text out of a file, fit for a message: one line of at most 200 characters, unprintable ones as '?'.
std::string plain_text(const std::string& text);

}  // namespace goldthread
