// A glTF document to its file or files.
#pragma once
#include <string>

#include "files/gltf_document.h"

namespace goldthread {

/// Writes .glb, or .gltf with one .bin of the same name beside it (both appear, or neither). External images
/// go into the buffer, except where `file` is a .gltf in the source's own folder: there their URIs still
/// hold. An image that cannot be found keeps its URI.
Status write_gltf_document(const std::string& file, GltfDocument document);

}  // namespace goldthread
