#include "math/visible_polygon.h"

#include <algorithm>
#include <utility>

#include "math/polygon_exchange.h"

namespace goldthread {
namespace {

// The planes whose common front is what `occluder` hides from x; none where x lies in the occluder's plane.
std::vector<Plane> shadow(const dvec3& x, std::span<const dvec3> occluder) {
  const Plane plane = plane_of(occluder);
  const double height = plane.height(x), size = radius(occluder);
  if (std::abs(height) <= 1e-12 * (size + glm::distance(x, occluder[0]))) return {};
  const double side = height > 0 ? 1 : -1;
  std::vector<Plane> planes{{-side * plane.normal, -side * plane.offset}};  // beyond
  for (size_t i = 0; i < occluder.size(); ++i) {
    const dvec3 a = occluder[i] - x, b = occluder[(i + 1) % occluder.size()] - x;
    // From the front corners run counter-clockwise, so that inside lies to the left.
    const dvec3 normal = -side * glm::cross(a, b);
    const double length = glm::length(normal);
    if (length > 0) planes.push_back({normal / length, -glm::dot(normal, x) / length});
  }
  return planes;
}

Plane turned(const Plane& plane) {
  return {-plane.normal, -plane.offset};
}

// `part` less the common front of `planes`, added to `left`.
void cut_away(Polygon part, std::span<const Plane> planes, std::vector<Polygon>& left) {
  // Most shadows miss: then it stays in one piece.
  for (const Plane& plane : planes)
    if (std::all_of(part.begin(), part.end(), [&](const dvec3& p) { return plane.height(p) <= 0; })) {
      left.push_back(std::move(part));
      return;
    }
  for (const Plane& plane : planes) {
    if (Polygon outside = clip(part, turned(plane)); !outside.empty()) left.push_back(std::move(outside));
    part = clip(part, plane);
    if (part.empty()) return;
  }
}

}  // namespace

std::vector<Polygon> visible_parts(const dvec3& x, std::span<const dvec3> target,
                                   std::span<const Polygon> occluders) {
  std::vector<Polygon> parts{Polygon(target.begin(), target.end())}, left;
  for (const Polygon& occluder : occluders) {
    const std::vector<Plane> planes = shadow(x, occluder);
    if (planes.empty()) continue;
    left.clear();
    for (Polygon& part : parts) cut_away(std::move(part), planes, left);
    std::swap(parts, left);
    if (parts.empty()) break;
  }
  return parts;
}

double visible_form_factor(const dvec3& x, const dvec3& n, std::span<const Polygon> target,
                           std::span<const Polygon> occluders) {
  double sum = 0;
  for (const Polygon& polygon : target)
    for (const Polygon& part : visible_parts(x, polygon, occluders)) sum += point_form_factor(x, n, part);
  return std::min(sum, 1.0);
}

}  // namespace goldthread
