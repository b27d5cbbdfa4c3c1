// Light through translucent sheets, between two rooms where it is known everywhere.
#include <gtest/gtest.h>

#include "reconstruct/reconstruct.h"
#include "scene/translucent_scenes.h"
#include "session/power_balance.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

TEST(Translucent, TwoRoomsHaveTheirKnownLight) {
  Solved solved(test::parted_rooms());
  solved.solve();
  for (int c = 0; c < 3; ++c) {
    const test::Summary s = summarise(solved, [&](ElementId id) {
      const Element& e = solved.pool()[id];
      return solved.state().irradiance[id][c] / test::parted_light(e.centre, normalize(e.summed_normal))[c];
    });
    EXPECT_NEAR(s.mean, 1, 0.004) << c;
    EXPECT_NEAR(s.least, 1, 0.08) << c;
    EXPECT_NEAR(s.most, 1, 0.08) << c;
  }
  const PowerBalance power = measure_power(*solved.solver, 400000, 1);
  EXPECT_LE(std::abs(power.residual), 0.01 * power.emitted);
}

TEST(Translucent, SoDoVertices) {
  Solved solved(test::parted_rooms());
  solved.solve();
  ReconstructStats stats;
  const Lighting lighting = reconstruct(*solved.solver, {}, CancelToken(), stats);
  const LitPrimitive& sheet = lighting.primitives.back();
  ASSERT_FALSE(sheet.irradiance_back.empty());  // of one side, and lit on both
  for (size_t i = 0; i < sheet.irradiance.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(sheet.irradiance[i][c] / test::kBeforeSheet[c], 1, 0.04);
      EXPECT_NEAR(sheet.irradiance_back[i][c] / test::kBehindSheet[c], 1, 0.04);
    }
}

// One side is in a pattern of light that the other knows nothing of.
TEST(Translucent, WhatShinesThroughIsAsUnevenAndNoMore) {
  Scene scene;
  test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 2),
            test::translucent(vec3(0.3f), vec3(0.5f)));
  test::add(scene, test::square(0.3f, 0.2f, true), test::diffuse(0));  // shades its middle from above
  scene.lights.push_back(test::lamp(LightKind::kPoint, 500, {0.2f, 0.1f, 1}));
  Solved solved(std::move(scene));
  solved.solve();
  double landed = 0, leaves_below = 0, above = 0;
  float most_landed = 0, most_below = 0;
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    if (e.part != 0) continue;
    landed += e.back ? 0.0 : double(e.area * solved.state().irradiance[id].y);
    leaves_below += e.back ? double(e.area * solved.state().radiosity[id].y) : 0.0;
    above += e.back ? double(e.area * solved.state().irradiance[id].y) : 0.0;
    most_below = std::max(most_below, e.back ? solved.state().radiosity[id].y : 0.0f);
    most_landed = std::max(most_landed, e.back ? 0.0f : solved.state().irradiance[id].y);
  }
  EXPECT_GT(landed, 100);
  EXPECT_NEAR(leaves_below / landed, 0.5, 1e-3);
  EXPECT_EQ(above, 0);
  EXPECT_FLOAT_EQ(most_below, 0.5f * most_landed);  // as bright a spot as the light behind makes
}

TEST(Translucent, NoSheetSendsOnMoreThanThereIs) {
  Scene scene = test::parted_rooms();
  scene.materials.back().base_colour = vec3(1);
  scene.materials.back().diffuse_transmission_colour = vec3(1);
  const Solved solved(std::move(scene));
  for (ElementId id = 0; id < solved.pool().size(); ++id) {
    const vec3 all = solved.pool()[id].reflectance + solved.pool().transmittance(id);
    for (int c = 0; c < 3; ++c) EXPECT_LE(all[c], kMaxReflectance + 1e-6f);
  }
}

}  // namespace
}  // namespace goldthread
