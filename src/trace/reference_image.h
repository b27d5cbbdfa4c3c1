// A picture by path tracing.
#pragma once
#include <limits>

#include "base/progress.h"
#include "scene/image.h"
#include "trace/irradiance_estimate.h"
#include "trace/path_tracer.h"

namespace goldthread {

struct ReferenceImageOptions {
  int width = 960, height = 0;  ///< height 0: the camera's aspect, or 16:9
  uint64_t seed = 0;
  StopRules stop;  ///< samples are those of a pixel
};

/// Radiance in nits, the plain mean of each pixel's samples (a box filter).
struct ReferenceImage {
  FloatImage image;
  uint64_t least_samples = 0, most_samples = 0;  ///< of a pixel
  double relative_error = 0;  ///< mean over pixels that light comes from of standard error over mean; 0 below
                              ///< two passes
  RayCount rays;
  StopReason stop_reason = StopReason::kSamples;
};

/// Looks through the scene's first camera, or one that frames it. Each pass over the picture takes kBatches
/// samples of every pixel with a scrambling of its own; the error is estimated from the spread of passes.
/// Rows that were not reached before the time was up are black.
ReferenceImage trace_reference_image(const PathTracer& tracer, const ReferenceImageOptions& options,
                                     const CancelToken& cancel, EstimateProgress& progress);

}  // namespace goldthread
