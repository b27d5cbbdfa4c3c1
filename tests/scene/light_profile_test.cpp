// Known answers of photometric profiles.
#include "scene/light_profile.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace goldthread {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kRound = 3.14159265358979323846;

using Direction = dvec3 (*)(double vertical, double horizontal);
using Distribution = std::function<double(const dvec3& direction)>;

std::vector<float> steps(float first, float last, int count) {
  std::vector<float> out;
  for (int i = 0; i <= count; ++i) out.push_back(first + (last - first) * float(i) / float(count));
  return out;
}

// Directions by the definitions of both types, apart from what the code does with them.
dvec3 direction_c(double vertical, double horizontal) {
  const double v = vertical * kDegree, h = horizontal * kDegree;
  return {std::sin(v) * std::cos(h), std::sin(v) * std::sin(h), -std::cos(v)};
}

dvec3 direction_b(double vertical, double horizontal) {
  const double v = vertical * kDegree, h = horizontal * kDegree;
  return {std::cos(h) * std::sin(v), -std::sin(h), -std::cos(h) * std::cos(v)};
}

PhotometricGrid grid_of(const std::vector<float>& vertical, const std::vector<float>& horizontal,
                        Direction direction, const Distribution& candela) {
  PhotometricGrid grid{vertical, horizontal, {}};
  for (const float h : horizontal)
    for (const float v : vertical) grid.candela.push_back(float(candela(direction(double(v), double(h)))));
  return grid;
}

LightProfile profile_c(const std::vector<float>& vertical, const std::vector<float>& horizontal,
                       const Distribution& candela) {
  return type_c_profile(grid_of(vertical, horizontal, direction_c, candela));
}

LightProfile profile_b(const std::vector<float>& vertical, const std::vector<float>& horizontal,
                       const Distribution& candela) {
  return type_b_profile(grid_of(vertical, horizontal, direction_b, candela));
}

// Evenly over the sphere, on a spiral.
std::vector<vec3> directions(int count) {
  std::vector<vec3> out;
  for (int i = 0; i < count; ++i) {
    const double z = -1 + (2 * i + 1.0) / count, turn = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    out.emplace_back(r * std::cos(turn), r * std::sin(turn), z);
  }
  return out;
}

void expect_same(const LightProfile& a, const LightProfile& b, double tolerance) {
  for (const vec3& d : directions(5000))
    ASSERT_NEAR(a.intensity(d), b.intensity(d), tolerance) << d.x << " " << d.y << " " << d.z;
  EXPECT_NEAR(a.luminous_flux(), b.luminous_flux(), 4 * kRound * tolerance);
}

// No symmetry at all, and smooth. Its flux is that of the constant and of the square.
double lopsided(const dvec3& d) {
  return 100 + 30 * d.x + 20 * d.y - 40 * d.z + 60 * d.x * d.x + 25 * d.x * d.y;
}
constexpr double kLopsidedFlux = 4 * kRound * (100 + 60 / 3.0);

TEST(LightProfile, ADefaultOneIsDark) {
  const LightProfile dark;
  EXPECT_EQ(dark.intensity(vec3(0, 0, -1)), 0);
  EXPECT_EQ(dark.luminous_flux(), 0);
  EXPECT_EQ(dark.peak(), 0);
}

TEST(LightProfile, IsotropicFluxIsFourPi) {
  const LightProfile coarse = type_c_profile({{0, 180}, {0}, {70, 70}});
  EXPECT_NEAR(coarse.luminous_flux(), 4 * kRound * 70, 1e-9);
  EXPECT_EQ(coarse.peak(), 70);
  for (const vec3& d : directions(200)) EXPECT_FLOAT_EQ(coarse.intensity(d), 70);
  const auto all = [](const dvec3&) { return 70.0; };
  EXPECT_NEAR(profile_c(steps(0, 180, 7), steps(0, 90, 3), all).luminous_flux(), 4 * kRound * 70, 1e-3);
  EXPECT_NEAR(profile_b(steps(-180, 180, 8), steps(-90, 90, 5), all).luminous_flux(), 4 * kRound * 70, 1e-3);
  // From -90 to 90 type B is the lower half.
  EXPECT_NEAR(profile_b(steps(-90, 90, 8), steps(-90, 90, 5), all).luminous_flux(), 2 * kRound * 70, 1e-3);
}

TEST(LightProfile, LambertianDownlightFluxIsPi) {
  const auto lambert = [](const dvec3& d) { return 300 * std::max(-d.z, 0.0); };
  EXPECT_NEAR(profile_c(steps(0, 90, 90), {0}, lambert).luminous_flux(), 300 * kRound, 300 * kRound * 1e-4);
  EXPECT_NEAR(profile_b(steps(0, 90, 90), steps(0, 90, 90), lambert).luminous_flux(), 300 * kRound,
              300 * kRound * 1e-4);
}

TEST(LightProfile, FluxIsTheIntegralOfTheIntensity) {
  for (const LightProfile& profile : {profile_c(steps(0, 120, 5), steps(0, 360, 7), lopsided),
                                      profile_b(steps(-90, 90, 6), steps(-90, 90, 5), lopsided),
                                      profile_c(steps(90, 180, 3), {0}, lopsided)}) {
    double sum = 0;
    const int count = 400000;
    for (const vec3& d : directions(count)) sum += double(profile.intensity(d));
    EXPECT_NEAR(profile.luminous_flux(), sum * 4 * kRound / count, 1e-3 * profile.luminous_flux());
  }
}

TEST(LightProfile, FluxOfALopsidedDistribution) {
  EXPECT_NEAR(profile_c(steps(0, 180, 72), steps(0, 360, 72), lopsided).luminous_flux(), kLopsidedFlux,
              1e-3 * kLopsidedFlux);
  EXPECT_NEAR(profile_b(steps(-180, 180, 72), steps(-90, 90, 36), lopsided).luminous_flux(), kLopsidedFlux,
              1e-3 * kLopsidedFlux);
}

TEST(LightProfile, TypesBAndCAgree) {
  expect_same(profile_c(steps(0, 180, 180), steps(0, 360, 360), lopsided),
              profile_b(steps(-180, 180, 360), steps(-90, 90, 180), lopsided), 0.02);
}

TEST(LightProfile, TypeBFromZeroIsMirrored) {
  const auto even = [](const dvec3& d) { return 50 - 40 * d.z + 30 * d.x * d.x + 10 * d.y * d.y; };
  expect_same(profile_b(steps(0, 90, 30), steps(0, 90, 30), even),
              profile_b(steps(-90, 90, 60), steps(-90, 90, 60), even), 1e-3);
}

TEST(LightProfile, SymmetriesAreThoseOfTheUnfoldedGrid) {
  const std::vector<float> vertical = steps(0, 180, 12), round = steps(0, 360, 24);
  const auto axial = [](const dvec3& d) { return 60 - 40 * d.z + 10 * d.z * d.z; };
  const auto quadrant = [](const dvec3& d) { return 60 - 40 * d.z + 30 * d.x * d.x; };
  const auto about_x = [](const dvec3& d) { return 60 + 30 * d.x + 20 * d.y * d.y; };
  const auto about_y = [](const dvec3& d) { return 60 + 30 * d.y + 20 * d.x * d.x; };
  expect_same(profile_c(vertical, {0}, axial), profile_c(vertical, round, axial), 1e-3);
  expect_same(profile_c(vertical, steps(0, 90, 6), quadrant), profile_c(vertical, round, quadrant), 1e-3);
  expect_same(profile_c(vertical, steps(0, 180, 12), about_x), profile_c(vertical, round, about_x), 1e-3);
  expect_same(profile_c(vertical, steps(90, 270, 12), about_y), profile_c(vertical, round, about_y), 1e-3);
  expect_same(profile_c(vertical, steps(0, 345, 23), lopsided), profile_c(vertical, round, lopsided), 1e-3);
}

void expect_values_of(const PhotometricGrid& grid, const LightProfile& profile, Direction direction) {
  const float* candela = grid.candela.data();
  for (const float h : grid.horizontal)
    for (const float v : grid.vertical)
      EXPECT_NEAR(profile.intensity(vec3(direction(double(v), double(h)))), *candela++, 1e-4);
}

TEST(LightProfile, HitsTheValuesOfTheGrid) {
  const std::vector<float> vertical = steps(0, 90, 9), horizontal = steps(0, 360, 12);
  const PhotometricGrid c = grid_of(vertical, horizontal, direction_c, lopsided);
  const PhotometricGrid b = grid_of(steps(-90, 90, 9), steps(-90, 90, 9), direction_b, lopsided);
  const LightProfile of_c = type_c_profile(c), of_b = type_b_profile(b);
  expect_values_of(c, of_c, direction_c);
  expect_values_of(b, of_b, direction_b);
  EXPECT_EQ(of_c.peak(), *std::max_element(c.candela.begin(), c.candela.end()));
}

TEST(LightProfile, HalfwayIsTheMean) {
  const LightProfile profile = type_c_profile({{0, 90, 180}, {0, 90}, {10, 20, 40, 10, 60, 40}});
  EXPECT_NEAR(profile.intensity(vec3(direction_c(45, 0))), 15, 1e-4);
  EXPECT_NEAR(profile.intensity(vec3(direction_c(90, 45))), 40, 1e-4);
  EXPECT_NEAR(profile.intensity(vec3(direction_c(90, 225))), 40, 1e-4);
  EXPECT_NEAR(profile.intensity(vec3(direction_c(45, -45))), 25, 1e-4);
}

TEST(LightProfile, NoLightBeyondWhatWasMeasured) {
  const LightProfile down = type_c_profile({{0, 90}, {0}, {10, 10}});
  EXPECT_EQ(down.intensity(vec3(0, 0, -1)), 10);
  EXPECT_EQ(down.intensity(vec3(1, 0, 0)), 10);
  EXPECT_EQ(down.intensity(vec3(direction_c(90.1, 10))), 0);
  const LightProfile up = type_c_profile({{90, 180}, {0}, {10, 10}});
  EXPECT_EQ(up.intensity(vec3(0, 0, 1)), 10);
  EXPECT_EQ(up.intensity(vec3(0, 0, -1)), 0);
  const LightProfile flood = type_b_profile({{-30, 30}, {-20, 20}, {5, 5, 5, 5}});
  EXPECT_EQ(flood.intensity(vec3(0, 0, -1)), 5);
  EXPECT_EQ(flood.intensity(vec3(direction_b(29, -19))), 5);
  EXPECT_EQ(flood.intensity(vec3(direction_b(31, 0))), 0);
  EXPECT_EQ(flood.intensity(vec3(direction_b(0, 21))), 0);
  EXPECT_EQ(flood.intensity(vec3(0, 0, 1)), 0);
}

TEST(LightProfile, ContinuousAtThePolesAndWhereTheCircleCloses) {
  const LightProfile of_c = profile_c(steps(0, 180, 36), steps(0, 360, 36), lopsided);
  const LightProfile of_b = profile_b(steps(-180, 180, 72), steps(-90, 90, 36), lopsided);
  for (const LightProfile* profile : {&of_c, &of_b})
    for (const vec3& axis : {vec3(0, 0, 1), vec3(0, 0, -1), vec3(0, 1, 0), vec3(0, -1, 0), vec3(1, 0, 0)}) {
      const float there = profile->intensity(axis);
      EXPECT_NEAR(there, lopsided(dvec3(axis)), 1e-3);
      for (const vec3& d : directions(50))
        EXPECT_NEAR(profile->intensity(normalize(axis + 1e-5f * d)), there, 0.01);
    }
}

}  // namespace
}  // namespace goldthread
