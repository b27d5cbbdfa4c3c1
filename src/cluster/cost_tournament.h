// The priority queue of dual edges: a tournament of costs.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

namespace goldthread {

/// Holds a cost for every number below size(); finds the least, the lowest number among equals. Each match is
/// between four and keeps the least of them. A change climbs only while it alters the outcome of a match, so
/// that costs can be updated in place: no stale entries, no positions to track, 5.4 bytes a cost.
class CostTournament {
 public:
  static constexpr float kOut = std::numeric_limits<float>::infinity();

  /// All `size` costs start at kOut.
  void reset(size_t size) {
    level_begin_.clear();
    size_t total = 0, width = std::max<size_t>(size, 1);
    do {
      width = (width + 3) / 4 * 4;
      level_begin_.push_back(total);
      total += width;
      width /= 4;
    } while (width > 1);
    cost_.assign(total, kOut);
  }

  float cost(uint32_t i) const { return cost_[i]; }

  /// Sets a cost without holding matches; build() must follow before least().
  void prepare(uint32_t i, float cost) { cost_[i] = cost; }
  void build() {
    for (size_t level = 1; level < level_begin_.size(); ++level) {
      const size_t below = level_begin_[level - 1], matches = (level_begin_[level] - below) / 4;
      for (size_t m = 0; m < matches; ++m) cost_[level_begin_[level] + m] = least_of(below + 4 * m);
    }
  }

  void set(uint32_t i, float cost) {
    size_t slot = i;
    cost_[slot] = cost;
    for (size_t level = 1; level < level_begin_.size(); ++level) {
      i /= 4;
      const float winner = least_of(level_begin_[level - 1] + 4 * size_t(i));
      slot = level_begin_[level] + i;
      if (cost_[slot] == winner) return;
      cost_[slot] = winner;
    }
  }

  /// The number of least cost; its cost is kOut when all are out.
  uint32_t least() const {
    size_t i = 0;
    for (size_t level = level_begin_.size(); level-- > 0;) {
      const float* match = &cost_[level_begin_[level] + 4 * i];
      const float winner = std::min(std::min(match[0], match[1]), std::min(match[2], match[3]));
      size_t k = 0;
      while (match[k] != winner) ++k;
      i = 4 * i + k;
    }
    return uint32_t(i);
  }

 private:
  float least_of(size_t first) const {
    const float* c = &cost_[first];
    return std::min(std::min(c[0], c[1]), std::min(c[2], c[3]));
  }

  std::vector<float> cost_;          ///< level 0 are the costs, each level padded to whole matches
  std::vector<size_t> level_begin_;  ///< the top level is one match
};

}  // namespace goldthread
