#include "trace/light_sampling.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/wide.h"
#include "math/colour.h"
#include "trace/directions.h"

namespace goldthread {
namespace {

/// All of `lights` but what of the emitters' luminance makes irradiance, which goes to `shares`: 0 where a
/// place and an emitter do not face each other.
GOLDTHREAD_WIDE_CLONES void look_at_emitters(const Places& at, const EmitterPoints& drawn, float epsilon,
                                             LightSamples& __restrict lights, FloatLanes& __restrict shares) {
  for (size_t i = 0; i < at.count; ++i) {
    const vec3 d(drawn.points.x[i] - at.points.x[i], drawn.points.y[i] - at.points.y[i],
                 drawn.points.z[i] - at.points.z[i]);
    const vec3 n(drawn.normals.x[i], drawn.normals.y[i], drawn.normals.z[i]);
    const float squared = dot(d, d), distance = std::sqrt(squared), from_behind = dot(n, d);
    const float side = from_behind > 0 && drawn.two_sided[i] > 0 ? -1.0f : 1.0f;
    const float here = dot(vec3(at.normals.x[i], at.normals.y[i], at.normals.z[i]), d) / distance;
    const float there = -side * from_behind / distance;
    const bool face = here > 0 && there > 0;
    const float density = drawn.density[i] * squared / there, share = here / density;
    lights.cosine[i] = here;
    lights.density[i] = face ? density : 0.0f;
    shares[i] = face ? share : 0.0f;
    lights.far[i] = 1;
    lights.ways.x[i] = d.x + epsilon * side * n.x;
    lights.ways.y[i] = d.y + epsilon * side * n.y;
    lights.ways.z[i] = d.z + epsilon * side * n.z;
  }
}

/// Turns shares of a lamp's intensity into running sums of what lamps bring.
GOLDTHREAD_WIDE_CLONES void add_up(float brightness, size_t count, FloatLanes& __restrict shares,
                                   FloatLanes& __restrict totals) {
  for (size_t i = 0; i < count; ++i) {
    totals[i] += brightness * shares[i];
    shares[i] = totals[i];
  }
}

/// Counts the lamps before the first whose sum is above what is wanted; where rounding leaves none above,
/// before the last that brings anything.
GOLDTHREAD_WIDE_CLONES void count_passed(const FloatLanes& sums, size_t count, const FloatLanes& wanted,
                                         const FloatLanes& totals,
                                         std::array<uint32_t, kLanes>& __restrict passed) {
  for (size_t i = 0; i < count; ++i) {
    const uint32_t below = sums[i] <= wanted[i] ? 1 : 0, before = sums[i] < totals[i] ? 1 : 0;
    passed[i] += below & before;
  }
}

}  // namespace

LightSampler::LightSampler(const TracedScene& scene) : scene_(scene), emitters_(scene) {
  for (const Light& lamp : scene.scene().lights)
    if (luminance(lamp.intensity) > 0) lamps_.emplace_back(lamp);
  for (const Lamp& lamp : lamps_) lamps_with_size_ = lamps_with_size_ || lamp.has_size();
  const Sky& sky = scene.scene().sky;
  if (sky.present() && !sky.is_uniform()) sky_table_.emplace(sky);
}

void LightSampler::sample_emitters(const Places& at, std::span<const SobolPoint> points,
                                   LightSamples& lights) const {
  GOLDTHREAD_CHECK_EQ(at.count, points.size());
  EmitterPoints drawn;
  emitters_.sample(points, drawn);
  FloatLanes shares;
  look_at_emitters(at, drawn, scene_.epsilon(), lights, shares);
  for (size_t i = 0; i < at.count; ++i)
    lights.irradiance[i] =
        shares[i] > 0 ? emitters_.nits(*drawn.emitters[i], drawn.weights[i]) * shares[i] : vec3(0);
}

float LightSampler::emitter_density(uint32_t triangle, float distance, float cosine) const {
  return emitters_.density(triangle) * distance * distance / std::max(cosine, 1e-12f);
}

void LightSampler::sample_sky(const Places& at, std::span<const SobolPoint> points,
                              LightSamples& lights) const {
  GOLDTHREAD_CHECK_EQ(at.count, points.size());
  for (size_t i = 0; i < at.count; ++i) lights.set(i, sky_sample(at.normals[i], points[i]));
}

LightSample LightSampler::sky_sample(const vec3& normal, SobolPoint p) const {
  LightSample light;
  if (!sky_table_) {
    light.way = cosine_direction(normal, p);
    light.cosine = std::max(0.0f, dot(normal, light.way));
    light.density = sky_density(light.way, light.cosine);
    light.irradiance = kPi * scene_.scene().sky.radiance;
    return light;
  }
  if (sky_table_->empty()) return light;
  const SkyDirection drawn = sky_table_->sample(unit_double(p.u), unit_double(p.v));
  light.way = drawn.direction;
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

void LightSampler::sample_lamps(const Places& at, std::span<const SobolPoint> choices,
                                std::span<const SobolPoint> points, std::span<FloatLanes> sums,
                                LightSamples& lights) const {
  GOLDTHREAD_CHECK_EQ(at.count, choices.size());
  GOLDTHREAD_CHECK_EQ(lamps_.size(), sums.size());
  FloatLanes totals{}, wanted;
  for (size_t l = 0; l < lamps_.size(); ++l) {
    lamps_[l].shares_at(at, sums[l]);
    add_up(lamps_[l].brightness(), at.count, sums[l], totals);
  }
  std::array<uint32_t, kLanes> chosen{};
  for (size_t i = 0; i < at.count; ++i)
    wanted[i] = static_cast<float>(unit_double(choices[i].u) * static_cast<double>(totals[i]));
  for (size_t l = 0; l + 1 < lamps_.size(); ++l) count_passed(sums[l], at.count, wanted, totals, chosen);
  for (size_t i = 0; i < at.count; ++i) {
    const Lamp& lamp = lamps_[chosen[i]];
    if (!(totals[i] > 0)) {
      lights.set(i, {});
    } else if (!lamp.has_size()) {
      // Its share over the chance that it is drawn: the share is in both.
      lights.set(i, lamp.light_of_share(at.points[i], totals[i] / lamp.brightness()));
    } else {
      const float before = chosen[i] > 0 ? sums[chosen[i] - 1][i] : 0.0f;
      LightSample light = lamp.light_at(at.points[i], at.normals[i], points[i]);
      light.irradiance *= totals[i] / (sums[chosen[i]][i] - before);
      lights.set(i, light);
    }
  }
}

}  // namespace goldthread
