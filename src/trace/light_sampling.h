// The light that reaches a point directly, one sample at a time, and the densities that multiple importance
// sampling weighs samples by (Veach and Guibas 1995).
#pragma once
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "trace/emitter_table.h"
#include "trace/lamp.h"
#include "trace/lanes.h"
#include "trace/scrambled_sobol.h"
#include "trace/sky_table.h"
#include "trace/traced_scene.h"

namespace goldthread {

/// The share of a sample of density `own` where another strategy has density `other` (power heuristic,
/// exponent 2).
inline float power_heuristic(float own, float other) {
  if (!(own > 0)) return 0;
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

/// A LightSample of each of some places.
struct LightSamples {
  std::array<vec3, kLanes> irradiance;
  Vec3Lanes ways;  ///< of the rays that ask, from the places
  FloatLanes far;  ///< of these rays
  FloatLanes cosine, density;

  void set(size_t i, const LightSample& light) {
    irradiance[i] = light.irradiance;
    ways.set(i, light.way);
    far[i] = light.far;
    cosine[i] = light.cosine;
    density[i] = light.density;
  }
};

/// Draws light for points of a scene, which must outlive it.
class LightSampler {
 public:
  explicit LightSampler(const TracedScene& scene);

  bool has_emitters() const { return !emitters_.empty(); }
  bool has_sky() const { return scene_.scene().sky.present(); }
  bool has_lamps() const { return !lamps_.empty(); }
  size_t lamp_count() const { return lamps_.size(); }
  bool has_lamps_with_size() const { return lamps_with_size_; }

  /// One point of one emitting triangle for each place, drawn by power.
  void sample_emitters(const Places& at, std::span<const SobolPoint> points, LightSamples& lights) const;
  /// One direction to the sky: of a uniform one by the cosine, which alone is worth following; else by
  /// luminance.
  void sample_sky(const Places& at, std::span<const SobolPoint> points, LightSamples& lights) const;
  /// One lamp, drawn with `choices`' first numbers by what it would bring were nothing in between, and of one
  /// with size a direction; without such lamps `points` may be empty. `sums` is room to work in,
  /// lamp_count() long.
  void sample_lamps(const Places& at, std::span<const SobolPoint> choices, std::span<const SobolPoint> points,
                    std::span<FloatLanes> sums, LightSamples& lights) const;

  /// Density, 1/sr, with which sample_emitters takes the direction in which a ray has met an emitter after
  /// `distance` metres at the given cosine between ray and normal.
  float emitter_density(uint32_t triangle, float distance, float cosine) const;
  /// Density, 1/sr, with which sample_sky takes a unit direction at that cosine to the receiver's normal.
  float sky_density(const vec3& direction, float cosine) const;

 private:
  LightSample sky_sample(const vec3& normal, SobolPoint p) const;

  const TracedScene& scene_;
  EmitterTable emitters_;
  std::optional<SkyTable> sky_table_;  ///< of a sky that is not uniform
  std::vector<Lamp> lamps_;            ///< those that shine
  bool lamps_with_size_ = false;
};

}  // namespace goldthread
