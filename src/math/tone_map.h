// From nits to display values: the photographic operator of Reinhard, Stark, Shirley and Ferwerda (SIGGRAPH
// 2002).
#pragma once
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

struct ToneMap {
  float scale = 1;      ///< a / L_av: multiplies luminance (equation 2)
  float white = 1e30f;  ///< L_white, scaled luminance that maps to 1 (equation 4)

  /// Linear display colour in 0..1 for `nits`, hue kept.
  vec3 operator()(const vec3& nits) const;
};

/// Those of `luminances` (any unit) that an eye adapts to, ascending: what is not positive and finite is left
/// out, and what lies more than seven stops below the middle of the picture's lightness. That middle parts
/// the sum of the luminances' cube roots (CIE 1976) in half: it is where the picture is light, however much
/// nearly black there is around, and not on the few pixels of a lamp. No more than a quarter of that sum is
/// left out, however bright the rest: a room past a window on the sky stays.
std::vector<float> lit_luminances(std::vector<float> luminances);

/// Equation 1 without its delta, over `lit_luminances`: the log average of what is lit, in their unit. 0 of
/// none.
double log_average(std::span<const float> lit);

/// Chooses scale and white from a picture: key over the log average of what is lit in it (equation 1), white
/// at the 99.5th percentile of that or more. `exposure` > 0 fixes the scale instead.
ToneMap choose_tone_map(std::span<const vec3> nits, float key = 0.18f, float exposure = 0);

}  // namespace goldthread
