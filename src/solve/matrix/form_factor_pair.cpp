#include "solve/matrix/form_factor_pair.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "math/polygon_exchange.h"
#include "math/visible_polygon.h"

namespace goldthread {
namespace {

constexpr uint32_t kNoOwner = 0xffffffffu;
// Of the sizes involved: what is closer to a plane lies in it.
constexpr double kOnPlane = 1e-9;

bool is_behind(const Plane& plane, std::span<const dvec3> polygon, double tolerance) {
  return std::all_of(polygon.begin(), polygon.end(),
                     [&](const dvec3& p) { return plane.height(p) <= tolerance; });
}

// Whether a plane through an edge of `a` and a corner of `b` has both on one side and `c` on the other.
bool is_parted(std::span<const dvec3> a, std::span<const dvec3> b, std::span<const dvec3> c,
               double tolerance) {
  for (size_t i = 0; i < a.size(); ++i)
    for (const dvec3& corner : b) {
      const dvec3 normal = glm::cross(a[(i + 1) % a.size()] - a[i], corner - a[i]);
      const double length = glm::length(normal);
      if (length <= 0) continue;
      const Plane plane{normal / length, -glm::dot(normal, a[i]) / length};
      const Plane other{-plane.normal, -plane.offset};
      for (const auto& [one, reverse] : {std::pair(plane, other), std::pair(other, plane)})
        if (is_behind(one, a, tolerance) && is_behind(one, b, tolerance) && is_behind(reverse, c, tolerance))
          return true;
    }
  return false;
}

std::vector<std::array<dvec3, 3>> triangles_of(std::span<const dvec3> polygon) {
  std::vector<std::array<dvec3, 3>> out;
  for (const UVec3& t : triangulate(polygon)) out.push_back({polygon[t.x], polygon[t.y], polygon[t.z]});
  return out;
}

std::vector<Polygon> all_convex(std::span<const Polygon> polygons) {
  std::vector<Polygon> out;
  for (const Polygon& polygon : polygons)
    for (Polygon& part : convex_parts(polygon)) out.push_back(std::move(part));
  return out;
}

// The integral over `from` of what is visible of `to`; `exchange` is all of it, if nothing stood between.
Estimate integrate_visible(std::span<const dvec3> from, std::span<const dvec3> to,
                           std::span<const Polygon> blockers, const Estimate& exchange,
                           const CubatureLimits& limits) {
  const auto triangles = triangles_of(from);
  const dvec3 n = plane_of(from).normal;
  const std::vector<Polygon> targets = convex_parts(to);
  const auto visible = [&](const dvec3& x) { return visible_form_factor(x, n, targets, blockers); };
  double rough = 0;
  for (const auto& t : triangles) rough += triangle_area(t) * triangle_mean(visible, t);
  if (rough < 0.5 * exchange.value) return integrate_triangles(visible, triangles, limits);
  const auto hidden = [&](const dvec3& x) { return std::max(0.0, point_form_factor(x, n, to) - visible(x)); };
  CubatureLimits allowed = limits;
  allowed.absolute = std::max(limits.absolute, limits.relative * 0.5 * exchange.value);
  const Estimate missing = integrate_triangles(hidden, triangles, allowed);
  return {std::max(0.0, exchange.value - missing.value), exchange.error + missing.error};
}

}  // namespace

const char* method_name(FormFactorMethod method) {
  switch (method) {
    case FormFactorMethod::kFacesAway:
      return "faces-away";
    case FormFactorMethod::kPoint:
      return "point";
    case FormFactorMethod::kContour:
      return "contour";
    case FormFactorMethod::kVisibleParts:
      return "visible-parts";
    case FormFactorMethod::kShape:
      return "shape";
    case FormFactorMethod::kRays:
      return "rays";
    case FormFactorMethod::kHemicube:
      return "hemicube";
    case FormFactorMethod::kCovered:
      return "covered";
  }
  return "";
}

Blockers::Blockers(std::span<const Polygon> polygons, std::span<const uint32_t> owners) {
  for (size_t i = 0; i < polygons.size(); ++i)
    for (Polygon& corners : convex_parts(polygons[i])) {
      dvec3 low = corners[0], high = corners[0];
      for (const dvec3& p : corners) {
        low = glm::min(low, p);
        high = glm::max(high, p);
      }
      parts_.push_back({std::move(corners), low, high, owners[i]});
    }
}

Blockers::Blockers(std::span<const Polygon> polygons)
    : Blockers(polygons, std::vector<uint32_t>(polygons.size(), kNoOwner)) {}

std::vector<Polygon> Blockers::between(std::span<const dvec3> from, std::span<const dvec3> to,
                                       uint32_t not_this, uint32_t nor_this) const {
  std::vector<Polygon> out;
  const double tolerance = kOnPlane * (radius(from) + radius(to));
  const Plane first = plane_of(from), second = plane_of(to);
  dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
  for (const auto& polygon : {from, to})
    for (const dvec3& p : polygon) {
      low = glm::min(low, p);
      high = glm::max(high, p);
    }
  low -= tolerance;
  high += tolerance;
  for (const Part& part : parts_) {
    if (part.owner != kNoOwner && (part.owner == not_this || part.owner == nor_this)) continue;
    if (glm::any(glm::greaterThan(part.low, high)) || glm::any(glm::lessThan(part.high, low))) continue;
    if (is_behind(first, part.corners, tolerance) || is_behind(second, part.corners, tolerance)) continue;
    if (is_parted(from, to, part.corners, tolerance) || is_parted(to, from, part.corners, tolerance))
      continue;
    out.push_back(part.corners);
  }
  return out;
}

Exchange visible_exchange(std::span<const dvec3> first, std::span<const dvec3> second,
                          std::span<const Polygon> blockers, const CubatureLimits& limits) {
  const double tolerance = kOnPlane * (radius(first) + radius(second));
  const Polygon from = clip(first, plane_of(second), tolerance),
                to = clip(second, plane_of(first), tolerance);
  if (from.size() < 3 || to.size() < 3) return {};
  const Estimate exchange = polygon_exchange(from, to);
  if (blockers.empty()) return {exchange, FormFactorMethod::kContour};
  Estimate best = integrate_visible(from, to, blockers, exchange, limits);
  if (best.error > std::max(limits.absolute, limits.relative * best.value)) {
    const Estimate back = integrate_visible(to, from, blockers, exchange, limits);
    if (back.error < best.error) best = back;
  }
  best.value = std::min(best.value, exchange.value);
  return {best, FormFactorMethod::kVisibleParts};
}

FormFactor polygon_form_factor(std::span<const dvec3> from, std::span<const dvec3> to,
                               std::span<const Polygon> occluders, const CubatureLimits& limits) {
  const double whole = area(from);
  const std::vector<Polygon> blockers = Blockers(occluders).between(from, to, kNoOwner, kNoOwner);
  CubatureLimits scaled = limits;
  scaled.absolute *= whole;
  const Exchange exchange = visible_exchange(from, to, blockers, scaled);
  return {std::clamp(exchange.area.value / whole, 0.0, 1.0), exchange.area.error / whole, exchange.method};
}

FormFactor point_to_polygon(const dvec3& x, const dvec3& n, std::span<const dvec3> to,
                            std::span<const Polygon> occluders) {
  const double value = visible_form_factor(x, n, convex_parts(to), all_convex(occluders));
  // Sums of a few angles of at most pi.
  return {value, 1e-14, value > 0 ? FormFactorMethod::kPoint : FormFactorMethod::kFacesAway};
}

}  // namespace goldthread
