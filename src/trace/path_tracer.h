// Light along random paths: an unbiased estimate of the rendering equation (Kajiya 1986) for diffuse
// surfaces, one path at a time. Nothing is clamped.
#pragma once
#include <cstdint>

#include "trace/light_sampling.h"
#include "trace/scrambled_sobol.h"
#include "trace/traced_scene.h"

namespace goldthread {

/// The rays of some paths, and the share of time that went into them.
struct RayCount {
  uint64_t rays = 0;
  bool timed = false;            ///< reading clocks costs, so only some paths are timed
  int64_t ray_nanoseconds = 0;   ///< of timed paths: in the ray caster
  int64_t path_nanoseconds = 0;  ///< of timed paths: all of it

  RayCount& operator+=(const RayCount& more) {
    rays += more.rays;
    ray_nanoseconds += more.ray_nanoseconds;
    path_nanoseconds += more.path_nanoseconds;
    return *this;
  }
  /// Share of time in the ray caster, 0..1. Both times are of the same paths, so that a busy machine, which
  /// interrupts either, hardly changes it.
  double ray_share() const;
};

/// Paths through a scene. Thread safe; refers to the scene, which must outlive it.
class PathTracer {
 public:
  explicit PathTracer(const TracedScene& scene) : scene_(scene), lights_(scene) {}

  /// One sample of the irradiance on a plane of unit `normal`, lux; its expectation is the integral of
  /// incident radiance times cosine over the hemisphere. `origin` lies epsilon off its surface.
  vec3 irradiance(const vec3& origin, const vec3& normal, PathSampler& sampler, RayCount& count) const;

  /// One sample of the radiance that a camera sees along `ray`, nits. As in any viewer, backs of one-sided
  /// surfaces are looked through by the camera (and by nothing else), and unlit surfaces show their colour.
  vec3 radiance(const Ray& ray, PathSampler& sampler, RayCount& count) const;

  const TracedScene& scene() const { return scene_; }
  const LightSampler& lights() const { return lights_; }

 private:
  /// A place on a surface, where its rays start, a little above, and its unit normal.
  struct Start {
    vec3 point, origin, normal;
  };
  vec3 trace_irradiance(const vec3& first, const vec3& plane, PathSampler& sampler, RayCount& count) const;
  vec3 trace_radiance(const Ray& ray, PathSampler& sampler, RayCount& count) const;
  vec3 direct(const Start& start, double lamp, PathSampler& sampler, RayCount& count) const;
  vec3 arriving(const LightSample& light, const Start& start, RayCount& count) const;
  float from_the_point(const Start& start, const Ray& ray, const Meeting& met, float& cosine, float& distance,
                       float& cosine_there) const;
  Meeting closest(const Ray& ray, RayCount& count) const;

  const TracedScene& scene_;
  LightSampler lights_;
};

}  // namespace goldthread
