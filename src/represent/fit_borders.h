// Charts' edges as a texture filter shows them: where two charts meet on the surface both must show its
// light.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"
#include "scene/image.h"

namespace goldthread {

/// A place on a chart's edge and the light that is there.
struct BorderSample {
  vec2 at{0};     ///< texels of the page
  vec3 light{0};  ///< lux
};

/// Changes the texels that a bilinear filter reads at the samples so that what it shows there is their light,
/// as nearly as least squares get, and all of them as little as that allows, those least whose `trust` (0 to
/// 1, by row and column) is high. Where light runs on across an edge, charts on both sides of it then show
/// the same. Sets `used` (by row and column) to 1 for these texels. No value becomes negative.
void fit_borders(FloatImage& page, std::span<const float> trust, std::span<const BorderSample> samples,
                 std::vector<uint8_t>& used);

}  // namespace goldthread
