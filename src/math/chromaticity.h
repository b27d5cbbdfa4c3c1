// From the CIE's XYZ of 1931 to linear Rec.709.
#pragma once
#include <algorithm>

#include "math/vec.h"

namespace goldthread {

/// Linear Rec.709 (white D65) of the tristimulus values `xyz`, in the unit of their Y (ITU-R BT.709). Colours
/// out of gamut have negative components.
inline dvec3 rec709_from_xyz(const dvec3& xyz) {
  return {3.240970 * xyz.x - 1.537383 * xyz.y - 0.498611 * xyz.z,
          -0.969244 * xyz.x + 1.875968 * xyz.y + 0.041555 * xyz.z,
          0.055630 * xyz.x - 0.203977 * xyz.y + 1.056972 * xyz.z};
}

/// The colour of luminance `xyz.y` that the primaries can make: negative components are cut off and the
/// others dimmed until the luminance is right again.
inline dvec3 rec709_in_gamut(const dvec3& xyz) {
  const auto luminance = [](const dvec3& c) { return 0.212639 * c.x + 0.715169 * c.y + 0.072192 * c.z; };
  const dvec3 colour = rec709_from_xyz(xyz), cut = glm::max(colour, dvec3(0));
  const double shown = luminance(cut);
  return shown > 0 ? cut * (std::max(xyz.y, 0.0) / shown) : dvec3(0);
}

/// Tristimulus values of chromaticity (x, y) and luminance Y.
inline dvec3 xyz_from_chromaticity(double x, double y, double luminance) {
  return luminance / y * dvec3(x, y, 1 - x - y);
}

}  // namespace goldthread
