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

// What each patch counts as: itself or its whole, and less of what it lies in.
std::vector<std::vector<Share>> shares_of(const SurfaceRoles& roles, size_t count) {
  const auto whole = [&](uint32_t p) {
    while (roles.combined[p] != SurfaceRoles::kNone) p = roles.combined[p];
    return p;
  };
  std::vector<std::vector<Share>> shares(count);
  for (uint32_t p = 0; p < count; ++p) {
    shares[p].push_back({whole(p), 1});
    if (roles.base[p] != SurfaceRoles::kNone) shares[p].push_back({whole(roles.base[p]), -1});
  }
  return shares;
}

struct Entry {
  double exchange = 0, reverse = 0, error = 0;
  FormFactorMethod method = FormFactorMethod::kFacesAway;
};

}  // namespace

bool SurfaceRoles::any() const {
  const auto given = [](uint32_t s) { return s != kNone; };
  return std::any_of(base.begin(), base.end(), given) || std::any_of(combined.begin(), combined.end(), given);
}

FormFactorMatrix fold_surfaces(const FormFactorMatrix& matrix, const SurfaceRoles& roles,
                               std::vector<uint32_t>& kept) {
  const size_t n = matrix.size();
  kept.clear();
  std::vector<uint32_t> number(n, SurfaceRoles::kNone);
  for (uint32_t p = 0; p < n; ++p)
    if (roles.combined[p] == SurfaceRoles::kNone) {
      number[p] = static_cast<uint32_t>(kept.size());
      kept.push_back(p);
    }
  const std::vector<std::vector<Share>> shares = shares_of(roles, n);
  FormFactorMatrix out;
  out.areas.assign(kept.size(), 0);
  std::vector<double> missed(kept.size()), behind(kept.size());
  for (uint32_t p = 0; p < n; ++p)
    for (const Share& s : shares[p]) {
      const uint32_t row = number[s.surface];
      out.areas[row] += s.weight * matrix.areas[p];
      missed[row] += s.weight * matrix.areas[p] * static_cast<double>(matrix.environment[p]);
      behind[row] += s.weight * matrix.areas[p] * static_cast<double>(matrix.back[p]);
    }
  std::map<std::pair<uint32_t, uint32_t>, Entry> entries;
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
    out.environment.push_back(static_cast<float>(std::clamp(missed[row] / out.areas[row], 0.0, 1.0)));
    out.back.push_back(static_cast<float>(std::clamp(behind[row] / out.areas[row], 0.0, 1.0)));
  }
  out.share_error = matrix.share_error;
  out.rays = matrix.rays;
  return out;
}

}  // namespace goldthread
