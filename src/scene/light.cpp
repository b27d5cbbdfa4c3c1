#include "scene/light.h"

#include "math/oriented_box.h"

namespace goldthread {

float Light::area() const {
  if (!has_area()) return 0;
  return size.x * size.y * (kind == LightKind::kDisc ? kPi / 4 : 1.0f);
}

void aim(Light& light, const vec3& direction, const vec3& across) {
  light.direction = normalize_or(direction, vec3(0, 0, -1));
  const vec3 square = across - dot(across, light.direction) * light.direction;
  light.across = normalize_or(square, frame_about(light.direction)[0]);
}

}  // namespace goldthread
