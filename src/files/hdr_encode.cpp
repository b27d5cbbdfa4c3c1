#include "files/hdr_encode.h"

#include <fmt/format.h>

#include "files/light_map_pack.h"

namespace goldthread {

std::vector<uint8_t> encode_hdr(const FloatImage& image) {
  const std::string header = fmt::format("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n-Y {} +X {}\n",
                                         image.height, image.width);
  std::vector<uint8_t> bytes(header.begin(), header.end());
  const PackedLight packed = pack_light(image, MapEncoding::kRgbe, 1);
  bytes.insert(bytes.end(), packed.bytes.begin(), packed.bytes.end());
  return bytes;
}

}  // namespace goldthread
