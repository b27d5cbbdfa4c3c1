// Path-traced pictures in files that can be gone on from.
#pragma once
#include <string>

#include "goldthread/error.h"
#include "trace/reference_image.h"

namespace goldthread {

/// A picture that was written.
struct SavedPicture {
  uint64_t seed = 0, fingerprint = 0;
  uint32_t width = 0, height = 0;
  std::vector<PixelSums> pixels;
};

/// What must be the same to go on: the scene as it is traced, and the camera that looks at it.
uint64_t picture_fingerprint(const TracedScene& scene);

/// An EXR as any other, with two more channels: `samples` of each pixel, and `error`, the standard error of
/// its luminance, nits.
Status write_picture(const std::string& file, const ReferenceImage& picture, uint64_t seed,
                     uint64_t fingerprint);
/// Means are in single precision, so that what is gone on from here differs by rounding from what never
/// stopped.
Result<SavedPicture> read_picture_to_go_on(const std::string& file);

}  // namespace goldthread
