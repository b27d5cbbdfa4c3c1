// The glTF file a scene was read from, opened again to have light written into it.
#pragma once
#include "files/gltf_build.h"
#include "files/gltf_document.h"
#include "files/gltf_load.h"
#include "scene/scene.h"

namespace goldthread {

struct GltfSource {
  GltfDocument document;  ///< the file's own JSON, all its buffers joined into one
  tinygltf::Model model;  ///< the same with compression undone: where attribute values are read
  DocumentMap map;
};

/// Reads scene.file again. An Error when it is gone, or no longer what the scene was read from.
Result<GltfSource> open_source(const Scene& scene);

}  // namespace goldthread
