// The lamps of glTF files.
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/scene_read.h"
#include "scene/small_profiles.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double kHalf = 0.7071067811865476;  ///< sine and cosine of 45 degrees: quarter turns as quaternions

Scene read_built(const GltfBuilder& builder) {
  TempFolder folder;
  Result<Scene> scene = read_scene(folder.write("scene.gltf", builder.text()));
  EXPECT_TRUE(scene) << scene.error().line();
  return scene ? *std::move(scene) : Scene{};
}

MATCHER_P(Near, expected, "") {
  return length(arg - expected) < 1e-5f;
}

/// A file with one light on one node.
GltfBuilder with_light(const json& light, json node) {
  GltfBuilder b;
  b.doc["extensionsUsed"] = {"KHR_lights_punctual"};
  b.doc["extensions"] = {{"KHR_lights_punctual", {{"lights", {light}}}}};
  node["extensions"] = {{"KHR_lights_punctual", {{"light", 0}}}};
  b.push("nodes", node);
  return b;
}

TEST(GltfLights, PointLightKeepsCandelaUnderScale) {
  const Scene scene =
      read_built(with_light({{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 200}, {"range", 9}},
                            {{"translation", {1, 2, 3}}, {"scale", {10, 10, 10}}}));
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].kind, LightKind::kPoint);
  EXPECT_THAT(scene.lights[0].intensity, Near(vec3(200, 100, 0)));
  EXPECT_THAT(scene.lights[0].position, Near(vec3(1, 2, 3)));
  EXPECT_EQ(scene.lights[0].range, 9);
}

TEST(GltfLights, NegativeIntensityIsDarkAndNamed) {
  const Scene scene = read_built(with_light({{"type", "point"}, {"name", "hole"}, {"intensity", -200}}, {}));
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_EQ(scene.lights[0].intensity, vec3(0));
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("light 0 \"hole\": an intensity of -200")));
}

TEST(GltfLights, RadiusComesFromTheExtras) {
  const auto radius = [](const json& light) { return read_built(with_light(light, {})).lights.at(0).radius; };
  EXPECT_FLOAT_EQ(radius({{"type", "point"}, {"extras", {{"radius", 0.05}}}}), 0.05f);
  EXPECT_EQ(radius({{"type", "point"}, {"extras", {{"radius", -1}}}}), 0);
  EXPECT_EQ(radius({{"type", "point"}, {"extras", {{"radius", "large"}}}}), 0);
  EXPECT_EQ(radius({{"type", "directional"}, {"extras", {{"radius", 3}}}}), 0);
  EXPECT_EQ(radius({{"type", "point"}}), 0);
}

TEST(GltfLights, ASunsDiameterComesFromTheExtrasInDegrees) {
  const auto diameter = [](const char* type, const json& value) {
    return read_built(with_light({{"type", type}, {"extras", {{"angular_diameter", value}}}}, {}))
        .lights.at(0)
        .angular_diameter;
  };
  EXPECT_NEAR(diameter("directional", 0.533), 0.533f * kPi / 180, 1e-7f);
  EXPECT_NEAR(diameter("directional", 5), 5 * kPi / 180, 1e-6f);
  EXPECT_EQ(diameter("directional", -1), 0);
  EXPECT_EQ(diameter("directional", 120), 0);
  EXPECT_EQ(diameter("directional", "sun"), 0);
  EXPECT_EQ(diameter("point", 1), 0);
}

/// A file with one area light on one node.
GltfBuilder with_area_light(const json& light, json node = json::object()) {
  GltfBuilder b;
  b.doc["extensionsUsed"] = {"EXT_lights_area"};
  b.doc["extensionsRequired"] = {"EXT_lights_area"};
  b.doc["extensions"] = {{"EXT_lights_area", {{"lights", {light}}}}};
  node["extensions"] = {{"EXT_lights_area", {{"light", 0}}}};
  b.push("nodes", node);
  return b;
}

TEST(GltfAreaLights, ARectangleHasHeightAndAspectAndNits) {
  const Scene scene =
      read_built(with_area_light({{"type", "rect"},
                                  {"name", "panel"},
                                  {"color", {1, 0.5, 0}},
                                  {"intensity", 400},
                                  {"size", 0.5},
                                  {"rect", {{"aspect", 3}}}},
                                 {{"translation", {1, 2, 3}}, {"rotation", {-kHalf, 0, 0, kHalf}}}));
  EXPECT_THAT(scene.warnings, IsEmpty());
  ASSERT_EQ(scene.lights.size(), 1u);
  const Light& light = scene.lights[0];
  EXPECT_EQ(light.kind, LightKind::kRectangle);
  EXPECT_EQ(light.name, "panel");
  EXPECT_EQ(light.size, vec2(1.5f, 0.5f));
  EXPECT_FLOAT_EQ(light.area(), 0.75f);
  EXPECT_THAT(light.intensity, Near(vec3(300, 150, 0)));  // candela straight ahead
  EXPECT_THAT(light.position, Near(vec3(1, 2, 3)));
  EXPECT_THAT(light.direction, Near(vec3(0, -1, 0)));
  EXPECT_THAT(light.across, Near(vec3(1, 0, 0)));
}

TEST(GltfAreaLights, WhatIsAbsentIsTheDraftsDefault) {
  const Light light = read_built(with_area_light({{"type", "disk"}}, {{"name", "node"}})).lights.at(0);
  EXPECT_EQ(light.kind, LightKind::kDisc);
  EXPECT_EQ(light.size, vec2(1));
  EXPECT_EQ(light.name, "node");
  EXPECT_NEAR(light.intensity.x, 1000 * kPi / 4, 1e-3f);
  EXPECT_EQ(read_built(with_area_light({{"type", "rect"}, {"size", 2}})).lights.at(0).size, vec2(2));
}

TEST(GltfAreaLights, TheLargestScaleIsAllOfThem) {
  GltfBuilder b =
      with_area_light({{"type", "rect"}, {"size", 2}, {"rect", {{"aspect", 0.5}}}}, {{"scale", {1, -3, 2}}});
  b.push("nodes", {{"children", {0}}, {"scale", {2, 2, 2}}});
  const Light light = read_built(b).lights.at(0);
  EXPECT_EQ(light.size, vec2(6, 12));
  EXPECT_NEAR(light.intensity.x, 1000 * 72, 1);  // luminance stays
}

TEST(GltfAreaLights, TheFirstDraftsWordsAreUnderstood) {
  EXPECT_EQ(read_built(with_area_light({{"shape", "rect"}, {"width", 2}, {"height", 0.5}})).lights.at(0).size,
            vec2(2, 0.5f));
  const Light disc = read_built(with_area_light({{"shape", "disk"}, {"radius", 0.3}})).lights.at(0);
  EXPECT_EQ(disc.kind, LightKind::kDisc);
  EXPECT_FLOAT_EQ(disc.size.x, 0.6f);
}

TEST(GltfAreaLights, WhatCannotBeIsNamed) {
  const auto warnings_of = [](const json& light, json node = json::object()) {
    return read_built(with_area_light(light, node)).warnings;
  };
  EXPECT_THAT(warnings_of({{"type", "rect"}, {"name", "panel"}, {"size", -2}}),
              ElementsAre(HasSubstr("area light 0 \"panel\": a size of -2 x -2 m")));
  EXPECT_THAT(warnings_of({{"type", "rect"}, {"rect", {{"aspect", 0}}}}), ElementsAre(HasSubstr("0 x 1 m")));
  EXPECT_THAT(warnings_of({{"type", "disk"}, {"size", "large"}}), ElementsAre(HasSubstr("nan x nan m")));
  EXPECT_THAT(warnings_of({{"type", "disk"}}, {{"scale", {0, 0, 0}}}),
              ElementsAre(HasSubstr("0 times that on node 0")));
  EXPECT_THAT(warnings_of({{"type", "tube"}}), ElementsAre(HasSubstr("kind \"tube\" is unknown; left out")));
  const Scene dark = read_built(with_area_light({{"type", "disk"}, {"intensity", -5}}));
  EXPECT_EQ(dark.lights.at(0).intensity, vec3(0));
  EXPECT_THAT(dark.warnings, ElementsAre(HasSubstr("area light 0: an intensity of -5 nits is no light")));
  GltfBuilder b = with_area_light({{"type", "disk"}});
  b.doc["nodes"][0]["extensions"]["EXT_lights_area"]["light"] = 4;
  const TempFolder folder;
  const Result<Scene> scene = read_scene(folder.write("a.gltf", b.text()));
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().line(), HasSubstr("node 0: there is no area light 4"));
}

TEST(GltfAreaLights, ANodeMayHaveAPunctualLightBeside) {
  GltfBuilder b = with_area_light({{"type", "disk"}});
  b.doc["extensions"]["KHR_lights_punctual"] = {{"lights", {{{"type", "point"}}}}};
  b.doc["nodes"][0]["extensions"]["KHR_lights_punctual"] = {{"light", 0}};
  EXPECT_EQ(read_built(b).lights.size(), 2u);
}

TEST(GltfLights, SpotShinesAlongMinusZTurned) {
  const Scene scene =
      read_built(with_light({{"type", "spot"}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}},
                            {{"rotation", {-kHalf, 0, 0, kHalf}}}));  // -z turns to -y
  EXPECT_EQ(scene.lights[0].kind, LightKind::kSpot);
  EXPECT_THAT(scene.lights[0].direction, Near(vec3(0, -1, 0)));
  EXPECT_FLOAT_EQ(scene.lights[0].inner_cone, 0.2f);
  EXPECT_FLOAT_EQ(scene.lights[0].outer_cone, 0.4f);
  EXPECT_THAT(scene.lights[0].intensity, Near(vec3(1)));
}

TEST(GltfLights, DirectionUnderMirrorsAndUnevenScale) {
  GltfBuilder b =
      with_light({{"type", "directional"}}, {{"rotation", {0, kHalf, 0, kHalf}}});  // -z turns to -x
  b.push("nodes", {{"children", {0}}, {"scale", {-3, 1, 1}}});
  const Scene scene = read_built(b);
  EXPECT_EQ(scene.lights[0].kind, LightKind::kDirectional);
  EXPECT_THAT(scene.lights[0].direction, Near(vec3(1, 0, 0)));
}

TEST(GltfLights, LightsOutsideTheSceneDoNotShine) {
  GltfBuilder b = with_light({{"type", "point"}}, json::object());
  b.triangle();
  b.doc["scenes"] = {{{"nodes", {1}}}};
  EXPECT_TRUE(read_built(b).lights.empty());
}

/// A file with a light profile on one node, `more` beside the number of the profile.
GltfBuilder with_profile(const json& profile, json node = json::object(), json more = json::object()) {
  GltfBuilder b;
  b.doc["extensionsUsed"] = {"EXT_lights_ies"};
  b.doc["extensionsRequired"] = {"EXT_lights_ies"};
  b.doc["extensions"] = {{"EXT_lights_ies", {{"lights", {profile}}}}};
  more["light"] = 0;
  node["extensions"]["EXT_lights_ies"] = more;
  b.push("nodes", node);
  return b;
}

json data_uri(const std::string& text) {
  return {{"uri", "data:application/x-ies-lm-63;base64," + base64(text)}};
}

TEST(GltfProfiles, MultiplierAndColourScaleTheFilesCandela) {
  const Scene scene =
      read_built(with_profile(data_uri(lopsided_ies()), {{"name", "lamp"}, {"translation", {1, 2, 3}}},
                              {{"multiplier", 2}, {"color", {1, 0.5, 7}}}));
  EXPECT_THAT(scene.warnings, IsEmpty());
  ASSERT_EQ(scene.lights.size(), 1u);
  const Light& light = scene.lights[0];
  EXPECT_EQ(light.kind, LightKind::kPoint);
  EXPECT_EQ(light.name, "lamp");
  EXPECT_THAT(light.position, Near(vec3(1, 2, 3)));
  ASSERT_TRUE(light.profile);
  EXPECT_FLOAT_EQ(light.profile->peak(), 1);
  // Colour is clamped to 1.
  const vec3 ahead = light.intensity * light.profile->intensity({0.6f, 0, -0.8f});
  EXPECT_NEAR(ahead.x, 2 * lopsided_candela(0.6, -0.8), 1);
  EXPECT_NEAR(ahead.y, ahead.x / 2, 1e-3f);
  EXPECT_NEAR(ahead.z, ahead.x, 1e-3f);
}

TEST(GltfProfiles, NodesTurnThemAndScaleDoesNot) {
  GltfBuilder b = with_profile(data_uri(lopsided_ies()), {{"rotation", {-kHalf, 0, 0, kHalf}}});
  b.push("nodes", {{"children", {0}}, {"scale", {5, 5, 5}}, {"rotation", {0, kHalf, 0, kHalf}}});
  const Scene scene = read_built(b);
  EXPECT_THAT(scene.lights.at(0).direction, Near(vec3(0, -1, 0)));
  EXPECT_THAT(scene.lights[0].across, Near(vec3(0, 0, -1)));
  EXPECT_NEAR(scene.lights[0].intensity.x, 1299, 1);  // the peak of cos v (1 + sin v)
}

TEST(GltfProfiles, ComeFromFilesBesideAndFromBuffersAndAreReadOnce) {
  const TempFolder folder;
  folder.write("lamps/down light.ies", lopsided_ies());
  GltfBuilder b = with_profile({{"uri", "lamps/down%20light.ies"}});
  b.push("nodes", {{"extensions", {{"EXT_lights_ies", {{"light", 0}}}}}});
  b.push("nodes", {{"extensions", {{"EXT_lights_ies", {{"light", 1}}}}}});
  const int view = b.view(lopsided_type_b_ies());
  b.doc["extensions"]["EXT_lights_ies"]["lights"].push_back(
      {{"bufferView", view}, {"mimeType", "application/x-ies-lm-63"}, {"name", "b"}});
  const Result<Scene> scene = read_scene(folder.write("a.gltf", b.text()));
  ASSERT_TRUE(scene) << scene.error().line();
  ASSERT_EQ(scene->lights.size(), 3u);
  EXPECT_EQ(scene->lights[0].profile, scene->lights[1].profile);
  EXPECT_THAT(scene->lights[0].profile->name, HasSubstr("light.ies"));
  EXPECT_EQ(scene->lights[2].profile->pole, LightProfile::Pole::kSide);
  EXPECT_EQ(scene->lights[2].profile->name, "b");
}

TEST(GltfProfiles, ANodeWithAPunctualLightTooIsOneLamp) {
  GltfBuilder b = with_profile(data_uri(lopsided_ies()));
  b.doc["extensions"]["KHR_lights_punctual"] = {{"lights", {{{"type", "point"}}}}};
  b.doc["nodes"][0]["extensions"]["KHR_lights_punctual"] = {{"light", 0}};
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.lights.size(), 1u);
  EXPECT_TRUE(scene.lights[0].profile);
  EXPECT_THAT(scene.warnings, ElementsAre(HasSubstr("each is one lamp")));
}

TEST(GltfProfiles, BrokenOnesAreNamedWithTheirLine) {
  const TempFolder folder;
  const auto error_of = [&](const GltfBuilder& b) {
    const Result<Scene> scene = read_scene(folder.write("a.gltf", b.text()));
    return scene ? std::string("none") : scene.error().line();
  };
  folder.write("cut.ies", lopsided_ies().substr(0, 300));
  EXPECT_THAT(error_of(with_profile({{"uri", "cut.ies"}})), HasSubstr("cut.ies: line "));
  EXPECT_THAT(error_of(with_profile(data_uri("no photometry"))), HasSubstr("a.gltf: light profile 0"));
  EXPECT_THAT(error_of(with_profile({{"uri", "gone.ies"}})), HasSubstr("light profile 0"));
  EXPECT_THAT(error_of(with_profile({{"bufferView", 7}})), HasSubstr("bufferView"));
  EXPECT_THAT(error_of(with_profile({{"name", "nothing"}})), HasSubstr("bufferView"));
  GltfBuilder b = with_profile(data_uri(lopsided_ies()));
  b.doc["nodes"][0]["extensions"]["EXT_lights_ies"]["light"] = 4;
  EXPECT_THAT(error_of(b), HasSubstr("node 0: there is no light profile 4"));
}

TEST(GltfProfiles, NegativeMultipliersAreDark) {
  EXPECT_EQ(read_built(with_profile(data_uri(lopsided_ies()), {}, {{"multiplier", -1}})).lights[0].intensity,
            vec3(0));
}

}  // namespace
}  // namespace goldthread
