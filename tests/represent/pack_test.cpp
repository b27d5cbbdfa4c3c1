// Charts on pages: nothing touches another's texels, nor its padding, as exact geometry sees it.
#include "represent/atlas/pack.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <map>
#include <random>
#include <set>

namespace goldthread {
namespace {

const CancelToken kNever;

struct Shape {
  std::vector<UVec3> faces;
  std::vector<vec2> coordinates;

  void quad(const vec2& low, const vec2& high) {
    const auto first = uint32_t(coordinates.size());
    coordinates.insert(coordinates.end(), {low, {high.x, low.y}, high, {low.x, high.y}});
    faces.insert(faces.end(), {UVec3(first, first + 1, first + 2), UVec3(first, first + 2, first + 3)});
  }
  void triangle(const vec2& a, const vec2& b, const vec2& c) {
    const auto first = uint32_t(coordinates.size());
    coordinates.insert(coordinates.end(), {a, b, c});
    faces.push_back(UVec3(first, first + 1, first + 2));
  }
};

Shape box(float width, float height) {
  Shape shape;
  shape.quad(vec2(0), vec2(width, height));
  return shape;
}

std::vector<PackChart> charts_of(const std::vector<Shape>& shapes) {
  std::vector<PackChart> charts;
  for (const Shape& shape : shapes) charts.push_back({shape.faces, shape.coordinates, 1});
  return charts;
}

/// Whether a triangle and the closed square of texel x, y have a point in common: no line along one of their
/// edges parts them.
bool touches(const std::array<dvec2, 3>& t, double x, double y) {
  const auto parted = [&](const dvec2& axis) {
    double low = INFINITY, high = -INFINITY, least = INFINITY, most = -INFINITY;
    for (const dvec2& corner : t) {
      low = std::min(low, glm::dot(axis, corner));
      high = std::max(high, glm::dot(axis, corner));
    }
    for (const double u : {0.0, 1.0})
      for (const double v : {0.0, 1.0}) {
        least = std::min(least, glm::dot(axis, dvec2(x + u, y + v)));
        most = std::max(most, glm::dot(axis, dvec2(x + u, y + v)));
      }
    return high < least || low > most;
  };
  if (parted({1, 0}) || parted({0, 1})) return false;
  for (size_t k = 0; k < 3; ++k) {
    const dvec2 edge = t[(k + 1) % 3] - t[k];
    if (parted({-edge.y, edge.x})) return false;
  }
  return true;
}

using Texel = std::pair<int, int>;

std::set<Texel> texels_of(const PackChart& chart, const Placement& placement, float density) {
  std::set<Texel> texels;
  for (const UVec3& face : chart.faces) {
    std::array<dvec2, 3> t;
    for (int k = 0; k < 3; ++k)
      t[size_t(k)] = dvec2(place(chart, placement, density, chart.coordinates[face[k]]));
    const auto [left, right] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [bottom, top] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (int y = int(std::floor(bottom)) - 1; y <= int(std::floor(top)) + 1; ++y)
      for (int x = int(std::floor(left)) - 1; x <= int(std::floor(right)) + 1; ++x)
        if (touches(t, x, y)) texels.emplace(x, y);
  }
  return texels;
}

/// Every chart within its page, and `padding` texels between any two.
void expect_apart(std::span<const PackChart> charts, const Packing& packing, const PackOptions& options) {
  ASSERT_EQ(packing.placements.size(), charts.size());
  std::map<uint32_t, std::map<Texel, size_t>> owner;
  uint64_t touched = 0;
  for (size_t i = 0; i < charts.size(); ++i) {
    ASSERT_LT(packing.placements[i].page, packing.pages);
    for (const Texel& texel : texels_of(charts[i], packing.placements[i], packing.texels_per_metre)) {
      ASSERT_GE(std::min(texel.first, texel.second), 0) << i;
      ASSERT_LT(std::max(texel.first, texel.second), int(options.page_size)) << i;
      const auto [known, is_new] = owner[packing.placements[i].page].emplace(texel, i);
      ASSERT_TRUE(is_new || known->second == i) << "charts " << i << " and " << known->second;
      touched += is_new;
    }
  }
  const int reach = int(options.padding);
  for (const auto& [page, texels] : owner)
    for (const auto& [texel, chart] : texels)
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) {
          const auto found = texels.find({texel.first + dx, texel.second + dy});
          if (found == texels.end()) continue;
          ASSERT_EQ(found->second, chart)
              << "at " << texel.first << ", " << texel.second << " of page " << page;
        }
  // The mask may hold a little more than exact geometry, never less.
  const double all = double(options.page_size) * options.page_size * packing.pages;
  EXPECT_GE(packing.use, double(touched) / all - 1e-12);
  EXPECT_LE(packing.use, double(touched) / all * 1.1 + 0.02);
}

Shape random_shape(std::mt19937& random) {
  std::uniform_real_distribution<float> at(0.05f, 1);
  Shape shape;
  const float size = std::exp(std::normal_distribution<float>(0, 0.7f)(random));
  switch (random() % 4) {
    case 0:
      shape.quad(vec2(-size), vec2(size * at(random), size * at(random)));
      break;
    case 1:
      shape.triangle(size * vec2(at(random), at(random)), size * vec2(-at(random), at(random)),
                     size * vec2(at(random), -at(random)));
      break;
    case 2:  // an angle, with room in it
      shape.quad(vec2(0), size * vec2(1, 0.2f));
      shape.quad(vec2(0), size * vec2(0.2f, 1));
      break;
    default:  // a needle
      shape.triangle(vec2(0), size * vec2(4 * at(random), at(random)),
                     size * vec2(4 * at(random), at(random)));
  }
  return shape;
}

TEST(Pack, ChartsKeepApartWhateverTheyAre) {
  std::mt19937 random(11);
  for (int round = 0; round < 60; ++round) {
    std::vector<Shape> shapes;
    const size_t count = 1 + random() % 40;
    for (size_t i = 0; i < count; ++i) shapes.push_back(random_shape(random));
    const std::vector<PackChart> charts = charts_of(shapes);
    PackOptions options;
    options.page_size = 32 + random() % 100;
    options.padding = std::array<uint32_t, 4>{0, 1, 2, 5}[random() % 4];
    options.pages = 1 + random() % 3;
    const std::optional<Packing> packing = pack(charts, options, kNever);
    ASSERT_TRUE(packing) << round;
    expect_apart(charts, *packing, options);
    if (HasFailure()) FAIL() << "round " << round;
  }
}

TEST(Pack, SquaresThatJustFitFillThePage) {
  // Four of 15.9 texels aside on a page of 32.
  const std::vector<Shape> shapes(4, box(1, 1));
  PackOptions options;
  options.page_size = 32;
  options.padding = 0;
  options.texels_per_metre = 15.9f;
  const std::optional<Packing> packing = pack(charts_of(shapes), options, kNever);
  ASSERT_TRUE(packing);
  EXPECT_EQ(packing->texels_per_metre, 15.9f);
  EXPECT_EQ(packing->use, 1);
  EXPECT_EQ(packing->pages, 1u);
}

/// On a page of 64 texels without padding at the density asked for, 15.9 texels a unit.
void expect_fit(const std::vector<Shape>& shapes) {
  PackOptions options;
  options.page_size = 64;
  options.padding = 0;
  options.texels_per_metre = 15.9f;
  const std::optional<Packing> packing = pack(charts_of(shapes), options, kNever);
  ASSERT_TRUE(packing);
  EXPECT_EQ(packing->texels_per_metre, 15.9f);
  expect_apart(charts_of(shapes), *packing, options);
}

TEST(Pack, LongBoxesAreTurnedToFit) {
  // Round the middle, each begins where another ends: as they come, side by side, they would not fit.
  expect_fit({box(3, 1), box(1, 3), box(3, 1), box(1, 3)});
}

TEST(Pack, AnAngleHoldsABox) {
  Shape angle;
  angle.quad(vec2(0), vec2(4, 1));
  angle.quad(vec2(0), vec2(1, 4));
  expect_fit({angle, box(2.9f, 2.9f)});
}

TEST(Pack, DensityIsNeverMoreThanAskedAndFollowsThePage) {
  std::mt19937 random(5);
  std::vector<Shape> shapes;
  for (int i = 0; i < 50; ++i) shapes.push_back(random_shape(random));
  const std::vector<PackChart> charts = charts_of(shapes);
  PackOptions options;
  options.page_size = 256;
  const std::optional<Packing> free = pack(charts, options, kNever);
  ASSERT_TRUE(free);
  options.texels_per_metre = free->texels_per_metre * 0.5f;
  EXPECT_EQ(pack(charts, options, kNever)->texels_per_metre, options.texels_per_metre);
  options.texels_per_metre = free->texels_per_metre * 5;
  const std::optional<Packing> lowered = pack(charts, options, kNever);
  ASSERT_TRUE(lowered);
  EXPECT_LT(lowered->texels_per_metre, options.texels_per_metre);
  EXPECT_NEAR(lowered->texels_per_metre / free->texels_per_metre, 1, 0.1);
  options.texels_per_metre = 0;
  options.page_size = 512;
  EXPECT_NEAR(pack(charts, options, kNever)->texels_per_metre / free->texels_per_metre, 2, 0.3);
}

TEST(Pack, MorePagesOnlyWhereOneIsNotEnough) {
  const std::vector<Shape> shapes(9, box(1, 1));
  PackOptions options;
  options.page_size = 64;
  options.pages = 4;
  options.texels_per_metre = 10;
  EXPECT_EQ(pack(charts_of(shapes), options, kNever)->pages, 1u);
  options.texels_per_metre = 25;
  const std::optional<Packing> more = pack(charts_of(shapes), options, kNever);
  ASSERT_TRUE(more);
  EXPECT_EQ(more->texels_per_metre, 25);
  EXPECT_EQ(more->pages, 3u);
  expect_apart(charts_of(shapes), *more, options);
}

TEST(Pack, ScaleIsMetresAUnit) {
  const std::vector<Shape> shapes = {box(1, 1), box(1, 1)};
  std::vector<PackChart> charts = charts_of(shapes);
  charts[1].scale = 3;
  PackOptions options;
  options.page_size = 256;
  const std::optional<Packing> packing = pack(charts, options, kNever);
  ASSERT_TRUE(packing);
  const auto length_of = [&](size_t i) {
    return glm::distance(place(charts[i], packing->placements[i], packing->texels_per_metre, vec2(0)),
                         place(charts[i], packing->placements[i], packing->texels_per_metre, vec2(1, 0)));
  };
  EXPECT_NEAR(length_of(1) / length_of(0), 3, 1e-3);
}

TEST(Pack, WhatCannotFitIsRefused) {
  const std::vector<Shape> shapes(1000, box(1, 1));
  PackOptions options;
  options.page_size = 4;
  EXPECT_FALSE(pack(charts_of(shapes), options, kNever));
}

TEST(Pack, AsManyPointsAsThereIsRoomForFit) {
  // Charts far below a texel: on 10 texels with padding 2, four by four of them. One more cannot be.
  PackOptions options;
  options.page_size = 10;
  options.texels_per_metre = 0.01f;
  const std::vector<Shape> full(16, box(1, 1)), more(17, box(1, 1));
  const std::optional<Packing> packing = pack(charts_of(full), options, kNever);
  ASSERT_TRUE(packing);
  expect_apart(charts_of(full), *packing, options);
  EXPECT_FALSE(pack(charts_of(more), options, kNever));
}

TEST(Pack, NothingNeedsNoPage) {
  const std::optional<Packing> packing = pack({}, {}, kNever);
  ASSERT_TRUE(packing);
  EXPECT_EQ(packing->pages, 0u);
}

TEST(Pack, ThreadsLeaveNoTrace) {
  std::mt19937 random(8);
  std::vector<Shape> shapes;
  for (int i = 0; i < 200; ++i) shapes.push_back(random_shape(random));
  const auto with_threads = [&](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return *pack(charts_of(shapes), {}, kNever);
  };
  const Packing one = with_threads(1), two = with_threads(2);
  EXPECT_EQ(one.texels_per_metre, two.texels_per_metre);
  for (size_t i = 0; i < shapes.size(); ++i) {
    EXPECT_EQ(one.placements[i].offset, two.placements[i].offset);
    EXPECT_EQ(one.placements[i].quarter_turns, two.placements[i].quarter_turns);
  }
}

TEST(Pack, BoxesOfAllKindsLieClose) {
  std::mt19937 random(2);
  std::uniform_real_distribution<float> length(0.2f, 2);
  std::vector<Shape> shapes;
  for (int i = 0; i < 500; ++i) shapes.push_back(box(length(random), length(random)));
  const std::optional<Packing> packing = pack(charts_of(shapes), {}, kNever);
  ASSERT_TRUE(packing);
  EXPECT_GE(packing->use, 0.8);
}

}  // namespace
}  // namespace goldthread
