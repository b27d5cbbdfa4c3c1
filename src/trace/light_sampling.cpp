#include "trace/light_sampling.h"

#include <algorithm>
#include <cmath>

#include "math/colour.h"

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

float lamp_cone(const Light& lamp, const vec3& d) {
  if (lamp.kind != LightKind::kSpot) return 1;
  // KHR_lights_punctual's own guard against cones without a soft edge.
  const float outer = std::cos(lamp.outer_cone);
  const float scale = 1 / std::max(0.001f, std::cos(lamp.inner_cone) - outer);
  const float edge = std::clamp((dot(d, lamp.direction) - outer) * scale, 0.0f, 1.0f);
  return edge * edge;
}

float lamp_range(const Light& lamp, float distance) {
  if (lamp.range <= 0) return 1;
  return std::clamp(1 - std::pow(distance / lamp.range, 4.0f), 0.0f, 1.0f);
}

LightSampler::LightSampler(const TracedScene& scene) : scene_(scene), emitters_(scene) {
  for (const Light& lamp : scene.scene().lights)
    if (luminance(lamp.intensity) > 0) lamps_.push_back(lamp);
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
  light.shadow.direction = cosine_direction(normal, p);
  light.density = sky_density(std::max(0.0f, dot(normal, light.shadow.direction)));
  light.irradiance = kPi * scene_.scene().sky.radiance;
  return light;
}

LightSample LightSampler::sample_lamp(const vec3& origin, const vec3& normal, double u) const {
  double total = 0;
  for (const Light& lamp : lamps_)
    total += static_cast<double>(luminance(lamp_light(lamp, origin, normal).irradiance));
  if (!(total > 0)) return {};
  double left = u * total;
  LightSample chosen;
  double brings = 0;
  for (const Light& lamp : lamps_) {
    const LightSample light = lamp_light(lamp, origin, normal);
    const auto share = static_cast<double>(luminance(light.irradiance));
    if (!(share > 0)) continue;
    chosen = light;
    brings = share;
    if (left < share) break;
    left -= share;
  }
  chosen.irradiance *= static_cast<float>(total / brings);
  return chosen;
}

LightSample LightSampler::lamp_light(const Light& lamp, const vec3& origin, const vec3& normal) const {
  LightSample light;
  light.shadow.origin = origin;
  if (lamp.kind == LightKind::kDirectional) {
    light.shadow.direction = -lamp.direction;
    light.irradiance = lamp.intensity * std::max(0.0f, -dot(lamp.direction, normal));
    return light;
  }
  const vec3 d = lamp.position - origin;
  const float squared = dot(d, d), distance = std::sqrt(squared);
  if (!(distance > 0)) return light;
  const float cosine = std::max(0.0f, dot(d, normal) / distance);
  light.shadow.direction = d;
  light.shadow.far = 0.9999f;  // a lamp may be fixed to a surface
  light.irradiance =
      lamp.intensity * (cosine * lamp_cone(lamp, -d / distance) * lamp_range(lamp, distance) / squared);
  return light;
}

}  // namespace goldthread
