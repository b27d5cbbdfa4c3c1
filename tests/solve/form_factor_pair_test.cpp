// Form factors with others in between, against exact values and against rays.
#include "solve/matrix/form_factor_pair.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <random>

#include "math/polygon_exchange.h"
#include "math/shared_cases.h"
#include "math/visible_polygon.h"

namespace goldthread {
namespace {

Polygon rectangle(const dvec3& corner, const dvec3& across, const dvec3& up) {
  return {corner, corner + across, corner + across + up, corner + up};
}

std::vector<Polygon> only(const Polygon& polygon) {
  return std::vector<Polygon>(1, polygon);
}

const Polygon kBelow = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
const Polygon kAbove = rectangle({0, 0, 1}, {0, 1, 0}, {1, 0, 0});

TEST(VisibleParts, AShadowOfTwiceTheSizeHalfWay) {
  const Polygon blocker = rectangle({-0.1, -0.1, 0.5}, {0.2, 0, 0}, {0, 0.2, 0});
  const Polygon target = rectangle({-1, -1, 1}, {0, 2, 0}, {2, 0, 0});
  double seen = 0;
  for (const Polygon& part : visible_parts({0, 0, 0}, target, only(blocker))) {
    EXPECT_TRUE(is_convex(part));
    EXPECT_GT(glm::dot(area_vector(part), area_vector(target)), 0);
    seen += area(part);
  }
  EXPECT_NEAR(seen, 4 - 0.16, 1e-12);
}

TEST(VisibleParts, WhatStandsBehindTheTargetOrThePointHidesNothing) {
  const Polygon target = rectangle({-1, -1, 1}, {0, 2, 0}, {2, 0, 0});
  for (const double z : {-0.5, 1.0, 1.5}) {
    const Polygon blocker = rectangle({-2, -2, z}, {4, 0, 0}, {0, 4, 0});
    double seen = 0;
    for (const Polygon& part : visible_parts({0, 0, 0}, target, only(blocker))) seen += area(part);
    EXPECT_NEAR(seen, 4, 1e-12) << z;
  }
}

TEST(VisibleParts, OverlappingShadowsCountOnce) {
  const Polygon target = rectangle({-1, -1, 1}, {0, 2, 0}, {2, 0, 0});
  const std::vector<Polygon> blockers{rectangle({-0.2, -0.2, 0.5}, {0.3, 0, 0}, {0, 0.3, 0}),
                                      rectangle({-0.1, -0.1, 0.5}, {0.3, 0, 0}, {0, 0.3, 0})};
  double seen = 0;
  for (const Polygon& part : visible_parts({0, 0, 0}, target, blockers)) seen += area(part);
  EXPECT_NEAR(seen, 4 - (0.36 + 0.36 - 0.16), 1e-12);
}

TEST(PolygonFormFactor, AFullBlockerLeavesNothing) {
  const FormFactor f =
      polygon_form_factor(kBelow, kAbove, only(rectangle({-9, -9, 0.5}, {19, 0, 0}, {0, 19, 0})));
  EXPECT_EQ(f.value, 0);
  EXPECT_LT(f.error_bound, 1e-12);
}

TEST(PolygonFormFactor, WhatCannotBlockIsNotLookedAt) {
  const std::vector<Polygon> outside{
      rectangle({2, 0, 0.5}, {1, 0, 0}, {0, 1, 0}), rectangle({0, 0, -0.5}, {1, 0, 0}, {0, 1, 0}),
      rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), rectangle({0, 0, 0}, {0, 1, 0}, {0, 0, 1})};
  EXPECT_EQ(polygon_form_factor(kBelow, kAbove, outside).method, FormFactorMethod::kContour);
}

TEST(PolygonFormFactor, HalvesOfABlockerHideWhatItHides) {
  const Polygon whole = rectangle({0.2, 0.3, 0.4}, {0.5, 0, 0.1}, {0, 0.3, 0});
  const std::vector<Polygon> halves{{whole[0], whole[1], whole[2]}, {whole[0], whole[2], whole[3]}};
  const FormFactor one = polygon_form_factor(kBelow, kAbove, only(whole)),
                   two = polygon_form_factor(kBelow, kAbove, halves);
  EXPECT_NEAR(one.value, two.value, one.error_bound + two.error_bound);
}

/// Share of random straight lines between the two that are free, weighted as the form factor is.
double by_chance(const Polygon& from, const Polygon& to, const Polygon& blocker, int count,
                 double& standard_error) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  const auto on = [&](const Polygon& p) {
    return p[0] + unit(random) * (p[1] - p[0]) + unit(random) * (p[3] - p[0]);
  };
  const dvec3 n1 = plane_of(from).normal, n2 = plane_of(to).normal;
  const Plane plane = plane_of(blocker);
  double sum = 0, squares = 0;
  for (int i = 0; i < count; ++i) {
    const dvec3 x = on(from), y = on(to), d = y - x;
    double value = std::max(0.0, glm::dot(n1, d)) * std::max(0.0, -glm::dot(n2, d)) /
                   (3.14159265358979 * glm::dot(d, d) * glm::dot(d, d)) * area(to);
    const double a = plane.height(x), b = plane.height(y);
    if (a * b < 0) {
      const dvec3 hit = x + a / (a - b) * d;
      bool inside = true;
      for (size_t k = 0; k < 4; ++k)
        inside = inside &&
                 glm::dot(glm::cross(blocker[(k + 1) % 4] - blocker[k], hit - blocker[k]), plane.normal) >= 0;
      if (inside) value = 0;
    }
    sum += value;
    squares += value * value;
  }
  standard_error = std::sqrt((squares / count - sum / count * sum / count) / count);
  return sum / count;
}

TEST(PolygonFormFactor, AgreesWithChance) {
  const Polygon wall = rectangle({0, 0, 0}, {0, 0, 1}, {1, 0, 0});
  const std::vector<Polygon> blockers{rectangle({0.2, 0.1, 0.1}, {0.6, 0.1, 0}, {0, 0.2, 0.4}),
                                      rectangle({-0.5, 0.3, 0.2}, {1, 0, 0}, {0, 0, 0.5}),
                                      rectangle({0.3, 0.2, -1}, {0.5, 0, 0}, {0, 0.1, 2})};
  for (const Polygon& blocker : blockers)
    for (const Polygon& target : {kAbove, wall}) {
      const FormFactor f = polygon_form_factor(kBelow, target, only(blocker));
      double deviation = 0;
      const double chance = by_chance(kBelow, target, blocker, 400000, deviation);
      EXPECT_NEAR(f.value, chance, 4 * deviation + f.error_bound);
      EXPECT_EQ(f.method, FormFactorMethod::kVisibleParts);
    }
}

RC_GTEST_PROP(PolygonFormFactor, BlockersOnlyTakeAndReciprocityHolds, ()) {
  const auto number = [] {
    return static_cast<double>(*rc::gen::resize(rc::kNominalSize, rc::gen::inRange(-1000, 1001))) / 1000;
  };
  const auto point = [&] { return dvec3(number(), number(), number()); };
  const Polygon a{point(), point(), point()}, b{point() + dvec3(0, 0, 1), point() + dvec3(0, 0, 1), point()},
      c{point(), point(), point()};
  for (const Polygon& p : {a, b, c}) RC_PRE(!polygon_problem(p) && area(p) > 0.05);
  const CubatureLimits limits{1e-3, 1e-5, 3000};
  const FormFactor there = polygon_form_factor(a, b, only(c), limits),
                   back = polygon_form_factor(b, a, only(c), limits),
                   open = polygon_form_factor(a, b, {}, limits);
  RC_LOG() << there.value * area(a) << " +- " << there.error_bound * area(a) << " back "
           << back.value * area(b) << " +- " << back.error_bound * area(b) << " open "
           << open.value * area(a);
  RC_ASSERT(there.value >= 0 && there.value <= open.value + open.error_bound);
  RC_ASSERT(std::abs(there.value * area(a) - back.value * area(b)) <=
            there.error_bound * area(a) + back.error_bound * area(b) + 1e-14);
}

TEST(PolygonFormFactor, SharedCasesWithOccluders) {
  const test::Json cases = test::shared_cases("view_factors.json");
  if (cases.is_null()) GTEST_SKIP() << test::kNoSharedCases;
  const auto corners = test::corners_of<dvec3>;
  size_t count = 0;
  for (const auto& item : cases) {
    if (item["occluders"].empty()) continue;
    std::vector<Polygon> occluders;
    for (const auto& o : item["occluders"]) occluders.push_back(corners(o));
    FormFactor f;
    if (item["from"]["type"] == "polygon") {
      f = polygon_form_factor(corners(item["from"]), corners(item["to"]), occluders);
    } else {
      f = point_to_polygon(test::vector_of<dvec3>(item["from"]["position"]),
                           glm::normalize(test::vector_of<dvec3>(item["from"]["normal"])),
                           corners(item["to"]), occluders);
    }
    const double exact = item["value"];
    EXPECT_NEAR(f.value, exact, 2e-5 * exact + 1e-14) << item["id"];
    EXPECT_LE(std::abs(f.value - exact), f.error_bound) << item["id"];
    ++count;
  }
  EXPECT_EQ(count, 20u);
}

}  // namespace
}  // namespace goldthread
