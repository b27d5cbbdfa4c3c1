// Glass as visibility: what of the light goes straight on, in which colour, and that none is lost.
#include <gtest/gtest.h>

#include "scene/glass_scenes.h"
#include "session/light_setup.h"
#include "session/power_balance.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

vec3 floor_mean(Scene scene) {
  Solved solved(std::move(scene), test::quick(), transparency);
  solved.solve();
  vec3 sum(0);
  float area = 0;
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    if (e.part != 0) continue;
    sum += e.area * solved.state().irradiance[id];
    area += e.area;
  }
  return sum / area;
}

Scene sunny(const Material& pane, int panes) {
  Scene scene = test::under_panes(pane, panes);
  scene.lights.push_back(test::lamp(LightKind::kDirectional, 1000, vec3(0)));
  return scene;
}

void expect_colour(const vec3& value, const vec3& truth, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(value[c], truth[c], tolerance) << "channel " << c;
}

TEST(Glass, LetsItsShareThrough) {
  expect_colour(floor_mean(sunny(test::glass(vec3(0), 1), 1)), vec3(0), 0);
  // The floor is black: nothing comes back to what the pane reflects.
  expect_colour(floor_mean(sunny(test::glass(vec3(0.8f), 0.75f), 1)), vec3(600), 0.1f);
}

TEST(Glass, ClearPanesMultiply) {
  expect_colour(floor_mean(sunny(test::glass(vec3(0.8f), 1), 1)), vec3(800), 0.1f);
  expect_colour(floor_mean(sunny(test::glass(vec3(0.8f), 1), 2)), vec3(640), 0.1f);
}

TEST(Glass, ColouredPanesMultiplyByChannel) {
  const vec3 colour(0.9f, 0.5f, 0.04f);
  expect_colour(floor_mean(sunny(test::glass(colour, 1), 1)), 1000.0f * colour, 1);
  expect_colour(floor_mean(sunny(test::glass(colour, 1), 2)), 1000.0f * colour * colour, 1);
}

TEST(Glass, OfSkyByChannel) {
  const vec3 colour(0.9f, 0.5f, 0.04f);
  Scene scene = test::under_panes(test::glass(colour, 1), 1);
  scene.sky.radiance = vec3(1000 / kPi);
  const vec3 mean = floor_mean(std::move(scene));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / (1000 * colour[c]), 1, 0.03) << c;
}

TEST(Glass, MetalLetsNothingThrough) {
  Material pane = test::glass(vec3(0.8f), 1);
  pane.metallic = 1;
  EXPECT_EQ(floor_mean(sunny(pane, 1)), vec3(0));
  pane.metallic = 0.25f;
  expect_colour(floor_mean(sunny(pane, 1)), vec3(600), 0.1f);
}

TEST(Glass, FurnaceIsUniform) {
  const vec3 b(3, 2, 1);
  Solved solved(test::glazed_furnace(b, {0.8f, 0.5f, 0.2f}, 0.5f), {}, transparency);
  solved.solve();
  for (int c = 0; c < 3; ++c) {
    const test::Summary s = summarise(solved, [&](ElementId id) { return solved.state().irradiance[id][c]; });
    EXPECT_NEAR(s.mean / double(b[c]), 1, 0.004) << c;
    EXPECT_NEAR(s.least / double(b[c]), 1, 0.08) << c;
    EXPECT_NEAR(s.most / double(b[c]), 1, 0.08) << c;
  }
  const PowerBalance power = measure_power(*solved.solver, 400000, 1);
  EXPECT_LE(std::abs(power.residual), 0.01 * power.emitted);
}

// Coloured light on coloured glass: what each pane absorbs goes by channel.
TEST(Glass, PowerIsKeptByChannel) {
  const vec3 colour(0.9f, 0.5f, 0.04f);
  for (const bool two_sided : {true, false}) {
    Material pane = test::glass(colour, 0.7f);
    pane.double_sided = two_sided;
    Scene scene = test::under_panes(pane, 2);
    scene.materials[0].base_colour = vec3(0.5f);
    scene.lights.push_back(test::lamp(LightKind::kDirectional, 1000, vec3(0)));
    scene.lights.back().intensity = vec3(1000, 300, 3000);
    scene.lights.push_back(test::lamp(LightKind::kPoint, 300, vec3(0, 0, 2)));
    Solved solved(std::move(scene), {}, transparency);
    solved.solve();
    const PowerBalance power = measure_power(*solved.solver, 400000, 1);
    EXPECT_GT(power.emitted, 0);
    EXPECT_LE(std::abs(power.residual), 0.01 * power.emitted) << two_sided;
  }
}

TEST(Glass, TintsOfLinksKeepDarkChannels) {
  EXPECT_TRUE(Tint().is_white());
  EXPECT_TRUE(Tint(vec3(1)).is_white());
  EXPECT_EQ(Tint().colour(), vec3(1));
  for (const vec3& colour : {vec3(1, 0.5f, 0.01f), vec3(0, 1, 0.3f), vec3(0.7f, 0.9f, 0.05f)})
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(Tint(colour).colour()[c], colour[c], 0.001f + 0.01f * colour[c]) << c;
}

}  // namespace
}  // namespace goldthread
