#include "trace/path_tracer.h"

#include <algorithm>
#include <array>
#include <chrono>

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

vec3 PathTracer::arriving(const LightSample& light, const vec3& normal, RayCount& count) const {
  if (!(largest(light.irradiance) > 0)) return vec3(0);
  float weight = 1;
  if (light.density > 0) {
    const float cosine = dot(normal, light.shadow.direction) / length(light.shadow.direction);
    weight = power_heuristic(light.density, std::max(0.0f, cosine) / kPi);
  }
  return light.irradiance * (weight * counted_ray(count, [&] { return scene_.transmittance(light.shadow); }));
}

vec3 PathTracer::direct(const vec3& origin, const vec3& normal, double lamp, PathSampler& sampler,
                        RayCount& count) const {
  vec3 sum(0);
  if (lights_.has_emitters())
    sum += arriving(lights_.sample_emitter(origin, normal, sampler.next()), normal, count);
  if (lights_.has_sky()) sum += arriving(lights_.sample_sky(origin, normal, sampler.next()), normal, count);
  if (lights_.has_lamps()) sum += arriving(lights_.sample_lamp(origin, normal, lamp), normal, count);
  return sum;
}

// E = integral of L cos = E[pi L] over cosine-distributed directions, and the L that comes back from a
// diffuse surface is rho E / pi: so a path's throughput, relative to irradiance, is the product of
// reflectances.
vec3 PathTracer::trace_irradiance(vec3 origin, vec3 normal, PathSampler& sampler, RayCount& count) const {
  vec3 sum(0), throughput(1);
  for (int bounce = 1;; ++bounce) {
    const bool sure = bounce < kSureBounces;
    const SobolPoint choices = sure && !lights_.has_lamps() ? SobolPoint{} : sampler.next();
    sum += throughput * direct(origin, normal, unit_double(choices.u), sampler, count);
    Ray ray;
    ray.origin = origin;
    ray.direction = cosine_direction(normal, sampler.next());
    const float cosine = std::max(0.0f, dot(normal, ray.direction));
    const Meeting met = closest(ray, count);
    if (met.missed()) {
      if (lights_.has_sky())
        sum += throughput * (kPi * power_heuristic(cosine / kPi, lights_.sky_density(cosine))) *
               scene_.scene().sky.radiance;
      return sum;
    }
    if (!met.live) return sum;
    const vec3 nits = scene_.emission(met.triangle, met.weights);
    if (largest(nits) > 0) {
      const float density =
          lights_.emitter_density(met.triangle, met.distance, -dot(met.normal, ray.direction));
      sum += throughput * (kPi * power_heuristic(cosine / kPi, density)) * nits;
    }
    throughput *= scene_.reflectance(met.triangle, met.weights);
    const float survival = sure ? 1.0f : std::min(kMostSurvival, largest(throughput));
    if (!(largest(throughput) > 0) || unit_double(choices.v) >= static_cast<double>(survival)) return sum;
    throughput /= survival;
    normal = met.normal;
    origin = ray.origin + met.distance * ray.direction + scene_.epsilon() * normal;
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
