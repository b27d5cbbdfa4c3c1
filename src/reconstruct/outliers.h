// Leaves whose light the solver knows poorly, taken anew.
#pragma once
#include "reconstruct/final_gather.h"
#include "reconstruct/reconstruct.h"

namespace goldthread {

/// What the solver shows, with the radiosity of outliers, and of the leaves beside them, gathered at points
/// of their own. An outlier is a small leaf that faces quite another way than a larger, otherwise nearly flat
/// cluster that it is part of: the one triangle of the wall that a cluster of the floor has caught at its
/// edge. What the cluster's links bring it was measured on the others, and what they bring those, by chance
/// on it; in power that is nothing, but to a vertex next to it such a leaf fills a third of the view.
ShownLight settle_outliers(const HierarchicalSolver& solver, const ReconstructOptions& options,
                           const CancelToken& cancel, ReconstructStats& stats);

}  // namespace goldthread
