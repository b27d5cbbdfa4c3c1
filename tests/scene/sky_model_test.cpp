#include "scene/sky_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "math/colour.h"
#include "math/quadrature.h"
#include "math/shared_cases.h"

namespace goldthread {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

vec3 direction_at(double altitude, double azimuth) {
  const double flat = std::cos(altitude * kDegree);
  return vec3(dvec3(flat * std::sin(azimuth * kDegree), std::sin(altitude * kDegree),
                    -flat * std::cos(azimuth * kDegree)));
}

SkyModel good(const Result<SkyModel>& sky) {
  EXPECT_TRUE(sky) << sky.error().line();
  return sky ? *sky : SkyModel::uniform(vec3(0));
}

SkyModel cie(int type, const vec3& sun, float lux = 10000) {
  return good(SkyModel::cie_general(type, sun, SkyLevel::horizontal_illuminance(vec3(lux))));
}

// All fifteen skies and Preetham's, for a sun there.
std::vector<SkyModel> all_skies(const vec3& sun) {
  std::vector<SkyModel> skies;
  for (int type = 1; type <= 15; ++type) skies.push_back(cie(type, sun));
  for (const float turbidity : {1.7f, 2.0f, 3.0f, 6.0f, 10.0f})
    skies.push_back(good(SkyModel::preetham(sun, turbidity)));
  return skies;
}

void expect_near(const vec3& a, const vec3& b, float relative) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], relative * std::max(std::abs(b[k]), 1.0f)) << k;
}

// Lux on the flat by the midpoint rule.
vec3 summed_illuminance(const SkyModel& sky) {
  constexpr int kRings = 400, kSectors = 800;
  dvec3 sum(0);
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kSectors; ++j) {
      const double altitude = std::asin(std::sqrt((i + 0.5) / kRings)) / kDegree;
      sum += dvec3(sky.radiance(direction_at(altitude, 360 * (j + 0.5) / kSectors)));
    }
  return vec3(sum * (3.14159265358979323846 / kRings / kSectors));
}

TEST(SkyModel, UniformSkyGivesPiTimesItsLuminance) {
  const SkyModel sky = SkyModel::uniform(vec3(100, 200, 300));
  expect_near(sky.horizontal_illuminance(), kPi * vec3(100, 200, 300), 1e-6f);
  EXPECT_EQ(sky.radiance(vec3(0, 1, 0)), vec3(100, 200, 300));
  EXPECT_EQ(sky.radiance(vec3(1, 0, 0)), vec3(100, 200, 300));
  EXPECT_EQ(sky.radiance(vec3(0, -1, 0)), vec3(0));
  expect_near(cie(5, vec3(1, 1, 0)).radiance(direction_at(20, 30)), vec3(10000 / kPi), 1e-5f);
}

TEST(SkyModel, TraditionalOvercastSkyGivesSevenNinthsOfPi) {
  const SkyModel sky = good(SkyModel::traditional_overcast(SkyLevel::zenith_luminance(vec3(900))));
  expect_near(sky.horizontal_illuminance(), vec3(700 * kPi), 1e-6f);
  expect_near(sky.radiance(vec3(1, 0, 0)), vec3(300), 1e-6f);
}

TEST(SkyModel, OvercastSkyIsAThirdAsBrightAtTheHorizon) {
  const SkyModel sky = good(SkyModel::overcast(SkyLevel::zenith_luminance(vec3(1))));
  EXPECT_NEAR(sky.radiance(vec3(0, 0, 1)).x, 1 / (1 + 4 * std::exp(-0.7f)), 1e-6f);
  EXPECT_NEAR(sky.radiance(vec3(0, 0, 1)).x, 1 / 3.0f, 0.002f);
  EXPECT_NEAR(sky.radiance(direction_at(30, 10)).x, sky.radiance(direction_at(30, 200)).x, 1e-6f);
}

TEST(SkyModel, ZenithAndIlluminanceAreAsAskedFor) {
  for (const vec3 sun : {direction_at(60, 0), direction_at(5, 130), vec3(0, 1, 0)})
    for (int type = 1; type <= 15; ++type) {
      const auto by_zenith =
          good(SkyModel::cie_general(type, sun, SkyLevel::zenith_luminance(vec3(3000, 4000, 5000))));
      expect_near(by_zenith.radiance(vec3(0, 1, 0)), vec3(3000, 4000, 5000), 1e-6f);
      const auto by_illuminance =
          good(SkyModel::cie_general(type, sun, SkyLevel::horizontal_illuminance(vec3(100, 200, 300))));
      expect_near(by_illuminance.horizontal_illuminance(), vec3(100, 200, 300), 1e-6f);
    }
}

TEST(SkyModel, ClearSkyIsTypeTwelve) {
  const vec3 sun = direction_at(35, 80);
  const SkyModel clear = good(SkyModel::clear(sun, SkyLevel::horizontal_illuminance(vec3(10000))));
  EXPECT_EQ(clear.radiance(direction_at(20, 50)), cie(12, sun).radiance(direction_at(20, 50)));
}

TEST(SkyModel, HorizontalIlluminanceIsTheIntegral) {
  for (const vec3 sun : {direction_at(37, 20), direction_at(90, 0), direction_at(0, 250)})
    for (const SkyModel& sky : all_skies(sun))
      expect_near(summed_illuminance(sky), sky.horizontal_illuminance(), 3e-4f);
}

TEST(SkyModel, SidesOfTheSunsPlaneAreAlike) {
  for (const SkyModel& sky : all_skies(direction_at(40, 70)))
    for (const double altitude : {0.0, 15.0, 60.0})
      for (const double aside : {10.0, 80.0, 170.0})
        expect_near(sky.radiance(direction_at(altitude, 70 + aside)),
                    sky.radiance(direction_at(altitude, 70 - aside)), 1e-5f);
}

TEST(SkyModel, TurningTheSunTurnsTheSky) {
  const auto before = all_skies(direction_at(25, 0)), after = all_skies(direction_at(25, 111));
  for (size_t i = 0; i < before.size(); ++i) {
    expect_near(after[i].horizontal_illuminance(), before[i].horizontal_illuminance(), 1e-5f);
    for (const double azimuth : {0.0, 45.0, 200.0})
      expect_near(after[i].radiance(direction_at(25, azimuth + 111)),
                  before[i].radiance(direction_at(25, azimuth)), 1e-5f);
  }
}

TEST(SkyModel, TwiceTheLevelIsTwiceTheLight) {
  const vec3 sun = direction_at(50, 0), seen = direction_at(30, 60);
  for (int type = 1; type <= 15; ++type)
    expect_near(cie(type, sun, 20000).radiance(seen), 2.0f * cie(type, sun).radiance(seen), 1e-6f);
}

TEST(SkyModel, HasNoJumps) {
  for (const vec3 sun : {direction_at(37, 0), direction_at(0, 0), vec3(0, 1, 0)})
    for (const SkyModel& sky : all_skies(sun))
      for (double azimuth = 0; azimuth < 360; azimuth += 40)
        for (double altitude = 0; altitude < 90; altitude += 0.25) {
          const vec3 here = sky.radiance(direction_at(altitude, azimuth));
          const vec3 next = sky.radiance(direction_at(altitude + 0.01, azimuth));
          EXPECT_NEAR(luminance(next) / luminance(here), 1, 0.01) << altitude << ' ' << azimuth;
        }
}

TEST(SkyModel, IsFiniteAndPositiveEverywhere) {
  for (const vec3 sun : {direction_at(45, 10), direction_at(0, 10), direction_at(-30, 10), vec3(0, 1, 0),
                         vec3(0, -1, 0), 1e-6f * direction_at(3, 3)})
    for (const SkyModel& sky : all_skies(sun)) {
      EXPECT_TRUE(is_finite(sky.horizontal_illuminance()));
      for (const vec3 seen : {vec3(0, 1, 0), vec3(1, 0, 0), vec3(1, -0.0f, 0), vec3(0, 1e-30f, -1), sun, -sun,
                              direction_at(1e-4, 10), direction_at(0, 10), vec3(3, 4, 5)}) {
        const vec3 nits = sky.radiance(seen);
        EXPECT_TRUE(is_finite(nits) && std::min({nits.x, nits.y, nits.z}) >= 0);
        EXPECT_TRUE(seen.y < 0 || luminance(nits) > 0);
      }
    }
}

TEST(SkyModel, SunBelowTheHorizonStandsOnIt) {
  expect_near(cie(12, direction_at(-20, 30)).radiance(direction_at(10, 50)),
              cie(12, direction_at(0, 30)).radiance(direction_at(10, 50)), 1e-5f);
}

TEST(SkyModel, GroundGivesBackWhatFallsOnIt) {
  const SkyModel sky = cie(7, direction_at(50, 0)).with_ground(vec3(0.3f, 0.2f, 0.1f), vec3(5000));
  expect_near(sky.radiance(direction_at(-1, 0)), vec3(0.3f, 0.2f, 0.1f) * 15000.0f / kPi, 1e-5f);
  expect_near(sky.radiance(direction_at(10, 0)), cie(7, direction_at(50, 0)).radiance(direction_at(10, 0)),
              0);
  EXPECT_EQ(cie(7, direction_at(50, 0)).radiance(direction_at(-1, 0)), vec3(0));
}

TEST(SkyModel, WhatDoesNotExistIsAnError) {
  const SkyLevel level = SkyLevel::horizontal_illuminance(vec3(1));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(SkyModel::cie_general(0, vec3(0, 1, 0), level));
  EXPECT_FALSE(SkyModel::cie_general(16, vec3(0, 1, 0), level));
  EXPECT_FALSE(SkyModel::cie_general(1, vec3(0), level));
  EXPECT_FALSE(SkyModel::cie_general(1, vec3(nan, 1, 0), level));
  EXPECT_FALSE(SkyModel::overcast(SkyLevel::zenith_luminance(vec3(-1, 0, 0))));
  EXPECT_FALSE(SkyModel::preetham(vec3(0, 1, 0), 1.6f));
  EXPECT_FALSE(SkyModel::preetham(vec3(0, 1, 0), 10.5f));
  EXPECT_FALSE(SkyModel::preetham(vec3(0, 1, 0), nan));
  EXPECT_FALSE(SkyModel::preetham(vec3(0), 2));
}

TEST(PreethamSky, IsThePapersInAbsoluteUnits) {
  // Turbidity 2, sun at 45 degrees, worked out apart: at the zenith x = 0.24095, y = 0.24372, Y = 4469.64
  // nits; 60 degrees down from it, away from the sun, x = 0.23365, y = 0.24358, Y = 5531.84 nits.
  const SkyModel sky = good(SkyModel::preetham(direction_at(45, 0), 2));
  expect_near(sky.radiance(vec3(0, 1, 0)), vec3(2737.16f, 4494.80f, 9325.38f), 3e-4f);
  expect_near(sky.radiance(direction_at(30, 180)), vec3(2773.14f, 5727.90f, 11718.00f), 3e-4f);
  EXPECT_NEAR(luminance(sky.radiance(vec3(0, 1, 0))), 4469.64f, 1);
}

TEST(PreethamSky, HazeWhitensTheZenith) {
  float bluer = std::numeric_limits<float>::infinity();
  for (const float turbidity : {2.0f, 3.0f, 4.0f, 6.0f, 8.0f}) {
    const vec3 zenith = good(SkyModel::preetham(direction_at(30, 0), turbidity)).radiance(vec3(0, 1, 0));
    EXPECT_GT(zenith.z, zenith.x);
    EXPECT_LT(zenith.z / zenith.x, bluer) << turbidity;
    bluer = zenith.z / zenith.x;
  }
}

// Rectangles that make up an opening, none on both sides of the height `z`: the horizon of who looks from
// there.
std::vector<std::array<dvec3, 3>> opening_triangles(const test::Json& opening, double z) {
  const dvec3 low = test::vector_of<dvec3>(opening[0]), high = test::vector_of<dvec3>(opening[2]);
  std::vector<double> heights{low.z, high.z};
  if (low.z < z && z < high.z) heights.insert(heights.begin() + 1, z);
  std::vector<std::array<dvec3, 3>> triangles;
  const auto add = [&](dvec3 a, dvec3 b, dvec3 c, dvec3 d) {
    triangles.push_back({a, b, c});
    triangles.push_back({a, c, d});
  };
  if (low.z == high.z)
    add(low, {high.x, low.y, low.z}, high, {low.x, high.y, low.z});
  else
    for (size_t i = 0; i + 1 < heights.size(); ++i)
      add({low.x, low.y, heights[i]}, {high.x, low.y, heights[i]}, {high.x, low.y, heights[i + 1]},
          {low.x, low.y, heights[i + 1]});
  return triangles;
}

// Percent of the horizontal illuminance outside (which is 1 lux) that `sky` sends through the opening. The
// cases' z is up, their y north.
double daylight_factor(const SkyModel& sky, const test::Json& room, const test::Json& receiver) {
  const dvec3 point = test::vector_of<dvec3>(receiver["point"]);
  const dvec3 normal = test::vector_of<dvec3>(receiver["normal"]);
  const bool roof = room["opening"][0][2] == room["opening"][2][2];
  const dvec3 outwards = roof ? dvec3(0, 0, 1) : dvec3(0, -1, 0);
  const auto light = [&](const dvec3& x) {
    const dvec3 way = x - point, to = glm::normalize(way);
    const double cosines = std::max(0.0, glm::dot(to, normal)) * std::max(0.0, glm::dot(to, outwards));
    return sky.radiance(vec3(dvec3(to.x, to.z, -to.y))).x * cosines / glm::dot(way, way);
  };
  const auto triangles = opening_triangles(room["opening"], point.z);
  return 100 * integrate_triangles(light, triangles, {.relative = 1e-4, .absolute = 1e-7}).value;
}

SkyModel sky_of_case(int type, const vec3& sun) {
  const SkyLevel level = SkyLevel::horizontal_illuminance(vec3(1));
  return type == 16 ? good(SkyModel::traditional_overcast(level))
                    : good(SkyModel::cie_general(type, sun, level));
}

class DaylightThroughOpenings : public testing::TestWithParam<const char*> {};

TEST_P(DaylightThroughOpenings, IsThatOfTheStandardsTestCase) {
  const test::Json room = test::shared_case("cie171.json", GetParam());
  if (room.is_null()) GTEST_SKIP() << test::kNoSharedCases;
  const bool roof = room["cie_section"] == "5.9";
  // 60 degrees high, to +y through the roof, to -y before the facade.
  const vec3 sun = direction_at(60, roof ? 0 : 180);
  double worst = 0;
  for (const auto& [type, values] : room["values_percent_of_Ehz"].items()) {
    const SkyModel sky = sky_of_case(std::stoi(type), sun).with_ground(vec3(roof ? 0.0f : 0.3f));
    for (const test::Json& receiver : room["receivers"]) {
      const double expected = values["computed"][receiver["name"].get<std::string>()].get<double>();
      const double error = std::abs(daylight_factor(sky, room, receiver) / expected - 1);
      EXPECT_LT(error, 2e-4) << "type " << type << ", point " << receiver["name"];
      worst = std::max(worst, error);
    }
  }
  RecordProperty("worst_relative_error", std::to_string(worst));
}

INSTANTIATE_TEST_SUITE_P(Cie171, DaylightThroughOpenings,
                         testing::Values("cie-p-5.9-1x1", "cie-p-5.9-4x4", "cie-p-5.11-2x1",
                                         "cie-p-5.11-4x3"),
                         [](const auto& info) {
                           std::string name(info.param + 6);
                           std::replace_if(
                               name.begin(), name.end(), [](char c) { return !std::isalnum(c); }, '_');
                           return name;
                         });

}  // namespace
}  // namespace goldthread
