// Undoing EXT_meshopt_compression and KHR_draco_mesh_compression inside a glTF model.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "files/gltf_load.h"
#include "goldthread/error.h"

namespace goldthread {

/// Whether a buffer (as JSON) is meshopt's fallback: present in the file by length only.
bool is_meshopt_fallback(const nlohmann::json& buffer);

/// Whether the bytes of this view are still to be decoded by meshopt.
bool is_meshopt_view(const tinygltf::BufferView& view);

/// Decodes all compressed views and primitives into one buffer appended to the model, and makes the model one
/// that was never compressed (see load_gltf_model). Views that are not compressed must have been checked.
/// Sizes claimed by the file are compared with what its bytes could hold before memory is taken.
Status expand_compression(tinygltf::Model& model, const std::string& file);

}  // namespace goldthread
