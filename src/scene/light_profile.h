// Luminous intensity by direction, as photometric laboratories measure it.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// Candela over a grid of polar and azimuth angles. The luminaire's own frame is that of EXT_lights_ies: it
/// shines to -Z (nadir, where both of the file's angles are 0), up is +Z, photometric horizontal is +X.
///
/// Between the angles intensity is bilinear in them; beyond the first and last polar angle, and beyond
/// azimuths that do not go all the way round, there is no light. A default one is dark.
struct LightProfile {
  enum class Pole : uint8_t {
    kNadir,  ///< type C: polar from -Z, azimuth from +X counter-clockwise as seen from above (to +Y)
    kSide,   ///< type B: polar from +Y, azimuth from -Z about Y to +X
  };

  Pole pole = Pole::kNadir;
  std::vector<float> polar;    ///< degrees, ascending, within 0 to 180
  std::vector<float> azimuth;  ///< degrees, ascending, over 360 at the most; a single one: the same all round
  std::vector<float> candela;  ///< at [azimuth * polar.size() + polar]
  std::string name;            ///< what it was read from, for people
  /// The lamp's output changes as the luminaire is tilted. `candela` holds that of one that is not.
  bool changes_with_tilt = false;

  /// Candela in a direction (unit, luminaire's frame).
  float intensity(const vec3& direction) const;

  /// Lumens in all directions: the exact integral of `intensity`.
  double luminous_flux() const;

  /// The greatest intensity, candela.
  float peak() const;
};

/// A profile as many lamps may share it: its candela as shares of the greatest, and that, candela. One that
/// is dark has shares of 0.
struct SharedProfile {
  std::shared_ptr<const LightProfile> shares;
  float peak = 0;
};
SharedProfile share_profile(LightProfile profile);

/// Candela as a photometric file lists them. Angles in degrees, ascending.
struct PhotometricGrid {
  std::vector<float> vertical, horizontal;
  std::vector<float> candela;  ///< at [horizontal * vertical.size() + vertical]
};

/// Of type C: vertical 0 is nadir, 180 zenith; horizontal is counter-clockwise. Horizontal angles say the
/// symmetry: a single one all round, 0 to 90 in each quadrant, 0 to 180 or 90 to 270 on both sides of that
/// plane, 0 to 360 none. Where the last is less than 360 but more than 180 the first comes after it.
LightProfile type_c_profile(const PhotometricGrid& grid);

/// Of type B: vertical turns about the horizontal axis Y (0 at -Z, 90 at +X), horizontal leads from that
/// plane to the poles, clockwise (90 at -Y). Angles of either that begin with 0 are mirrored there.
LightProfile type_b_profile(const PhotometricGrid& grid);

}  // namespace goldthread
