#include "scene/sky.h"

namespace goldthread {

bool Sky::present() const {
  const auto shines = [](const vec3& light) { return light.x > 0 || light.y > 0 || light.z > 0; };
  if (map) return !map->is_dark();
  if (model) return shines(model->horizontal_illuminance()) || shines(model->radiance(vec3(0, -1, 0)));
  return shines(radiance);
}

vec3 Sky::radiance_towards(const vec3& direction) const {
  if (map) return map->radiance(direction);
  return model ? model->radiance(direction) : radiance;
}

}  // namespace goldthread
