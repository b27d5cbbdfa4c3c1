// All form factors of a model of polygons: the matrix of the classical methods.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "goldthread/error.h"
#include "solve/matrix/form_factor_pair.h"

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

/// Exchange areas, sparse: of each pair that exchanges anything once, in its lower-numbered row.
struct FormFactorMatrix {
  std::vector<double> areas;     ///< m², a patch
  std::vector<uint64_t> first;   ///< pairs [first[i], first[i + 1]) are patch i's with higher ones
  std::vector<uint32_t> column;  ///< the other patch, ascending in a row
  std::vector<double> exchange;  ///< A_i F_ij, m²; of a patch with itself all of it
  std::vector<double> reverse;   ///< A_j F_ji, where rows were found one by one; empty when it is the same
  std::vector<float> error;      ///< of both; bound, or two standard errors where rays were cast; of
                                 ///< item buffers without what their few points miss of a patch
  std::vector<FormFactorMethod> method;

  /// Shares of what leaves a patch that meet nothing, and that meet the back of something or an occluder: by
  /// rays.
  std::vector<float> environment, back;
  float share_error = 0;  ///< two standard errors of these, at most
  uint64_t rays = 0;

  size_t size() const { return areas.size(); }
  uint64_t memory_bytes() const;
  double reverse_exchange(uint64_t k) const { return reverse.empty() ? exchange[k] : reverse[k]; }
  double reciprocity_error() const;      ///< largest difference of A_i F_ij and A_j F_ji, by the smaller area
  std::vector<double> row_sums() const;  ///< of F
  std::vector<double> row_error_bounds() const;  ///< of these sums
};

/// `progress` is told the share done, from one thread at a time. When cancelled: ErrorCode::kCancelled.
Result<FormFactorMatrix> build_form_factor_matrix(const PatchModel& model, const MatrixOptions& options,
                                                  const CancelToken& cancel,
                                                  const std::function<void(double)>& progress = {});

/// Gives both directions of every pair their mean. Returns what reciprocity_error was.
double enforce_reciprocity(FormFactorMatrix& matrix);

/// Scales exchanges so that each row and what its environment and backs take sum to one, both ways alike: the
/// matrix stays symmetric if it is, and no entry changes its sign (Sinkhorn 1967; rows that were found one by
/// one are scaled one by one). Returns the largest relative change of an entry, or an error where no scaling
/// does it: a row without entries, or rows that do not come together.
Result<double> enforce_closure(FormFactorMatrix& matrix);

}  // namespace goldthread
