// Radiance pictures (.hdr, .pic) in memory to pixels.
#pragma once
#include <span>

#include "goldthread/error.h"
#include "scene/image.h"

namespace goldthread {

/// Whether the bytes begin as Radiance pictures do.
bool is_radiance_picture(std::span<const unsigned char> bytes);

/// Decodes RGBE (G. Ward, Real Pixels, 1991), flat or with runs of either age, rows from the top. Values are
/// the picture's, its exposures taken off: what unit they are in, no such file says. The bytes may come from
/// anyone: sides are compared with kLargestImageSide and with what so many bytes can hold before pixels are
/// allocated. An Error (kBadInput, no file) for what is cut off or broken, XYZE, and other orders of rows.
Result<FloatImage> decode_radiance_picture(std::span<const unsigned char> bytes);

}  // namespace goldthread
