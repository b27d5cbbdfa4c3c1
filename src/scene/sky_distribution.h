// The shape that most analytic skies share: brightness by height, times brightness by angle from the sun.
#pragma once
#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace goldthread {

/// R. Perez, R. Seals, J. Michalsky, All-weather model for sky luminance distribution, 1993. The letters are
/// theirs, and the CIE's (ISO 15469:2004). Relative, without unit; b < 0.
struct SkyDistribution {
  double a = 0, b = -1, c = 0, d = -1, e = 0;
  double base = 1;  ///< 1, and in the CIE's skies 1 - c exp(d pi / 2): a right angle from the sun counts as 1

  /// phi(Z) by the cosine of the zenith angle; cosines of 0 and less are the horizon.
  double gradation(double cos_zenith) const { return 1 + a * std::exp(b / std::max(cos_zenith, 1e-9)); }

  /// f(chi), chi in radians from the sun.
  double indicatrix(double chi) const {
    const double cosine = std::cos(chi);
    return base + c * std::exp(d * chi) + e * cosine * cosine;
  }

  double value(double cos_zenith, double chi) const { return gradation(cos_zenith) * indicatrix(chi); }

  /// The value as a share of the zenith's, for a sun at that zenith angle (radians).
  double of_zenith(double cos_zenith, double chi, double sun_zenith) const {
    return value(cos_zenith, chi) / value(1, sun_zenith);
  }
};

/// Radians between two directions of any length; precise where they nearly agree.
inline double angle_between(const dvec3& a, const dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

}  // namespace goldthread
