#include "solve/matrix/fold_surfaces.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace goldthread {
namespace {

struct Share {
  uint32_t surface;
  double weight;
};

uint32_t whole_of(const SurfaceRoles& roles, uint32_t p) {
  while (roles.combined[p] != SurfaceRoles::kNone) p = roles.combined[p];
  return p;
}

// What each patch counts as: itself or its whole, and less of what it lies in. Where something lies on its
// base, it only takes.
std::vector<std::vector<Share>> shares_of(const SurfaceRoles& roles, size_t count) {
  std::vector<std::vector<Share>> shares(count);
  for (uint32_t p = 0; p < count; ++p) {
    if (roles.cover_of(p) == Cover::kNothing) shares[p].push_back({whole_of(roles, p), 1});
    if (roles.base[p] != SurfaceRoles::kNone) shares[p].push_back({whole_of(roles, roles.base[p]), -1});
  }
  return shares;
}

// The surfaces that remain, and the number of each as one of them.
std::vector<uint32_t> numbers_of(const SurfaceRoles& roles, size_t count, std::vector<uint32_t>& kept) {
  std::vector<uint32_t> numbers(count, SurfaceRoles::kNone);
  kept.clear();
  for (uint32_t p = 0; p < count; ++p) {
    if (roles.combined[p] != SurfaceRoles::kNone || roles.cover_of(p) == Cover::kNull) continue;
    numbers[p] = static_cast<uint32_t>(kept.size());
    kept.push_back(p);
  }
  return numbers;
}

struct Entry {
  double exchange = 0, reverse = 0, error = 0;
  FormFactorMethod method = FormFactorMethod::kFacesAway;
};
using Entries = std::map<std::pair<uint32_t, uint32_t>, Entry>;

// Areas that each row's surface has, and that of what leaves it miss all and meet backs: m².
struct Rows {
  std::vector<double> areas, missed, behind;
};

Rows rows_of(const FormFactorMatrix& matrix, const SurfaceRoles& roles,
             const std::vector<std::vector<Share>>& shares, const std::vector<uint32_t>& number,
             size_t count) {
  Rows rows{std::vector<double>(count), std::vector<double>(count), std::vector<double>(count)};
  for (uint32_t p = 0; p < matrix.size(); ++p) {
    for (const Share& s : shares[p]) {
      const uint32_t row = number[s.surface];
      rows.areas[row] += s.weight * matrix.areas[p];
      rows.missed[row] += s.weight * matrix.areas[p] * static_cast<double>(matrix.environment[p]);
      rows.behind[row] += s.weight * matrix.areas[p] * static_cast<double>(matrix.back[p]);
    }
    if (roles.cover_of(p) != Cover::kMask) continue;
    rows.areas[number[p]] += matrix.areas[p];
    rows.areas[number[whole_of(roles, roles.base[p])]] += matrix.areas[p];  // what it covers is still there
  }
  return rows;
}

// What others send to where a mask or null surface lies reaches its back.
void add_covered(const FormFactorMatrix& matrix, const SurfaceRoles& roles,
                 const std::vector<std::vector<Share>>& shares, const std::vector<uint32_t>& number,
                 std::vector<double>& behind) {
  const auto send = [&](uint32_t from, uint32_t to, double exchange) {
    if (roles.cover_of(to) == Cover::kNothing) return;
    for (const Share& s : shares[from]) behind[number[s.surface]] += s.weight * exchange;
  };
  for (uint32_t p = 0; p < matrix.size(); ++p)
    for (uint64_t k = matrix.first[p]; k < matrix.first[p + 1]; ++k) {
      send(p, matrix.column[k], matrix.exchange[k]);
      send(matrix.column[k], p, matrix.reverse_exchange(k));
    }
}

// A mask and its base see each other wholly.
void add_masks(const FormFactorMatrix& matrix, const SurfaceRoles& roles, const std::vector<uint32_t>& number,
               Entries& entries) {
  for (uint32_t p = 0; p < matrix.size(); ++p) {
    if (roles.cover_of(p) != Cover::kMask) continue;
    const uint32_t mask = number[p], base = number[whole_of(roles, roles.base[p])];
    entries[{std::min(mask, base), std::max(mask, base)}] = {matrix.areas[p], matrix.areas[p], 0,
                                                             FormFactorMethod::kCovered};
  }
}

}  // namespace

bool SurfaceRoles::any() const {
  const auto given = [](uint32_t s) { return s != kNone; };
  return std::any_of(base.begin(), base.end(), given) || std::any_of(combined.begin(), combined.end(), given);
}

FormFactorMatrix fold_surfaces(const FormFactorMatrix& matrix, const SurfaceRoles& roles,
                               std::vector<uint32_t>& kept) {
  const size_t n = matrix.size();
  const std::vector<uint32_t> number = numbers_of(roles, n, kept);
  const std::vector<std::vector<Share>> shares = shares_of(roles, n);
  Rows rows = rows_of(matrix, roles, shares, number, kept.size());
  add_covered(matrix, roles, shares, number, rows.behind);
  Entries entries;
  for (uint32_t p = 0; p < n; ++p)
    for (uint64_t k = matrix.first[p]; k < matrix.first[p + 1]; ++k)
      for (const Share& a : shares[p])
        for (const Share& b : shares[matrix.column[k]]) {
          const uint32_t from = number[a.surface], to = number[b.surface];
          const double weight = a.weight * b.weight;
          double there = weight * matrix.exchange[k], back = weight * matrix.reverse_exchange(k);
          if (from > to) std::swap(there, back);
          // Within one surface both directions are its own.
          Entry& entry = entries[{std::min(from, to), std::max(from, to)}];
          entry.exchange += from == to ? there + back : there;
          entry.reverse += from == to ? there + back : back;
          entry.error += static_cast<double>(matrix.error[k]) * (from == to ? 2 : 1);
          entry.method = std::max(entry.method, matrix.method[k]);
        }
  add_masks(matrix, roles, number, entries);
  FormFactorMatrix out;
  out.areas = rows.areas;
  out.first.assign(1, 0);
  auto entry = entries.begin();
  for (uint32_t row = 0; row < kept.size(); ++row) {
    for (; entry != entries.end() && entry->first.first == row; ++entry) {
      out.column.push_back(entry->first.second);
      out.exchange.push_back(std::max(0.0, entry->second.exchange));
      if (!matrix.reverse.empty()) out.reverse.push_back(std::max(0.0, entry->second.reverse));
      out.error.push_back(static_cast<float>(entry->second.error));
      out.method.push_back(entry->second.method);
    }
    out.first.push_back(out.column.size());
    out.environment.push_back(static_cast<float>(std::clamp(rows.missed[row] / out.areas[row], 0.0, 1.0)));
    out.back.push_back(static_cast<float>(std::clamp(rows.behind[row] / out.areas[row], 0.0, 1.0)));
  }
  out.share_error = matrix.share_error;
  out.rays = matrix.rays;
  return out;
}

}  // namespace goldthread
