// Top-down sweeps over three lists of items, each sorted once along its axis and kept sorted by stable
// partition.
#include "cluster/volume_cluster_tree.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <bit>

#include "base/parallel.h"

namespace goldthread {
namespace {

constexpr size_t kParallelAbove = 2048;  ///< items below which a subtree is one task

using Lists = std::array<std::span<uint32_t>, 3>;

struct Split {
  float cost = std::numeric_limits<float>::infinity();
  int axis = 0;
  size_t left = 0;  ///< items on the left; 0 for none found
};

class Builder {
 public:
  Builder(std::span<const Box> items, VolumeClusterTree& tree) : items_(items), tree_(tree) {
    for (auto& list : sorted_) list.resize(items.size());
    on_left_.resize(items.size());
    moved_.resize(items.size());
    left_cost_.resize(items.size());
    tree.nodes.resize(items.size() - 1);
    // A chain of splits that each part one item from the rest is right for a galaxy of sizes, and ruin for a
    // stack.
    deepest_ = 64 + 2 * size_t(std::bit_width(items.size()));
  }

  void build() {
    parallel_invoke([&] { sort_along(0); }, [&] { sort_along(1); }, [&] { sort_along(2); });
    split({sorted_[0], sorted_[1], sorted_[2]}, 0, 0, 0);
  }

 private:
  float key(uint32_t item, int axis) const {
    return 0.5f * items_[item].low[axis] + 0.5f * items_[item].high[axis];
  }

  void sort_along(int axis) {
    auto& list = sorted_[size_t(axis)];
    for (uint32_t i = 0; i < list.size(); ++i) list[i] = i;
    tbb::parallel_sort(list.begin(), list.end(), [&](uint32_t a, uint32_t b) {
      const float ka = key(a, axis), kb = key(b, axis);
      return ka != kb ? ka < kb : a < b;
    });
  }

  /// Makes node `node` of the items in `lists`, which are slots [first, first + n) of the scratch arrays.
  void split(const Lists& lists, uint32_t node, size_t first, size_t depth) {
    const size_t count = lists[0].size();
    VolumeCluster& cluster = tree_.nodes[node];
    for (const uint32_t i : lists[0]) cluster.box.add(items_[i]);
    const size_t left = partition(lists, best_split(lists, cluster.box, first, depth), first);
    Lists front, back;
    for (size_t axis = 0; axis < 3; ++axis) {
      front[axis] = lists[axis].first(left);
      back[axis] = lists[axis].subspan(left);
    }
    const uint32_t front_node = node + 1, back_node = node + uint32_t(left);  // k items make k - 1 nodes
    cluster.child[0] = left == 1 ? front[0][0] | kItemBit : front_node;
    cluster.child[1] = count - left == 1 ? back[0][0] | kItemBit : back_node;
    const auto go_front = [&] {
      if (left > 1) split(front, front_node, first, depth + 1);
    };
    const auto go_back = [&] {
      if (count - left > 1) split(back, back_node, first + left, depth + 1);
    };
    if (count > kParallelAbove) return parallel_invoke(go_front, go_back);
    go_front();
    go_back();
  }

  Split best_split(const Lists& lists, const Box& box, size_t first, size_t depth) {
    Split best;
    if (depth < deepest_ && !all_centres_equal(lists))
      for (int axis = 0; axis < 3; ++axis) sweep(lists[size_t(axis)], axis, first, best);
    if (best.left == 0) {
      const vec3 size = box.size();
      best.axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
      best.left = lists[0].size() / 2;
    }
    return best;
  }

  bool all_centres_equal(const Lists& lists) const {
    for (int axis = 0; axis < 3; ++axis)
      if (key(lists[size_t(axis)].front(), axis) < key(lists[size_t(axis)].back(), axis)) return false;
    return true;
  }

  /// Equation 4.22 at every position; S(H) divides all alike and is left out.
  void sweep(std::span<const uint32_t> list, int axis, size_t first, Split& best) {
    Box left, right;
    for (size_t i = 0; i + 1 < list.size(); ++i) {
      left.add(items_[list[i]]);
      left_cost_[first + i] = left.surface_area() * float(i + 1);
    }
    for (size_t i = list.size() - 1; i > 0; --i) {
      right.add(items_[list[i]]);
      const float total = left_cost_[first + i - 1] + right.surface_area() * float(list.size() - i);
      if (total < best.cost) best = {total, axis, i};
    }
  }

  /// Parts all three lists by the split, keeping their order. Returns how many went left.
  size_t partition(const Lists& lists, const Split& split, size_t first) {
    const auto& along = lists[size_t(split.axis)];
    for (size_t i = 0; i < along.size(); ++i) on_left_[along[i]] = i < split.left;
    for (size_t axis = 0; axis < 3; ++axis) {
      if (int(axis) == split.axis) continue;
      size_t left = 0, right = first;
      for (const uint32_t item : lists[axis]) {
        if (on_left_[item])
          lists[axis][left++] = item;
        else
          moved_[right++] = item;
      }
      std::copy(moved_.begin() + ptrdiff_t(first), moved_.begin() + ptrdiff_t(right),
                lists[axis].begin() + ptrdiff_t(left));
    }
    return split.left;
  }

  std::span<const Box> items_;
  VolumeClusterTree& tree_;
  size_t deepest_ = 0;
  std::array<std::vector<uint32_t>, 3> sorted_;
  std::vector<uint8_t> on_left_;  ///< by item
  // Scratch, a subtree using only its own range.
  std::vector<uint32_t> moved_;
  std::vector<float> left_cost_;
};

}  // namespace

VolumeClusterTree build_volume_clusters(std::span<const Box> items) {
  VolumeClusterTree tree;
  if (items.size() > 1) Builder(items, tree).build();
  return tree;
}

}  // namespace goldthread
