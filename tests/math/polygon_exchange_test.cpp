// Form factors between polygons against closed forms, and their invariants.
#include "math/polygon_exchange.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "math/shared_cases.h"

namespace goldthread {
namespace {

constexpr double kPiExact = 3.14159265358979323846;

Polygon rectangle(const dvec3& corner, const dvec3& across, const dvec3& up) {
  return {corner, corner + across, corner + across + up, corner + up};
}

/// Two equal rectangles a x b that face each other at distance c (Howell C-11). Far apart its terms cancel:
/// in more digits than it is compared in.
long double opposed_rectangles(long double a, long double b, long double c) {
  const long double x = a / c, y = b / c, xx = 1 + x * x, yy = 1 + y * y;
  return 2 / (std::acos(-1.0L) * x * y) *
         (0.5L * std::log(xx * yy / (1 + x * x + y * y)) + x * std::sqrt(yy) * std::atan(x / std::sqrt(yy)) +
          y * std::sqrt(xx) * std::atan(y / std::sqrt(xx)) - x * std::atan(x) - y * std::atan(y));
}

/// Two rectangles at a right angle with a common edge l; w and h away from it (Howell C-14), from w's.
double perpendicular_rectangles(double l, double w, double h) {
  const double W = w / l, H = h / l, w2 = W * W, h2 = H * H, s = std::sqrt(w2 + h2);
  return 1 / (kPiExact * W) *
         (W * std::atan(1 / W) + H * std::atan(1 / H) - s * std::atan(1 / s) +
          0.25 * std::log((1 + w2) * (1 + h2) / (1 + w2 + h2) *
                          std::pow(w2 * (1 + w2 + h2) / ((1 + w2) * (w2 + h2)), w2) *
                          std::pow(h2 * (1 + h2 + w2) / ((1 + h2) * (h2 + w2)), h2)));
}

TEST(PolygonExchange, OpposedRectangles) {
  for (const double a : {0.1, 1.0, 7.0})
    for (const double c : {0.05, 1.0, 20.0}) {
      const Polygon below = rectangle({0, 0, 0}, {a, 0, 0}, {0, 1, 0}),
                    above = rectangle({0, 0, c}, {0, 1, 0}, {a, 0, 0});
      const Estimate exchange = polygon_exchange(below, above);
      const auto exact = static_cast<double>(opposed_rectangles(a, 1, c));
      EXPECT_NEAR(exchange.value / a / exact, 1, 1e-10) << a << " " << c;
      EXPECT_LE(std::abs(exchange.value / a - exact), exchange.error / a + 1e-12 * exact);
      EXPECT_LT(exchange.error, 1e-9 * exchange.value);
    }
}

TEST(PolygonExchange, ACommonEdge) {
  for (const double w : {0.02, 0.5, 3.0})
    for (const double h : {0.1, 1.0, 40.0}) {
      const Polygon floor = rectangle({0, 0, 0}, {1, 0, 0}, {0, w, 0}),
                    wall = rectangle({0, 0, 0}, {0, 0, h}, {1, 0, 0});
      const double exact = perpendicular_rectangles(1, w, h);
      EXPECT_NEAR(polygon_exchange(floor, wall).value / w / exact, 1, 1e-11) << w << " " << h;
    }
}

TEST(PolygonExchange, FarAwayItIsThatOfTwoPoints) {
  for (const double distance : {1e2, 1e3, 1e4}) {
    const Polygon a = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                  b = rectangle({0, 0, distance}, {0, 1, 0}, {1, 0, 0});
    const double point = 1 / (kPiExact * distance * distance);
    const Estimate exchange = polygon_exchange(a, b);
    EXPECT_NEAR(exchange.value / point, 1, 1 / distance);
    EXPECT_LT(exchange.error, 1e-6 * point);
  }
}

/// The exchange of two triangles far apart: Radon's rule on both, whose error falls with the sixth power of
/// their distance.
double distant_exchange(const Polygon& a, const Polygon& b) {
  const std::array<dvec3, 3> from{a[0], a[1], a[2]}, to{b[0], b[1], b[2]};
  const dvec3 n = plane_of(a).normal, m = plane_of(b).normal;
  const auto kernel = [&](const dvec3& x) {
    return triangle_mean(
        [&](const dvec3& y) {
          const dvec3 d = y - x;
          const double squared = glm::dot(d, d);
          return glm::dot(n, d) * -glm::dot(m, d) / (kPiExact * squared * squared);
        },
        to);
  };
  return area(a) * area(b) * triangle_mean(kernel, from);
}

TEST(PolygonExchange, FarAndAslantItIsRightToItsError) {
  const Polygon a{{0, 0, 0}, {1, 0.1, 0.2}, {0.3, 0.8, -0.1}};
  for (const double distance : {20.0, 50.0, 100.0, 300.0, 1e3, 1e4}) {
    const dvec3 away = distance * glm::normalize(dvec3(0.3, 0.2, 0.9));
    const Polygon b{away + dvec3(0, 0, 0), away + dvec3(0.2, 0.9, 0.3), away + dvec3(1, 0.2, -0.2)};
    const Estimate exchange = polygon_exchange(a, b);
    const double exact = distant_exchange(a, b);
    EXPECT_LE(std::abs(exchange.value - exact), exchange.error + std::pow(distance, -6) * exact) << distance;
    EXPECT_LT(exchange.error, 1e-14) << distance;
  }
}

TEST(PolygonExchange, OfTwoThatCutEachOtherItsErrorCoversBothWays) {
  // What is left of the second of the first pair is 4e-5 wide; of the other pair it is less.
  const std::array<std::array<Polygon, 2>, 2> pairs{{
      {Polygon{{0.266, 0.393, 0.051}, {0.901, -0.16, -0.663}, {0.888, -0.57, 0.53}},
       Polygon{{0.463, 0.13, 1.193}, {-0.387, -0.28, 0.629}, {0.445, 0.142, -0.454}}},
      {Polygon{{0.358, 0.706, 0.693}, {-0.799, -0.417, -0.74}, {-0.417, 0.6, -0.393}},
       Polygon{{0.115, -0.288, 0.54}, {-0.51, -0.808, 1.114}, {-0.695, 0.278, -0.68}}},
  }};
  for (const auto& [a, b] : pairs) {
    const Estimate there = polygon_exchange(a, b), back = polygon_exchange(b, a);
    EXPECT_LE(std::abs(there.value - back.value), there.error + back.error);
  }
}

TEST(PolygonExchange, LargeCoordinatesCostNoDigits) {
  // Two that cut each other, moved without rounding: all coordinates are multiples of 1/64.
  Polygon a{{0, 0, 0}, {1, 0.125, 0.25}, {0.25, 0.75, -0.125}},
      b{{0.25, 0.125, -0.5}, {0.5, 1, 1.25}, {1.25, 0.25, 1}};
  const Estimate here = polygon_exchange(a, b);
  ASSERT_GT(here.value, 0.01);
  for (Polygon* polygon : {&a, &b})
    for (dvec3& p : *polygon) p += dvec3(1 << 22, 1 << 20, 1 << 23);
  const Estimate moved = polygon_exchange(a, b);
  EXPECT_LE(std::abs(moved.value - here.value), moved.error + here.error);
  EXPECT_LT(moved.error, 1e-13);
}

TEST(PolygonExchange, BehindEachOtherNothing) {
  const Polygon up = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(polygon_exchange(up, rectangle({0, 0, 1}, {1, 0, 0}, {0, 1, 0})).value, 0);   // its back
  EXPECT_EQ(polygon_exchange(up, rectangle({0, 0, -1}, {1, 0, 0}, {0, 1, 0})).value, 0);  // below
  EXPECT_EQ(polygon_exchange(up, rectangle({2, 0, 0}, {1, 0, 0}, {0, 1, 0})).value, 0);   // in its plane
}

TEST(PolygonExchange, WhatStandsHalfBehindCountsByItsFront) {
  // A wall that goes on beneath the floor.
  const Polygon floor = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}),
                wall = rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0}),
                deep_wall = rectangle({0, 0, -3}, {0, 0, 4}, {1, 0, 0});
  EXPECT_NEAR(polygon_exchange(floor, deep_wall).value, polygon_exchange(floor, wall).value, 1e-14);
}

TEST(PolygonExchange, ShapesThatAreNotConvexAreTheSumOfTheirParts) {
  const Polygon target = rectangle({0, 0, 2}, {0, 3, 0}, {3, 0, 0});
  const Polygon bent{{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}};
  const double parts = polygon_exchange(rectangle({0, 0, 0}, {3, 0, 0}, {0, 1, 0}), target).value +
                       polygon_exchange(rectangle({0, 1, 0}, {1, 0, 0}, {0, 2, 0}), target).value;
  EXPECT_NEAR(polygon_exchange(bent, target).value, parts, 1e-13);
  double triangles = 0;
  for (const Polygon& part : convex_parts(bent)) triangles += polygon_exchange(part, target).value;
  EXPECT_NEAR(triangles, parts, 1e-13);
}

RC_GTEST_PROP(PolygonExchange, TheSameBothWaysAndWhereverTheyAre, ()) {
  const auto number = [] {
    return static_cast<double>(*rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-1000, 1001))) / 1000;
  };
  const auto point = [&] { return dvec3(number(), number(), number()); };
  Polygon a{point(), point(), point()}, b{point() + dvec3(0, 0, 1), point() + dvec3(0, 0, 1), point()};
  RC_PRE(!polygon_problem(a) && !polygon_problem(b) && area(a) > 0.01 && area(b) > 0.01);
  const Estimate there = polygon_exchange(a, b), back = polygon_exchange(b, a);
  RC_ASSERT(std::abs(there.value - back.value) <= there.error + back.error + 1e-14);
  RC_ASSERT(there.value >= 0 && there.value <= std::min(area(a), area(b)) + there.error);
  const dvec3 shift = 5.0 * point();
  const glm::dquat turn = glm::normalize(glm::dquat(number() + 2, number(), number(), number()));
  for (Polygon* polygon : {&a, &b})
    for (dvec3& p : *polygon) p = turn * p * 3.0 + shift;
  const Estimate moved = polygon_exchange(a, b);
  RC_ASSERT(std::abs(moved.value / 9 - there.value) <= moved.error / 9 + there.error + 1e-13);
}

TEST(PolygonExchange, ClosedRoomsSumToOne) {
  // A tetrahedron of any shape, seen from inside.
  const dvec3 p[4] = {{0, 0, 0}, {2, 0.3, 0.1}, {0.4, 1.7, -0.2}, {0.6, 0.5, 1.1}};
  std::vector<Polygon> faces{{p[0], p[1], p[2]}, {p[0], p[3], p[1]}, {p[1], p[3], p[2]}, {p[2], p[3], p[0]}};
  for (const Polygon& face : faces) {
    double sum = 0;
    for (const Polygon& other : faces)
      if (&other != &face) sum += polygon_exchange(face, other).value;
    EXPECT_NEAR(sum / area(face), 1, 1e-12);
  }
}

TEST(PointFormFactor, OfARectangleThroughItsCornersNormal) {
  // Howell B-3: element parallel to a rectangle a x b, above its corner at distance c.
  for (const double a : {0.3, 2.0})
    for (const double c : {0.01, 1.0, 50.0}) {
      const double A = a / c, B = 1 / c, sa = std::sqrt(1 + A * A), sb = std::sqrt(1 + B * B);
      const double exact = (A / sa * std::atan(B / sa) + B / sb * std::atan(A / sb)) / (2 * kPiExact);
      const Polygon target = rectangle({0, 0, c}, {0, 1, 0}, {a, 0, 0});
      EXPECT_NEAR(point_form_factor({0, 0, 0}, {0, 0, 1}, target) / exact, 1, 1e-12);
    }
}

TEST(PointFormFactor, AHorizonCutsIt) {
  // A wall of any depth below the floor adds nothing.
  const Polygon wall = rectangle({-1, 1, 0}, {2, 0, 0}, {0, 0, 1}),
                deep = rectangle({-1, 1, -7}, {2, 0, 0}, {0, 0, 8});
  const double above = point_form_factor({0, 0, 0}, {0, 0, 1}, wall);
  EXPECT_GT(above, 0.1);
  EXPECT_NEAR(point_form_factor({0, 0, 0}, {0, 0, 1}, deep), above, 1e-15);
}

TEST(PolygonProblem, NamesWhatIsWrong) {
  EXPECT_FALSE(polygon_problem(rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})));
  const auto problem = [](const Polygon& polygon) { return polygon_problem(polygon).value_or("none"); };
  EXPECT_NE(problem({{0, 0, 0}, {1, 0, 0}}).find("three"), std::string::npos);
  EXPECT_NE(problem({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}).find("area"), std::string::npos);
  EXPECT_NE(problem({{0, 0, 0}, {1, 0, 0}, {NAN, 1, 0}}).find("finite"), std::string::npos);
  EXPECT_NE(problem({{0, 0, 0}, {1, 0, 0}, {1, 1, 0.1}, {0, 1, 0}}).find("planar"), std::string::npos);
  EXPECT_NE(problem({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {2, -1, 0}}).find("crosses"), std::string::npos);
}

TEST(PolygonClip, KeepsWhatLiesInFront) {
  const Polygon square = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(area(clip(square, {{1, 0, 0}, -0.25})), 0.75, 1e-15);
  EXPECT_TRUE(clip(square, {{1, 0, 0}, -1}).empty());
  EXPECT_NEAR(area(clip(square, {{1, 0, 0}, 0})), 1, 1e-15);
  EXPECT_TRUE(clip(square, {{1, 0, 0}, -1 + 1e-9}, 1e-6).empty());  // nothing but a sliver
}

TEST(Triangulate, CoversThePolygonOnce) {
  const Polygon comb{{0, 0, 0}, {5, 0, 0}, {5, 3, 0}, {4, 3, 0}, {4, 1, 0},
                     {3, 1, 0}, {3, 3, 0}, {2, 3, 0}, {2, 1, 0}, {0, 1, 0}};
  double sum = 0;
  for (const UVec3& t : triangulate(comb)) {
    const Polygon part{comb[t.x], comb[t.y], comb[t.z]};
    EXPECT_GE(area_vector(part).z, 0);
    sum += area(part);
  }
  EXPECT_NEAR(sum, area(comb), 1e-12);
}

TEST(PolygonExchange, SharedCases) {
  const test::Json cases = test::shared_cases("view_factors.json");
  if (cases.is_null()) GTEST_SKIP() << test::kNoSharedCases;
  size_t pairs = 0;
  for (const auto& item : cases) {
    if (!item["occluders"].empty() || item["to"]["type"] != "polygon") continue;
    const double exact = item["value"];
    double value = 0;
    if (item["from"]["type"] == "polygon") {
      const Polygon from = test::corners_of<dvec3>(item["from"]);
      value = polygon_exchange(from, test::corners_of<dvec3>(item["to"])).value / area(from);
    } else {
      value = point_form_factor(test::vector_of<dvec3>(item["from"]["position"]),
                                glm::normalize(test::vector_of<dvec3>(item["from"]["normal"])),
                                test::corners_of<dvec3>(item["to"]));
    }
    EXPECT_NEAR(value / exact, 1, 1e-11) << item["id"];
    ++pairs;
  }
  EXPECT_GE(pairs, 36u);
}

}  // namespace
}  // namespace goldthread
