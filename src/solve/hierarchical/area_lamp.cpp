#include "solve/hierarchical/area_lamp.h"

#include <algorithm>

#include "math/form_factor.h"
#include "math/spherical_triangle.h"

namespace goldthread {
namespace {

// Squared radius over squared distance below which a lamp is a point: what that leaves out is no more.
constexpr float kPointLike = 1e-5f;
// And below which it is one even where the horizon may cut it: its corners' rounded directions tell less.
constexpr float kSpeck = 1e-8f;

// Squared distance over squared radius below which places are drawn by solid angle instead of by area.
constexpr float kNearLamp = 6;

// Metres of x before the lamp's plane, 0 behind it and where rounding cannot tell: seen edge-on, a polygon
// has no sides, and one that x lies on would seem to fill the sky.
float height_before(const Light& light, const vec3& x) {
  const vec3 most = glm::max(glm::abs(x), glm::abs(light.position));
  const float height = dot(x - light.position, light.direction);
  return height > 5e-7f * std::max(most.x, std::max(most.y, most.z)) ? height : 0.0f;
}

// The form factor of a disc to a point whose horizon does not cut it, as a vector. With the disc's radius r,
// the point h below its plane and a aside of its axis, k = a^2 + h^2 - r^2 and w = sqrt(k^2 + 4 r^2 h^2), the
// part towards the plane is (1 - k / w) / 2, that towards the axis 2 h r^2 a / (w (k + 2 r^2 + w)).
vec3 disc_form_factor(const Light& light, const vec3& d) {
  const double h = -static_cast<double>(dot(d, light.direction));
  const dvec3 aside = dvec3(d) + h * dvec3(light.direction);
  const double r = static_cast<double>(light.reach()), r2 = r * r;
  const double k = glm::dot(aside, aside) + h * h - r2, w = std::sqrt(k * k + 4 * r2 * h * h);
  const double ahead = k > 0 ? 2 * r2 * h * h / (w * (w + k)) : (w - k) / (2 * w);
  return vec3(-ahead * dvec3(light.direction) + aside * (2 * h * r2 / (w * (k + 2 * r2 + w))));
}

}  // namespace

ElementPolygon area_lamp_corners(const Light& light, const vec3& x) {
  const vec3 middle = light.position - x;
  const vec3 across = 0.5f * light.size.x * light.across;
  const vec3 up = 0.5f * light.size.y * cross(light.direction, light.across);
  ElementPolygon polygon;
  if (light.kind == LightKind::kRectangle) {
    for (const vec3& corner : {-across - up, across - up, across + up, up - across})
      polygon.corners[polygon.count++] = middle + corner;
    return polygon;
  }
  // A regular polygon of n corners at radius R has the area n/2 R^2 sin(2 pi/n).
  static const float out = [] {
    const auto n = static_cast<float>(kDiscCorners);
    return std::sqrt(2 * kPi / (n * std::sin(2 * kPi / n)));
  }();
  for (size_t i = 0; i < kDiscCorners; ++i) {
    const float angle = 2 * kPi * static_cast<float>(i) / static_cast<float>(kDiscCorners);
    polygon.corners[polygon.count++] = middle + out * (std::cos(angle) * across + std::sin(angle) * up);
  }
  return polygon;
}

vec3 area_lamp_transfer(const Light& light, const vec3& x, const vec3& n) {
  const float height = height_before(light, x), area = light.area();
  if (!(height > 0) || !(area > 0)) return vec3(0);
  const vec3 d = light.position - x;
  const float squared = dot(d, d), reach = light.reach(), size = reach * reach / squared;
  if (size < kSpeck || (size < kPointLike && dot(d, n) > reach))
    return dot(d, n) > 0 ? d * (height / (squared * squared)) : vec3(0);
  const float tilt = length(n - dot(n, light.direction) * light.direction);
  if (light.kind == LightKind::kDisc && dot(d, n) >= reach * tilt)
    return (kPi / area) * disc_form_factor(light, d);
  return (kPi / area) * polygon_form_factor(vec3(0), n, area_lamp_corners(light, x).span());
}

AreaLampView::AreaLampView(const Light& light, const vec3& x, const vec3& n)
    : n_(n), direction_(light.direction), height_(height_before(light, x)) {
  if (!(height_ > 0)) return;
  std::array<vec3, kMaxPolygon + 1> above;
  const ElementPolygon all = area_lamp_corners(light, x);
  corners_.count = clip_to_horizon(n, all.span(), above);
  std::copy_n(above.begin(), corners_.count, corners_.corners.begin());
  const vec3 d = light.position - x;
  if (dot(d, d) < kNearLamp * light.reach() * light.reach()) directions_.emplace(corners_.span());
}

vec3 AreaLampView::by_area(float u, float v) const {
  const auto corners = corners_.span();
  const auto area = [&](size_t i) {
    return length(cross(corners[i] - corners[0], corners[i + 1] - corners[0]));
  };
  float all = 0;
  for (size_t i = 1; i + 1 < corners.size(); ++i) all += area(i);
  float target = u * all;
  size_t i = 1;
  for (; i + 2 < corners.size() && target >= area(i); ++i) target -= area(i);
  const float own = area(i), root = std::sqrt(own > 0 ? std::clamp(target / own, 0.0f, 1.0f) : 0.5f);
  return (1 - root) * corners[0] + root * ((1 - v) * corners[i] + v * corners[i + 1]);
}

vec3 AreaLampView::way(float u, float v, float& weight) const {
  weight = 0;
  if (directions_) {
    const vec3 unit = directions_->sample(u, v);
    const float at_lamp = -dot(unit, direction_);
    if (!(at_lamp > 1e-6f)) return vec3(0);
    weight = std::max(0.0f, dot(unit, n_));
    return unit * (height_ / at_lamp);
  }
  const vec3 way = by_area(u, v);
  const float squared = dot(way, way);
  if (!(squared > 0)) return vec3(0);
  weight = std::max(0.0f, dot(way, n_)) * height_ / (squared * squared);
  return way;
}

}  // namespace goldthread
