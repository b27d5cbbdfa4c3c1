#include "scene/light_check.h"

#include <fmt/format.h>

namespace goldthread {
namespace {

// The first channel that is no light, or -1; those that are none become 0.
int put_out(vec3& light, float& found) {
  int first = -1;
  for (int k = 0; k < 3; ++k) {
    if (light[k] >= 0 && light[k] <= kMostLight) continue;  // what is not a number is neither
    if (first < 0) found = light[k];
    if (first < 0) first = k;
    light[k] = 0;
  }
  return first;
}

std::string named(const char* kind, size_t number, const std::string& name) {
  return name.empty() ? fmt::format("{} {}", kind, number) : fmt::format("{} {} \"{}\"", kind, number, name);
}

}  // namespace

void put_out_absurd_lights(Scene& scene) {
  float found = 0;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    Light& light = scene.lights[i];
    if (put_out(light.intensity, found) >= 0)
      scene.warnings.push_back(fmt::format("{}: an intensity of {:g} is no light; taken as 0",
                                           named("light", i, light.name), static_cast<double>(found)));
    if (is_finite(light.position) && is_finite(light.direction) && is_finite(light.across)) continue;
    light.position = vec3(0);
    light.direction = vec3(0, 0, -1);
    light.across = vec3(1, 0, 0);
    light.intensity = vec3(0);
    scene.warnings.push_back(fmt::format("{}: it is nowhere; taken as dark", named("light", i, light.name)));
  }
  for (size_t i = 0; i < scene.materials.size(); ++i)
    if (put_out(scene.materials[i].emission, found) >= 0)
      scene.warnings.push_back(fmt::format("{}: an emission of {:g} nits is no light; taken as 0",
                                           named("material", i, scene.materials[i].name),
                                           static_cast<double>(found)));
}

}  // namespace goldthread
