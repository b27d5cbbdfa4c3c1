// Skies that are not the same all over: the CIE's standard skies and Preetham's clear one, as values.
#pragma once
#include <cstdint>
#include <variant>

#include "goldthread/error.h"
#include "math/vec.h"
#include "scene/preetham_sky.h"
#include "scene/sky_distribution.h"

namespace goldthread {

/// How bright a sky of known shape is, linear Rec.709. The standards know no colour: equal components are
/// white.
struct SkyLevel {
  enum class Measure { kHorizontalIlluminance, kZenithLuminance };
  Measure measure = Measure::kHorizontalIlluminance;
  vec3 value{0};  ///< lux or nits

  /// Lux on open flat ground by the sky alone, without the sun.
  static SkyLevel horizontal_illuminance(const vec3& lux) { return {Measure::kHorizontalIlluminance, lux}; }
  /// Nits straight above. A sun near the zenith makes that its halo.
  static SkyLevel zenith_luminance(const vec3& nits) { return {Measure::kZenithLuminance, nits}; }
};

/// What a SkyModel is made of, as plain values.
struct SkyDescription {
  enum class Kind : uint8_t { kUniform, kCieGeneral, kTraditionalOvercast, kPreetham };
  Kind kind = Kind::kUniform;
  int32_t cie_type = 5;         ///< of kCieGeneral
  vec3 sun_direction{0, 1, 0};  ///< of kCieGeneral and kPreetham
  SkyLevel level;               ///< of all but kPreetham; of kUniform the zenith's luminance
  float turbidity = 3;          ///< of kPreetham
  vec3 ground_reflectance{0};   ///< diffuse, 0..1
  vec3 sunlight{0};             ///< lux on flat ground by a sun that is no part of the sky
};

/// A sky's luminance in every direction, the sun's disc not included (scene/sun.h), and flat, diffuse ground
/// below the horizon. Directions are in the world, Y up; they need not be of length 1. A sun below the
/// horizon is taken to stand on it: none of these models knows twilight.
class SkyModel {
 public:
  /// `nits` everywhere above the horizon. The CIE's type 5.
  static SkyModel uniform(const vec3& nits);

  /// One of the fifteen standard skies of ISO 15469:2004 (CIE S 011/E:2003). Error: a type that is not 1..15,
  /// a sun without direction, a level that is negative or not finite.
  static Result<SkyModel> cie_general(int type, const vec3& sun_direction, const SkyLevel& level);
  /// Type 1, "CIE standard overcast sky": about three times as bright above as at the horizon, the
  /// same all round.
  static Result<SkyModel> overcast(const SkyLevel& level);
  /// Type 12, "CIE standard clear sky, low illuminance turbidity".
  static Result<SkyModel> clear(const vec3& sun_direction, const SkyLevel& level);
  /// Moon and Spencer's of 1942: zenith luminance times (1 + 2 cos Z) / 3. The standard's number 16.
  static Result<SkyModel> traditional_overcast(const SkyLevel& level);

  /// A coloured clear or hazy sky in absolute units (scene/preetham_sky.h). Error: turbidity out of 1.7..10,
  /// a sun without direction.
  static Result<SkyModel> preetham(const vec3& sun_direction, float turbidity);

  /// The one that `description` says; errors as of the others, and for values that are none or negative.
  static Result<SkyModel> make(const SkyDescription& description);
  /// What it was made of: `make` gives the same again.
  const SkyDescription& description() const { return description_; }

  /// The same sky over ground of that diffuse reflectance (0 before), which also gets `sunlight` lux on the
  /// flat from a sun that is no part of the sky.
  SkyModel with_ground(const vec3& reflectance, const vec3& sunlight = vec3(0)) const;

  /// Nits, linear Rec.709, from where `direction` points to; at the horizon the sky's, below it the ground's.
  /// Finite and not negative for every direction that is not zero.
  vec3 radiance(const vec3& direction) const;

  /// Lux on open flat ground by the sky alone; to 1e-5 (relative).
  vec3 horizontal_illuminance() const { return vec3(illuminance_); }

 private:
  struct Uniform {
    dvec3 radiance(const dvec3&) const { return dvec3(1); }
    dvec3 sun{0, 1, 0};
  };
  struct TraditionalOvercast {
    dvec3 radiance(const dvec3& direction) const { return dvec3((1 + 2 * direction.y) / 3); }
    dvec3 sun{0, 1, 0};
  };
  struct CieGeneral {
    dvec3 radiance(const dvec3& direction) const;
    SkyDistribution distribution;
    dvec3 sun{0, 1, 0};
  };
  using Shape = std::variant<Uniform, TraditionalOvercast, CieGeneral, PreethamSky>;

  SkyModel(const SkyDescription& description, const Shape& shape, const dvec3& scale);
  static Result<SkyModel> scaled(const SkyDescription& description, const Shape& shape);
  dvec3 sky_radiance(const dvec3& direction) const;
  dvec3 shape_radiance(const dvec3& direction) const;
  dvec3 shape_illuminance() const;

  SkyDescription description_;
  Shape shape_;
  dvec3 scale_{1};        ///< of the shape's radiance
  dvec3 illuminance_{0};  ///< lux
  dvec3 ground_{0};       ///< nits
};

}  // namespace goldthread
