// Sums by texel against integrals that are known, and against sums of the whole.
#include "represent/texel_sums.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <random>

namespace goldthread {
namespace {

/// A linear function of the place on the page, for values that should come out as they went in.
dvec3 linear(const dvec2& p) {
  return {1 + 2 * p.x - p.y, 5 - 0.25 * p.x, 3 * p.y};
}

ValueTriangle with_values(const vec2& a, const vec2& b, const vec2& c) {
  return {{a, b, c}, {vec3(linear(dvec2(a))), vec3(linear(dvec2(b))), vec3(linear(dvec2(c)))}};
}

double twice_area(const ValueTriangle& t) {
  const dvec2 u = dvec2(t.corners[1]) - dvec2(t.corners[0]), v = dvec2(t.corners[2]) - dvec2(t.corners[0]);
  return std::abs(u.x * v.y - u.y * v.x);
}

double sum_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum;
}

TEST(TexelSums, WholeTexelsHoldTheFunctionAtTheirMiddles) {
  // A rectangle of whole texels, as two triangles: each texel's mean of a linear function is that in its
  // middle.
  const vec2 a(1, 2), b(6, 2), c(6, 5), d(1, 5);
  const std::vector<ValueTriangle> both = {with_values(a, b, c), with_values(a, c, d)};
  const TexelSums sums = sum_texels(both, 8, 8);
  for (uint32_t y = 0; y < 8; ++y)
    for (uint32_t x = 0; x < 8; ++x) {
      const size_t i = 8 * y + x;
      const bool inside = x >= 1 && x < 6 && y >= 2 && y < 5;
      EXPECT_NEAR(sums.area[i], inside ? 1 : 0, 1e-12) << x << " " << y;
      const dvec3 expected = inside ? linear(dvec2(x + 0.5, y + 0.5)) : dvec3(0);
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(sums.value[i][k], expected[k], 1e-5) << x << " " << y;
    }
}

TEST(TexelSums, AHalfTexelIsCutWhereItIs) {
  // The lower left half of texel (0, 0): its centroid is at a third.
  const std::vector<ValueTriangle> one = {with_values({0, 0}, {1, 0}, {0, 1})};
  const TexelSums sums = sum_texels(one, 2, 2);
  EXPECT_NEAR(sums.area[0], 0.5, 1e-15);
  const dvec3 mean = sums.value[0] / sums.area[0], expected = linear(dvec2(1.0 / 3));
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(mean[k], expected[k], 1e-6);
  EXPECT_EQ(sums.area[1] + sums.area[2] + sums.area[3], 0);
}

TEST(TexelSums, NothingIsLostOrCountedTwice) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> at(0, 40);
  for (int round = 0; round < 200; ++round) {
    const ValueTriangle triangle =
        with_values({at(random), at(random)}, {at(random), at(random)}, {at(random), at(random)});
    const TexelSums sums = sum_texels(std::vector{triangle}, 40, 40);
    const double area = twice_area(triangle) / 2;
    EXPECT_NEAR(sum_of(sums.area), area, 1e-9 * std::max(1.0, area));
    dvec3 whole(0), mean(0);
    for (const dvec3& value : sums.value) whole += value;
    for (const vec3& value : triangle.values) mean += dvec3(value) / 3.0;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(whole[k], area * mean[k], 1e-4 * std::max(1.0, area));
  }
}

TEST(TexelSums, WindingDoesNotMatter) {
  const vec2 a(0.3f, 0.2f), b(7.1f, 1.9f), c(2.2f, 6.4f);
  const TexelSums one = sum_texels(std::vector{with_values(a, b, c)}, 8, 8);
  const TexelSums other = sum_texels(std::vector{with_values(a, c, b)}, 8, 8);
  for (size_t i = 0; i < one.area.size(); ++i) EXPECT_NEAR(one.area[i], other.area[i], 1e-12);
}

TEST(TexelSums, NeedlesReachEveryTexelOnTheirWay) {
  // A hair's breadth wide, across the page: without exact clipping its texels would be missed.
  const std::vector<ValueTriangle> needle = {with_values({0.5f, 0.5f}, {63.5f, 31.5f}, {63.5f, 31.501f})};
  const TexelSums sums = sum_texels(needle, 64, 32);
  size_t reached = 0;
  for (const double area : sums.area) reached += area > 0;
  EXPECT_GE(reached, 63u + 30u);
  for (size_t i = 0; i < sums.area.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      if (sums.area[i] <= 0) continue;
      const double mean = sums.value[i][k] / sums.area[i];
      EXPECT_GE(mean,
                std::min({needle[0].values[0][k], needle[0].values[1][k], needle[0].values[2][k]}) - 1e-3);
      EXPECT_LE(mean,
                std::max({needle[0].values[0][k], needle[0].values[1][k], needle[0].values[2][k]}) + 1e-3);
    }
}

TEST(TexelSums, WhatLiesBeyondThePageIsLeftOut) {
  const TexelSums sums = sum_texels(std::vector{with_values({-5, -5}, {20, -5}, {-5, 20})}, 4, 4);
  for (const double area : sums.area) EXPECT_NEAR(area, 1, 1e-12);
  const TexelSums none = sum_texels(std::vector{with_values({9, 9}, {12, 9}, {9, 12})}, 4, 4);
  EXPECT_EQ(sum_of(none.area), 0);
}

TEST(TexelSums, TrianglesWithoutAreaBringNothing) {
  const float nan = std::nanf("");
  const std::vector<ValueTriangle> broken = {with_values({1, 1}, {2, 2}, {3, 3}),
                                             with_values({1, 1}, {1, 1}, {1, 1}),
                                             {{vec2(nan), vec2(1, 0), vec2(0, 1)}, {}}};
  const TexelSums sums = sum_texels(broken, 4, 4);
  EXPECT_EQ(sum_of(sums.area), 0);
}

TEST(TexelSums, ThreadsLeaveNoTrace) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> at(0, 100);
  std::vector<ValueTriangle> many;
  for (int i = 0; i < 500; ++i)
    many.push_back(with_values({at(random), at(random)}, {at(random), at(random)}, {at(random), at(random)}));
  const auto with_threads = [&](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return sum_texels(many, 100, 100);
  };
  const TexelSums one = with_threads(1), two = with_threads(2);
  EXPECT_EQ(one.area, two.area);
  EXPECT_EQ(one.value, two.value);
}

}  // namespace
}  // namespace goldthread
