// Lights with size, by the hierarchical solver.
#include <gtest/gtest.h>

#include "solve/hierarchical/point_transfer.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

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

TEST(LightDisc, CosineIsTheDiscsAboveTheHorizon) {
  for (const double sine : {0.0047, 0.1, 0.5, 0.95})
    for (const double degrees : {0.0, 40.0, 60.0, 80.0, 89.8, 90.0, 90.2, 95.0, 110.0, 130.0, 175.0}) {
      const double theta = degrees * double(kPi) / 180;
      const LightDisc disc{vec3(0, float(std::sin(theta)), float(std::cos(theta))), 0, float(sine)};
      EXPECT_NEAR(double(disc_cosine(disc, vec3(0, 0, 1))), disc_truth(sine, theta), 2e-4)
          << sine << " " << degrees;
    }
}

Scene floor_below_a_plate(float height) {
  Scene scene;
  test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 8), test::diffuse(0));
  Material plate = test::diffuse(0);
  plate.double_sided = true;
  test::add(scene, test::parallelogram({-4, -4, height}, {4, 0, 0}, {0, 8, 0}), plate);
  return scene;
}

/// Mean over the floor's leaves with centres between `low` and `high` along x, less what falls on all of them
/// when light is `exact(x)`.
template <typename Exact>
double error_between(const Solved& solved, float low, float high, const Exact& exact) {
  double sum = 0, truth = 0;
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    if (e.part != 0 || e.centre.x < low || e.centre.x > high) continue;
    sum += double(e.area) * double(solved.state().irradiance[id].x);
    truth += double(e.area) * exact(double(e.centre.x));
  }
  EXPECT_GT(truth, 0);
  return sum / truth - 1;
}

// The penumbra below a straight edge: within `reach` of it light is the share of a disc beyond a chord.
TEST(SoftSun, PenumbraOfAStraightEdge) {
  const float height = 2;
  const double degrees = 20, reach = height * std::tan(degrees / 2 * double(kPi) / 180);
  const auto exact = [&](double x) {
    const double share = std::clamp(x / reach, -1.0, 1.0);
    return 1000 * (std::acos(-share) + share * std::sqrt(1 - share * share)) / double(kPi);
  };
  Scene scene = floor_below_a_plate(height);
  Light sun = test::lamp(LightKind::kDirectional, 1000, vec3(0));
  sun.angular_diameter = float(degrees) * kPi / 180;
  scene.lights.push_back(sun);
  Solved solved(std::move(scene));
  solved.solve();
  EXPECT_NEAR(error_between(solved, -2, 2, exact), 0, 0.005);
  EXPECT_NEAR(error_between(solved, 0, float(reach), exact), 0, 0.03);
  EXPECT_NEAR(error_between(solved, -float(reach), 0, exact), 0, 0.1);
  EXPECT_NEAR(error_between(solved, float(reach) + 0.2f, 2, exact), 0, 1e-3);
}

TEST(SoftSun, OpenGroundGetsTheSineOfItsHeight) {
  Scene scene;
  test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 8), test::diffuse(0));
  Light sun = test::lamp(LightKind::kDirectional, 1000, vec3(0), normalize(vec3(1, 0, -1)));
  sun.angular_diameter = 0.533f * kPi / 180;
  scene.lights.push_back(sun);
  Solved solved(std::move(scene));
  solved.solve();
  EXPECT_NEAR(test::summarise(solved, [&](ElementId id) { return solved.state().irradiance[id].x; }).mean,
              1000 * std::sqrt(0.5), 0.1);
}

TEST(SoftLamp, ABallAboveLightsLikeAPoint) {
  Scene scene;
  test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 8), test::diffuse(0));
  Scene point = scene;
  Light lamp = test::lamp(LightKind::kPoint, 100, vec3(0.5f, 0, 1.5f));
  point.lights.push_back(lamp);
  lamp.radius = 0.3f;
  scene.lights.push_back(lamp);
  const auto mean = [](Scene s) {
    Solved solved(std::move(s));
    solved.solve();
    return test::summarise(solved, [&](ElementId id) { return solved.state().irradiance[id].x; }).mean;
  };
  const double as_point = mean(point);
  EXPECT_NEAR(mean(scene) / as_point, 1, 1e-3);
}

}  // namespace
}  // namespace goldthread
