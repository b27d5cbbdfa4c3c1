#include "scene/light_check.h"

#include <gmock/gmock.h>

#include <limits>

#include "scene/small_scenes.h"

namespace goldthread {
namespace {

using ::testing::HasSubstr;

TEST(LightCheck, WhatIsNoLightIsPutOutAndNamed) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN(),
                  kEndless = std::numeric_limits<float>::infinity();
  Scene scene;
  scene.lights = {test::lamp(LightKind::kPoint, 100, vec3(0)), test::lamp(LightKind::kPoint, kNone, vec3(0)),
                  test::lamp(LightKind::kDirectional, -5, vec3(0)),
                  test::lamp(LightKind::kPoint, 7, vec3(0, kEndless, 0))};
  scene.lights[2].name = "anti-sun";
  scene.materials = {test::diffuse(0.5f, 3), test::diffuse(vec3(0.5f), vec3(1, kEndless, 3)),
                     test::diffuse(0.5f, 1e14f)};
  put_out_absurd_lights(scene);
  EXPECT_EQ(scene.lights[0].intensity, vec3(100));
  EXPECT_EQ(scene.lights[1].intensity, vec3(0));
  EXPECT_EQ(scene.lights[2].intensity, vec3(0));
  EXPECT_EQ(scene.lights[3].intensity, vec3(0));
  EXPECT_EQ(scene.lights[3].position, vec3(0));
  EXPECT_EQ(scene.materials[0].emission, vec3(3 / kPi));
  EXPECT_EQ(scene.materials[1].emission, vec3(1, 0, 3) / kPi);
  EXPECT_EQ(scene.materials[2].emission, vec3(0));
  ASSERT_EQ(scene.warnings.size(), 5u);
  EXPECT_THAT(scene.warnings[0], HasSubstr("light 1: an intensity of nan"));
  EXPECT_THAT(scene.warnings[1], HasSubstr("light 2 \"anti-sun\": an intensity of -5"));
  EXPECT_THAT(scene.warnings[2], HasSubstr("light 3: it is nowhere"));
  EXPECT_THAT(scene.warnings[3], HasSubstr("material 1: an emission of inf"));
  EXPECT_THAT(scene.warnings[4], HasSubstr("material 2"));
}

TEST(LightCheck, GoodLightIsLeftAlone) {
  Scene scene = test::procedural("cornell-box");
  const vec3 before = scene.materials.back().emission;
  put_out_absurd_lights(scene);
  EXPECT_EQ(scene.materials.back().emission, before);
  EXPECT_TRUE(scene.warnings.empty());
}

}  // namespace
}  // namespace goldthread
