// Minimum-area enclosing rectangle (thesis 4.4.2 and 6.2.1).
#pragma once
#include <span>

#include "math/vec.h"

namespace goldthread {

struct MinRectangle {
  vec2 centre{0};
  vec2 u{1, 0};  ///< unit direction of the longer side
  vec2 half{0};  ///< half extents along u and v; half.x >= half.y

  vec2 v() const { return {-u.y, u.x}; }
  float area() const { return 4 * half.x * half.y; }
};

/// Rotating calipers (Toussaint 1983) round the convex hull: one side of the best rectangle lies on a hull
/// edge. Collinear points give half.y = 0, a single one half = 0, none the default. Points must be finite. Of
/// rectangles of equal area the first round the hull is taken.
MinRectangle min_rectangle(std::span<const vec2> points);

}  // namespace goldthread
