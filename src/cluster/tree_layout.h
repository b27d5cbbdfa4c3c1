// From merges to a tree in depth-first order.
#pragma once
#include "cluster/merge_forest.h"

namespace goldthread {

/// Gives nodes their ranges and children and puts roots and the mesh's triangles in order; sums and bounds
/// are left to fill_bounds(). Every tree has one node less than triangles, so that all places are known from
/// counts alone.
FaceClusterTree lay_out(TriangleMesh mesh, MergeForest forest);

}  // namespace goldthread
