// A glTF file as it is being written: its whole JSON and one buffer.
//
// Light is added by editing the source's own JSON document, not by filling tinygltf's model and serialising
// that: tinygltf 2.7 drops what it has no field for (unknown keys beside the known ones, extensions on
// texture infos, unknown values of known keys, the order of everything), rewrites lights and images, and
// turns every number into its own type. A document that is only appended to loses nothing by construction.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "goldthread/error.h"
#include "math/vec.h"

namespace goldthread {

using Json = nlohmann::ordered_json;  // keys keep the source's order

struct GltfDocument {
  Json json = Json::object();
  std::vector<uint8_t> bin;  ///< what bufferViews of buffer 0 point into
  std::string source_file;   ///< what relative image URIs start from; empty when made from nothing
};

enum class ComponentType : uint32_t {
  kByte = 5120,
  kUnsignedByte = 5121,
  kShort = 5122,
  kUnsignedShort = 5123,
  kUnsignedInt = 5125,
  kFloat = 5126
};

/// Bytes of one component; 0 for a number that is no component type.
uint32_t component_size(ComponentType type);
/// Components of "SCALAR", "VEC3", "MAT4" ...; 0 for an unknown name.
uint32_t component_count(std::string_view type);

/// The array named `key` at the top of the document, made when missing.
Json& top_array(GltfDocument& document, const char* key);
/// Appends to a top-level array; returns the new index.
uint32_t append_to(GltfDocument& document, const char* key, Json value);
/// Lists an extension in extensionsUsed, once.
void use_extension(GltfDocument& document, const char* name);

/// Copies bytes to the end of the buffer, at a multiple of 4, and makes a bufferView of them.
uint32_t append_view(GltfDocument& document, std::span<const uint8_t> bytes);

/// New vertex attributes. Values that are not finite are written as 0: glTF allows none.
uint32_t append_attribute(GltfDocument& document, std::span<const float> values);
uint32_t append_attribute(GltfDocument& document, std::span<const vec2> values);
uint32_t append_attribute(GltfDocument& document, std::span<const vec3> values);
uint32_t append_attribute(GltfDocument& document, std::span<const vec4> values);
/// POSITION: as append_attribute, with the min and max that glTF demands there.
uint32_t append_positions(GltfDocument& document, std::span<const vec3> values);
/// Any element type, tightly packed in `elements`; padded to the 4 bytes a vertex attribute's stride must
/// divide into.
uint32_t append_elements(GltfDocument& document, std::span<const uint8_t> elements, ComponentType component,
                         std::string_view type, bool normalized, size_t count);
/// Indices for `vertex_count` vertices, 16 bits wide where that is enough.
uint32_t append_indices(GltfDocument& document, std::span<const uint32_t> indices, size_t vertex_count);

/// The double that prints as the shortest decimal which reads back as this float. 0 for NaN and infinity.
double shortest(float value);
Json json_array(std::span<const float> values);

}  // namespace goldthread
