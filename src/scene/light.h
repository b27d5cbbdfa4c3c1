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
  float range = 0;  ///< metres, 0 for no limit
};

}  // namespace goldthread
