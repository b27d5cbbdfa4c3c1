#include "session/buried_lamps.h"

#include <fmt/format.h>

#include <cmath>

#include "math/colour.h"

namespace goldthread {
namespace {

constexpr int kLooks = 64, kFew = 2;

// Places of a spiral from pole to pole, a golden angle apart.
vec3 even_direction(int i) {
  const float z = 1 - 2 * (static_cast<float>(i) + 0.5f) / kLooks, r = std::sqrt(1 - z * z);
  const float turn = 2.3999632f * static_cast<float>(i);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

}  // namespace

std::vector<std::string> describe_buried_lamps(const Scene& scene,
                                               const std::function<bool(const Ray&)>& ends_on_back) {
  std::vector<std::string> lines;
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    if (light.kind == LightKind::kDirectional || !(luminance(light.intensity) > 0)) continue;
    int others = 0;
    for (int look = 0; look < kLooks && others <= kFew; ++look) {
      const vec3 way = even_direction(look);
      if (light.has_area() && dot(way, light.direction) <= 0) continue;  // it does not shine there
      others += ends_on_back({light.position, way}) ? 0 : 1;
    }
    if (others > kFew) continue;
    lines.push_back(fmt::format("light {} \"{}\" is inside a closed solid and lights nothing outside of it",
                                i, light.name));
  }
  return lines;
}

}  // namespace goldthread
