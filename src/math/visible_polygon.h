// What a point sees of a polygon past other polygons, exactly.
#pragma once
#include <span>
#include <vector>

#include "math/polygon.h"

namespace goldthread {

/// The parts of the convex polygon `target` that can be seen from `x` past convex `occluders`, which have no
/// thickness and block from both sides. Convex, without overlap, with the target's winding. What an occluder
/// hides is the target's part beyond the occluder's plane and within the pyramid of x and its edges.
std::vector<Polygon> visible_parts(const dvec3& x, std::span<const dvec3> target,
                                   std::span<const Polygon> occluders);

/// point_form_factor of what can be seen of `target`, given as convex parts.
double visible_form_factor(const dvec3& x, const dvec3& n, std::span<const Polygon> target,
                           std::span<const Polygon> occluders);

}  // namespace goldthread
