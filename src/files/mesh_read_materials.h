// Materials and textures of OBJ, PLY, STL, FBX and Collada as glTF has them.
#pragma once
#include "files/mesh_import.h"
#include "scene/scene.h"

struct aiScene;

namespace goldthread {

/// Fills scene.materials, one for each of the source's and never none, and scene.images, each decoded once.
/// `scene.file` must be set. A texture replaces the colour it is for where the format says so (FBX, Collada)
/// and where the file gives no colour beside it. Pictures are looked for where the file says, then by their
/// name alone beside the file and in `textures` there; what is not found is a warning.
void read_mesh_materials(const aiScene& source, MeshFormat format, Scene& scene);

/// Materials that no file gave (STL, most PLY, OBJ without a library) become plain grey, or white where
/// vertex colours paint them. Called when the meshes are there.
void paint_default_materials(const aiScene& source, MeshFormat format, Scene& scene);

}  // namespace goldthread
