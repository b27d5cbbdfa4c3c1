#include "files/hdr_encode.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace goldthread {
namespace {

std::array<uint8_t, 4> to_rgbe(vec3 pixel) {
  for (int c = 0; c < 3; ++c)
    if (!(pixel[c] > 0) || !std::isfinite(pixel[c])) pixel[c] = 0;
  const float most = std::max({pixel.x, pixel.y, pixel.z});
  if (most < 1e-32f) return {0, 0, 0, 0};
  int exponent = 0;
  std::frexp(most, &exponent);  // most is half to one times two to this
  if (std::lround(std::ldexp(most, 8 - exponent)) > 255) ++exponent;
  std::array<uint8_t, 4> bytes{};
  for (int c = 0; c < 3; ++c)
    bytes[static_cast<size_t>(c)] = static_cast<uint8_t>(std::lround(std::ldexp(pixel[c], 8 - exponent)));
  bytes[3] = static_cast<uint8_t>(exponent + 128);
  return bytes;
}

}  // namespace

std::vector<uint8_t> encode_hdr(const FloatImage& image) {
  const std::string header = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n-Y {} +X {}\n",
                                         image.height, image.width);
  std::vector<uint8_t> bytes(header.begin(), header.end());
  bytes.reserve(bytes.size() + 4 * image.pixels.size());
  for (const vec3& pixel : image.pixels)
    for (const uint8_t byte : to_rgbe(pixel)) bytes.push_back(byte);
  return bytes;
}

}  // namespace goldthread
