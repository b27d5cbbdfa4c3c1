#include "math/polygon.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

namespace goldthread {
namespace {

bool all_finite(std::span<const dvec3> polygon) {
  return std::all_of(polygon.begin(), polygon.end(), [](const dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  });
}

// Twice the signed area of a triangle, as seen from the side that `normal` points to.
double turn(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& normal) {
  return glm::dot(glm::cross(b - a, c - a), normal);
}

bool edges_cross(const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& d, const dvec3& normal) {
  return turn(a, b, c, normal) * turn(a, b, d, normal) < 0 &&
         turn(c, d, a, normal) * turn(c, d, b, normal) < 0;
}

bool is_in_triangle(const dvec3& p, const dvec3& a, const dvec3& b, const dvec3& c, const dvec3& normal) {
  return turn(a, b, p, normal) >= 0 && turn(b, c, p, normal) >= 0 && turn(c, a, p, normal) >= 0;
}

}  // namespace

dvec3 mean_corner(std::span<const dvec3> polygon) {
  return std::accumulate(polygon.begin(), polygon.end(), dvec3(0)) /
         static_cast<double>(std::max<size_t>(1, polygon.size()));
}

dvec3 area_vector(std::span<const dvec3> polygon) {
  dvec3 sum(0);
  const dvec3 origin = mean_corner(polygon);  // so that far from nought nothing cancels
  for (size_t i = 0; i < polygon.size(); ++i)
    sum += glm::cross(polygon[i] - origin, polygon[(i + 1) % polygon.size()] - origin);
  return 0.5 * sum;
}

double area(std::span<const dvec3> polygon) {
  return glm::length(area_vector(polygon));
}

Plane plane_of(std::span<const dvec3> polygon) {
  const dvec3 normal = glm::normalize(area_vector(polygon));
  return {normal, -glm::dot(normal, mean_corner(polygon))};
}

double radius(std::span<const dvec3> polygon) {
  const dvec3 centre = mean_corner(polygon);
  double most = 0;
  for (const dvec3& p : polygon) most = std::max(most, glm::distance(p, centre));
  return most;
}

bool is_convex(std::span<const dvec3> polygon) {
  const dvec3 normal = glm::normalize(area_vector(polygon));
  const size_t n = polygon.size();
  for (size_t i = 0; i < n; ++i)
    if (turn(polygon[i], polygon[(i + 1) % n], polygon[(i + 2) % n], normal) < 0) return false;
  return true;
}

std::optional<std::string> polygon_problem(std::span<const dvec3> polygon, double tolerance) {
  const size_t n = polygon.size();
  if (n < 3) return fmt::format("a polygon has three corners at least, this one {}", n);
  if (!all_finite(polygon)) return "a corner is not finite";
  const double size = radius(polygon);
  if (!(area(polygon) > 1e-12 * size * size)) return "it has no area";
  const Plane plane = plane_of(polygon);
  for (size_t i = 0; i < n; ++i)
    if (const double away = std::abs(plane.height(polygon[i])); away > tolerance * size)
      return fmt::format("it is not planar: corner {} lies {:.3g} off its plane", i + 1, away);
  for (size_t i = 0; i < n; ++i)
    for (size_t k = i + 2; k < n; ++k) {
      if (i == 0 && k == n - 1) continue;  // neighbours
      if (edges_cross(polygon[i], polygon[i + 1], polygon[k], polygon[(k + 1) % n], plane.normal))
        return fmt::format("it crosses itself: edges {} and {}", i + 1, k + 1);
    }
  return std::nullopt;
}

std::optional<std::pair<uint32_t, uint32_t>> find_twice(std::span<const Polygon> polygons) {
  std::vector<dvec3> centres;
  std::vector<uint32_t> order(polygons.size());
  for (const Polygon& polygon : polygons) centres.push_back(mean_corner(polygon));
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return centres[a].x < centres[b].x; });
  const auto has_corners_of = [](const Polygon& a, const Polygon& b, double tolerance) {
    return std::all_of(b.begin(), b.end(), [&](const dvec3& p) {
      return std::any_of(a.begin(), a.end(),
                         [&](const dvec3& q) { return glm::distance(p, q) <= tolerance; });
    });
  };
  std::optional<std::pair<uint32_t, uint32_t>> first;
  for (size_t i = 0; i < order.size(); ++i) {
    const Polygon& a = polygons[order[i]];
    const double tolerance = 1e-6 * radius(a);
    for (size_t k = i + 1; k < order.size(); ++k) {
      if (centres[order[k]].x > centres[order[i]].x + tolerance) break;
      if (glm::distance(centres[order[k]], centres[order[i]]) > tolerance) continue;
      const Polygon& b = polygons[order[k]];
      if (glm::dot(area_vector(a), area_vector(b)) <= 0 || !has_corners_of(a, b, tolerance) ||
          !has_corners_of(b, a, tolerance))
        continue;
      const std::pair<uint32_t, uint32_t> pair = std::minmax(order[i], order[k]);
      if (!first || pair.second < first->second) first = pair;
    }
  }
  return first;
}

Polygon clip(std::span<const dvec3> polygon, const Plane& plane, double tolerance) {
  const auto height = [&](const dvec3& p) {
    const double h = plane.height(p);
    return std::abs(h) <= tolerance ? 0 : h;
  };
  Polygon kept;
  if (polygon.empty()) return kept;
  dvec3 previous = polygon.back();
  double previous_height = height(previous);
  bool any = false;
  for (const dvec3& current : polygon) {
    const double h = height(current);
    if ((h < 0 && previous_height > 0) || (h > 0 && previous_height < 0))
      kept.push_back(previous + previous_height / (previous_height - h) * (current - previous));
    if (h >= 0) kept.push_back(current);
    any = any || h > 0;
    previous = current;
    previous_height = h;
  }
  if (!any || kept.size() < 3) kept.clear();
  return kept;
}

std::vector<UVec3> triangulate(std::span<const dvec3> polygon) {
  std::vector<UVec3> triangles;
  std::vector<uint32_t> left(polygon.size());
  std::iota(left.begin(), left.end(), 0u);
  const dvec3 normal = area_vector(polygon);
  const auto is_ear = [&](size_t i) {
    const size_t n = left.size();
    const uint32_t before = left[(i + n - 1) % n], here = left[i], after = left[(i + 1) % n];
    const dvec3 &a = polygon[before], &b = polygon[here], &c = polygon[after];
    if (turn(a, b, c, normal) <= 0) return false;
    return std::none_of(left.begin(), left.end(), [&](uint32_t k) {
      return k != before && k != here && k != after && is_in_triangle(polygon[k], a, b, c, normal);
    });
  };
  while (left.size() > 3) {
    size_t ear = 0;
    while (ear < left.size() && !is_ear(ear)) ++ear;
    // Corners on a straight line are no ears and leave nothing out: any will do.
    if (ear == left.size()) ear = 0;
    const size_t n = left.size();
    triangles.emplace_back(left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  if (left.size() == 3) triangles.emplace_back(left[0], left[1], left[2]);
  return triangles;
}

std::vector<Polygon> convex_parts(std::span<const dvec3> polygon) {
  if (is_convex(polygon)) return {Polygon(polygon.begin(), polygon.end())};
  std::vector<Polygon> parts;
  for (const UVec3& t : triangulate(polygon)) {
    Polygon part{polygon[t.x], polygon[t.y], polygon[t.z]};
    const double size = radius(part);
    if (area(part) > 1e-14 * size * size) parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace goldthread
