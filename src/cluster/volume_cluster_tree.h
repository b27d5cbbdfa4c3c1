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

/// What is clustered: a surface's box and the direction in which it mostly sends light.
struct VolumeItem {
  Box box;
  vec3 facing{0};  ///< summed normal / area: length 1 for a plane, 0 for a closed object
};

struct VolumeClusterOptions {
  float orientation = 0;  ///< weight of the orientation term (thesis 9.2.3); 0 is equation 4.22 alone
};

/// Top down: the split along any axis, by item centres, that minimises the surface-area cost (equation 4.22),
/// until one item is left. O(n log^2 n), deterministic for any number of threads.
VolumeClusterTree build_volume_clusters(std::span<const VolumeItem> items,
                                        const VolumeClusterOptions& options = {});

/// Aborts if boxes, items or depth-first order are broken. For tests.
void validate(const VolumeClusterTree& tree, std::span<const VolumeItem> items);

}  // namespace goldthread
