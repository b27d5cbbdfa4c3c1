// From pairs of values to the figures of `compare`.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "math/vec.h"
#include "scene/image.h"

namespace goldthread {

/// One place at which two results are held against each other; luminances.
struct Measured {
  dvec3 position{0};  ///< metres, or pixels
  double value = 0, truth = 0;
  double standard_error = 0;  ///< of the truth
};

/// design.md section 9, "compare". All shares, not percent.
struct ErrorFigures {
  size_t points = 0;
  double mean_truth = 0;
  double relative_rmse = 0;         ///< over the mean, noise taken off
  double raw_rmse = 0;              ///< with the noise
  double reference_noise = 0;       ///< root of the mean squared standard error, over the mean
  double bias = 0, bias_error = 0;  ///< mean difference over the mean, and its standard error
  double median = 0, p99 = 0;       ///< of |difference| / max(truth, mean / 100)
  Measured worst;
  double worst_error = 0;
};

/// Of no places: all nought.
ErrorFigures measure_errors(const std::vector<Measured>& places);

nlohmann::ordered_json as_json(const ErrorFigures& figures);
/// `unit` as "lx"; places are named with it.
std::string as_text(const ErrorFigures& figures, const std::string& unit);

/// The colour of a signed error (after Cohen 1988): `shade` grey where it is nought, blue for -full_scale,
/// red for +full_scale and beyond. Linear.
vec3 error_colour(double signed_error, double full_scale, float shade);

}  // namespace goldthread
