// The priority queue of dual edges: a tournament of costs.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <vector>

namespace goldthread {

/// Holds a cost, not negative, for every number below size(); finds the least, the lowest number among
/// equals. Each match is between four and keeps the least of them. A change climbs only while it alters the
/// outcome of a match, so that costs can be updated in place: no stale entries, no positions to track, 5.4
/// bytes a cost. Costs are compared by their bits, which are in the same order and branch less.
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
    cost_.assign(total, std::bit_cast<uint32_t>(kOut));
  }

  float cost(uint32_t i) const { return std::bit_cast<float>(cost_[i]); }

  /// Sets a cost without holding matches; build() must follow before least().
  void prepare(uint32_t i, float cost) { cost_[i] = std::bit_cast<uint32_t>(cost); }
  void build() {
    for (size_t level = 1; level < level_begin_.size(); ++level) {
      const size_t below = level_begin_[level - 1], matches = (level_begin_[level] - below) / 4;
      for (size_t m = 0; m < matches; ++m) cost_[level_begin_[level] + m] = least_of(&cost_[below + 4 * m]);
    }
  }

  void set(uint32_t i, float cost) {
    cost_[i] = std::bit_cast<uint32_t>(cost);
    for (size_t level = 1; level < level_begin_.size(); ++level) {
      i /= 4;
      const uint32_t winner = least_of(&cost_[level_begin_[level - 1] + 4 * size_t(i)]);
      uint32_t& place = cost_[level_begin_[level] + i];
      if (place == winner) return;
      place = winner;
    }
  }

  /// The number of least cost; its cost is kOut when all are out.
  uint32_t least() const {
    size_t i = 0;
    for (size_t level = level_begin_.size(); level-- > 0;) {
      const uint32_t* match = &cost_[level_begin_[level] + 4 * i];
      const size_t front = match[1] < match[0], back = 2 + size_t(match[3] < match[2]);
      i = 4 * i + (match[back] < match[front] ? back : front);
    }
    return uint32_t(i);
  }

 private:
  static uint32_t least_of(const uint32_t* c) { return std::min(std::min(c[0], c[1]), std::min(c[2], c[3])); }

  std::vector<uint32_t> cost_;       ///< level 0 are the costs, each level padded to whole matches
  std::vector<size_t> level_begin_;  ///< the top level is one match
};

}  // namespace goldthread
