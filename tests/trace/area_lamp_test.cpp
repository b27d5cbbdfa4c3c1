// Rectangle and disc lamps, by path tracing.
#include "scene/area_lamps.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using test::add;
using test::diffuse;
using test::disc_lamp;
using test::expect_estimates;
using test::rectangle_lamp;
using test::Traced;

const vec3 kUp(0, 0, 1);
constexpr double kNits = 700, kExitance = kNits * double(kPi);

/// A black square of 40 by 40 in the plane z = 0, and lamps.
Traced floor_with(std::vector<Light> lamps) {
  Scene scene;
  add(scene, test::square(20, 0, true), diffuse(0));
  scene.lights = std::move(lamps);
  return Traced(std::move(scene));
}

/// Light of a rectangle of that size at (0, 0, height) at places from straight below to far aside.
TEST(AreaLamp, ARectangleBringsItsFormFactor) {
  for (const vec2 size : {vec2(0.1f, 0.2f), vec2(1, 3), vec2(8, 8)})
    for (const float height : {0.05f, 0.5f, 2.0f, 30.0f}) {
      const Traced t = floor_with({rectangle_lamp(float(kNits), size, vec3(0, 0, height))});
      const dvec2 half = 0.5 * dvec2(size);
      for (const dvec2 place : {dvec2(0), dvec2(0.3, 0.2), dvec2(2, 5)})
        expect_estimates(
            t.at(vec3(place, 0), kUp),
            dvec3(kExitance * test::parallel_factor(-half - place, half - place, double(height))), 0.03,
            1e-3);
    }
}

TEST(AreaLamp, ADiscBringsItsFormFactor) {
  for (const float radius : {0.05f, 0.5f, 4.0f})
    for (const float height : {0.05f, 0.5f, 30.0f}) {
      const Traced t = floor_with({disc_lamp(float(kNits), 2 * radius, vec3(0, 0, height))});
      for (const double aside : {0.0, 0.3, 5.0})
        expect_estimates(t.at(vec3(float(aside), 0, 0), kUp),
                         dvec3(kExitance * test::disc_factor(double(radius), double(height), aside)), 0.03,
                         1e-3);
    }
}

TEST(AreaLamp, TheHorizonCutsWhatIsLargeAndNear) {
  Scene scene;
  add(scene, test::parallelogram({0, -1, -1}, {0, 2, 0}, {0, 0, 1.5f}), diffuse(0));  // faces +x
  for (const float height : {0.1f, 1.0f}) {
    Scene lit = scene;
    lit.lights = {rectangle_lamp(float(kNits), {6, 4}, vec3(0, 0, height))};
    expect_estimates(Traced(std::move(lit)).at(vec3(0), vec3(1, 0, 0)),
                     dvec3(2 * kExitance * test::upright_factor(3, 2, double(height))), 0.02, 1e-3);
  }
}

TEST(AreaLamp, NothingBehindItAndInItsPlane) {
  for (const Light& light : {rectangle_lamp(float(kNits), {2, 2}, vec3(0, 0, 1), vec3(0, 0, 1)),
                             rectangle_lamp(float(kNits), {2, 2}, vec3(0), vec3(0, 0, -1)),
                             disc_lamp(float(kNits), 2, vec3(0, 0, 1), vec3(0, 0, 1))})
    EXPECT_EQ(floor_with({light}).at(vec3(0.1f, 0.2f, 0), kUp).mean, dvec3(0));
}

TEST(AreaLamp, WhatStandsHalfwayHidesHalf) {
  Scene scene;
  add(scene, test::square(20, 0, true), diffuse(0));
  Material plate = diffuse(0);
  plate.double_sided = true;
  add(scene, test::parallelogram({-20, -20, 1}, {20, 0, 0}, {0, 40, 0}), plate);  // its edge above x = 0
  scene.lights = {rectangle_lamp(float(kNits), {3, 2}, vec3(0, 0, 2))};
  const Traced t(std::move(scene));
  for (const double x : {-1.0, 0.0, 0.4}) {
    // Of the lamp what lies beyond -x shows over the edge.
    const double truth = kExitance * test::parallel_factor({-2 * x, -1}, {1.5 - x, 1}, 2);
    if (x > -0.75) expect_estimates(t.at(vec3(float(x), 0, 0), kUp), dvec3(truth), 0.03, 5e-3);
  }
  EXPECT_EQ(t.at(vec3(-1.6f, 0, 0), kUp).mean, dvec3(0));
}

TEST(AreaLamp, ItStandsInNoLightsWayAndLampsAddUp) {
  const Traced t =
      floor_with({rectangle_lamp(float(kNits), {4, 4}, vec3(0, 0, 1)), disc_lamp(100, 1, vec3(0, 0, 3)),
                  test::lamp(LightKind::kPoint, 50, vec3(0, 0, 2))});
  const double truth = kExitance * test::parallel_factor(dvec2(-2), dvec2(2), 1) +
                       100 * double(kPi) * test::disc_factor(0.5, 3) + 50.0 / 4;
  expect_estimates(t.at(vec3(0), kUp), truth);
}

TEST(AreaLamp, AClosedBoxGetsAllOfItsPower) {
  for (const bool disc : {false, true}) {
    Scene scene;
    add(scene, test::turned(shapes::cube()), diffuse(0));
    const vec3 lo = scene.bounds().low, size = scene.bounds().size(), middle = lo + 0.5f * size;
    const vec3 tilt(0.3f, -0.5f, -1);
    const Light light = disc ? disc_lamp(float(kNits), 0.4f * size.x, middle, tilt)
                             : rectangle_lamp(float(kNits), 0.2f * size.x * vec2(1, 2), middle, tilt);
    scene.lights = {light};
    const Traced t(std::move(scene));
    std::vector<Receiver> receivers;
    constexpr int kSteps = 24;
    for (int axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true})
        for (int i = 0; i < kSteps; ++i)
          for (int j = 0; j < kSteps; ++j) {
            vec3 place(0), normal(0);
            place[axis] = high ? 1.0f : 0.0f;
            place[(axis + 1) % 3] = (float(i) + 0.5f) / kSteps;
            place[(axis + 2) % 3] = (float(j) + 0.5f) / kSteps;
            normal[axis] = high ? -1.0f : 1.0f;
            receivers.push_back(t.receiver(lo + place * size, normal));
          }
    const IrradianceValue mean = t.mean(receivers, 256);
    const double area = 6 * double(size.x * size.x);
    EXPECT_NEAR(mean.mean.x * area, kExitance * double(light.area()),
                2e-3 * kExitance * double(light.area()));
  }
}

}  // namespace
}  // namespace goldthread
