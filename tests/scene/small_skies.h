// Skies for the tests of the light rooms, and what they send, by a quadrature that no room shares.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "scene/sky.h"

namespace goldthread::test {

/// A direction by degrees: azimuth 0 is -Z, 90 is +X.
inline vec3 towards(double elevation, double azimuth) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  const double level = std::cos(elevation * kDegree);
  return vec3(dvec3(level * std::sin(azimuth * kDegree), std::sin(elevation * kDegree),
                    -level * std::cos(azimuth * kDegree)));
}

inline Sky sky_of(const Result<SkyModel>& model) {
  Sky sky;
  EXPECT_TRUE(model) << model.error().line();
  if (model) sky.model = *model;
  return sky;
}

inline Sky sky_of(FloatImage picture, float scale = 1, float rotation = 0) {
  Sky sky;
  const Result<EnvironmentMap> map = EnvironmentMap::make(std::move(picture), scale, rotation);
  EXPECT_TRUE(map) << map.error().line();
  if (map) sky.map = *map;
  return sky;
}

/// All pixels `nits`.
inline FloatImage even_picture(uint32_t width, uint32_t height, const vec3& nits) {
  return {width, height, std::vector<vec3>(size_t{width} * height, nits)};
}

/// One of every kind, with names.
inline std::vector<std::pair<std::string, Sky>> many_skies() {
  const vec3 sun = towards(35, 140);
  const SkyLevel level = SkyLevel::horizontal_illuminance(vec3(10000));
  std::vector<std::pair<std::string, Sky>> skies{
      {"uniform model", sky_of(SkyModel::uniform(vec3(1000, 2000, 3000)))},
      {"traditional overcast", sky_of(SkyModel::traditional_overcast(level))},
      {"preetham", sky_of(SkyModel::preetham(sun, 3))}};
  for (int type = 1; type <= 15; ++type)
    skies.emplace_back("cie" + std::to_string(type), sky_of(SkyModel::cie_general(type, sun, level)));
  return skies;
}

/// Lux on an open plane of unit `normal`: the midpoint rule over `rings` by 2 `rings` directions of equal
/// solid angle about the zenith.
inline dvec3 open_illuminance(const Sky& sky, const vec3& normal, int rings = 600) {
  dvec3 sum(0);
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < 2 * rings; ++j) {
      const double height = 1 - 2 * (i + 0.5) / rings, level = std::sqrt(1 - height * height);
      const double azimuth = 3.14159265358979323846 * (j + 0.5) / rings;
      const vec3 d(dvec3(level * std::sin(azimuth), height, -level * std::cos(azimuth)));
      sum += double(std::max(0.0f, dot(d, normal))) * dvec3(sky.radiance_towards(d));
    }
  return sum * (4 * 3.14159265358979323846 / (2.0 * rings * rings));
}

}  // namespace goldthread::test
