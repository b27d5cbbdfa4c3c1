// PNG bytes in memory, by libpng.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace goldthread {

/// What the numbers stand for. Data has no word of colour in its file, so that nobody converts it.
enum class PngContent { kSrgb, kData };

/// `pixels` has width * height * channels bytes, rows from the top; 3 channels are RGB, 4 RGBA. Empty when
/// libpng refuses (no pixels, or more than it can hold). The same pixels give the same bytes.
std::vector<uint8_t> encode_png(uint32_t width, uint32_t height, uint32_t channels,
                                std::span<const uint8_t> pixels, PngContent content = PngContent::kSrgb);

}  // namespace goldthread
