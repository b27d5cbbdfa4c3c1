#include "mesh/min_rectangle.h"

#include <limits>
#include <vector>

#include "mesh/convex_hull.h"

namespace goldthread {
namespace {

struct Candidate {
  double area = std::numeric_limits<double>::infinity();
  dvec2 u{1, 0};
  double low_u = 0, high_u = 0, high_v = 0, base_v = 0;
};

/// Four calipers on the hull: the base edge i, and the farthest corners to the right, above and to the left.
class Calipers {
 public:
  explicit Calipers(std::span<const vec2> hull) : hull_(hull) {}

  /// The rectangle with a side on edge i; edges must be asked for in order, so that the calipers only move
  /// forward.
  Candidate measure(size_t i) {
    const dvec2 a(hull_[i]), edge = corner(i + 1) - a;
    const dvec2 u = edge / std::sqrt(dot(edge, edge)), v(-u.y, u.x);
    right_ = advance(std::max(right_, i), u);
    top_ = advance(std::max(top_, right_), v);
    left_ = advance(std::max(left_, top_), -u);
    Candidate c{0, u, dot(corner(left_), u), dot(corner(right_), u), dot(corner(top_), v), dot(a, v)};
    c.area = (c.high_u - c.low_u) * (c.high_v - c.base_v);
    return c;
  }

 private:
  dvec2 corner(size_t i) const { return dvec2(hull_[i % hull_.size()]); }

  /// From corner i forward to the farthest in `direction`; along a convex outline distance has one maximum.
  size_t advance(size_t i, const dvec2& direction) const {
    for (size_t steps = 0; steps < hull_.size(); ++steps, ++i)
      if (dot(corner(i + 1) - corner(i), direction) <= 0) break;
    return i;
  }

  std::span<const vec2> hull_;
  size_t right_ = 0, top_ = 0, left_ = 0;
};

MinRectangle to_rectangle(const Candidate& c) {
  const dvec2 v(-c.u.y, c.u.x);
  MinRectangle r;
  r.centre = vec2(0.5 * (c.low_u + c.high_u) * c.u + 0.5 * (c.base_v + c.high_v) * v);
  r.u = vec2(c.u);
  r.half = vec2(dvec2(0.5 * (c.high_u - c.low_u), 0.5 * (c.high_v - c.base_v)));
  if (r.half.y > r.half.x) {
    r.u = vec2(v);
    std::swap(r.half.x, r.half.y);
  }
  return r;
}

}  // namespace

MinRectangle min_rectangle(std::span<const vec2> points) {
  const std::vector<vec2> hull = convex_hull(points);
  if (hull.empty()) return {};
  if (hull.size() == 1) return {hull[0], {1, 0}, {0, 0}};
  if (hull.size() == 2) {
    const dvec2 a(hull[0]), b(hull[1]);
    const double span = length(b - a);
    return {vec2(0.5 * (a + b)), vec2((b - a) / span), {float(0.5 * span), 0}};
  }
  Calipers calipers(hull);
  Candidate best;
  for (size_t i = 0; i < hull.size(); ++i)
    if (const Candidate c = calipers.measure(i); c.area < best.area) best = c;
  return to_rectangle(best);
}

}  // namespace goldthread
