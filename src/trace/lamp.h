// Light from lamps, which no ray meets.
#pragma once
#include <limits>

#include "scene/light.h"
#include "trace/lanes.h"
#include "trace/scrambled_sobol.h"

namespace goldthread {

/// One way by which light may come.
struct LightSample {
  vec3 irradiance{0};  ///< lux: what it brings unless something is in between, over the sample's density
  vec3 way{0};         ///< to the light
  float far = std::numeric_limits<float>::infinity();  ///< in lengths of `way`, what may be in between
  float cosine = 0;   ///< between that way and the receiver's normal; of what has a density
  float density = 0;  ///< of its direction, 1/sr; 0 for lamps, which no other strategy can find
};

/// A lamp, with what its cone needs of sines and cosines worked out. From a place point, spot and directional
/// lights are discs of directions of one luminance, or, without size, one direction; area lamps are what they
/// are. No other strategy finds any of them: rays pass through.
class Lamp {
 public:
  /// What a point or spot light is besides its colour and profile; of a point light a cone that takes in all.
  struct Beam {
    vec3 position{0}, axis{0};
    float cos_outer = 0, cone_scale = 1, per_range = 0;  // 1/m; 0 without limit
  };

  explicit Lamp(const Light& light);

  /// Share of the intensity that it brings to a plane of unit `normal` unless something is in between, 1/m2;
  /// of the illuminance, if it is directional. Of a lamp with size more than that: all that it could, were
  /// its disc as high above the plane as any of it is; of an area lamp about that, and 0 only where it brings
  /// nothing.
  float share_at(const vec3& origin, const vec3& normal) const;
  /// The same of many places, bit for bit.
  void shares_at(const Places& at, FloatLanes& shares) const;
  /// Light from one direction of the disc, or one place of an area lamp, and the way there. `p` counts only
  /// for a lamp with size.
  LightSample light_at(const vec3& origin, const vec3& normal, SobolPoint p) const;
  /// All that a lamp without size brings, of which `share` is that of a plane there.
  LightSample light_of_share(const vec3& origin, float share) const;
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
  /// Whether its share is beam_'s and nothing else.
  bool is_plain() const;

  Light light_;
  float brightness_;
  Beam beam_;
  mat3 frame_;  // the lamp's own axes in the world
};

}  // namespace goldthread
