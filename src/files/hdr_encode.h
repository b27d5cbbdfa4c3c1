// Radiance pictures: a common exponent for red, green and blue (Ward 1991).
#pragma once
#include <cstdint>
#include <vector>

#include "scene/image.h"

namespace goldthread {

/// The file's bytes: "32-bit_rle_rgbe", rows from the top, not run-length coded, exposure 1. Each pixel is
/// right to half a 256th of its brightest channel. What is not finite or below 0 becomes 0.
std::vector<uint8_t> encode_hdr(const FloatImage& image);

}  // namespace goldthread
