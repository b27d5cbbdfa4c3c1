// The values of one accessor, out of their buffer: what is needed to write them again elsewhere.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "files/gltf_document.h"
#include "files/gltf_load.h"
#include "goldthread/error.h"
#include "scene/lighting.h"

namespace goldthread {

/// Elements one after the other, without stride or padding, in their own component type.
struct Elements {
  ComponentType component = ComponentType::kFloat;
  std::string type = "SCALAR";
  bool normalized = false;
  size_t count = 0;
  std::vector<uint8_t> bytes;

  uint32_t components() const { return component_count(type); }
  size_t element_size() const { return size_t{component_size(component)} * components(); }
  /// As a shader sees it: normalized integers become 0..1 or -1..1.
  float value(size_t element, uint32_t which) const;
};

/// An accessor of `model`, sparse values applied. An Error when it does not have `expected_count` elements or
/// lies outside its buffer.
Result<Elements> read_elements(const tinygltf::Model& model, int accessor, size_t expected_count,
                               const std::string& file);

Elements to_elements(std::span<const vec2> values);
Elements to_elements(std::span<const vec3> values);
Elements to_elements(std::span<const vec4> values);

/// A new accessor of these elements, for use as a vertex attribute; with min and max for "POSITION".
uint32_t append_elements(GltfDocument& document, const Elements& elements, std::string_view attribute);

/// The attribute `name` of a refined mesh's vertices: exact copies at corners of the source, interpolated
/// elsewhere. Interpolated values become floats; normals and tangents are made unit again, a tangent's sign
/// is its nearest corner's. What has no in-between (joints and the weights that go with them, integers of
/// unknown meaning) is taken whole from the corner with the largest weight. `indices` is the source's
/// triangle list; `delta` says that this is a morph target's displacement, which is no direction.
Elements refine_elements(const Elements& source, std::string_view name, bool delta,
                         std::span<const uint32_t> indices, std::span<const VertexOrigin> origins);

/// The three corners of the source that a final vertex lies between, and their weights.
struct OriginCorners {
  uint32_t vertex[3];
  float weight[3];
  int largest;  ///< the corner with the largest weight
  bool exact;   ///< that weight is 1
};
OriginCorners corners_of(const VertexOrigin& origin, std::span<const uint32_t> indices);

}  // namespace goldthread
