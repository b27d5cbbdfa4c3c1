// Light along random paths: an unbiased estimate of the rendering equation (Kajiya 1986) for diffuse
// surfaces. Nothing is clamped. Paths go in bundles, a bounce of all at a time, so that what one path waits
// for in memory another uses, and rays leave for the ray caster in one go; what becomes of a path does not
// depend on those beside it.
#pragma once
#include <cstdint>
#include <span>

#include "trace/light_sampling.h"
#include "trace/scrambled_sobol.h"
#include "trace/traced_scene.h"

namespace goldthread {

/// The rays of some paths, and the share of time that went into them.
struct PathCost {
  uint64_t rays = 0;
  int64_t ray_nanoseconds = 0;   ///< in the ray caster
  int64_t path_nanoseconds = 0;  ///< all of it

  PathCost& operator+=(const PathCost& more) {
    rays += more.rays;
    ray_nanoseconds += more.ray_nanoseconds;
    path_nanoseconds += more.path_nanoseconds;
    return *this;
  }
  /// Share of time in the ray caster, 0..1. Both times are of the same paths, so that a busy machine, which
  /// interrupts either, hardly changes it.
  double ray_share() const;
};

/// Where a path begins, and its random numbers.
struct PathStart {
  vec3 origin{0};  ///< epsilon off its surface
  vec3 normal{0};  ///< unit: of the plane that light is measured on
  PathSeed seed;
  /// Unit, of the surface itself where `normal` is bent: what comes from below it counts for nothing, and
  /// `origin` lies off it. 0 where there is no other than `normal`.
  vec3 surface{0};
};

/// What a camera looks along. The path's first pair of random numbers is left to the lens.
struct CameraPath {
  Ray ray;
  PathSeed seed;
};
constexpr uint32_t kLensPair = 1;

/// Paths through a scene. Thread safe; refers to the scene, which must outlive it.
class PathTracer {
 public:
  /// So many paths go together.
  static constexpr size_t kBundle = kLanes;

  explicit PathTracer(const TracedScene& scene) : scene_(scene), lights_(scene) {}

  /// One sample of the irradiance on each path's plane, lux; its expectation is the integral of incident
  /// radiance times cosine over the hemisphere. `lux` is as long as `starts`.
  void irradiance(std::span<const PathStart> starts, std::span<vec3> lux, PathCost& count) const;

  /// One sample of the radiance that a camera sees along each ray, nits. As in any viewer, backs of one-sided
  /// surfaces are looked through by the camera (and by nothing else), and unlit surfaces show their colour.
  /// `nits` is as long as `seen`.
  void radiance(std::span<const CameraPath> seen, std::span<vec3> nits, PathCost& count) const;

  const TracedScene& scene() const { return scene_; }
  const LightSampler& lights() const { return lights_; }

 private:
  const TracedScene& scene_;
  LightSampler lights_;
};

}  // namespace goldthread
