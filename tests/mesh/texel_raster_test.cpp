#include "mesh/texel_raster.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>
#include <set>
#include <vector>

namespace goldthread {
namespace {

using Corners = std::array<vec2, 3>;

double area_of(const Corners& t) {
  const dvec2 u(t[1] - t[0]), v(t[2] - t[0]);
  return std::abs(u.x * v.y - u.y * v.x) / 2;
}

Corners turned(const Corners& t) {
  return {t[0], t[2], t[1]};
}

/// Fourths of texels, so that many centres lie on corners and edges.
vec2 on_lattice(uint32_t side) {
  const auto quarter = [&] { return float(*rc::gen::inRange(0, int(4 * side) + 1)) / float(4 * side); };
  const float u = quarter();
  return {u, quarter()};
}

TEST(TexelRaster, HoldsAsManyTexelsAsItsArea) {
  const Corners t = {vec2(0.113f, 0.072f), vec2(0.921f, 0.317f), vec2(0.402f, 0.877f)};
  for (const auto& [width, height] : {std::pair(64u, 64u), std::pair(300u, 100u), std::pair(1000u, 700u)})
    for (const Corners& corners : {t, turned(t)}) {
      const TexelRaster raster = rasterise_texels(std::vector{corners}, width, height);
      // Along the sides, some 2.4 long, a centre is in or out by chance: a root of their number off, times
      // four.
      const double texels = area_of(corners) * width * height, chance = std::sqrt(2.4 * width);
      EXPECT_NEAR(double(raster.texels.size()), texels, 4 * chance) << width;
      EXPECT_EQ(raster.overlapping + raster.outside + raster.without_area, 0u);
    }
}

TEST(TexelRaster, WeightsLeadBackToTheCentre) {
  const Corners t = {vec2(0.9f, 0.1f), vec2(0.2f, 0.3f), vec2(0.5f, 0.95f)};
  const TexelRaster raster = rasterise_texels(std::array{turned(t), t}, 40, 90);
  ASSERT_GT(raster.texels.size(), 500u);
  std::set<std::pair<uint32_t, uint32_t>> seen;
  for (const CoveredTexel& texel : raster.texels) {
    EXPECT_EQ(texel.triangle, 0u);
    EXPECT_TRUE(seen.emplace(texel.x, texel.y).second);
    const vec2 w = texel.weights;
    EXPECT_GE(std::min({w.x, w.y, 1 - w.x - w.y}), -1e-6f);
    const vec2 uv = (1 - w.x - w.y) * t[0] + w.x * t[2] + w.y * t[1];
    EXPECT_NEAR(uv.x, (float(texel.x) + 0.5f) / 40, 1e-6f);
    EXPECT_NEAR(uv.y, (float(texel.y) + 0.5f) / 90, 1e-6f);
  }
}

// Four triangles about a point make up the square, whichever way each runs: every texel once, and none twice.
RC_GTEST_PROP(TexelRaster, NeighboursShareNoTexelAndLeaveNone, ()) {
  const auto side = *rc::gen::inRange(1u, 12u);
  const vec2 middle = on_lattice(side);
  const std::array<vec2, 4> corners = {vec2(0), vec2(1, 0), vec2(1), vec2(0, 1)};
  std::vector<Corners> fan;
  for (size_t k = 0; k < 4; ++k) {
    const Corners t = {middle, corners[k], corners[(k + 1) % 4]};
    fan.push_back(*rc::gen::arbitrary<bool>() ? t : turned(t));
  }
  const TexelRaster raster = rasterise_texels(fan, side, side);
  RC_ASSERT(raster.texels.size() == size_t{side} * side);
  RC_ASSERT(raster.overlapping == 0u);
  RC_ASSERT(raster.outside == 0u);
}

// Either side of a cut a triangle's parts have its texels.
RC_GTEST_PROP(TexelRaster, CutsChangeNothing, ()) {
  const auto side = *rc::gen::inRange(1u, 12u);
  const vec2 a = on_lattice(side), b = on_lattice(side), c = on_lattice(side);
  const vec2 middle = (a + b) / 2.0f;  // exact: eighths
  const Corners whole = {a, b, c};
  const std::array<Corners, 2> parts = {Corners{a, middle, c}, Corners{middle, b, c}};
  const TexelRaster one = rasterise_texels(std::vector{whole}, side, side);
  const TexelRaster two = rasterise_texels(parts, side, side);
  RC_ASSERT(one.texels.size() == two.texels.size());
  RC_ASSERT(two.overlapping == 0u);
  for (size_t i = 0; i < one.texels.size(); ++i)
    RC_ASSERT(one.texels[i].x == two.texels[i].x && one.texels[i].y == two.texels[i].y);
}

TEST(TexelRaster, OfOverlappingTrianglesTheFirstWins) {
  const Corners lower = {vec2(0), vec2(1, 0), vec2(0, 1)};
  const std::array three = {lower, Corners{vec2(0), vec2(1, 0), vec2(1)},
                            Corners{vec2(1), vec2(0, 1), vec2(1)}};
  const TexelRaster raster = rasterise_texels(three, 8, 8);
  size_t first = 0, second = 0;
  for (const CoveredTexel& t : raster.texels) {
    first += t.triangle == 0;
    second += t.triangle == 1;
    EXPECT_TRUE(t.triangle == 0u || t.x + t.y >= 7);
  }
  EXPECT_EQ(raster.overlapping, 1u);
  EXPECT_EQ(raster.without_area, 1u);
  EXPECT_NEAR(double(first), 32, 4);
  EXPECT_NEAR(double(second), 16, 4);
  EXPECT_EQ(first + second, raster.texels.size());
}

TEST(TexelRaster, WhatLiesOutsideIsCountedAndCut) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), huge = std::numeric_limits<float>::max();
  const std::array triangles = {
      Corners{vec2(-1), vec2(3, -1), vec2(-1, 3)},  // all of the square
      Corners{vec2(2), vec2(3, 2), vec2(2, 3)}, Corners{vec2(0), vec2(nan, 0), vec2(1)},
      Corners{vec2(0), vec2(huge, 0), vec2(0, -huge)}, Corners{vec2(0), vec2(0.5f), vec2(1)}};
  const TexelRaster raster = rasterise_texels(triangles, 5, 3);
  EXPECT_EQ(raster.texels.size(), 15u);
  EXPECT_EQ(raster.outside, 3u);
  EXPECT_EQ(raster.without_area, 2u);
  EXPECT_EQ(raster.overlapping, 0u);
  // Rounding in an unwrapper's favour: nothing is lost, nothing is said.
  EXPECT_EQ(
      rasterise_texels(std::vector{Corners{vec2(-1e-6f), vec2(1.000001f, 0), vec2(0, 1)}}, 64, 64).outside,
      0u);
}

TEST(TexelRaster, ASingleTexel) {
  const TexelRaster raster =
      rasterise_texels(std::vector{Corners{vec2(0.4f), vec2(0.7f, 0.4f), vec2(0.4f, 0.7f)}}, 1, 1);
  ASSERT_EQ(raster.texels.size(), 1u);
  EXPECT_NEAR(raster.texels[0].weights.x, 1 / 3.0f, 1e-6f);
  EXPECT_NEAR(raster.texels[0].weights.y, 1 / 3.0f, 1e-6f);
  EXPECT_TRUE(rasterise_texels({}, 4, 4).texels.empty());
}

}  // namespace
}  // namespace goldthread
