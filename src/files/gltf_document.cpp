#include "files/gltf_document.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace goldthread {
namespace {

constexpr uint32_t kArrayBuffer = 34962, kElementArrayBuffer = 34963;

uint32_t append_accessor(GltfDocument& document, uint32_t view, ComponentType component,
                         std::string_view type, size_t count) {
  return append_to(document, "accessors",
                   {{"bufferView", view},
                    {"componentType", static_cast<uint32_t>(component)},
                    {"count", count},
                    {"type", type}});
}

/// `values` as floats, N to an element.
uint32_t append_floats(GltfDocument& document, std::span<const float> values, std::string_view type,
                       size_t count) {
  const uint32_t view =
      append_view(document, {reinterpret_cast<const uint8_t*>(values.data()), values.size_bytes()});
  document.json["bufferViews"][view]["target"] = kArrayBuffer;
  const size_t start = document.json["bufferViews"][view]["byteOffset"];
  for (size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i])) std::memset(document.bin.data() + start + 4 * i, 0, 4);
  return append_accessor(document, view, ComponentType::kFloat, type, count);
}

template <typename Vector>
std::span<const float> as_floats(std::span<const Vector> values) {
  static_assert(sizeof(Vector) == sizeof(float) * static_cast<size_t>(Vector::length()));
  return {reinterpret_cast<const float*>(values.data()),
          values.size() * static_cast<size_t>(Vector::length())};
}

}  // namespace

uint32_t component_size(ComponentType type) {
  switch (type) {
    case ComponentType::kByte:
    case ComponentType::kUnsignedByte:
      return 1;
    case ComponentType::kShort:
    case ComponentType::kUnsignedShort:
      return 2;
    case ComponentType::kUnsignedInt:
    case ComponentType::kFloat:
      return 4;
  }
  return 0;
}

uint32_t component_count(std::string_view type) {
  constexpr std::pair<std::string_view, uint32_t> kTypes[] = {
      {"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}};
  for (const auto& [name, count] : kTypes)
    if (name == type) return count;
  return 0;
}

Json& top_array(GltfDocument& document, const char* key) {
  Json& array = document.json[key];
  if (array.is_null()) array = Json::array();
  return array;
}

uint32_t append_to(GltfDocument& document, const char* key, Json value) {
  Json& array = top_array(document, key);
  array.push_back(std::move(value));
  return static_cast<uint32_t>(array.size() - 1);
}

void use_extension(GltfDocument& document, const char* name) {
  Json& used = top_array(document, "extensionsUsed");
  for (const Json& known : used)
    if (known == name) return;
  used.push_back(name);
}

uint32_t append_view(GltfDocument& document, std::span<const uint8_t> bytes) {
  document.bin.resize((document.bin.size() + 3) / 4 * 4);
  const size_t start = document.bin.size();
  document.bin.insert(document.bin.end(), bytes.begin(), bytes.end());
  return append_to(document, "bufferViews",
                   {{"buffer", 0}, {"byteOffset", start}, {"byteLength", bytes.size()}});
}

uint32_t append_attribute(GltfDocument& document, std::span<const float> values) {
  return append_floats(document, values, "SCALAR", values.size());
}
uint32_t append_attribute(GltfDocument& document, std::span<const vec2> values) {
  return append_floats(document, as_floats(values), "VEC2", values.size());
}
uint32_t append_attribute(GltfDocument& document, std::span<const vec3> values) {
  return append_floats(document, as_floats(values), "VEC3", values.size());
}
uint32_t append_attribute(GltfDocument& document, std::span<const vec4> values) {
  return append_floats(document, as_floats(values), "VEC4", values.size());
}

uint32_t append_positions(GltfDocument& document, std::span<const vec3> values) {
  const uint32_t accessor = append_attribute(document, values);
  vec3 low(std::numeric_limits<float>::max()), high(std::numeric_limits<float>::lowest());
  for (vec3 position : values) {
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(position[c])) position[c] = 0;  // as append_attribute writes it
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  document.json["accessors"][accessor]["min"] = json_array({&low.x, 3});
  document.json["accessors"][accessor]["max"] = json_array({&high.x, 3});
  return accessor;
}

uint32_t append_elements(GltfDocument& document, std::span<const uint8_t> elements, ComponentType component,
                         std::string_view type, bool normalized, size_t count) {
  const size_t size = component_size(component) * component_count(type);
  const size_t stride = (size + 3) / 4 * 4;
  std::vector<uint8_t> padded(stride * count);
  for (size_t i = 0; i < count; ++i)
    std::memcpy(padded.data() + i * stride, elements.data() + i * size, size);
  const uint32_t view = append_view(document, padded);
  document.json["bufferViews"][view]["target"] = kArrayBuffer;
  if (stride != size) document.json["bufferViews"][view]["byteStride"] = stride;
  const uint32_t accessor = append_accessor(document, view, component, type, count);
  if (normalized) document.json["accessors"][accessor]["normalized"] = true;
  return accessor;
}

uint32_t append_indices(GltfDocument& document, std::span<const uint32_t> indices, size_t vertex_count) {
  const bool narrow = vertex_count <= 65535;  // 65535 itself would restart the primitive
  std::vector<uint16_t> halves;
  if (narrow) halves.assign(indices.begin(), indices.end());
  const void* data =
      narrow ? static_cast<const void*>(halves.data()) : static_cast<const void*>(indices.data());
  const size_t bytes = indices.size() * (narrow ? 2 : 4);
  const uint32_t view = append_view(document, {static_cast<const uint8_t*>(data), bytes});
  document.json["bufferViews"][view]["target"] = kElementArrayBuffer;
  return append_accessor(document, view, narrow ? ComponentType::kUnsignedShort : ComponentType::kUnsignedInt,
                         "SCALAR", indices.size());
}

double shortest(float value) {
  if (!std::isfinite(value)) return 0;
  return std::strtod(fmt::format("{}", value).c_str(), nullptr);
}

Json json_array(std::span<const float> values) {
  Json array = Json::array();
  for (float value : values) array.push_back(shortest(value));
  return array;
}

}  // namespace goldthread
