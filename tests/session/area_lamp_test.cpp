// Area lamps from a glTF file to the light at given places, and what is told of them.
#include <gtest/gtest.h>

#include "files/scene_read.h"
#include "goldthread/reference.h"
#include "scene/area_lamps.h"
#include "session/baked.h"
#include "session/power_balance.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::baked;
using test::draft;
using test::GltfBuilder;
using test::json;
using test::TempFolder;

constexpr double kNits = 700, kExitance = kNits * double(kPi);

/// A black floor of 8 by 8 m facing up (+y), and a rectangle of 1 by 2 m and a disc of 1 m across above it.
GltfBuilder lit_by_area_lamps() {
  GltfBuilder b;
  b.push("materials", {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {0, 0, 0, 1}}}}});
  b.mesh({{"attributes", {{"POSITION", b.vec3s({-4, 0, -4, 4, 0, -4, 4, 0, 4, -4, 0, 4})}}},
          {"indices", b.indices({0, 2, 1, 0, 3, 2})},
          {"material", 0}});
  b.doc["extensionsUsed"] = {"EXT_lights_area"};
  b.doc["extensions"]["EXT_lights_area"]["lights"] = {
      {{"type", "rect"}, {"intensity", kNits}, {"size", 2}, {"rect", {{"aspect", 0.5}}}},
      {{"type", "disk"}, {"intensity", kNits}, {"extras", {{"id", 7}}}}};
  const json down = {-0.7071067811865476, 0, 0, 0.7071067811865476};
  b.push("nodes", {{"translation", {0, 1, 0}},
                   {"rotation", down},
                   {"extensions", {{"EXT_lights_area", {{"light", 0}}}}}});
  b.push("nodes", {{"translation", {3, 2, 0}},
                   {"rotation", down},
                   {"extensions", {{"EXT_lights_area", {{"light", 1}}}}}});
  return b;
}

/// lux at (x, 0, z).
double truth_at(double x, double z) {
  return kExitance * (test::parallel_factor({-0.5 - x, -1 - z}, {0.5 - x, 1 - z}, 1) +
                      test::disc_factor(0.5, 2, std::hypot(x - 3, z)));
}

json points_of(const std::string& file) {
  return json::parse(test::bytes_of_file(file)).at("points");
}

TEST(AreaLamps, BakeAndReferenceTellTheSameLight) {
  const TempFolder folder;
  const std::string file = folder.write("scene.gltf", lit_by_area_lamps().text());
  const std::string places = folder.write("places.json", R"([{"point": [0, 0, 0], "normal": [0, 1, 0]},
      {"point": [1.5, 0, 0.5], "normal": [0, 1, 0]}, {"point": [3, 0, -1], "normal": [0, 1, 0]}])");
  const double truths[] = {truth_at(0, 0), truth_at(1.5, 0.5), truth_at(3, -1)};
  ReferenceOptions options;
  options.input = file;
  options.points_file = places;
  options.samples = 4096;
  options.json_file = folder.path("reference.json");
  const Result<ReferenceResult> traced = reference(options);
  ASSERT_TRUE(traced) << traced.error().line();
  EXPECT_TRUE(traced->warnings.empty());
  const json reference_points = points_of(options.json_file);
  for (size_t i = 0; i < 3; ++i) {
    const double error = reference_points[i]["standard_error"][1];
    EXPECT_NEAR(double(reference_points[i]["irradiance"][1]), truths[i], 3 * error + 1e-3 * truths[i]);
    EXPECT_LT(error, 0.01 * truths[i]);
  }
  BakeOptions bake_options = draft(file, {folder.path("lit.gltf")});
  bake_options.points_file = places;
  bake_options.json_file = folder.path("bake.json");
  baked(bake_options);
  const json bake_points = points_of(bake_options.json_file);
  for (size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(double(bake_points[i]["irradiance"][1]), truths[i], 5e-3 * truths[i]);

  // The lamps are in the lit scene as they were.
  const json lit = json::parse(test::bytes_of_file(folder.path("lit.gltf")));
  EXPECT_EQ(lit["extensions"], lit_by_area_lamps().doc["extensions"]);
  const Result<Scene> again = read_scene(folder.path("lit.gltf"));
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(again->lights.size(), 2u);
}

TEST(AreaLamps, InfoTellsTheirAreaAndPower) {
  const TempFolder folder;
  const Result<SceneInfo> info = inspect(folder.write("scene.gltf", lit_by_area_lamps().text()));
  ASSERT_TRUE(info) << info.error().line();
  const json lamps = json::parse(info->json)["area_lamps"];
  const double area = 2 + double(kPi) / 4;
  EXPECT_EQ(lamps["count"], 2);
  EXPECT_NEAR(double(lamps["area_m2"]), area, 1e-5);
  EXPECT_NEAR(double(lamps["power_lm"]), kExitance * area, 0.01);
  EXPECT_NE(info->text.find("2 area lamps, 2.785 m2, 6125 lm"), std::string::npos) << info->text;
}

TEST(AreaLamps, ThePowerBalanceCountsThem) {
  for (const bool disc : {false, true}) {
    Scene scene;
    test::add(scene, test::turned(shapes::cube(4)), test::diffuse(0.5f));
    const vec3 middle(0.5f), tilt(0.3f, -0.5f, -1);
    const Light light = disc ? test::disc_lamp(float(kNits), 0.4f, middle, tilt)
                             : test::rectangle_lamp(float(kNits), {0.2f, 0.4f}, middle, tilt);
    scene.lights = {light};
    test::Solved solved(std::move(scene), test::quick());
    solved.solve();
    const PowerBalance balance = measure_power(*solved.solver, 100000, 1);
    const double power = kExitance * double(light.area());
    EXPECT_NEAR(balance.emitted, power, 1e-3 * power);
    EXPECT_NEAR(balance.escaped, 0, 1e-3 * power);
    EXPECT_NEAR(balance.residual, 0, 0.01 * power);
  }
}

}  // namespace
}  // namespace goldthread
