// A picture by path tracing.
#pragma once
#include <limits>

#include "base/progress.h"
#include "scene/image.h"
#include "trace/irradiance_estimate.h"
#include "trace/path_tracer.h"

namespace goldthread {

/// What is known of a pixel: all that is needed to go on.
struct PixelSums {
  dvec3 sum{0};                       ///< of its passes' means, nits
  double luminance = 0, squares = 0;  ///< of these means' luminance: sum and sum of squares
  uint32_t passes = 0;

  void add(const dvec3& pass_mean);
  dvec3 mean() const { return passes > 0 ? sum / static_cast<double>(passes) : dvec3(0); }
  /// Of the mean's luminance; 0 below two passes.
  double standard_error() const;
  /// The sums behind a mean, its luminance's standard error and a number of passes.
  static PixelSums of(const dvec3& mean, double standard_error, uint32_t passes);
};

struct ReferenceImageOptions {
  int width = 960, height = 0;  ///< height 0: the camera's aspect, or 16:9
  uint64_t seed = 0;
  StopRules stop;  ///< samples are those of a pixel
  /// An earlier picture's of the same size, scene and seed, to go on from; or empty.
  std::vector<PixelSums> before;
};

/// Radiance in nits, the plain mean of each pixel's samples (a box filter).
struct ReferenceImage {
  FloatImage image;
  std::vector<PixelSums> pixels;                 ///< of the image's
  uint64_t least_samples = 0, most_samples = 0;  ///< of a pixel
  double relative_error = 0;  ///< mean over pixels that light comes from of standard error over mean; 0 below
                              ///< two passes
  PathCost rays;
  StopReason stop_reason = StopReason::kSamples;
};

/// Looks through the scene's first camera, or one that frames it. Each pass over the picture takes kBatches
/// samples of every pixel with a scrambling of its own; the error is estimated from the spread of passes.
/// Rows that were not reached before the time was up are black.
ReferenceImage trace_reference_image(const PathTracer& tracer, const ReferenceImageOptions& options,
                                     const CancelToken& cancel, EstimateProgress& progress);

}  // namespace goldthread
