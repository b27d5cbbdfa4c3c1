#include "mesh/min_rectangle.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <random>

#include "mesh/convex_hull.h"

namespace goldthread {
namespace {

std::vector<vec2> random_points(uint32_t seed, size_t count) {
  std::mt19937 random(seed);
  std::vector<vec2> points(count);
  const bool coarse = random() % 2;  // many coinciding and collinear points, or hardly any
  for (vec2& p : points)
    for (int k = 0; k < 2; ++k) p[k] = coarse ? float(random() % 6) : float(random() % 100003) * 1e-3f - 20;
  return points;
}

void expect_inside(const MinRectangle& r, const std::vector<vec2>& points) {
  EXPECT_NEAR(length(r.u), 1, 1e-6f);
  EXPECT_GE(r.half.x, r.half.y);
  for (const vec2& p : points) {
    const float slack = 1e-4f * (1 + r.half.x);
    EXPECT_LE(std::abs(dot(p - r.centre, r.u)), r.half.x + slack);
    EXPECT_LE(std::abs(dot(p - r.centre, r.v())), r.half.y + slack);
  }
}

TEST(ConvexHull, SquareWithPointsInsideAndOnItsSides) {
  const std::vector<vec2> points{{1, 1}, {0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 0}, {2, 1}, {0, 0}};
  EXPECT_EQ(convex_hull(points), (std::vector<vec2>{{0, 0}, {2, 0}, {2, 2}, {0, 2}}));
}

TEST(ConvexHull, NoneOneAndALine) {
  EXPECT_TRUE(convex_hull({}).empty());
  EXPECT_EQ(convex_hull(std::vector<vec2>(100, vec2(3, 4))), (std::vector<vec2>{{3, 4}}));
  std::vector<vec2> line;
  for (int i = 0; i < 100; ++i) line.push_back({float(i * 7 % 100), 2 * float(i * 7 % 100)});
  EXPECT_EQ(convex_hull(line), (std::vector<vec2>{{0, 0}, {99, 198}}));
}

TEST(MinRectangle, FindsATurnedRectangle) {
  for (int degrees = 0; degrees < 180; degrees += 7) {
    const float angle = float(degrees) * kPi / 180;
    const vec2 u(std::cos(angle), std::sin(angle)), v(-u.y, u.x), middle(5, -3);
    std::vector<vec2> points;
    for (int i = 0; i <= 10; ++i)
      for (int j = 0; j <= 10; ++j)
        points.push_back(middle + float(i - 5) * 0.4f * u + float(j - 5) * 0.1f * v);
    const MinRectangle r = min_rectangle(points);
    EXPECT_NEAR(length(r.centre - middle), 0, 1e-5f);
    EXPECT_NEAR(r.half.x, 2, 1e-5f);
    EXPECT_NEAR(r.half.y, 0.5f, 1e-5f);
    EXPECT_NEAR(std::abs(dot(r.u, u)), 1, 1e-5f);
  }
}

TEST(MinRectangle, NonePointsAndLines) {
  EXPECT_EQ(min_rectangle({}).area(), 0);
  const MinRectangle one = min_rectangle(std::vector<vec2>{{3, 4}});
  EXPECT_EQ(one.centre, vec2(3, 4));
  EXPECT_EQ(one.half, vec2(0));
  const MinRectangle line = min_rectangle(std::vector<vec2>{{0, 0}, {3, 4}, {1.5f, 2}});
  EXPECT_NEAR(line.half.x, 2.5f, 1e-6f);
  EXPECT_EQ(line.half.y, 0);
  EXPECT_NEAR(dot(line.u, vec2(0.6f, 0.8f)), 1, 1e-6f);
}

RC_GTEST_PROP(MinRectangle, HoldsAllAndNoSmallerOneIsFoundByTrying, (uint32_t seed)) {
  const std::vector<vec2> points = random_points(seed, *rc::gen::inRange<size_t>(1, 200));
  const MinRectangle r = min_rectangle(points);
  expect_inside(r, points);
  for (int i = 0; i < 360; ++i) {
    const float angle = float(i) * kPi / 720;
    const vec2 u(std::cos(angle), std::sin(angle)), v(-u.y, u.x);
    vec2 low(std::numeric_limits<float>::max()), high(-low);
    for (const vec2& p : points) {
      low = glm::min(low, vec2(dot(p, u), dot(p, v)));
      high = glm::max(high, vec2(dot(p, u), dot(p, v)));
    }
    RC_ASSERT(r.area() <= (high.x - low.x) * (high.y - low.y) * 1.0001f + 1e-3f);
  }
}

RC_GTEST_PROP(ConvexHull, TurnsLeftAndLeavesNothingOutside, (uint32_t seed)) {
  const std::vector<vec2> points = random_points(seed, *rc::gen::inRange<size_t>(3, 300));
  const std::vector<vec2> hull = convex_hull(points);
  if (hull.size() < 3) return;
  for (size_t i = 0; i < hull.size(); ++i) {
    const dvec2 a(hull[i]), edge = dvec2(hull[(i + 1) % hull.size()]) - a;
    const auto side = [&](const vec2& p) {
      return edge.x * (double(p.y) - a.y) - edge.y * (double(p.x) - a.x);
    };
    RC_ASSERT(side(hull[(i + 2) % hull.size()]) > 0);
    for (const vec2& p : points) RC_ASSERT(side(p) >= -1e-9);
  }
}

}  // namespace
}  // namespace goldthread
