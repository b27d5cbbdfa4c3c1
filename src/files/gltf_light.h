// Light into a glTF document: new attributes, refined meshes, meshes of their own for instances lit
// differently.
#pragma once
#include "files/gltf_build.h"
#include "files/gltf_document.h"
#include "files/gltf_geometry.h"
#include "files/scene_write.h"
#include "goldthread/error.h"

namespace goldthread {

/// Changes the primitives in `lighting`, and no others. May throw Json::exception on a document whose members
/// have other types than glTF gives them.
Status add_lighting(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                    const Lighting& lighting, const SceneWriteOptions& options, const SourceReader& read);

}  // namespace goldthread
