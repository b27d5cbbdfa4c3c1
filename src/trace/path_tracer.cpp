#include "trace/path_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

namespace goldthread {
namespace {

// Russian roulette starts where paths have mostly said what they have to say, and never lets all of them
// live.
constexpr int kSureBounces = 3;
constexpr float kMostSurvival = 0.95f;

float largest(const vec3& v) {
  return std::max({v.x, v.y, v.z});
}

using Clock = std::chrono::steady_clock;

int64_t nanoseconds_since(Clock::time_point begin) {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count();
}

/// What reading the clock takes: as much as a tenth of a ray.
int64_t clock_nanoseconds() {
  std::array<int64_t, 101> readings{};
  for (int64_t& reading : readings) reading = nanoseconds_since(Clock::now());
  std::nth_element(readings.begin(), readings.begin() + readings.size() / 2, readings.end());
  return readings[readings.size() / 2];
}

const int64_t kClockNanoseconds = clock_nanoseconds();

/// Runs `trace` as one ray, timed where the count asks for it.
template <typename Trace>
auto counted_ray(RayCount& count, const Trace& trace) {
  ++count.rays;
  if (!count.timed) return trace();
  const auto begin = Clock::now();
  auto result = trace();
  count.ray_nanoseconds += nanoseconds_since(begin) - kClockNanoseconds;
  return result;
}

/// Runs `trace` as one path; what its rays' clocks took is no part of it.
template <typename Trace>
vec3 counted_path(RayCount& count, const Trace& trace) {
  if (!count.timed) return trace();
  const uint64_t rays = count.rays;
  const auto begin = Clock::now();
  const vec3 result = trace();
  const int64_t clocks = 2 * static_cast<int64_t>(count.rays - rays) + 1;
  count.path_nanoseconds += nanoseconds_since(begin) - clocks * kClockNanoseconds;
  return result;
}

}  // namespace

double RayCount::ray_share() const {
  if (path_nanoseconds <= 0) return 0;
  return std::clamp(static_cast<double>(ray_nanoseconds) / static_cast<double>(path_nanoseconds), 0.0, 1.0);
}

vec3 PathTracer::irradiance(const vec3& origin, const vec3& normal, PathSampler& sampler,
                            RayCount& count) const {
  return counted_path(count, [&] { return trace_irradiance(origin, normal, sampler, count); });
}

vec3 PathTracer::radiance(const Ray& ray, PathSampler& sampler, RayCount& count) const {
  return counted_path(count, [&] { return trace_radiance(ray, sampler, count); });
}

Meeting PathTracer::closest(const Ray& ray, RayCount& count) const {
  return counted_ray(count, [&] { return scene_.closest(ray); });
}

vec3 PathTracer::arriving(const LightSample& light, const Start& start, RayCount& count) const {
  if (!(largest(light.irradiance) > 0)) return vec3(0);
  float weight = 1;
  if (light.density > 0) {
    const float cosine = dot(start.normal, light.shadow.direction) / length(light.shadow.direction);
    weight = power_heuristic(light.density, std::max(0.0f, cosine) / kPi);
  }
  // What it brings is that of the point; the ray that asks starts above it and ends where it would.
  Ray shadow = light.shadow;
  shadow.origin = start.origin;
  if (std::isfinite(shadow.far)) shadow.direction += start.point - start.origin;
  return light.irradiance * (weight * counted_ray(count, [&] { return scene_.transmittance(shadow); }));
}

vec3 PathTracer::direct(const Start& start, double lamp, PathSampler& sampler, RayCount& count) const {
  vec3 sum(0);
  if (lights_.has_emitters())
    sum += arriving(lights_.sample_emitter(start.point, start.normal, sampler.next()), start, count);
  if (lights_.has_sky())
    sum += arriving(lights_.sample_sky(start.point, start.normal, sampler.next()), start, count);
  if (lights_.has_lamps())
    sum += arriving(lights_.sample_lamp(start.point, start.normal, lamp), start, count);
  return sum;
}

// A ray that starts a little above its point meets y with another density than one from the point itself
// would: cos cos' / r² of the one over that of the other makes up for it. Without, light from close by would
// be off by the lift over the distance, twice. Nought where the point does not see y.
float PathTracer::from_the_point(const Start& start, const Ray& ray, const Meeting& met, float& cosine,
                                 float& distance, float& cosine_there) const {
  const vec3 y = ray.origin + met.distance * ray.direction, d = y - start.point;
  const float lifted = dot(start.normal, ray.direction) * -dot(met.normal, ray.direction) /
                       std::max(met.distance * met.distance, 1e-30f);
  distance = length(d);
  cosine = dot(start.normal, d) / distance;
  cosine_there = -dot(met.normal, d) / distance;
  // In a corner, a few lifts from the walls, the ratio is anything; and there all looks the same from a
  // little further off, so that nothing has to be made up for.
  if (met.distance < 32 * scene_.epsilon()) return 1;
  if (!(cosine > 0) || !(cosine_there > 0) || !(lifted > 0)) return 0;
  return cosine * cosine_there / (distance * distance) / lifted;
}

// E = integral of L cos = E[pi L] over cosine-distributed directions, and the L that comes back from a
// diffuse surface is rho E / pi: so a path's throughput, relative to irradiance, is the product of
// reflectances.
vec3 PathTracer::trace_irradiance(const vec3& first, const vec3& plane, PathSampler& sampler,
                                  RayCount& count) const {
  vec3 sum(0), throughput(1);
  Start start{first - scene_.epsilon() * plane, first, plane};
  for (int bounce = 1;; ++bounce) {
    const bool sure = bounce < kSureBounces;
    const SobolPoint choices = sure && !lights_.has_lamps() ? SobolPoint{} : sampler.next();
    sum += throughput * direct(start, unit_double(choices.u), sampler, count);
    Ray ray;
    ray.origin = start.origin;
    ray.direction = cosine_direction(start.normal, sampler.next());
    const Meeting met = closest(ray, count);
    if (met.missed()) {
      const float cosine = std::max(0.0f, dot(start.normal, ray.direction));
      if (lights_.has_sky())
        sum += throughput * (kPi * power_heuristic(cosine / kPi, lights_.sky_density(cosine))) *
               scene_.scene().sky.radiance;
      return sum;
    }
    if (!met.live) return sum;
    float cosine = 0, distance = 0, cosine_there = 0;
    const float share = from_the_point(start, ray, met, cosine, distance, cosine_there);
    if (!(share > 0)) return sum;
    throughput *= share;
    const vec3 nits = scene_.emission(met.triangle, met.weights);
    if (largest(nits) > 0) {
      const float density = lights_.emitter_density(met.triangle, distance, cosine_there);
      sum += throughput * (kPi * power_heuristic(cosine / kPi, density)) * nits;
    }
    throughput *= scene_.reflectance(met.triangle, met.weights);
    const float survival = sure ? 1.0f : std::min(kMostSurvival, largest(throughput));
    if (!(largest(throughput) > 0) || unit_double(choices.v) >= static_cast<double>(survival)) return sum;
    throughput /= survival;
    start.point = ray.origin + met.distance * ray.direction;
    start.normal = met.normal;
    start.origin = start.point + scene_.epsilon() * start.normal;
  }
}

vec3 PathTracer::trace_radiance(const Ray& seen, PathSampler& sampler, RayCount& count) const {
  Ray ray = seen;
  Meeting met = closest(ray, count);
  while (!met.missed() && !met.live && !scene_.material(met.triangle).unlit) {
    ray.near = met.distance + 2 * scene_.epsilon();
    met = closest(ray, count);
  }
  if (met.missed()) return scene_.scene().sky.radiance;
  if (scene_.material(met.triangle).unlit) return scene_.unlit_colour(met.triangle, met.weights);
  vec3 nits = scene_.emission(met.triangle, met.weights);
  const vec3 reflectance = scene_.reflectance(met.triangle, met.weights);
  if (largest(reflectance) > 0) {
    const vec3 origin = ray.origin + met.distance * ray.direction + scene_.epsilon() * met.normal;
    nits += reflectance / kPi * trace_irradiance(origin, met.normal, sampler, count);
  }
  return nits;
}

}  // namespace goldthread
