// Lamps that shine by a light profile, by path tracing.
#include "scene/small_profiles.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using test::expect_estimates;
using test::Traced;

const vec3 kUp(0, 0, 1);

TEST(ProfileLight, FloorUnderATiltedLamp) {
  for (const auto pole : {LightProfile::Pole::kNadir, LightProfile::Pole::kSide})
    for (const float tilt : {0.0f, 0.5f})
      for (const float radius : {0.0f, 0.02f}) {
        Light light =
            test::lopsided_lamp(pole, {0.3f, 0.2f, 2}, {std::sin(tilt), 0, -std::cos(tilt)}, {0.6f, 0.8f, 0});
        light.radius = radius;
        Scene scene;
        test::add(scene, test::square(20, 0, true), test::diffuse(0));
        scene.lights = {light};
        const Traced t(std::move(scene));
        for (const vec3& p : {vec3(0.3f, 0.2f, 0), vec3(2, 1, 0), vec3(-1.5f, 0.5f, 0), vec3(0, -3, 0)})
          expect_estimates(t.at(p, kUp), dvec3(test::lopsided_lux(light, dvec3(p))), 0.02, 2e-3);
      }
}

TEST(ProfileLight, IsDrawnByWhatItSendsThisWay) {
  // Two lamps side by side that look away from each other: nearly all that arrives is one's.
  Scene scene;
  test::add(scene, test::square(20, 0, true), test::diffuse(0));
  for (const float side : {-1.0f, 1.0f})
    scene.lights.push_back(
        test::lopsided_lamp(LightProfile::Pole::kNadir, {0, 0, 2}, {side, 0, -0.2f}, {0, 1, 0}));
  const double truth = test::lopsided_lux(scene.lights[0], dvec3(3, 0, 0)) +
                       test::lopsided_lux(scene.lights[1], dvec3(3, 0, 0));
  expect_estimates(Traced(std::move(scene)).at(vec3(3, 0, 0), kUp, 64), dvec3(truth), 1e-4, 2e-3);
}

}  // namespace
}  // namespace goldthread
