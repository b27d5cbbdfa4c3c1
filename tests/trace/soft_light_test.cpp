// Lights with size, by path tracing: the sun's disc and lamps that are balls.
#include "scene/small_skies.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using test::add;
using test::diffuse;
using test::expect_estimates;
using test::lamp;
using test::Traced;

const vec3 kUp(0, 0, 1);

/// A black square of 40 by 40 in the plane z = 0.
Scene floor_scene() {
  Scene scene;
  add(scene, test::square(20, 0, true), diffuse(0));
  return scene;
}

Light sun(float lux, float diameter_degrees, const vec3& direction) {
  Light light = lamp(LightKind::kDirectional, lux, vec3(0), normalize(direction));
  light.angular_diameter = diameter_degrees * kPi / 180;
  return light;
}

/// Irradiance by an even disc of directions that brings 1 to a plane facing it, by brute force.
double disc_truth(double sine, double theta) {
  constexpr int kRings = 400;
  double sum = 0;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kRings; ++j) {
      const double s = sine * std::sqrt((i + 0.5) / kRings), turn = 2 * double(kPi) * (j + 0.5) / kRings;
      const double along = std::sqrt(1 - s * s);
      sum += std::max(0.0, along * std::cos(theta) + s * std::cos(turn) * std::sin(theta)) / along;
    }
  return sum / kRings / kRings;
}

TEST(SoftSun, OpenGroundGetsTheSineOfItsHeight) {
  for (const float diameter : {0.533f, 10.0f, 60.0f}) {
    Scene scene = floor_scene();
    scene.lights.push_back(sun(1000, diameter, {1, 0, -1}));
    expect_estimates(Traced(std::move(scene)).at(vec3(0), kUp), dvec3(1000 * std::sqrt(0.5)));
  }
}

TEST(SoftSun, OnTheHorizonHalfOfItIsSeen) {
  Scene scene = floor_scene();
  scene.lights.push_back(sun(1000, 20, {1, 0, 0}));
  const double truth = 1000 * disc_truth(std::sin(10 * double(kPi) / 180), double(kPi) / 2);
  EXPECT_GT(truth, 30);
  expect_estimates(Traced(std::move(scene)).at(vec3(0), kUp, 16384), dvec3(truth), 0.02, 2e-3);
}

// Below a straight edge at height h, sun overhead, the penumbra is 2 h tan(radius) wide; within it light is
// the share of a disc beyond a chord.
TEST(SoftSun, PenumbraOfAStraightEdge) {
  const float height = 2, diameter = 6;
  const double reach = height * std::tan(double(diameter) / 2 * double(kPi) / 180);
  Scene scene = floor_scene();
  scene.lights.push_back(sun(1000, diameter, {0, 0, -1}));
  Material plate = diffuse(0);
  plate.double_sided = true;
  add(scene, test::parallelogram({-20, -20, height}, {20, 0, 0}, {0, 40, 0}), plate);  // its edge above x = 0
  const Traced t(std::move(scene));
  EXPECT_EQ(t.at(vec3(float(-1.01 * reach), 0, 0), kUp).mean.x, 0);
  expect_estimates(t.at(vec3(float(1.01 * reach), 0, 0), kUp), dvec3(1000), 0.01, 1e-3);
  for (const double share : {-0.6, 0.0, 0.5}) {
    // Seen from x, what has x' > -x is open: the disc's area beyond a chord.
    const double lit = (std::acos(-share) + share * std::sqrt(1 - share * share)) / double(kPi);
    expect_estimates(t.at(vec3(float(share * reach), 0, 0), kUp, 16384), dvec3(1000 * lit), 0.02, 0.005);
  }
}

TEST(SoftLamp, ABallOnTheWholeAboveLightsLikeAPoint) {
  Scene scene = floor_scene();
  Light ball = lamp(LightKind::kPoint, 100, vec3(1, 0, 2));
  ball.radius = 0.7f;
  scene.lights.push_back(ball);
  expect_estimates(Traced(std::move(scene)).at(vec3(0), kUp), dvec3(100 * 2 / std::pow(5.0, 1.5)));
}

TEST(SoftLamp, ABallThatTheFloorCuts) {
  Scene scene = floor_scene();
  Light ball = lamp(LightKind::kPoint, 100, vec3(2, 0, 0.1f));
  ball.radius = 0.5f;
  scene.lights.push_back(ball);
  const double distance = std::sqrt(4.01);
  const double truth = 100 / (distance * distance) * disc_truth(0.5 / distance, std::acos(0.1 / distance));
  // What is below the floor is behind it.
  expect_estimates(Traced(std::move(scene)).at(vec3(0), kUp, 16384), dvec3(truth), 0.02, 5e-3);
}

}  // namespace
}  // namespace goldthread
