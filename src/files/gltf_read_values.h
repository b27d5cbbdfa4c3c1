// Members of glTF extension objects, as tinygltf keeps them, with defaults for what is absent or of another
// type.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "files/gltf_load.h"
#include "math/vec.h"

namespace goldthread {

/// Whether a file may require this extension without our having to say anything: it is read, or it changes
/// nothing about diffuse light. Compression is undone before anyone asks.
inline bool is_known_extension(std::string_view name) {
  constexpr std::array<std::string_view, 12> kKnown = {
      "KHR_mesh_quantization", "KHR_texture_transform",  "KHR_lights_punctual", "KHR_texture_basisu",
      "EXT_lights_ies",        "EXT_lights_image_based", "EXT_texture_webp",    "EXT_mesh_gpu_instancing",
      "KHR_xmp_json_ld",       "KHR_animation_pointer",  "EXT_lights_area",     "MOZ_lightmap"};
  return name.starts_with("KHR_materials_") || std::find(kKnown.begin(), kKnown.end(), name) != kKnown.end();
}

/// In a lamp's extras: the intensity that it had before its light was put on textures and it was turned off.
constexpr const char* kBakedIntensity = "goldthread_baked_intensity";

/// The extension object `name`, or null.
inline const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

/// Member `key` if it is an object, or null.
inline const tinygltf::Value* object_member(const tinygltf::Value& object, const char* key) {
  return object.Has(key) && object.Get(key).IsObject() ? &object.Get(key) : nullptr;
}

inline float number_member(const tinygltf::Value& object, const char* key, float otherwise) {
  return object.Has(key) && object.Get(key).IsNumber() ? float(object.Get(key).GetNumberAsDouble())
                                                       : otherwise;
}

/// A whole number of any sign.
inline std::optional<int> int_member(const tinygltf::Value& object, const char* key) {
  if (!object.Has(key) || !object.Get(key).IsInt()) return std::nullopt;
  return object.Get(key).GetNumberAsInt();
}

/// An array of numbers that may be shorter or longer than the vector: only what both have is taken.
template <typename Vector>
Vector vector_member(const tinygltf::Value& object, const char* key, Vector value) {
  if (!object.Has(key) || !object.Get(key).IsArray()) return value;
  const tinygltf::Value& array = object.Get(key);
  for (int i = 0; i < Vector::length() && size_t(i) < array.ArrayLen(); ++i)
    if (array.Get(i).IsNumber()) value[i] = float(array.Get(i).GetNumberAsDouble());
  return value;
}

/// The same for tinygltf's own arrays of numbers.
template <typename Vector>
Vector vector_of(const std::vector<double>& numbers, Vector value) {
  for (int i = 0; i < Vector::length() && size_t(i) < numbers.size(); ++i)
    value[i] = float(numbers[size_t(i)]);
  return value;
}

}  // namespace goldthread
