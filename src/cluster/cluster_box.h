// Oriented bounding boxes of face clusters (thesis 4.2.2 and 6.2.1), worked out when asked for.
#pragma once
#include "cluster/face_cluster_tree.h"
#include "math/oriented_box.h"

namespace goldthread {

/// A box around all corners of a cluster or a single triangle, in mesh space, to within rounding. Nearly flat
/// clusters get S as their third axis and the smallest rectangle in its plane; others the principal axes of
/// their corners, or the coordinate axes where that box is smaller (the principal axes of a cube point
/// anywhere). O(n) for n triangles, O(n log n) at worst.
OrientedBox fit_box(const FaceClusterTree& tree, ClusterRef cluster);

}  // namespace goldthread
