// Convex hull in the plane.
#pragma once
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// The hull's corners counter-clockwise from the leftmost (lowest of those), without points on its edges; one
/// or two points where all coincide or lie on a line, none for none. Points must be finite. Andrew's monotone
/// chain (1979), O(n log n), behind a linear filter that drops most inner points.
std::vector<vec2> convex_hull(std::span<const vec2> points);

}  // namespace goldthread
