// Pictures in, as light.
#pragma once
#include <string>

#include "goldthread/error.h"
#include "scene/image.h"

namespace goldthread {

/// .exr: channels R, G, B (or Y alone) as they are. .hdr: as files/hdr_decode.h has it. .png, .jpg, .webp:
/// 8-bit sRGB turned linear, 0..1. Sides of at most kLargestImageSide.
Result<FloatImage> read_picture(const std::string& file);

/// An .exr with all its other float channels as layers and its text attributes as notes.
Result<LayeredImage> read_layered_exr(const std::string& file);

}  // namespace goldthread
