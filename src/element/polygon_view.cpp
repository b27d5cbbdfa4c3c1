#include "element/polygon_view.h"

#include <algorithm>

#include "mesh/triangle_mesh.h"

namespace goldthread {
namespace {

// Steradians below which a polygon is sampled by area: it is about even there, and the angles of so small a
// spherical triangle are lost in rounding.
constexpr float kSmallSolidAngle = 0.05f;

}  // namespace

vec3 ElementPolygon::normal() const {
  vec3 sum(0);
  for (size_t i = 1; i + 1 < count; ++i) sum += area_vector(corners[0], corners[i], corners[i + 1]);
  return normalize_or(sum, vec3(0, 1, 0));
}

PolygonSampler::PolygonSampler(const ElementPolygon& polygon, const vec3& normal, uint32_t triangle)
    : polygon_(polygon), normal_(normal), triangle_(triangle) {
  const vec3& a = polygon.corners[0];
  for (size_t i = 1; i + 1 < polygon.count; ++i)
    twice_area_ += twice_areas_[i] = length(cross(polygon.corners[i] - a, polygon.corners[i + 1] - a));
}

SurfacePoint PolygonSampler::sample(float u, float v) const {
  // A fan triangle by area, then a point in it by the square-root map.
  float target = u * twice_area_;
  size_t i = 1;
  while (i + 2 < polygon_.count && target >= twice_areas_[i]) target -= twice_areas_[i++];
  const float s = std::sqrt(std::clamp(twice_areas_[i] > 0 ? target / twice_areas_[i] : 0.5f, 0.0f, 1.0f));
  const vec3 &a = polygon_.corners[0], &b = polygon_.corners[i], &c = polygon_.corners[i + 1];
  // A hair's breadth from the edges: on one, a point would lie in the wall that stands there as much as
  // before it.
  constexpr float kDrawnIn = 1e-3f;
  const vec3 position = (1 - s) * a + s * ((1 - v) * b + v * c), centroid = (a + b + c) / 3.0f;
  return {position + kDrawnIn * (centroid - position), normal_, triangle_};
}

PolygonView::PolygonView(const PolygonSampler& places, const vec3& x)
    : places_(places), x_(x), before_(dot(x - places.polygon().corners[0], places.normal())) {
  if (before_ <= 0) return;
  const ElementPolygon& polygon = places_.polygon();
  std::array<vec3, kMaxPolygon> from_x;
  for (size_t i = 0; i < polygon.count; ++i) {
    from_x[i] = polygon.corners[i] - x;
    middle_ += polygon.corners[i] / static_cast<float>(polygon.count);
  }
  directions_.emplace(std::span<const vec3>(from_x.data(), polygon.count));
  if (directions_->solid_angle() < kSmallSolidAngle) directions_.reset();
}

SurfacePoint PolygonView::sample(const vec3& n, float u, float v, float& weight) const {
  weight = 0;
  const vec3& normal = places_.normal();
  const SurfacePoint nowhere{places_.polygon().corners[0], normal, places_.triangle()};
  if (before_ <= 0) return nowhere;
  if (!directions_) {
    const SurfacePoint point = places_.sample(u, v);
    const vec3 d = point.position - x_;
    const float squared = dot(d, d);
    weight = std::max(0.0f, dot(d, n)) * before_ * places_.area() / (squared * squared + 1e-30f);
    return point;
  }
  const vec3 direction = directions_->sample(u, v);
  const float towards = -dot(direction, normal);
  if (towards <= 1e-5f) return nowhere;
  weight = std::max(0.0f, dot(direction, n)) * directions_->solid_angle();
  // At a grazing angle the rounding of the direction moves the point along the plane, perhaps past an edge
  // and into what stands there or even behind it: it is drawn in by more than that.
  constexpr float kRounding = 4e-6f;
  const float distance = before_ / towards;
  const vec3 position = x_ + distance * direction, inward = middle_ - position;
  const float step = std::min(kRounding * distance / towards, 0.1f * length(inward));
  return {position + step * normalize_or(inward, vec3(0)), normal, places_.triangle()};
}

}  // namespace goldthread
