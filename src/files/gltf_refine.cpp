// Attributes of refined meshes. See refine_elements in gltf_elements.h.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "files/gltf_elements.h"

namespace goldthread {
namespace {

enum class Rule { kBlend, kDirection, kTangent, kNearest };

Rule rule_for(const Elements& source, std::string_view name, bool delta) {
  if (name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")) return Rule::kNearest;
  const bool whole_numbers = source.component != ComponentType::kFloat && !source.normalized;
  if (name.starts_with("_") && whole_numbers) return Rule::kNearest;  // an identifier, most likely
  if (delta) return Rule::kBlend;
  if (name == "NORMAL" && source.components() == 3) return Rule::kDirection;
  if (name == "TANGENT" && source.components() == 4) return Rule::kTangent;
  return Rule::kBlend;
}

Elements take_nearest(const Elements& source, std::span<const uint32_t> indices,
                      std::span<const VertexOrigin> origins) {
  Elements result = source;
  const size_t size = source.element_size();
  result.count = origins.size();
  result.bytes.resize(origins.size() * size);
  for (size_t i = 0; i < origins.size(); ++i) {
    const OriginCorners corners = corners_of(origins[i], indices);
    std::memcpy(result.bytes.data() + i * size, source.bytes.data() + corners.vertex[corners.largest] * size,
                size);
  }
  return result;
}

/// Between the corners' values, whatever the weights round to: white must not be whiter than white.
float blend(const Elements& source, const OriginCorners& corners, uint32_t component) {
  float sum = 0, least = INFINITY, most = -INFINITY;
  for (size_t k = 0; k < 3; ++k) {
    const float value = source.value(corners.vertex[k], component);
    sum += corners.weight[k] * value;
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return std::min(std::max(sum, least), most);
}

void make_unit(float* v, const Elements& source, const OriginCorners& corners) {
  const vec3 sum(v[0], v[1], v[2]);
  const uint32_t nearest = corners.vertex[corners.largest];
  const vec3 otherwise(source.value(nearest, 0), source.value(nearest, 1), source.value(nearest, 2));
  const vec3 unit = normalize_or(sum, otherwise);
  for (int c = 0; c < 3; ++c) v[c] = unit[c];
}

}  // namespace

OriginCorners corners_of(const VertexOrigin& origin, std::span<const uint32_t> indices) {
  OriginCorners corners;
  for (size_t k = 0; k < 3; ++k) corners.vertex[k] = indices[3 * size_t{origin.triangle} + k];
  corners.weight[0] = 1 - origin.weights.x - origin.weights.y;
  corners.weight[1] = origin.weights.x;
  corners.weight[2] = origin.weights.y;
  corners.largest = 0;
  for (int k = 1; k < 3; ++k)
    if (corners.weight[k] > corners.weight[corners.largest]) corners.largest = k;
  corners.exact = corners.weight[corners.largest] == 1;
  return corners;
}

Elements refine_elements(const Elements& source, std::string_view name, bool delta,
                         std::span<const uint32_t> indices, std::span<const VertexOrigin> origins) {
  const Rule rule = rule_for(source, name, delta);
  if (rule == Rule::kNearest) return take_nearest(source, indices, origins);
  const uint32_t components = source.components();
  std::vector<float> values(origins.size() * components);
  for (size_t i = 0; i < origins.size(); ++i) {
    const OriginCorners corners = corners_of(origins[i], indices);
    float* out = values.data() + i * components;
    for (uint32_t c = 0; c < components; ++c) {
      // Not a sum with zero weights: that would spread a neighbour's NaN and lose a bit of rounding.
      if (corners.exact) {
        out[c] = source.value(corners.vertex[corners.largest], c);
        continue;
      }
      out[c] = blend(source, corners, c);
    }
    if (!corners.exact && rule != Rule::kBlend) make_unit(out, source, corners);
    if (rule == Rule::kTangent) out[3] = source.value(corners.vertex[corners.largest], 3) < 0 ? -1.0f : 1.0f;
  }
  Elements result;
  result.type = source.type;
  result.count = origins.size();
  result.bytes.resize(values.size() * sizeof(float));
  std::memcpy(result.bytes.data(), values.data(), result.bytes.size());
  return result;
}

}  // namespace goldthread
