#include "files/light_map_pack.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "math/colour.h"

namespace goldthread {
namespace {

vec3 clean(vec3 light) {
  for (int c = 0; c < 3; ++c)
    if (!(light[c] > 0) || !std::isfinite(light[c])) light[c] = 0;
  return light;
}

float largest_channel(const vec3& light) {
  return std::max({light.x, light.y, light.z});
}

/// Nearest byte of a share, 0..1.
uint8_t to_byte(float share) {
  return static_cast<uint8_t>(std::lround(255 * std::clamp(share, 0.0f, 1.0f)));
}

/// A share of the page's brightest: the multiplier is rounded up, or the brightest channel would not fit.
void to_rgbm(const vec3& share, uint8_t* out) {
  const float multiplier = std::clamp(std::ceil(255 * largest_channel(share)), 1.0f, 255.0f);
  for (int c = 0; c < 3; ++c) out[c] = to_byte(share[c] * 255 / multiplier);
  out[3] = static_cast<uint8_t>(multiplier);
}

/// In 255ths of the page's brightest: the divisor is rounded down, for the same reason.
void to_rgbd(const vec3& value, uint8_t* out) {
  const float divisor = std::clamp(std::floor(255 / std::max(largest_channel(value), 1.0f)), 1.0f, 255.0f);
  for (int c = 0; c < 3; ++c) out[c] = to_byte(value[c] * divisor / 255);
  out[3] = static_cast<uint8_t>(divisor);
}

void to_rgbe(const vec3& light, uint8_t* out) {
  const float most = largest_channel(light);
  std::fill_n(out, 4, uint8_t{0});
  if (most < 1e-32f) return;
  int exponent = 0;
  std::frexp(most, &exponent);  // most is half to one times two to this
  if (std::lround(std::ldexp(most, 8 - exponent)) > 255) ++exponent;
  for (int c = 0; c < 3; ++c) out[c] = static_cast<uint8_t>(std::lround(std::ldexp(light[c], 8 - exponent)));
  out[3] = static_cast<uint8_t>(exponent + 128);
}

}  // namespace

PackedLight pack_light(const FloatImage& light, MapEncoding encoding, float white) {
  float most = 0;
  for (const vec3& texel : light.pixels) most = std::max(most, largest_channel(clean(texel)));
  if (!(most > 0)) most = 1;
  PackedLight packed;
  packed.channels = encoding == MapEncoding::kSrgb ? 3 : 4;
  if (encoding == MapEncoding::kRgbm) packed.scale = most;
  if (encoding == MapEncoding::kRgbd) packed.scale = most / 255;
  if (encoding == MapEncoding::kSrgb) packed.scale = white;
  packed.bytes.resize(light.pixels.size() * packed.channels);
  parallel_for(
      light.pixels.size(),
      [&](size_t i) {
        uint8_t* out = &packed.bytes[i * packed.channels];
        const vec3 texel = clean(light.pixels[i]) / packed.scale;
        if (encoding == MapEncoding::kRgbm) return to_rgbm(texel, out);
        if (encoding == MapEncoding::kRgbd) return to_rgbd(texel, out);
        if (encoding == MapEncoding::kRgbe) return to_rgbe(texel, out);
        for (int c = 0; c < 3; ++c) out[c] = to_byte(linear_to_srgb(texel[c]));
      },
      4096);
  return packed;
}

}  // namespace goldthread
