// Pictures out: 8-bit sRGB PNG and floating-point EXR.
#pragma once
#include <string>

#include "goldthread/error.h"
#include "scene/image.h"

namespace goldthread {

/// Display values 0..1 linear are sRGB encoded. Temporary name and rename, as all outputs.
Status write_png(const std::string& file, const FloatImage& image);
/// Scene-linear values, 32-bit float channels R, G, B.
Status write_exr(const std::string& file, const FloatImage& image);
/// What R, G and B are kept as. Half floats end at 65504; what is more becomes that.
enum class ExrDepth { kFloat, kHalf };
/// The same with a channel a layer, of the same depth, and notes as text attributes of the header.
Status write_layered_exr(const std::string& file, const LayeredImage& image,
                         ExrDepth depth = ExrDepth::kFloat);

}  // namespace goldthread
