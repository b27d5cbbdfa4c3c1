#include "math/tone_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "math/colour.h"

namespace goldthread {
namespace {

/// Equation 1 without its delta: black pixels are left out of the average instead of being lifted, so that
/// the result depends neither on the unit nor on how much of the picture is empty.
double log_average(const std::vector<float>& luminances) {
  double sum = 0;
  for (float value : luminances) sum += std::log(static_cast<double>(value));
  return std::exp(sum / static_cast<double>(luminances.size()));
}

float percentile(std::vector<float>& values, double share) {
  const auto rank = static_cast<size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rank), values.end());
  return values[rank];
}

}  // namespace

vec3 ToneMap::operator()(const vec3& nits) const {
  const float before = luminance(nits);
  if (!(before > 0) || !std::isfinite(before)) return vec3(0);
  const float scaled = std::min(scale * before, 1e18f);  // equation 2, kept from overflow
  const float display = scaled * (1 + scaled / (white * white)) / (1 + scaled);  // equation 4
  const vec3 colour = nits * (display / before);
  // Saturated colours leave the display's range before white does: dimmed as a whole, they keep their hue.
  const float largest = std::max(1.0f, std::max(colour.x, std::max(colour.y, colour.z)));
  return glm::max(colour / largest, vec3(0));
}

ToneMap choose_tone_map(std::span<const vec3> nits, float key, float exposure) {
  std::vector<float> luminances;
  luminances.reserve(nits.size());
  for (const vec3& pixel : nits)
    if (const float value = luminance(pixel); value > 0 && std::isfinite(value)) luminances.push_back(value);
  ToneMap map;
  if (exposure > 0) map.scale = exposure;
  if (luminances.empty()) return map;
  if (!(exposure > 0)) map.scale = static_cast<float>(static_cast<double>(key) / log_average(luminances));
  // Below 1 the operator would brighten what is already in range.
  map.white = std::max(1.0f, map.scale * percentile(luminances, 0.995));
  return map;
}

}  // namespace goldthread
