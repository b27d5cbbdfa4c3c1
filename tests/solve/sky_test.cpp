// Skies that are not the same all over, by the hierarchical solver.
#include <gtest/gtest.h>

#include "scene/small_skies.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::even_picture;
using test::quick;
using test::sky_of;
using test::Solved;
using test::summarise;
using test::towards;

/// A black square of 2 by 2 round the origin, facing the unit `normal`.
Scene open_square(const Sky& sky, const vec3& normal) {
  const vec3 across =
      normalize(std::abs(normal.x) > 0.6f ? cross(normal, vec3(0, 1, 0)) : cross(normal, vec3(1, 0, 0)));
  const vec3 up = cross(normal, across);
  Scene scene;
  scene.sky = sky;
  test::add(scene, test::parallelogram(-across - up, 2.0f * across, 2.0f * up, 2), test::diffuse(0));
  return scene;
}

dvec3 open_light(const Sky& sky, const vec3& normal) {
  Solved solved(open_square(sky, normal));
  solved.solve();
  dvec3 lux;
  for (int k = 0; k < 3; ++k)
    lux[k] = summarise(solved, [&](ElementId id) { return solved.state().irradiance[id][k]; }).mean;
  return lux;
}

void expect_relative(const dvec3& value, const dvec3& truth, double tolerance) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(value[k], truth[k], tolerance * truth[k]) << "channel " << k;
}

TEST(SolvedSky, OpenGroundGetsTheModelsIlluminance) {
  for (const auto& [name, sky] : test::many_skies()) {
    SCOPED_TRACE(name);
    expect_relative(open_light(sky, vec3(0, 1, 0)), dvec3(sky.model->horizontal_illuminance()), 0.005);
  }
}

TEST(SolvedSky, WallsGetWhatTheirHalfOfTheSkySends) {
  for (const auto& [name, sky] : test::many_skies()) {
    if (name != "preetham" && name != "cie1" && name != "cie8" && name != "cie15") continue;
    SCOPED_TRACE(name);
    for (const vec3& normal : {towards(0, 140), towards(0, -20), towards(40, 60)})
      expect_relative(open_light(sky, normal), test::open_illuminance(sky, normal), 0.005);
  }
}

TEST(SolvedSky, GroundLightsWhatLooksDown) {
  const Result<SkyModel> overcast = SkyModel::overcast(SkyLevel::horizontal_illuminance(vec3(10000)));
  ASSERT_TRUE(overcast);
  expect_relative(open_light(sky_of(overcast->with_ground(vec3(0.2f, 0.3f, 0.4f))), vec3(0, -1, 0)),
                  dvec3(2000, 3000, 4000), 0.002);
}

TEST(SolvedSky, EvenPictureIsAUniformSky) {
  const Sky picture = sky_of(even_picture(16, 8, vec3(1, 2, 3)), 100, 0.7f);
  Sky uniform;
  uniform.radiance = vec3(100, 200, 300);
  for (const Sky& sky : {picture, uniform})
    expect_relative(open_light(sky, towards(30, 50)), double(kPi) * dvec3(100, 200, 300), 1e-3);
}

TEST(SolvedSky, TurningThePictureIsTurningTheReceiver) {
  FloatImage picture = even_picture(64, 32, vec3(1));
  for (uint32_t y = 4; y < 12; ++y)
    for (uint32_t x = 10; x < 20; ++x) picture.pixels[y * 64 + x] = vec3(50, 20, 10);
  const dvec3 plain = open_light(sky_of(picture), towards(0, -90));
  EXPECT_GT(plain.x, 10);
  expect_relative(open_light(sky_of(picture, 1, kPi / 2), towards(0, 0)), plain, 0.002);
  expect_relative(plain, test::open_illuminance(sky_of(picture), towards(0, -90)), 0.01);
}

/// Mean irradiance of a floor of side 1 below a black plate of side 4, half a metre up, whose edge runs over
/// the floor's middle along z: the floor sees the half of the sky where x > 0, about.
double below_half_a_roof(const Sky& sky) {
  Scene scene;
  scene.sky = sky;
  test::add(scene, test::parallelogram({-0.5f, 0, 0.5f}, {1, 0, 0}, {0, 0, -1}, 4), test::diffuse(0));
  Material plate = test::diffuse(0);
  plate.double_sided = true;
  test::add(scene, test::parallelogram({-4, 0.5f, -4}, {4, 0, 0}, {0, 0, 8}), plate);
  Solved solved(std::move(scene));
  solved.solve();
  double sum = 0, area = 0;
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    if (e.part != 0) continue;
    sum += double(e.area) * double(solved.state().irradiance[id].x);
    area += double(e.area);
  }
  return sum / area;
}

/// The same by brute force: a grid of points, each asking all directions for the plate.
double below_half_a_roof_truth(const Sky& sky) {
  constexpr int kPoints = 8, kRings = 300;
  double sum = 0;
  for (int p = 0; p < kPoints; ++p)
    for (int q = 0; q < kPoints; ++q) {
      const vec3 x(-0.5f + (float(p) + 0.5f) / kPoints, 0, -0.5f + (float(q) + 0.5f) / kPoints);
      for (int i = 0; i < kRings; ++i)
        for (int j = 0; j < 4 * kRings; ++j) {
          const double height = (i + 0.5) / kRings, level = std::sqrt(1 - height * height);
          const double azimuth = 2 * double(kPi) * (j + 0.5) / (4 * kRings);
          const vec3 d(dvec3(level * std::sin(azimuth), height, -level * std::cos(azimuth)));
          const vec3 at = x + (0.5f / d.y) * d;
          if (at.x > -4 && at.x < 0 && std::abs(at.z) < 4) continue;
          sum += height * double(sky.radiance_towards(d).x);
        }
    }
  return sum * 2 * double(kPi) / (4.0 * kRings * kRings) / (kPoints * kPoints);
}

TEST(SolvedSky, ARoofHidesWhatIsBehindIt) {
  const SkyLevel level = SkyLevel::horizontal_illuminance(vec3(10000));
  for (const Sky& sky : {sky_of(SkyModel::overcast(level)), sky_of(SkyModel::clear(towards(35, 110), level)),
                         sky_of(SkyModel::cie_general(15, towards(35, -110), level))}) {
    const double truth = below_half_a_roof_truth(sky);
    EXPECT_NEAR(below_half_a_roof(sky), truth, 0.02 * truth);
  }
}

TEST(SolvedSky, ASunInThePictureCastsAShadow) {
  // A patch of sky of 2.8 degrees to the east at 45 degrees, far brighter than the rest: the roof's edge
  // parts the floor in a lit piece and a shaded one.
  FloatImage picture = even_picture(128, 64, vec3(0.001f));
  picture.pixels[16 * 128 + 96] = vec3(1e5f);
  const Sky sky = sky_of(picture);
  const double truth = below_half_a_roof_truth(sky);
  EXPECT_NEAR(below_half_a_roof(sky), truth, 0.02 * truth);
}

TEST(Sky, AStepIsFinerThanTheOneBeforeByALimit) {
  EXPECT_EQ(next_power_error(3, 100), 3);
  EXPECT_EQ(next_power_error(0, 256), 1);
  EXPECT_EQ(next_power_error(5, 0), 5);  // the first
}

}  // namespace
}  // namespace goldthread
