// The form factors of all pairs of a model, and the two laws that they should keep: closure and reciprocity.
#pragma once
#include <cstdint>
#include <vector>

#include "goldthread/error.h"
#include "solve/matrix/form_factor_pair.h"

namespace goldthread {

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

/// Gives both directions of every pair their mean. Returns what reciprocity_error was.
double enforce_reciprocity(FormFactorMatrix& matrix);

/// Scales exchanges so that each row and what its environment and backs take sum to one, both ways alike: the
/// matrix stays symmetric if it is, and no entry changes its sign (Sinkhorn 1967; rows that were found one by
/// one are scaled one by one). Rows of which environment and backs take all stay as they are. Returns the
/// largest relative change of an entry. Fails, and leaves the matrix as it was, on a row without entries that
/// should have some (ErrorCode::kBadInput), and on rows that do not converge: still more than 1e-9 off one
/// after 10000 rounds of scaling (ErrorCode::kLimit).
Result<double> enforce_closure(FormFactorMatrix& matrix);

}  // namespace goldthread
