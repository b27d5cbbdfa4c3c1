// From nits to display values: the photographic operator of Reinhard, Stark, Shirley and Ferwerda (SIGGRAPH
// 2002).
#pragma once
#include <span>

#include "math/vec.h"

namespace goldthread {

struct ToneMap {
  float scale = 1;      ///< a / L_av: multiplies luminance (equation 2)
  float white = 1e30f;  ///< L_white, scaled luminance that maps to 1 (equation 4)

  /// Linear display colour in 0..1 for `nits`, hue kept.
  vec3 operator()(const vec3& nits) const;
};

/// Chooses scale and white from a picture: key over the log average of its non-black pixels (equation 1),
/// white at the 99.5th percentile of luminance or more. `exposure` > 0 fixes the scale instead.
ToneMap choose_tone_map(std::span<const vec3> nits, float key = 0.18f, float exposure = 0);

}  // namespace goldthread
