// A coloured sky in absolute units by the sun's height and the air's haze.
#pragma once
#include "goldthread/error.h"
#include "math/vec.h"
#include "scene/sky_distribution.h"

namespace goldthread {

/// A. Preetham, P. Shirley, B. Smits, A Practical Analytic Model for Daylight, 1999, appendix A.2: Perez's
/// shape for luminance and chromaticity, each relative to the zenith's.
///
/// The paper's formulas as they are, with their faults. They suit turbidities 2 to 6; at 1.7 the horizon is
/// so bright that the flat gets up to three times the light of turbidity 2. A low sun's sky is far too
/// bright: on the flat 4 to 15 klx with the sun on the horizon, where IES (1984) has 0.8 under a clear sky;
/// at 60 degrees and turbidity 2 it is 24 against 15.
class PreethamSky {
 public:
  static constexpr float kLeastTurbidity = 1.7f;  ///< further down the zenith's luminance would cross zero
  static constexpr float kGreatestTurbidity = 10;

  /// `sun_direction` of length 1, at or above the horizon; `turbidity` within the limits.
  PreethamSky(const dvec3& sun_direction, double turbidity);

  /// Nits, linear Rec.709, by a direction of length 1 at or above the horizon; what is out of gamut keeps its
  /// luminance.
  dvec3 radiance(const dvec3& direction) const;

  dvec3 sun;  ///< its direction

 private:
  double sun_zenith_;
  SkyDistribution luminance_, x_, y_;
  dvec3 zenith_;  ///< kcd/m², chromaticity x and y
};

/// An Error where the turbidity is out of PreethamSky's limits or not a number.
Status check_turbidity(float turbidity);

}  // namespace goldthread
