// The light that a scene file does not have.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

namespace goldthread {

/// Light that is added to a scene's own. Of what a sky can be (`sky` alone, `sky_model`, `environment`) it is
/// one.
struct LightOptions {
  std::optional<std::array<float, 3>>
      sky;                          ///< nits, linear RGB: of a uniform sky, or straight above of a model
  bool sky_is_illuminance = false;  ///< of a model, pi times `sky` is the lux on open flat ground instead

  struct Sun {
    float illuminance = 100000;           ///< lux on a plane facing it; 0 for one that only the sky knows of
    float elevation = 45, azimuth = 135;  ///< degrees; azimuth 0 is -Z, 90 is +X
  };
  std::optional<Sun> sun;
  float sun_diameter = 0.533f;  ///< degrees, 0 to 90: of that sun's even disc; 0 for shadows without penumbra
  /// The sun sends what its height and `turbidity` leave of it (Preetham 1999, A.1) instead of `illuminance`.
  bool sun_through_air = false;

  /// Where on Earth, and when: places the sun instead of its elevation and azimuth. -Z is north, +X east.
  struct Moment {
    double latitude = 0, longitude = 0;  ///< degrees, north and east positive
    int year = 2000, month = 6, day = 21;
    double hour = 12, time_zone = 0;  ///< hours; the zone's ahead of UTC
  };
  std::optional<Moment> moment;

  std::optional<float>
      lamp_radius;  ///< metres: makes the scene's point and spot lights balls, 0 points again

  /// A photometric file (IES LM-63) for the scene's point and spot lights, instead of their cones and
  /// intensities. They keep place, direction and colour.
  struct Profile {
    std::string file;
    std::string lamp;  ///< the lights that are called so; empty for all
  };
  std::vector<Profile> profiles;  ///< of two for one light the later counts
  float profile_scale = 1;        ///< of those files' candela

  /// uniform, overcast, clear, cie1 to cie16 or preetham; empty for none. Without `sky` as bright as the
  /// IES's mean sky of its kind with the sun at that height (Recommended Practice for the Calculation of
  /// Daylight Availability, 1984); preetham knows by itself.
  std::string sky_model;
  float turbidity = 3;           ///< of the air, 1.7 to 10
  float ground_reflectance = 0;  ///< of the model's flat ground below the horizon, 0 to 1

  std::string environment;  ///< equirectangular .exr or .hdr in nits, its middle towards -Z; empty for none
  float environment_rotation = 0;  ///< degrees; 90 turns what was towards -Z to +X
  float environment_scale = 1;     ///< nits a unit of the picture
};

}  // namespace goldthread
