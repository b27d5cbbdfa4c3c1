// From options to a sky and a sun.
#include "session/requested_lights.h"

#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "files/gltf_builder.h"
#include "files/image_write.h"
#include "scene/small_skies.h"

namespace goldthread {
namespace {

using ::testing::HasSubstr;

Scene lit(const LightOptions& options) {
  Scene scene;
  const Status status = add_requested_lights(scene, options);
  EXPECT_TRUE(status) << status.error().line();
  return scene;
}

std::string error_of(const LightOptions& options) {
  Scene scene;
  const Status status = add_requested_lights(scene, options);
  return status ? "no error" : status.error().line();
}

LightOptions model(const std::string& name) {
  LightOptions options;
  options.sky_model = name;
  return options;
}

TEST(RequestedLights, NothingIsNothing) {
  const Scene scene = lit({});
  EXPECT_FALSE(scene.sky.present());
  EXPECT_TRUE(scene.lights.empty());
}

TEST(RequestedLights, TheFilesOwnSkyStaysUnlessAnotherIsAskedFor) {
  Scene scene;
  scene.sky = test::sky_of(test::even_picture(4, 2, vec3(7)));
  ASSERT_TRUE(add_requested_lights(scene, {}));
  EXPECT_TRUE(scene.sky.map);
  EXPECT_TRUE(scene.warnings.empty());
  LightOptions options;
  options.sky = {100, 200, 300};
  ASSERT_TRUE(add_requested_lights(scene, options));
  EXPECT_EQ(scene.sky.radiance_towards({0, 1, 0}), vec3(100, 200, 300));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0], HasSubstr("give way"));
}

TEST(RequestedLights, SkyIsTheZenithsLuminanceOrLuxOnTheGround) {
  LightOptions options = model("overcast");
  options.sky = {100, 200, 300};
  EXPECT_NEAR(lit(options).sky.radiance_towards({0, 1, 0}).y, 200, 0.01);
  options.sky_is_illuminance = true;
  EXPECT_NEAR(lit(options).sky.model->horizontal_illuminance().y, 200 * kPi, 0.1);
  options.sky_model = "uniform";
  EXPECT_NEAR(lit(options).sky.model->horizontal_illuminance().y, 200 * kPi, 0.1);
  EXPECT_EQ(lit(options).sky.radiance_towards({0, -1, 0}), vec3(0));
}

// A model without a level has the IES's: 300 + 21000 sin h when overcast, 800 + 15500 sqrt(sin h) when clear.
TEST(RequestedLights, ModelsHaveAUsualLevel) {
  LightOptions options = model("overcast");
  options.sun = LightOptions::Sun{0, 30, 180};
  EXPECT_NEAR(lit(options).sky.model->horizontal_illuminance().x, 10800, 1);
  options.sky_model = "clear";
  EXPECT_NEAR(lit(options).sky.model->horizontal_illuminance().x, 800 + 15500 * std::sqrt(0.5f), 1);
  EXPECT_TRUE(lit(options).lights.empty());  // the sky knows the sun, which sends nothing by itself
}

// (1 + 2 sin) / 3: the sky of Moon and Spencer, without a direction.
TEST(RequestedLights, TheSixteenthSkyIsTheOvercastOneOfOld) {
  LightOptions options = model("cie16");
  options.sky = {300, 300, 300};
  const Scene scene = lit(options);
  EXPECT_NEAR(scene.sky.radiance_towards({0, 1, 0}).x, 300, 1e-3);
  EXPECT_NEAR(scene.sky.radiance_towards(test::towards(30, 77)).x, 200, 1e-3);
  EXPECT_NEAR(scene.sky.radiance_towards(test::towards(30, 200)).x, 200, 1e-3);
}

TEST(RequestedLights, ClearSkyIsBrightestAtTheSun) {
  LightOptions options = model("cie12");
  options.sun = LightOptions::Sun{90000, 40, 70};
  const Scene scene = lit(options);
  const float there = scene.sky.radiance_towards(test::towards(40, 70)).x;
  for (int azimuth = 100; azimuth < 400; azimuth += 30)
    EXPECT_GT(there, 2 * scene.sky.radiance_towards(test::towards(40, azimuth)).x);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_LT(length(scene.lights[0].direction + test::towards(40, 70)), 1e-5f);
}

// In Stockholm the sun stands highest on midsummer's day at about 12:50 summer time: 90 - 59.33 + 23.44
// degrees.
TEST(RequestedLights, PlaceAndTimePlaceTheSun) {
  LightOptions options;
  options.sun = LightOptions::Sun{};
  options.moment = LightOptions::Moment{59.33, 18.07, 2026, 6, 21, 12 + 50 / 60.0, 2};
  options.sun_through_air = true;
  const Scene scene = lit(options);
  ASSERT_EQ(scene.lights.size(), 1u);
  const vec3 to_sun = -scene.lights[0].direction;
  EXPECT_NEAR(std::asin(to_sun.y) * 180 / kPi, 54.1, 0.1);
  EXPECT_NEAR(to_sun.x, 0, 0.01);
  EXPECT_GT(to_sun.z, 0);  // in the south
  EXPECT_GT(scene.lights[0].intensity.y, 60000);
  EXPECT_LT(scene.lights[0].intensity.y, 110000);
  options.sun_through_air = false;
  EXPECT_EQ(lit(options).lights[0].intensity, vec3(100000));
  options.moment->hour = 1;
  options.sun_through_air = true;
  const Scene night = lit(options);
  EXPECT_TRUE(night.lights.empty());
  ASSERT_EQ(night.warnings.size(), 1u);
  EXPECT_THAT(night.warnings[0], HasSubstr("below the horizon"));
}

TEST(RequestedLights, SunHasItsDiscAndLampsTheRadiusThatIsAskedFor) {
  LightOptions options;
  options.sun = LightOptions::Sun{};
  EXPECT_NEAR(lit(options).lights[0].angular_diameter, 0.533f * kPi / 180, 1e-6f);
  options.sun_diameter = 0;
  EXPECT_EQ(lit(options).lights[0].angular_diameter, 0);
  Scene scene;
  scene.lights.resize(2);
  scene.lights[1].kind = LightKind::kDirectional;
  options.lamp_radius = 0.2f;
  ASSERT_TRUE(add_requested_lights(scene, options));
  EXPECT_EQ(scene.lights[0].radius, 0.2f);
  EXPECT_EQ(scene.lights[1].radius, 0);
  options.lamp_radius = -1.0f;
  EXPECT_THAT(error_of(options), HasSubstr("radius"));
  options.lamp_radius.reset();
  options.sun_diameter = 200;
  EXPECT_THAT(error_of(options), HasSubstr("diameter"));
}

TEST(RequestedLights, GroundReflectsSkyAndSun) {
  LightOptions options = model("uniform");
  options.sky = {1000, 1000, 1000};
  options.ground_reflectance = 0.25f;
  EXPECT_NEAR(lit(options).sky.radiance_towards({0, -1, 0}).x, 250, 0.1);
  options.sun = LightOptions::Sun{20000, 30, 0};
  EXPECT_NEAR(lit(options).sky.radiance_towards({0, -1, 0}).x, 0.25 * (1000 + 10000 / double(kPi)), 0.1);
}

TEST(RequestedLights, EnvironmentsAreTurnedScaledAndRepaired) {
  test::TempFolder folder;
  FloatImage picture = test::even_picture(8, 4, vec3(1, 2, 3));
  picture.pixels[0].x = -1;
  LightOptions options;
  options.environment = folder.path("sky.exr");
  ASSERT_TRUE(write_exr(options.environment, picture));
  options.environment_scale = 10;
  options.environment_rotation = 90;
  const Scene scene = lit(options);
  EXPECT_EQ(scene.sky.radiance_towards({0.1f, -1, 0}), vec3(10, 20, 30));
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0], HasSubstr("sky.exr: 1 pixels are negative"));
  // The first pixel reaches from -180 to -135 degrees; turned, from -90 to -45.
  EXPECT_EQ(scene.sky.radiance_towards(test::towards(80, -60)).x, 0);
}

TEST(RequestedLights, WhatMakesNoSenseIsNamed) {
  LightOptions options = model("cie17");
  EXPECT_THAT(error_of(options), HasSubstr("cie1 to cie16"));
  options = model("preetham");
  options.turbidity = 50;
  EXPECT_THAT(error_of(options), HasSubstr("turbidity 50"));
  options.turbidity = 3;
  options.sky = {1, 1, 1};
  EXPECT_THAT(error_of(options), HasSubstr("preetham"));
  options = model("overcast");
  options.ground_reflectance = 1.5f;
  EXPECT_THAT(error_of(options), HasSubstr("reflectance"));
  options = model("overcast");
  options.environment = "sky.exr";
  EXPECT_THAT(error_of(options), HasSubstr("--sky-model out"));
  options = {};
  options.environment = "sky.png";
  EXPECT_THAT(error_of(options), HasSubstr("give .exr or .hdr"));
  options = {};
  options.sun = LightOptions::Sun{1000, std::numeric_limits<float>::quiet_NaN(), 0};
  EXPECT_THAT(error_of(options), HasSubstr("the sun"));
  options.sun = LightOptions::Sun{-1000};
  EXPECT_THAT(error_of(options), HasSubstr("the sun"));
}

}  // namespace
}  // namespace goldthread
