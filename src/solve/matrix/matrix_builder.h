// From a model of polygons to its form factors: the matrix of the classical methods, a row at a time.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "base/progress.h"
#include "goldthread/error.h"
#include "solve/matrix/form_factor_matrix.h"

namespace goldthread {

/// Polygons that exchange light with their fronts and block with both sides. Planar and simple each.
struct PatchModel {
  std::vector<Polygon> patches;
  std::vector<Polygon> occluders;  ///< only block
};

enum class MatrixMethod {
  kAuto,      ///< exact up to kMostExact patches and occluders, else rays
  kExact,     ///< visible_exchange a pair
  kRays,      ///< closed forms for what is exchanged with nothing in between, rays for the share that is seen
  kHemicube,  ///< rows by hemicubes at a patch's points (Cohen and Greenberg 1985)
  kCubicTetrahedron,  ///< the same by cubic tetrahedra (Beran-Koehn and Pavicic 1991)
  kSinglePlane,       ///< the same by single planes (Sillion and Puech 1989), which miss the horizon
};
constexpr size_t kMostExact = 100;

struct MatrixOptions {
  MatrixMethod method = MatrixMethod::kAuto;
  CubatureLimits limits{1e-4, 1e-9, 40000};  ///< exact; the absolute one of a patch's area
  uint32_t rays = 16;                        ///< a pair, 1..64
  uint32_t resolution = 64;                  ///< of hemicubes and their kin, cells
  uint32_t samples_across = 2;               ///< of a cell: 1 through its middle, k for k x k jittered rays
  double plane_half_width = 4;               ///< of single planes, in units of their height
  uint32_t environment_rays = 1024;          ///< a patch
  uint32_t seed = 0;
  uint64_t max_memory = 0;  ///< bytes for the matrix, 0 for no limit
};

/// The matrix of `model.patches`, row i that of patch i; the same bytes for any number of threads. `progress`
/// is told the share done, 0..1, from one thread at a time. Errors: ErrorCode::kCancelled when cancelled,
/// ErrorCode::kLimit when the matrix would need more than `max_memory`.
Result<FormFactorMatrix> build_form_factor_matrix(const PatchModel& model, const MatrixOptions& options,
                                                  const CancelToken& cancel,
                                                  const std::function<void(double)>& progress = {});

}  // namespace goldthread
