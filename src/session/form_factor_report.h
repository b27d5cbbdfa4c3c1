// What `formfactors` found, as text, JSON and arrays.
#pragma once
#include <string>
#include <vector>

#include "goldthread/error.h"
#include "solve/matrix/form_factor_matrix.h"

namespace goldthread {

/// One form factor of a pair case.
struct PairAnswer {
  std::string id, from, to;
  FormFactor factor;
};

/// One model's matrix and what it was made with.
struct ModelAnswer {
  std::string id;
  std::vector<std::string> names;  ///< of the matrix's rows
  FormFactorMatrix matrix;
  double seconds = 0;
  double closing_change = 0;  ///< largest relative change by enforce_closure
  bool closed = false;        ///< enforce_closure was asked for
};

/// How far rows and what their surroundings take are from one, and how far that may be by what each says of
/// itself. `row` is the worst, relative to what it may be.
struct ClosureCheck {
  size_t row = 0;
  double off = 0, allowed = 0;
};
ClosureCheck check_closure(const FormFactorMatrix& matrix);

/// For a person: pairs line by line; of models row sums, and the matrix itself up to `most` rows.
std::string describe(const std::vector<PairAnswer>& pairs, const std::vector<ModelAnswer>& models,
                     size_t most);

/// One line "case from to value error_bound method" for each form factor that is not nought.
Status write_form_factor_text(const std::string& file, const std::vector<PairAnswer>& pairs,
                              const std::vector<ModelAnswer>& models);
/// The contract's JSON: pairs [{id, from, to, value, method, error_bound}], row_sums, and `cases` with more.
/// Sent in pieces: matrices may be large.
Status write_form_factor_json(const std::string& file, const std::vector<PairAnswer>& pairs,
                              const std::vector<ModelAnswer>& models);
/// One model's F as a compressed sparse row matrix that scipy.sparse.load_npz reads, with "areas" and
/// "environment" beside it.
Status write_form_factor_npz(const std::string& file, const ModelAnswer& model);

}  // namespace goldthread
