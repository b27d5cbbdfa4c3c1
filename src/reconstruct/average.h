// Light at points from what the leaf elements around them have: fast, and no finer than they are.
#pragma once
#include <vector>

#include "reconstruct/light_points.h"
#include "solve/hierarchical/solver.h"

namespace goldthread {

/// Lux by light point: means of the adjoining leaves' irradiance, each turned to the point's own normal.
/// `leaves`: the leaf element of every face, kNoElement for none.
std::vector<vec3> average_side(const HierarchicalSolver& solver, const PartPoints& points,
                               const std::vector<ElementId>& leaves, bool back);

}  // namespace goldthread
