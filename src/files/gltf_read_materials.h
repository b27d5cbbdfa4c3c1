// glTF materials, textures and pictures, reduced to what diffuse light needs.
#pragma once
#include <string>

#include "files/gltf_load.h"
#include "files/gltf_read.h"
#include "goldthread/error.h"
#include "scene/scene.h"

namespace goldthread {

/// Appends the model's materials to `scene.materials`, in order and all of them, and the pictures that their
/// base colour, metallic-roughness, emissive and other textures that count use to `scene.images`. Pictures
/// that are missing, broken or of a kind that cannot be decoded leave the factor alone and add a warning
/// each. Numbers of textures, pictures or samplers that do not exist are an Error.
Status read_gltf_materials(const tinygltf::Model& model, const std::string& file, NormalTextures normals,
                           Scene& scene);

/// What primitives without any material get: white paper rather than glTF's default, a perfect metal that
/// reflects no diffuse light.
Material default_material();

}  // namespace goldthread
