// Photometric files of formulas, as text.
#pragma once
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "scene/light.h"

namespace goldthread::test {

constexpr double kDegree = 3.14159265358979323846 / 180;

/// LM-63 text of type C (1) or B (2) with `candela(vertical, horizontal)`, angles in degrees.
inline std::string ies_text(int type, const std::vector<double>& vertical,
                            const std::vector<double>& horizontal,
                            const std::function<double(double, double)>& candela) {
  std::string text = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 " + std::to_string(vertical.size()) + " " +
                     std::to_string(horizontal.size()) + " " + std::to_string(type) + " 2 0 0 0\n1 1 0\n";
  for (const auto* angles : {&vertical, &horizontal}) {
    for (const double angle : *angles) text += std::to_string(angle) + " ";
    text += "\n";
  }
  for (const double h : horizontal)
    for (const double v : vertical) text += std::to_string(candela(v, h)) + "\n";
  return text;
}

inline std::vector<double> degrees(double first, double last, double step) {
  std::vector<double> out;
  for (double angle = first; angle <= last + 1e-9; angle += step) out.push_back(angle);
  return out;
}

/// Brightest between straight down and +X, without symmetry about the axis: 1000 cos(v) (1 + cos(h) sin(v)).
inline std::string lopsided_ies() {
  return ies_text(1, degrees(0, 90, 1), degrees(0, 180, 2), [](double v, double h) {
    return 1000 * std::cos(v * kDegree) * (1 + std::cos(h * kDegree) * std::sin(v * kDegree));
  });
}

/// The same light as type B. Where a direction has the cosines a to -Z and b to +X this is 1000 a (1 + b).
inline std::string lopsided_type_b_ies() {
  return ies_text(2, degrees(-90, 90, 1), degrees(0, 90, 1), [](double v, double h) {
    const double down = std::cos(v * kDegree) * std::cos(h * kDegree),
                 ahead = std::sin(v * kDegree) * std::cos(h * kDegree);
    return 1000 * down * (1 + ahead);
  });
}
/// What both send along a unit direction of the lamp's frame, candela.
inline double lopsided_candela(double x, double z) {
  return z < 0 ? 1000 * -z * (1 + x) : 0;
}

/// The same light without a file.
inline SharedProfile lopsided(LightProfile::Pole pole) {
  const bool side = pole == LightProfile::Pole::kSide;
  PhotometricGrid grid;
  for (const double v : degrees(side ? -90 : 0, 90, 1)) grid.vertical.push_back(float(v));
  for (const double h : degrees(0, side ? 90 : 180, 1)) grid.horizontal.push_back(float(h));
  for (const float horizontal : grid.horizontal)
    for (const float vertical : grid.vertical) {
      const double v = double(vertical) * kDegree, h = double(horizontal) * kDegree;
      const double x = std::sin(v) * std::cos(h);
      const double z = side ? -std::cos(v) * std::cos(h) : -std::cos(v);
      grid.candela.push_back(float(lopsided_candela(x, std::min(z, -1e-12))));
    }
  return share_profile(side ? type_b_profile(grid) : type_c_profile(grid));
}

/// A point light of that profile.
inline Light lopsided_lamp(LightProfile::Pole pole, const vec3& position, const vec3& direction,
                           const vec3& across) {
  const SharedProfile profile = lopsided(pole);
  Light light;
  light.intensity = vec3(profile.peak);
  light.position = position;
  light.profile = profile.shares;
  aim(light, direction, across);
  return light;
}

/// Lux that it brings to the place p of the plane z = 0.
inline double lopsided_lux(const Light& light, const dvec3& p) {
  const dvec3 d = p - dvec3(light.position), way = glm::normalize(d);
  const double x = glm::dot(way, dvec3(light.across)), z = -glm::dot(way, dvec3(light.direction));
  return lopsided_candela(x, z) * std::max(0.0, -way.z) / glm::dot(d, d);
}

}  // namespace goldthread::test
