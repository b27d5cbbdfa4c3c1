// Clusters that are convex polygons: how a flat wall is cut into triangles changes nothing that can be seen.
#pragma once
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

struct FaceClusterTree;

/// Outlines of those clusters of a tree that fill a convex polygon of few corners in one plane, as far as
/// their area and summed normal tell, so that the polygon may stand for them.
class FlatOutlines {
 public:
  /// The most corners that are kept.
  static constexpr size_t kMostCorners = 8;

  FlatOutlines() = default;
  /// `tree` must have its sums and bounds. O(n log n) at worst.
  explicit FlatOutlines(const FaceClusterTree& tree);

  /// Corners of an inner node in the tree's space, counter-clockwise about its summed normal; none when it is
  /// bent, not convex or has more than kMostCorners.
  std::span<const vec3> of(uint32_t node) const {
    if (node >= outline_.size() || outline_[node] == kNone) return {};
    const uint32_t first = first_[outline_[node]], end = first_[outline_[node] + 1];
    return std::span(corners_).subspan(first, end - first);
  }

  uint64_t memory_bytes() const {
    return (outline_.capacity() + first_.capacity()) * sizeof(uint32_t) + corners_.capacity() * sizeof(vec3);
  }

 private:
  static constexpr uint32_t kNone = 0xffffffffu;

  std::vector<uint32_t> outline_;  // by node
  std::vector<uint32_t> first_;    // by outline, into corners_; and the end
  std::vector<vec3> corners_;
};

}  // namespace goldthread
