// Encoded pictures in memory to pixels: PNG, JPEG and WebP, told apart by their first bytes.
#pragma once
#include <cstdint>
#include <span>

#include "goldthread/error.h"
#include "scene/image.h"

namespace goldthread {

/// The largest width and height that are accepted.
constexpr uint32_t kLargestImageSide = 16384;

/// Decodes a whole picture to 8-bit RGBA as stored: no colour management, as glTF demands. 16-bit channels
/// lose their low byte, grey is repeated, missing alpha is 255. The bytes may come from anyone: dimensions
/// are read and compared with kLargestImageSide and with what so many bytes can hold before pixels are
/// allocated; truncated and broken pictures are an Error (kBadInput, no file) and never leave a part.
Result<Image> decode_image(std::span<const uint8_t> bytes);

}  // namespace goldthread
