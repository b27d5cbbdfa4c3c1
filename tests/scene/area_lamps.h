// Rectangle and disc lamps, and the light that closed forms say they bring.
#pragma once
#include <cmath>

#include "scene/small_scenes.h"

namespace goldthread::test {

/// Of `nits` over width by height metres; its width lies along `across`.
inline Light rectangle_lamp(float nits, const vec2& size, const vec3& position,
                            const vec3& direction = {0, 0, -1}, const vec3& across = {1, 0, 0}) {
  Light light = lamp(LightKind::kRectangle, nits * size.x * size.y, position);
  light.size = size;
  aim(light, direction, across);
  return light;
}

inline Light disc_lamp(float nits, float diameter, const vec3& position, const vec3& direction = {0, 0, -1}) {
  Light light = lamp(LightKind::kDisc, 0, position);
  light.size = vec2(diameter);
  light.intensity = vec3(nits * light.area());
  aim(light, direction, vec3(1, 0, 0));
  return light;
}

/// Form factor from a point to the rectangle 0..a, 0..b of a plane parallel to its own, h away (Howell's
/// catalogue of configuration factors, B-3); odd in a and b.
inline double corner_factor(double a, double b, double h) {
  const double x = std::sqrt(a * a + h * h), y = std::sqrt(b * b + h * h);
  return (a / x * std::atan(b / x) + b / y * std::atan(a / y)) / (2 * double(kPi));
}
inline double parallel_factor(const dvec2& low, const dvec2& high, double h) {
  return corner_factor(high.x, high.y, h) - corner_factor(low.x, high.y, h) -
         corner_factor(high.x, low.y, h) + corner_factor(low.x, low.y, h);
}

/// The same where the point's plane is square to the rectangle's: 0..a is the way it faces, from straight
/// above it, 0..b along the edge there (Howell, B-5).
inline double upright_factor(double a, double b, double h) {
  const double x = std::sqrt(a * a + h * h);
  return (std::atan(b / h) - h / x * std::atan(b / x)) / (2 * double(kPi));
}

/// From a point to a disc of radius r of a plane parallel to its own, h away, its centre `aside` of straight
/// above (Howell, B-12).
inline double disc_factor(double r, double h, double aside = 0) {
  const double sum = aside * aside + h * h + r * r;
  return (1 - (aside * aside + h * h - r * r) / std::sqrt(sum * sum - 4 * r * r * aside * aside)) / 2;
}

}  // namespace goldthread::test
