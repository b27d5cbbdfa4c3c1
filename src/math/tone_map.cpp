#include "math/tone_map.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/colour.h"

namespace goldthread {
namespace {

// Photographers part a picture in zones of a stop each (Adams, on whom Reinhard draws): five stops below the
// middle a print is black, and two more no exposure that suits the rest would bring back.
constexpr float kBlack = 1.0f / 128;

// What is darker may be left out, but no more than this share of the lightness: a window on a bright sky does
// not make the room around it black.
constexpr double kMostLeftOut = 0.25;

// `ascending`, not empty: where the sum of the cube roots is `share` of all.
float at_lightness(const std::vector<float>& ascending, double share) {
  double all = 0, up_to = 0;
  for (const float value : ascending) all += std::cbrt(static_cast<double>(value));
  for (const float value : ascending)
    if (up_to += std::cbrt(static_cast<double>(value)); up_to >= share * all) return value;
  return ascending.back();
}

float percentile(const std::vector<float>& ascending, double share) {
  return ascending[static_cast<size_t>(share * static_cast<double>(ascending.size() - 1))];
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

std::vector<float> lit_luminances(std::vector<float> luminances) {
  std::erase_if(luminances, [](float value) { return !(value > 0) || !std::isfinite(value); });
  if (luminances.empty()) return luminances;
  std::sort(luminances.begin(), luminances.end());
  const float least =
      std::min(kBlack * at_lightness(luminances, 0.5), at_lightness(luminances, kMostLeftOut));
  luminances.erase(luminances.begin(), std::lower_bound(luminances.begin(), luminances.end(), least));
  return luminances;
}

double log_average(std::span<const float> lit) {
  // Black pixels are left out instead of being lifted by a delta, so that the result depends neither on the
  // unit nor on how much of the picture is empty.
  double sum = 0;
  for (const float value : lit) sum += std::log(static_cast<double>(value));
  return lit.empty() ? 0 : std::exp(sum / static_cast<double>(lit.size()));
}

ToneMap choose_tone_map(std::span<const vec3> nits, float key, float exposure) {
  std::vector<float> luminances;
  luminances.reserve(nits.size());
  for (const vec3& pixel : nits) luminances.push_back(luminance(pixel));
  const std::vector<float> lit = lit_luminances(std::move(luminances));
  ToneMap map;
  if (exposure > 0) map.scale = exposure;
  if (lit.empty()) return map;
  if (!(exposure > 0)) map.scale = static_cast<float>(static_cast<double>(key) / log_average(lit));
  // Below 1 the operator would brighten what is already in range.
  map.white = std::max(1.0f, map.scale * percentile(lit, 0.995));
  return map;
}

}  // namespace goldthread
