#include "trace/light_sampling.h"

#include <algorithm>
#include <cmath>

#include "math/colour.h"
#include "math/spherical_triangle.h"

namespace goldthread {

vec3 cosine_direction(const vec3& normal, SobolPoint p) {
  const double u = unit_double(p.u);
  const float angle = 2 * kPi * static_cast<float>(unit_double(p.v));
  const float radius = std::sqrt(static_cast<float>(u)), height = std::sqrt(static_cast<float>(1 - u));
  // The frame of Duff et al., Building an Orthonormal Basis, Revisited (2017): no root, no branch.
  const float sign = std::copysign(1.0f, normal.z);
  const float a = -1 / (sign + normal.z), b = normal.x * normal.y * a;
  const vec3 across(1 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
  const vec3 up(b, sign + normal.y * normal.y * a, -normal.y);
  return radius * (std::cos(angle) * across + std::sin(angle) * up) + height * normal;
}

vec3 even_direction(SobolPoint p) {
  const double z = 1 - 2 * unit_double(p.u), angle = 2 * 3.14159265358979323846 * unit_double(p.v);
  const double radius = std::sqrt(std::max(0.0, 1 - z * z));
  return vec3(dvec3(radius * std::cos(angle), radius * std::sin(angle), z));
}

// KHR_lights_punctual's own guard against cones without a soft edge.
Lamp::Lamp(const Light& light)
    : light_(light),
      brightness_(luminance(light.intensity)),
      cos_outer_(std::cos(light.outer_cone)),
      cone_scale_(1 / std::max(0.001f, std::cos(light.inner_cone) - cos_outer_)),
      frame_(light.across, cross(-light.direction, light.across), -light.direction) {}

/// Share of the intensity that goes along unit direction `d`: what its profile says; without one 1 for a
/// point light, and for a spot the square of (d . axis - cos outer) / (cos inner - cos outer), clamped to
/// 0..1 (KHR_lights_punctual).
float Lamp::cone(const vec3& d) const {
  if (light_.profile) return light_.profile->intensity(d * frame_);
  if (light_.kind != LightKind::kSpot) return 1;
  const float edge = std::clamp((dot(d, light_.direction) - cos_outer_) * cone_scale_, 0.0f, 1.0f);
  return edge * edge;
}

/// What KHR_lights_punctual's range leaves at `distance` metres: 1 - (distance / range)^4, at least 0.
float Lamp::reach(float distance) const {
  if (light_.range <= 0) return 1;
  const float share = distance / light_.range, squared = share * share;
  return std::clamp(1 - squared * squared, 0.0f, 1.0f);
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
  view.strength = cone(-view.axis) * reach(view.distance) / (view.distance * view.distance);
  return view;
}

float Lamp::share_at(const vec3& origin, const vec3& normal) const {
  if (light_.has_area()) return area_share_at(origin, normal);
  if (light_.kind == LightKind::kDirectional && !has_size())
    return std::max(0.0f, -dot(light_.direction, normal));
  if (has_size()) {
    const View view = view_from(origin);
    return view.strength * std::clamp(dot(view.axis, normal) + view.sine, 0.0f, 1.0f);
  }
  const vec3 d = light_.position - origin;
  const float height = dot(d, normal);
  if (!(height > 0)) return 0;
  const float squared = dot(d, d), distance = std::sqrt(squared);
  return height * cone(-d / distance) * reach(distance) / (squared * distance);
}

// Drawn evenly over the disc as a plane facing it sees it, with density cos / (pi sin^2) to its axis, a disc
// that brings E to that plane brings E cos_n / cos to one of normal n.
LightSample Lamp::light_at(const vec3& origin, const vec3& normal, SobolPoint p) const {
  if (light_.has_area()) return area_light_at(origin, normal, p);
  LightSample light;
  light.shadow.origin = origin;
  const View view = view_from(origin);
  if (!has_size() || !(view.sine > 0)) {
    const float cosine =
        has_size() ? view.strength * std::max(0.0f, dot(view.axis, normal)) : share_at(origin, normal);
    light.irradiance = light_.intensity * cosine;
    light.shadow.direction = -light_.direction;
    if (light_.kind == LightKind::kDirectional) return light;
    light.shadow.direction = light_.position - origin;
    light.shadow.far = 0.9999f;  // a lamp may be fixed to a surface
    return light;
  }
  const float aside = view.sine * std::sqrt(static_cast<float>(unit_double(p.u)));
  const float turn = 2 * kPi * static_cast<float>(unit_double(p.v));
  const vec3 across = normalize(std::abs(view.axis.x) > 0.6f ? vec3(view.axis.y, -view.axis.x, 0)
                                                             : vec3(0, view.axis.z, -view.axis.y));
  const float along = std::sqrt(1 - aside * aside);
  const vec3 way =
      along * view.axis + aside * (std::cos(turn) * across + std::sin(turn) * cross(view.axis, across));
  light.irradiance = light_.intensity * (view.strength * std::max(0.0f, dot(way, normal)) / along);
  light.shadow.direction = way;
  if (light_.kind == LightKind::kDirectional) return light;
  // Ends where it meets the ball.
  const float half_chord = std::sqrt(std::max(0.0f, view.sine * view.sine - aside * aside));
  light.shadow.direction = way * (view.distance * (along - half_chord));
  light.shadow.far = 0.9999f;
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
  light.shadow.origin = origin;
  light.shadow.far = 0.9999f;  // it may be fixed to a surface
  const vec3 middle = light_.position - origin;
  const float before = -dot(middle, light_.direction);
  if (!(before > 0)) return light;
  const vec3 across = 0.5f * light_.size.x * frame_[0], up = 0.5f * light_.size.y * frame_[1];
  const float reach = light_.reach();
  if (dot(middle, middle) < kNear * reach * reach) {
    const std::array<vec3, 4> corners{middle - across - up, middle + across - up, middle + across + up,
                                      middle - across + up};
    std::array<vec3, 4> unit;
    for (size_t i = 0; i < 4; ++i) unit[i] = normalize_or(corners[i], vec3(0));
    const float all = solid_angle(unit[0], unit[1], unit[2]) + solid_angle(unit[0], unit[2], unit[3]);
    if (all > kLeastSolidAngle) {
      const vec3 way = sample_spherical_polygon(corners, static_cast<float>(unit_double(p.u)),
                                                static_cast<float>(unit_double(p.v)));
      const float at_lamp = -dot(way, light_.direction);
      if (!(at_lamp > 0)) return light;
      light.shadow.direction = way * (before / at_lamp);
      if (light_.kind == LightKind::kDisc && length(light.shadow.direction - middle) > reach) return light;
      light.irradiance = light_.intensity * (all * std::max(0.0f, dot(way, normal)) / light_.area());
      return light;
    }
  }
  const vec2 place = place_on(p);
  const vec3 d = middle + place.x * frame_[0] + place.y * frame_[1];
  const float squared = dot(d, d);
  light.shadow.direction = d;
  light.irradiance = light_.intensity * (std::max(0.0f, dot(d, normal)) * before / (squared * squared));
  return light;
}

LightSampler::LightSampler(const TracedScene& scene) : scene_(scene), emitters_(scene) {
  for (const Light& lamp : scene.scene().lights)
    if (luminance(lamp.intensity) > 0) lamps_.emplace_back(lamp);
  for (const Lamp& lamp : lamps_) lamps_with_size_ = lamps_with_size_ || lamp.has_size();
  const Sky& sky = scene.scene().sky;
  if (sky.present() && !sky.is_uniform()) sky_table_.emplace(sky);
}

LightSample LightSampler::sample_emitter(const vec3& origin, const vec3& normal, SobolPoint p) const {
  LightSample light;
  vec2 weights;
  const Emitter& emitter = emitters_.sample(unit_double(p.u), unit_double(p.v), weights);
  const vec3 y = emitter.corner + weights.x * emitter.across + weights.y * emitter.up, d = y - origin;
  const float squared = dot(d, d), distance = std::sqrt(squared);
  const bool turned = emitter.double_sided && dot(emitter.normal, d) > 0;
  const vec3 front = turned ? -emitter.normal : emitter.normal;
  const float at_receiver = dot(normal, d) / distance, at_emitter = -dot(front, d) / distance;
  if (!(at_receiver > 0) || !(at_emitter > 0)) return light;
  light.cosine = at_receiver;
  light.density = emitter.density * squared / at_emitter;
  light.irradiance = emitters_.nits(emitter, weights) * (at_receiver / light.density);
  light.shadow.origin = origin;
  light.shadow.direction = d + scene_.epsilon() * front;
  light.shadow.far = 1;
  return light;
}

float LightSampler::emitter_density(uint32_t triangle, float distance, float cosine) const {
  return emitters_.density(triangle) * distance * distance / std::max(cosine, 1e-12f);
}

LightSample LightSampler::sample_sky(const vec3& origin, const vec3& normal, SobolPoint p) const {
  LightSample light;
  light.shadow.origin = origin;
  if (!sky_table_) {
    light.shadow.direction = cosine_direction(normal, p);
    light.cosine = std::max(0.0f, dot(normal, light.shadow.direction));
    light.density = sky_density(light.shadow.direction, light.cosine);
    light.irradiance = kPi * scene_.scene().sky.radiance;
    return light;
  }
  if (sky_table_->empty()) return light;
  const SkyDirection drawn = sky_table_->sample(unit_double(p.u), unit_double(p.v));
  light.shadow.direction = drawn.direction;
  light.cosine = dot(normal, drawn.direction);
  light.density = drawn.density;
  if (!(light.cosine > 0) || !(light.density > 0)) return light;
  light.irradiance = scene_.scene().sky.radiance_towards(drawn.direction) * (light.cosine / light.density);
  return light;
}

float LightSampler::sky_density(const vec3& direction, float cosine) const {
  if (sky_table_) return sky_table_->empty() ? 0.0f : sky_table_->density(direction);
  return has_sky() ? cosine / kPi : 0.0f;
}

LightSample LightSampler::sample_lamp(const vec3& origin, const vec3& normal, double u, SobolPoint p,
                                      std::span<float> sums) const {
  float total = 0;
  for (size_t i = 0; i < lamps_.size(); ++i) {
    total += lamps_[i].brightness() * lamps_[i].share_at(origin, normal);
    sums[i] = total;
  }
  if (!(total > 0)) return {};
  // The first whose sum is above, and the last that brings anything where rounding leaves none.
  const auto wanted = static_cast<float>(u * static_cast<double>(total));
  size_t chosen = 0;
  while (chosen + 1 < lamps_.size() && sums[chosen] <= wanted && sums[chosen] < total) ++chosen;
  const float before = chosen > 0 ? sums[chosen - 1] : 0.0f;
  LightSample light = lamps_[chosen].light_at(origin, normal, p);
  light.irradiance *= total / (sums[chosen] - before);
  return light;
}

}  // namespace goldthread
