// Placements, lights and cameras as glTF nodes.
#pragma once
#include "files/gltf_document.h"
#include "scene/scene.h"

namespace goldthread {

/// Appends a node that carries `content` under `transform` to the scene graph's roots; returns the node
/// `content` went into. A transform with shear, which one glTF node cannot hold, becomes two nodes, one
/// inside the other.
uint32_t build_node(GltfDocument& document, const mat4& transform, Json content);

void build_lights(GltfDocument& document, const Scene& scene);
void build_cameras(GltfDocument& document, const Scene& scene);

}  // namespace goldthread
