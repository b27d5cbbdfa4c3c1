// The hierarchy above surfaces (thesis 4.3): a binary tree of boxes over everything in the scene.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "math/box.h"

namespace goldthread {

/// A node's child: another node, or an item when the high bit is set.
using VolumeRef = uint32_t;
constexpr VolumeRef kItemBit = 0x80000000u;

struct VolumeCluster {
  Box box;
  VolumeRef child[2] = {0, 0};
};

/// Depth first, root at 0; empty when there are fewer than two items.
struct VolumeClusterTree {
  std::vector<VolumeCluster> nodes;
};

/// Top down: the split of the surfaces' boxes along any axis, by their centres, that minimises the
/// surface-area cost (equation 4.22), until one is left. O(n log^2 n), deterministic for any number of
/// threads.
VolumeClusterTree build_volume_clusters(std::span<const Box> items);

/// Aborts if boxes, items or depth-first order are broken. For tests.
void validate(const VolumeClusterTree& tree, std::span<const Box> items);

}  // namespace goldthread
