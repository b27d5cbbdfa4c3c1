#include "trace/lamp.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/wide.h"
#include "math/colour.h"
#include "math/spherical_triangle.h"

namespace goldthread {

namespace {

// KHR_lights_punctual's own guard against cones without a soft edge. No cosine is outside a point light's.
Lamp::Beam beam_of(const Light& light) {
  Lamp::Beam beam{.position = light.position, .axis = light.direction, .cos_outer = -2};
  if (light.kind == LightKind::kSpot) {
    beam.cos_outer = std::cos(light.outer_cone);
    beam.cone_scale = 1 / std::max(0.001f, std::cos(light.inner_cone) - beam.cos_outer);
  }
  if (light.range > 0) beam.per_range = 1 / light.range;
  return beam;
}

/// Share of the intensity that goes at `cosine` to the axis: the square of (cosine - cos outer) /
/// (cos inner - cos outer), clamped to 0..1 (KHR_lights_punctual).
inline float cone_share(const Lamp::Beam& beam, float cosine) {
  const float edge = std::clamp((cosine - beam.cos_outer) * beam.cone_scale, 0.0f, 1.0f);
  return edge * edge;
}

/// What KHR_lights_punctual's range leaves at `distance` metres: 1 - (distance / range)^4, at least 0.
inline float reach(const Lamp::Beam& beam, float distance) {
  const float share = distance * beam.per_range, squared = share * share;
  return std::clamp(1 - squared * squared, 0.0f, 1.0f);
}

/// Lamp::share_at of a lamp that is its beam; all is worked out and then chosen from, for many at once.
inline float beam_share(const Lamp::Beam& beam, const vec3& origin, const vec3& normal) {
  const vec3 d = beam.position - origin;
  const float height = dot(d, normal), distance = std::sqrt(dot(d, d)), per_metre = 1 / distance;
  const float share = height * cone_share(beam, -dot(d, beam.axis) * per_metre) * reach(beam, distance) *
                      (per_metre * per_metre * per_metre);
  return height > 0 ? share : 0.0f;
}

GOLDTHREAD_WIDE_CLONES void beam_shares(const Lamp::Beam& beam, const Places& at, float* __restrict shares) {
  const Vec3Lanes &p = at.points, &n = at.normals;
  for (size_t i = 0; i < at.count; ++i)
    shares[i] = beam_share(beam, vec3(p.x[i], p.y[i], p.z[i]), vec3(n.x[i], n.y[i], n.z[i]));
}

}  // namespace

Lamp::Lamp(const Light& light)
    : light_(light),
      brightness_(luminance(light.intensity)),
      beam_(beam_of(light)),
      frame_(light.across, cross(-light.direction, light.across), -light.direction) {}

bool Lamp::is_plain() const {
  return light_.kind != LightKind::kDirectional && !has_size() && !light_.profile;
}

/// Share of the intensity that goes along unit direction `d`: what its profile says, or its cone.
float Lamp::cone(const vec3& d) const {
  return light_.profile ? light_.profile->intensity(d * frame_) : cone_share(beam_, dot(d, light_.direction));
}

Lamp::View Lamp::view_from(const vec3& origin) const {
  View view;
  if (light_.kind == LightKind::kDirectional) {
    view.axis = -light_.direction;
    view.sine = std::sin(light_.angular_diameter / 2);
    view.strength = 1;
    return view;
  }
  const vec3 d = light_.position - origin;
  view.distance = length(d);
  if (!(view.distance > 0)) return view;
  view.axis = d / view.distance;
  view.sine = light_.radius < view.distance ? light_.radius / view.distance : 0.0f;
  view.strength = cone(-view.axis) * reach(beam_, view.distance) / (view.distance * view.distance);
  return view;
}

float Lamp::share_at(const vec3& origin, const vec3& normal) const {
  if (is_plain()) return beam_share(beam_, origin, normal);
  if (light_.has_area()) return area_share_at(origin, normal);
  if (light_.kind == LightKind::kDirectional && !has_size())
    return std::max(0.0f, -dot(light_.direction, normal));
  const View view = view_from(origin);
  return view.strength * std::clamp(dot(view.axis, normal) + view.sine, 0.0f, 1.0f);
}

void Lamp::shares_at(const Places& at, FloatLanes& shares) const {
  if (is_plain()) {
    beam_shares(beam_, at, shares.data());
    return;
  }
  for (size_t i = 0; i < at.count; ++i) shares[i] = share_at(at.points[i], at.normals[i]);
}

LightSample Lamp::light_of_share(const vec3& origin, float share) const {
  LightSample light;
  light.irradiance = light_.intensity * share;
  light.way = -light_.direction;
  if (light_.kind == LightKind::kDirectional) return light;
  light.way = light_.position - origin;
  light.far = 0.9999f;  // a lamp may be fixed to a surface
  return light;
}

// Drawn evenly over the disc as a plane facing it sees it, with density cos / (pi sin^2) to its axis, a disc
// that brings E to that plane brings E cos_n / cos to one of normal n.
LightSample Lamp::light_at(const vec3& origin, const vec3& normal, SobolPoint p) const {
  if (light_.has_area()) return area_light_at(origin, normal, p);
  if (!has_size()) return light_of_share(origin, share_at(origin, normal));
  const View view = view_from(origin);
  if (!(view.sine > 0)) return light_of_share(origin, view.strength * std::max(0.0f, dot(view.axis, normal)));
  LightSample light;
  const float aside = view.sine * std::sqrt(static_cast<float>(unit_double(p.u)));
  const float turn = 2 * kPi * static_cast<float>(unit_double(p.v));
  const vec3 across = normalize(std::abs(view.axis.x) > 0.6f ? vec3(view.axis.y, -view.axis.x, 0)
                                                             : vec3(0, view.axis.z, -view.axis.y));
  const float along = std::sqrt(1 - aside * aside);
  const vec3 way =
      along * view.axis + aside * (std::cos(turn) * across + std::sin(turn) * cross(view.axis, across));
  light.irradiance = light_.intensity * (view.strength * std::max(0.0f, dot(way, normal)) / along);
  light.way = way;
  if (light_.kind == LightKind::kDirectional) return light;
  // Ends where it meets the ball.
  const float half_chord = std::sqrt(std::max(0.0f, view.sine * view.sine - aside * aside));
  light.way = way * (view.distance * (along - half_chord));
  light.far = 0.9999f;
  return light;
}

/// As large as a plane's share by the lamp's nearest place can be: were all of it as far in front of the
/// plane as any of it is.
float Lamp::area_share_at(const vec3& origin, const vec3& normal) const {
  const vec3 here = (origin - light_.position) * frame_;  // in the lamp's frame, which shines to -z
  const vec3 n = normal * frame_, half = vec3(0.5f * light_.size, 0);
  if (!(here.z < 0)) return 0;
  const bool disc = light_.kind == LightKind::kDisc;
  const float rise = disc ? half.x * length(vec2(n)) : dot(half, glm::abs(n));
  const float height = rise - dot(here, n);
  if (!(height > 0)) return 0;
  const vec2 inside = disc ? vec2(here) * std::min(1.0f, half.x / std::max(length(vec2(here)), 1e-30f))
                           : glm::clamp(vec2(here), -vec2(half), vec2(half));
  const float nearest = length(here - vec3(inside, 0));
  // Never more than were the lamp all that is seen.
  return std::min(1.0f, height / nearest) * (-here.z / nearest) / (nearest * nearest + light_.area() / kPi);
}

/// Metres from the lamp's centre, evenly drawn.
vec2 Lamp::place_on(SobolPoint p) const {
  const vec2 uv(static_cast<float>(unit_double(p.u)), static_cast<float>(unit_double(p.v)));
  if (light_.kind == LightKind::kRectangle) return (uv - 0.5f) * light_.size;
  return 0.5f * light_.size.x * std::sqrt(uv.x) * vec2(std::cos(2 * kPi * uv.y), std::sin(2 * kPi * uv.y));
}

/// Near the lamp an even direction within the square or rectangle around it, with density 1 / its solid angle
/// (a disc is dark in the corners); farther an even place on it, with density squared distance / (cosine
/// area).
LightSample Lamp::area_light_at(const vec3& origin, const vec3& normal, SobolPoint p) const {
  // Squared distance over squared radius, and steradians above which directions are precise.
  constexpr float kNear = 16, kLeastSolidAngle = 0.02f;
  LightSample light;
  light.far = 0.9999f;  // it may be fixed to a surface
  const vec3 middle = light_.position - origin;
  const float before = -dot(middle, light_.direction);
  if (!(before > 0)) return light;
  const vec3 across = 0.5f * light_.size.x * frame_[0], up = 0.5f * light_.size.y * frame_[1];
  const float reach = light_.reach();
  if (dot(middle, middle) < kNear * reach * reach) {
    const std::array<vec3, 4> corners{middle - across - up, middle + across - up, middle + across + up,
                                      middle - across + up};
    const SphericalPolygon seen(corners);
    const float all = seen.solid_angle();
    if (all > kLeastSolidAngle) {
      const vec3 way =
          seen.sample(static_cast<float>(unit_double(p.u)), static_cast<float>(unit_double(p.v)));
      const float at_lamp = -dot(way, light_.direction);
      if (!(at_lamp > 0)) return light;
      light.way = way * (before / at_lamp);
      if (light_.kind == LightKind::kDisc && length(light.way - middle) > reach) return light;
      light.irradiance = light_.intensity * (all * std::max(0.0f, dot(way, normal)) / light_.area());
      return light;
    }
  }
  const vec2 place = place_on(p);
  const vec3 d = middle + place.x * frame_[0] + place.y * frame_[1];
  const float squared = dot(d, d);
  light.way = d;
  light.irradiance = light_.intensity * (std::max(0.0f, dot(d, normal)) * before / (squared * squared));
  return light;
}

}  // namespace goldthread
