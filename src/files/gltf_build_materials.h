// A Scene's materials and pictures as glTF's.
#pragma once
#include "files/gltf_document.h"
#include "scene/scene.h"

namespace goldthread {

/// Appends all images, and all materials with the textures and samplers they use, in the Scene's order.
void build_materials(GltfDocument& document, const Scene& scene);

}  // namespace goldthread
