// Curved shapes past polygons: rays against what is known without them.
#include "solve/matrix/shape_rays.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>

#include "solve/matrix/shape_form_factor.h"

namespace goldthread {
namespace {

constexpr double kPiExact = std::numbers::pi;

Polygon square(double half, double z, const dvec3& centre = dvec3(0)) {
  return {centre + dvec3(-half, -half, z), centre + dvec3(half, -half, z), centre + dvec3(half, half, z),
          centre + dvec3(-half, half, z)};
}

FormFactor factor(const Shape& from, const Shape& to, const std::vector<Polygon>& occluders,
                  double tolerance = 1e-3, uint32_t seed = 0) {
  ShapeRayLimits limits;
  limits.relative = tolerance;
  limits.seed = seed;
  const Result<FormFactor> f = shape_form_factor(from, to, occluders, {}, limits);
  if (!f) throw std::runtime_error(f.error().line());
  return *f;
}

/// Within four standard errors, which are as small as was asked for.
void expect_factor(const FormFactor& f, double truth, double tolerance = 1e-3) {
  EXPECT_NEAR(f.value, truth, 4 * f.standard_error + 1e-6);
  EXPECT_LE(f.error_bound, tolerance * f.value + 1e-7);
  EXPECT_EQ(f.method, FormFactorMethod::kRays);
}

double between_coaxial_discs(double r1, double r2, double h) {  // Howell C-41
  const double x = 1 + (1 + r2 * r2 / (h * h)) / (r1 * r1 / (h * h));
  return 0.5 * (x - std::sqrt(x * x - 4 * r2 * r2 / (r1 * r1)));
}

/// The double area integral of cos cos / (pi r²) between a disc about the axis at z = 0 and a square at z, by
/// the midpoint rule round the disc and Gauss's 5-point rule otherwise; over the disc's area.
double disc_to_square(double disc_radius, double half, double z) {
  constexpr std::array<double, 5> kNodes = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                                            0.9061798459386640};
  constexpr std::array<double, 5> kWeights = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                              0.4786286704993665, 0.2369268850561891};
  constexpr int kTurns = 32;
  double sum = 0;
  for (size_t i = 0; i < 5; ++i)
    for (int turn = 0; turn < kTurns; ++turn)
      for (size_t j = 0; j < 5; ++j)
        for (size_t k = 0; k < 5; ++k) {
          const double r = disc_radius * 0.5 * (1 + kNodes[i]), angle = 2 * kPiExact * turn / kTurns;
          const dvec3 d(half * kNodes[j] - r * std::cos(angle), half * kNodes[k] - r * std::sin(angle), z);
          const double squared = glm::dot(d, d);
          sum += kWeights[i] * kWeights[j] * kWeights[k] * r * z * z / (squared * squared);
        }
  const double measure = disc_radius / 2 * (2 * kPiExact / kTurns) * half * half;
  return sum * measure / kPiExact / (kPiExact * disc_radius * disc_radius);
}

// A square whose shadow, from wherever on the small disc, falls within the large one hides just what it would
// itself receive.
TEST(ShapeRays, CoaxialDiscsWithASquareBetween) {
  const DiscShape below{{0, 0, 0}, {0, 0, 1}, 0.5}, above{{0, 0, 2}, {0, 0, -1}, 1.5};
  const Polygon between = square(0.35, 1);
  const double truth = between_coaxial_discs(0.5, 1.5, 2) - disc_to_square(0.5, 0.35, 1);
  const double whole = between_coaxial_discs(0.5, 1.5, 2);
  EXPECT_LT(truth, 0.7 * whole);
  expect_factor(factor(below, above, {between}), truth);
  expect_factor(factor(below, above, {between}, 3e-4), truth, 3e-4);
  const FormFactor back = factor(above, below, {between});
  EXPECT_NEAR(back.value * 9, truth, 4 * 9 * back.standard_error);
}

TEST(ShapeRays, FromAPointToADisc) {
  const PointShape point{{0.1, 0.05, 0}, {0, 0, 1}};
  const DiscShape above{{0, 0, 2}, {0, 0, -1}, 1.5};
  const Polygon between = square(0.4, 1);
  const double open = shape_form_factor(point, above, {})->value;
  const double hidden =
      point_to_polygon(point.position, point.normal, Polygon(between.rbegin(), between.rend()), {}).value;
  expect_factor(factor(point, above, {between}), open - hidden);
}

TEST(ShapeRays, WhatHidesAllLeavesNothingAndWhatHidesNothingLeavesAll) {
  const SphereShape below{{0, 0, 0}, 0.5}, above{{0, 0, 3}, 1};
  const double open = shape_form_factor(below, above, {})->value;
  const FormFactor none = factor(below, above, {square(50, 1)});
  EXPECT_EQ(none.value, 0);
  EXPECT_GT(none.error_bound, 0);
  EXPECT_LT(none.error_bound, 1e-3 * open);
  const FormFactor all = factor(below, above, {square(1, 5), square(1, 1, {10, 0, 0})});
  EXPECT_DOUBLE_EQ(all.value, open);
  EXPECT_LT(all.error_bound, 1e-3 * open);
  // What faces away does so past occluders too.
  const FormFactor away = factor(DiscShape{{0, 0, 0}, {0, 0, -1}, 1}, above, {square(1, 1)});
  EXPECT_EQ(away.value, 0);
  EXPECT_EQ(away.error_bound, factor(DiscShape{{0, 0, 0}, {0, 0, -1}, 1}, above, {}).error_bound);
}

// By reflection half of every such pair's light passes on one side of a plane that parts it.
TEST(ShapeRays, AHalfPlaneThroughTheAxisHidesHalf) {
  const double far = 500;
  const Polygon half = {{-far, 0, 1.2}, {far, 0, 1.2}, {far, far, 1.2}, {-far, far, 1.2}};
  const SphereShape ball{{0, 0, 0}, 0.8}, other{{0, 0, 3}, 1.1};
  const DiscShape disc{{0, 0, 3}, {0, 0, -1}, 2};
  const CylinderShape column{{0, 0, -1}, {0, 0, 1}, 0.5, 1};
  const CapShape bowl{{0, 0, 2}, {0, 0, 1}, 1.5, 1.2};
  const DiscShape floor{{0, 0, 0}, {0, 0, 1}, 2};
  const Polygon plate = {{-1, -1, 3}, {-1, 1, 3}, {1, 1, 3}, {1, -1, 3}};
  const std::vector<std::pair<Shape, Shape>> pairs = {{ball, other},  {ball, disc},   {disc, ball},
                                                      {column, disc}, {disc, column}, {ball, plate},
                                                      {plate, ball},  {floor, bowl},  {floor, disc}};
  for (const auto& [from, to] : pairs) {
    const double open = shape_form_factor(from, to, {})->value;
    ASSERT_GT(open, 0);
    expect_factor(factor(from, to, {half}), open / 2);
  }
}

// Shapes that touch: a tube's wall and its end, by the law of reciprocity and both ways of closing.
TEST(ShapeRays, ATubeWithABaffle) {
  const CylinderShape tube{{0, 0, 0}, {0, 0, 1}, 1, 2, true};
  const DiscShape bottom{{0, 0, 0}, {0, 0, 1}, 1}, top{{0, 0, 2}, {0, 0, -1}, 1};
  const Polygon baffle = square(0.5, 1), facing_down(baffle.rbegin(), baffle.rend());
  // What leaves the bottom lands on top, wall or baffle.
  const double on_baffle = disc_to_square(1, 0.5, 1);
  const FormFactor to_top = factor(bottom, top, {baffle}), to_wall = factor(bottom, tube, {baffle});
  EXPECT_NEAR(to_top.value + to_wall.value + on_baffle, 1,
              4 * std::hypot(to_top.standard_error, to_wall.standard_error) + 1e-5);
  const FormFactor back = factor(tube, bottom, {baffle});
  EXPECT_NEAR(back.value * 4, to_wall.value, 4 * (4 * back.standard_error + to_wall.standard_error));
}

// A wall along the axis parts a tube in two. What it does not take of the tube's light lands on tube and
// ends; what it takes follows from what the wall itself sends to half an end.
TEST(ShapeRays, ATubeWithAWall) {
  const CylinderShape tube{{0, 0, 0}, {0, 0, 1}, 2, 3, true};
  const DiscShape bottom{{0, 0, 0}, {0, 0, 1}, 2}, top{{0, 0, 3}, {0, 0, -1}, 2};
  const Polygon wall = {{-2, 0, 0}, {-2, 0, 3}, {2, 0, 3}, {2, 0, 0}};
  Polygon half_end;
  for (int k = 0; k <= 128; ++k)
    half_end.emplace_back(2 * std::cos(kPiExact * k / 128), 2 * std::sin(kPiExact * k / 128), 0);
  const double to_ends = 2 * polygon_form_factor(wall, half_end, {}).value;
  const double on_wall = 2 * area(wall) * (1 - to_ends) / shape_area(tube);
  const FormFactor to_tube = factor(tube, tube, {wall}), down = factor(tube, bottom, {wall}),
                   up = factor(tube, top, {wall});
  EXPECT_NEAR(to_tube.value + down.value + up.value, 1 - on_wall,
              4 * (to_tube.standard_error + down.standard_error + up.standard_error) + 1e-4);
}

// The tolerance is met where the open exchange comes from cubature, too, whose error counts.
TEST(ShapeRays, AToleranceHoldsForAPlateAndASphere) {
  const Polygon plate = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}},
                half = {{0, -9, 1}, {9, -9, 1}, {9, 9, 1}, {0, 9, 1}};
  const SphereShape ball{{0, 0, 2}, 0.5};
  for (const double tolerance : {1e-2, 1e-3}) {
    const Result<FormFactor> f = shape_form_factor(plate, ball, std::vector<Polygon>{half},
                                                   {.relative = tolerance}, {.relative = tolerance});
    ASSERT_TRUE(f);
    expect_factor(*f, shape_form_factor(plate, ball, {})->value / 2, tolerance);
  }
}

TEST(ShapeRays, ErrorsAreHonestAndSeedsAndThreadsAsPromised) {
  const DiscShape below{{0, 0, 0}, {0, 0, 1}, 0.5}, above{{0, 0, 2}, {0, 0, -1}, 1.5};
  const std::vector<Polygon> between = {square(0.35, 1)};
  const double truth = between_coaxial_discs(0.5, 1.5, 2) - disc_to_square(0.5, 0.35, 1);
  int within_two = 0;
  double squares = 0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run) {
    const FormFactor f = factor(below, above, between, 1e-2, uint32_t(run));
    const double off = (f.value - truth) / f.standard_error;
    within_two += std::abs(off) <= 2;
    squares += off * off;
  }
  EXPECT_GE(within_two, 50);  // 94% by Student's t of 15 degrees of freedom
  EXPECT_NEAR(squares / kRuns, 15.0 / 13, 0.75);
  const FormFactor one = factor(below, above, between);
  EXPECT_NE(factor(below, above, between, 1e-3, 1).value, one.value);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(factor(below, above, between).value, one.value);
}

}  // namespace
}  // namespace goldthread
