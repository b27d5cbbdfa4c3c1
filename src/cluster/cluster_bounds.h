// Sums, bounding spheres and normal cones of a laid-out tree.
#pragma once
#include "cluster/face_cluster_tree.h"

namespace goldthread {

/// Fills summed_normal, area, centre, radius and cone_cosine of every node, bottom up. Small clusters are
/// measured triangle by triangle. Larger ones are bounded by their descendants' bounds, of which the worst
/// are opened, up to a fixed number, until what opening could still gain is under 1 % of the radius or 0.01
/// radians of the cone.
void fill_bounds(FaceClusterTree& tree);

}  // namespace goldthread
