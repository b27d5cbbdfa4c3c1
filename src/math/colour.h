// Scene-linear Rec.709 colour and the sRGB transfer function (IEC 61966-2-1).
#pragma once
#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace goldthread {

/// Relative luminance of a linear Rec.709 colour (ITU-R BT.709).
inline float luminance(const vec3& c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

inline float srgb_to_linear(float v) {
  return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

inline float linear_to_srgb(float v) {
  v = std::clamp(v, 0.0f, 1.0f);
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
}

}  // namespace goldthread
