// A page of light as eight bits a channel, for viewers.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/light_atlas.h"

namespace goldthread {

struct EncodedPage {
  std::vector<uint8_t> rgb;  ///< rows from the top; linear: lux = byte / 255 * intensity
  float intensity = 1;       ///< lux
  double error = 0;          ///< root mean square that the bytes are wrong by, over covered texels, lux
  uint64_t clipped = 0;      ///< covered texels of which a channel is brighter than that
};

/// A page of colour and light in one, as it is shown.
struct BakedPage {
  std::vector<uint8_t> rgba;  ///< sRGB, rows from the top
};

/// `nits` times `exposure`, clamped to 0..1. `alpha`, 0..1, has as many values.
BakedPage encode_baked_page(const FloatImage& nits, const std::vector<float>& alpha, float exposure);

/// Chooses the intensity at which clipping what is brighter and rounding the rest show least together: a few
/// texels next to a lamp do not take the steps from all others. What rounding takes from a texel its
/// neighbours get, so that slow gradients show no bands.
EncodedPage encode_page(const AtlasPage& page);

/// The same of luminance, alike in all three channels.
EncodedPage encode_grey_page(const AtlasPage& page);

}  // namespace goldthread
