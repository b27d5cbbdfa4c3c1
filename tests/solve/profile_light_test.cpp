// Lamps that shine by a light profile, by the hierarchical solver.
#include <gtest/gtest.h>

#include "scene/small_profiles.h"
#include "solve/hierarchical/point_transfer.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

TEST(ProfileLight, FloorUnderATiltedLamp) {
  for (const auto pole : {LightProfile::Pole::kNadir, LightProfile::Pole::kSide})
    for (const float tilt : {0.0f, 0.5f})
      for (const float radius : {0.0f, 0.05f}) {
        Scene scene;
        test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 8), test::diffuse(0));
        scene.lights = {test::lopsided_lamp(pole, {0.3f, 0.2f, 2}, {std::sin(tilt), 0, -std::cos(tilt)},
                                            {0.6f, 0.8f, 0})};
        scene.lights[0].radius = radius;
        const Light light = scene.lights[0];
        Solved solved(std::move(scene));
        solved.solve();
        for (const ElementId id : solved.leaves()) {
          const Element& e = solved.pool()[id];
          const double truth = test::lopsided_lux(light, dvec3(e.centre));
          EXPECT_NEAR(double(solved.state().irradiance[id].x), truth, 0.01 * truth + 1);
        }
      }
}

TEST(ProfileLight, EmittedPowerIsTheFilesFlux) {
  Scene scene;
  test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}), test::diffuse(0));
  scene.lights = {test::lopsided_lamp(LightProfile::Pole::kNadir, {0, 0, 2}, {0, 0, -1}, {1, 0, 0})};
  const Solved solved(std::move(scene));
  EXPECT_NEAR(double(emitted_power(solved.pool()).x), 1000 * double(kPi), 2);
}

}  // namespace
}  // namespace goldthread
