// The light that reaches a point directly, one sample at a time, and the densities that multiple importance
// sampling weighs samples by (Veach and Guibas 1995).
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "trace/emitter_table.h"
#include "trace/scrambled_sobol.h"
#include "trace/sky_table.h"
#include "trace/traced_scene.h"

namespace goldthread {

/// One way by which light may come.
struct LightSample {
  vec3 irradiance{0};  ///< lux: what it brings unless something is in between, over the sample's density
  Ray shadow;          ///< from the point to the light
  float cosine = 0;    ///< between that way and the receiver's normal; of what has a density
  float density = 0;   ///< of its direction, 1/sr; 0 for lamps, which no other strategy can find
};

/// A direction about `normal` with density cosine / pi.
vec3 cosine_direction(const vec3& normal, SobolPoint p);
/// A direction of even density 1 / 4 pi.
vec3 even_direction(SobolPoint p);

/// The share of a sample of density `own` where another strategy has density `other` (power heuristic,
/// exponent 2).
inline float power_heuristic(float own, float other) {
  if (!(own > 0)) return 0;
  const float ratio = other / own;
  return 1 / (1 + ratio * ratio);
}

/// A lamp, with what its cone needs of sines and cosines worked out. From a place point, spot and directional
/// lights are discs of directions of one luminance, or, without size, one direction; area lamps are what they
/// are. No other strategy finds any of them: rays pass through.
class Lamp {
 public:
  explicit Lamp(const Light& light);

  /// Share of the intensity that it brings to a plane of unit `normal` unless something is in between, 1/m2;
  /// of the illuminance, if it is directional. Of a lamp with size more than that: all that it could, were
  /// its disc as high above the plane as any of it is; of an area lamp about that, and 0 only where it brings
  /// nothing.
  float share_at(const vec3& origin, const vec3& normal) const;
  /// Light from one direction of the disc, or one place of an area lamp, and the way there. `p` counts only
  /// for a lamp with size.
  LightSample light_at(const vec3& origin, const vec3& normal, SobolPoint p) const;
  float brightness() const { return brightness_; }  ///< luminance of the intensity
  bool has_size() const { return light_.angular_diameter > 0 || light_.radius > 0 || light_.has_area(); }

 private:
  struct View {
    vec3 axis{0};        // unit, to the lamp's centre
    float distance = 0;  // metres; 0 for a directional light
    float sine = 0;      // of the disc's angular radius
    float strength = 0;  // share of the intensity on a plane that faces the lamp, 1/m2
  };
  View view_from(const vec3& origin) const;
  float area_share_at(const vec3& origin, const vec3& normal) const;
  LightSample area_light_at(const vec3& origin, const vec3& normal, SobolPoint p) const;
  vec2 place_on(SobolPoint p) const;
  float cone(const vec3& d) const;
  float reach(float distance) const;

  Light light_;
  float brightness_, cos_outer_, cone_scale_;
  mat3 frame_;  // the lamp's own axes in the world
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

  /// One point of one emitting triangle, drawn by power. `origin` is off its surface already; `normal` is
  /// unit.
  LightSample sample_emitter(const vec3& origin, const vec3& normal, SobolPoint p) const;
  /// One direction to the sky: of a uniform one by the cosine, which alone is worth following; else by
  /// luminance.
  LightSample sample_sky(const vec3& origin, const vec3& normal, SobolPoint p) const;
  /// One lamp, drawn by what it would bring were nothing in between, and of one
  /// with size a direction. `sums` is room to work in, lamp_count() long.
  LightSample sample_lamp(const vec3& origin, const vec3& normal, double u, SobolPoint p,
                          std::span<float> sums) const;

  /// Density, 1/sr, with which sample_emitter takes the direction in which a ray has met an emitter after
  /// `distance` metres at the given cosine between ray and normal.
  float emitter_density(uint32_t triangle, float distance, float cosine) const;
  /// Density, 1/sr, with which sample_sky takes a unit direction at that cosine to the receiver's normal.
  float sky_density(const vec3& direction, float cosine) const;

 private:
  const TracedScene& scene_;
  EmitterTable emitters_;
  std::optional<SkyTable> sky_table_;  ///< of a sky that is not uniform
  std::vector<Lamp> lamps_;            ///< those that shine
  bool lamps_with_size_ = false;
};

}  // namespace goldthread
