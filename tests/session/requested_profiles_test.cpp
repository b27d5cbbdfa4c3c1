// Photometric files from the command line, onto a scene's lamps.
#include "session/requested_profiles.h"

#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "math/colour.h"
#include "scene/small_profiles.h"
#include "scene/small_scenes.h"
#include "session/requested_lights.h"

namespace goldthread {
namespace {

using test::lamp;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A point, a spot and a sun.
Scene three_lights() {
  Scene scene;
  scene.lights = {lamp(LightKind::kPoint, 10, vec3(0)), lamp(LightKind::kSpot, 0, vec3(0)),
                  lamp(LightKind::kDirectional, 10, vec3(0))};
  scene.lights[0].name = "bulb";
  scene.lights[0].intensity = vec3(20, 10, 0);
  scene.lights[1].name = "torch";
  scene.lights[2].name = "sun";
  return scene;
}

struct Profiles : ::testing::Test {
  test::TempFolder folder;
  std::string file = folder.write("lopsided.ies", test::lopsided_ies());
  Scene scene = three_lights();

  std::string error_of(const std::vector<LightOptions::Profile>& profiles, float scale = 1) {
    LightOptions options;
    options.profiles = profiles;
    options.profile_scale = scale;
    const Status status = add_requested_lights(scene, options);
    if (status) return "none";
    last = status.error().code;
    return status.error().line();
  }
  ErrorCode last = ErrorCode::kUsage;
};

TEST_F(Profiles, CandelaAreTheFilesAndColourTheLamps) {
  ASSERT_EQ(error_of({{file, ""}}, 2), "none");
  const Light& bulb = scene.lights[0];
  ASSERT_TRUE(bulb.profile);
  EXPECT_EQ(bulb.profile->name, "lopsided.ies");
  EXPECT_NEAR(luminance(bulb.intensity) * bulb.profile->intensity({0, 0, -1}), 2000, 0.1);
  EXPECT_FLOAT_EQ(bulb.intensity.x, 2 * bulb.intensity.y);
  EXPECT_EQ(bulb.intensity.z, 0);
  EXPECT_EQ(scene.lights[1].profile, bulb.profile);
  EXPECT_EQ(scene.lights[1].intensity, vec3(0));  // it was off
  EXPECT_FALSE(scene.lights[2].profile);
}

TEST_F(Profiles, NamesChooseAndTheLaterCounts) {
  const std::string other = folder.write("b.ies", test::lopsided_type_b_ies());
  ASSERT_EQ(error_of({{file, ""}, {other, "torch"}}), "none");
  EXPECT_EQ(scene.lights[0].profile->name, "lopsided.ies");
  EXPECT_EQ(scene.lights[1].profile->name, "b.ies");
}

TEST_F(Profiles, WhatCannotBeIsSaid) {
  EXPECT_THAT(error_of({{file, "lamp"}}), HasSubstr("'lamp'; there are bulb, torch"));
  EXPECT_THAT(error_of({{file, "sun"}}), HasSubstr("'sun'"));
  EXPECT_EQ(last, ErrorCode::kUsage);
  EXPECT_THAT(error_of({{folder.path("gone.ies"), ""}}), HasSubstr("gone.ies"));
  EXPECT_EQ(last, ErrorCode::kBadInput);
  EXPECT_THAT(error_of({{folder.write("cut.ies", test::lopsided_ies().substr(0, 200)), ""}}),
              HasSubstr("cut.ies: line "));
  EXPECT_EQ(last, ErrorCode::kBadInput);
  EXPECT_THAT(error_of({{file, ""}}, -1), HasSubstr("scale"));
  scene.lights.clear();
  EXPECT_THAT(error_of({{file, ""}}), HasSubstr("no point or spot light"));
}

TEST_F(Profiles, TiltedLampsAreNamedWhereThatChangesThem) {
  std::string text = test::lopsided_ies();
  text.replace(text.find("TILT=NONE"), 9, "TILT=INCLUDE\n1\n2\n0 90\n1 0.8");
  scene.lights[0].direction = vec3(0, -1, 0);
  ASSERT_EQ(error_of({{folder.write("tilt.ies", text), ""}}), "none");
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("light 1 \"torch\": tilt.ies")));
}

}  // namespace
}  // namespace goldthread
