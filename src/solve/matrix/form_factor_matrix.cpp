#include "solve/matrix/form_factor_matrix.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace goldthread {

uint64_t FormFactorMatrix::memory_bytes() const {
  return areas.capacity() * sizeof(double) + first.capacity() * sizeof(uint64_t) +
         column.capacity() * (sizeof(uint32_t) + sizeof(double) + sizeof(float) + sizeof(FormFactorMethod)) +
         (environment.capacity() + back.capacity()) * sizeof(float) + reverse.capacity() * sizeof(double);
}

double FormFactorMatrix::reciprocity_error() const {
  double most = 0;
  for (size_t i = 0; i < size(); ++i)
    for (uint64_t k = first[i]; k < first[i + 1]; ++k)
      most =
          std::max(most, std::abs(exchange[k] - reverse_exchange(k)) / std::min(areas[i], areas[column[k]]));
  return most;
}

std::vector<double> FormFactorMatrix::row_sums() const {
  std::vector<double> sums(size());
  for (size_t i = 0; i < size(); ++i)
    for (uint64_t k = first[i]; k < first[i + 1]; ++k) {
      sums[i] += exchange[k] / areas[i];
      if (column[k] != i) sums[column[k]] += reverse_exchange(k) / areas[column[k]];
    }
  return sums;
}

std::vector<double> FormFactorMatrix::row_error_bounds() const {
  // Bounds add up; standard errors, which are independent, add up in quadrature.
  std::vector<double> bounds(size()), squares(size());
  const auto add = [&](size_t i, uint64_t k) {
    const double e = static_cast<double>(error[k]) / areas[i];
    if (method[k] == FormFactorMethod::kRays) {
      squares[i] += e * e;
    } else {
      bounds[i] += e;
    }
  };
  for (size_t i = 0; i < size(); ++i)
    for (uint64_t k = first[i]; k < first[i + 1]; ++k) {
      add(i, k);
      if (column[k] != i) add(column[k], k);
    }
  for (size_t i = 0; i < size(); ++i) bounds[i] += std::sqrt(squares[i]);
  return bounds;
}

double enforce_reciprocity(FormFactorMatrix& matrix) {
  const double was = matrix.reciprocity_error();
  for (size_t k = 0; k < matrix.reverse.size(); ++k)
    matrix.exchange[k] = 0.5 * (matrix.exchange[k] + matrix.reverse[k]);
  matrix.reverse.clear();
  return was;
}

Result<double> enforce_closure(FormFactorMatrix& matrix) {
  constexpr int kMostRounds = 10000;
  constexpr double kClosed = 1e-12, kCloseEnough = 1e-9;
  const size_t n = matrix.size();
  const bool symmetric = matrix.reverse.empty();
  std::vector<double> wanted(n), scale(n, 1.0), sums;
  for (size_t i = 0; i < n; ++i)
    wanted[i] = matrix.areas[i] * (1 - static_cast<double>(matrix.environment[i] + matrix.back[i]));
  const std::vector<double> open = matrix.row_sums();
  for (size_t i = 0; i < n; ++i)
    if (wanted[i] > 1e-9 * matrix.areas[i] && open[i] <= 0)
      return Error{ErrorCode::kBadInput,
                   "its row is empty and cannot be closed",
                   {},
                   fmt::format("surface {}", i + 1),
                   "leave out --enforce-closure"};
  // One side of an entry alone, or both: then the root, since the other side is scaled as well.
  const auto by = [&](size_t i, size_t j) { return symmetric ? scale[i] * scale[j] : scale[i]; };
  double off = 1;
  for (int round = 0; round < kMostRounds && off > kClosed; ++round) {
    sums.assign(n, 0.0);
    for (size_t i = 0; i < n; ++i)
      for (uint64_t k = matrix.first[i]; k < matrix.first[i + 1]; ++k) {
        const uint32_t j = matrix.column[k];
        sums[i] += matrix.exchange[k] * by(i, j);
        if (j != i) sums[j] += matrix.reverse_exchange(k) * by(j, i);
      }
    off = 0;
    for (size_t i = 0; i < n; ++i) {
      if (wanted[i] <= 1e-9 * matrix.areas[i]) continue;
      off = std::max(off, std::abs(sums[i] - wanted[i]) / matrix.areas[i]);
      scale[i] *= symmetric ? std::sqrt(wanted[i] / sums[i]) : wanted[i] / sums[i];
    }
  }
  if (off > kCloseEnough)
    return Error{ErrorCode::kLimit,
                 fmt::format("rows stay {:.1e} off one after {} rounds of scaling", off, kMostRounds),
                 {},
                 {},
                 "leave out --enforce-closure, or cast more rays"};
  double change = 0;
  for (size_t i = 0; i < n; ++i)
    for (uint64_t k = matrix.first[i]; k < matrix.first[i + 1]; ++k) {
      const uint32_t j = matrix.column[k];
      matrix.exchange[k] *= by(i, j);
      if (!symmetric) matrix.reverse[k] *= by(j, i);
      change = std::max({change, std::abs(by(i, j) - 1), std::abs(by(j, i) - 1)});
    }
  return change;
}

}  // namespace goldthread
