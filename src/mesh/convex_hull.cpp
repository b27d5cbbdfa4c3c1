#include "mesh/convex_hull.h"

#include <algorithm>
#include <array>

namespace goldthread {
namespace {

constexpr size_t kFilterAbove = 64;

/// Twice the signed area of abc, exact enough in double for float input.
double turn(const vec2& a, const vec2& b, const vec2& c) {
  const dvec2 u = dvec2(b) - dvec2(a), v = dvec2(c) - dvec2(a);
  return u.x * v.y - u.y * v.x;
}

/// Drops points strictly inside the quadrilateral of the four axis extremes (Akl and Toussaint 1978).
std::vector<vec2> drop_inner(std::span<const vec2> points) {
  const auto by_x = [](const vec2& a, const vec2& b) { return a.x < b.x; };
  const auto by_y = [](const vec2& a, const vec2& b) { return a.y < b.y; };
  const auto [left, right] = std::minmax_element(points.begin(), points.end(), by_x);
  const auto [bottom, top] = std::minmax_element(points.begin(), points.end(), by_y);
  const std::array<vec2, 4> quad{*left, *bottom, *right, *top};
  std::vector<vec2> kept;
  for (const vec2& p : points) {
    bool inside = true;
    for (size_t i = 0; i < 4; ++i) inside = inside && turn(quad[i], quad[(i + 1) % 4], p) > 0;
    if (!inside) kept.push_back(p);
  }
  return kept;
}

/// Appends p to a chain that only turns left, beyond its first `keep` corners.
void extend_chain(std::vector<vec2>& chain, size_t keep, const vec2& p) {
  while (chain.size() >= keep + 2 && turn(chain[chain.size() - 2], chain.back(), p) <= 0) chain.pop_back();
  chain.push_back(p);
}

}  // namespace

std::vector<vec2> convex_hull(std::span<const vec2> points) {
  std::vector<vec2> sorted =
      points.size() > kFilterAbove ? drop_inner(points) : std::vector<vec2>(points.begin(), points.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const vec2& a, const vec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  if (sorted.size() < 3) return sorted;
  std::vector<vec2> hull;
  for (const vec2& p : sorted) extend_chain(hull, 0, p);
  const size_t lower = hull.size() - 1;
  for (size_t i = sorted.size() - 1; i-- > 0;) extend_chain(hull, lower, sorted[i]);
  hull.pop_back();  // the first point again
  return hull;
}

}  // namespace goldthread
