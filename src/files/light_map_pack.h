// Light of any brightness in four bytes a texel, for engines that read no floating-point textures.
#pragma once
#include <cstdint>
#include <vector>

#include "goldthread/bake.h"
#include "scene/image.h"

namespace goldthread {

/// Bytes of RGBA (or RGB: kSrgb), rows from the top, and what turns them into lux again. With r, g, b and a
/// as bytes over 255, a channel is
/// - kRgbm: r * a * scale,
/// - kRgbd: r / a * scale,
/// - kRgbe: 255 r * 2^(255 a - 136) (Ward 1991), scale 1,
/// - kSrgb: scale times the linear value of the sRGB byte; brighter ones are clipped.
struct PackedLight {
  std::vector<uint8_t> bytes;
  uint32_t channels = 4;
  float scale = 1;  ///< lux
};

/// The encodings that packing knows: not kFloat and kHalf. Channels that are not finite or below 0 become 0.
/// kSrgb clips above `white`, lux; the others clip nothing. kRgbm is right to half a 255th of the texel's
/// brightest channel or a 65025th of the page's, kRgbd as near.
PackedLight pack_light(const FloatImage& light, MapEncoding encoding, float white);

}  // namespace goldthread
