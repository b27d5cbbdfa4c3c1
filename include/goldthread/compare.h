// How far two results are from each other, or one from the truth.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "goldthread/bake.h"
#include "goldthread/error.h"

namespace goldthread {

struct CompareOptions {
  std::string first;       ///< .gold solution, or a picture: .exr .png
  std::string second;      ///< what it is measured against, of the same kind; empty with `reference`
  bool reference = false;  ///< measure `first`, a solution, against path tracing of its own scene

  uint64_t points = 1000;   ///< random places over the lit surfaces, by area
  bool seen = false;        ///< instead, what the camera sees at the middle of each pixel
  bool light_maps = false;  ///< light is read from the solutions' light maps, not their vertices
  bool texels = false;      ///< the same at `points` of the texels of `first`, which stand for means
  std::optional<uint64_t>
      samples;  ///< reference: a point or texel; 1024 when neither this nor the next is given
  std::optional<double> target_error;  ///< reference: stop at this mean of standard error over irradiance
  std::optional<double> time_limit;    ///< reference: seconds for all of it
  uint64_t seed = 0;
  int threads = 0;  ///< 0: all

  std::string json_file;  ///< figures; empty for none, "-" for standard output
  /// Of solutions, every point as a line: x, y, z, normal (nx, ny, nz), irradiance of `first` and of what it
  /// is measured against (lux, luminance), the latter's standard error, and 1 for points inside solids.
  std::string csv_file;
  std::string picture;      ///< .png: where `first` is under (blue), right (grey), over (red); empty for none
  double full_scale = 0.2;  ///< relative error that is fully blue or red
  /// Pixels of `picture` and `seen`, of solutions; height 0 follows the camera's aspect.
  int picture_width = 320, picture_height = 0;
};

struct CompareResult {
  std::string summary;  ///< for a person, some lines
  std::string json;     ///< points, relative_rmse, bias, median_relative_error, p99_relative_error,
                        ///< reference_noise, worst {position, relative_error}, and more
  std::vector<std::string> warnings;
  std::vector<std::string> written;  ///< files
  bool cancelled = false;
};

/// Measures luminance: irradiance (lux) at points of surfaces, or pixels. Errors are differences over the
/// mean of what is measured against (relative_rmse, bias), or over its value there, at least a hundredth of
/// the mean (the others). Points inside solids, as of the floor beneath a box, are left out and told by
/// themselves. A texel is measured against the mean over what triangles have of it and anybody sees, at 16
/// places spread over it: a point would not tell what a texel on a shadow's edge should hold. The reference's
/// own noise is taken off the RMSE in quadrature, and told. When cancelled what was traced so far is
/// compared.
Result<CompareResult> compare(const CompareOptions& options, const BakeListener& listener = {});

}  // namespace goldthread
