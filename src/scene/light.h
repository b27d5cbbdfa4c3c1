// Lights that have no geometry. Photometric units, linear Rec.709 (KHR_lights_punctual).
#pragma once
#include <string>

#include "math/vec.h"

namespace goldthread {

enum class LightKind : uint8_t { kPoint, kSpot, kDirectional };

struct Light {
  std::string name;
  LightKind kind = LightKind::kPoint;
  vec3 intensity{0};         ///< colour * intensity: candela (point, spot) or lux (directional)
  vec3 position{0};          ///< world, metres
  vec3 direction{0, 0, -1};  ///< world, unit: where the light shines to
  float inner_cone = 0;      ///< radians from the axis
  float outer_cone = 0.7853981634f;
  float range = 0;             ///< metres, 0 for no limit
  float angular_diameter = 0;  ///< radians of a directional light's even disc; 0 for a point at infinity
  /// Metres, of a point or spot light that is an even ball: its intensity is that of the whole, and what its
  /// cone says holds for the way from its centre. 0 for a point; so it is taken for places within it, too.
  float radius = 0;
};

}  // namespace goldthread
