// Charts: each triangle in one of them, none over another, none turned over, and little stretched.
// Coordinates are multiples of a power of two below 2^24 of them, so that signs of areas in double are exact.
#include "represent/atlas/chart.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <map>
#include <random>
#include <set>

#include "mesh/dual_graph.h"
#include "mesh/shapes.h"

namespace goldthread {
namespace {

const CancelToken kNever;

struct Charted {
  FaceClusterTree tree;
  std::vector<Chart> charts;
  ChartStats stats;

  explicit Charted(const shapes::Soup& soup, float most_stretch = 2)
      : tree(build_face_clusters(soup.weld())) {
    charts = make_charts(tree, {.most_stretch = most_stretch}, kNever, stats);
  }
  dvec3 position(uint32_t triangle, int corner) const {
    return dvec3(tree.mesh.positions[tree.mesh.triangles[triangle][corner]]);
  }
  double area(uint32_t triangle) const {
    const dvec3 a = position(triangle, 0);
    return length(cross(position(triangle, 1) - a, position(triangle, 2) - a)) / 2;
  }
};

double turn(const dvec2& a, const dvec2& b, const dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

using Flat = std::array<dvec2, 3>;

Flat flat(const Chart& chart, size_t face) {
  Flat corners;
  for (int k = 0; k < 3; ++k) corners[size_t(k)] = dvec2(chart.coordinates[chart.faces[face][k]]);
  return corners;
}

/// Whether two triangles that turn left have an inner point in common: no side of either has all of the other
/// on its right or on it.
bool overlap(const Flat& s, const Flat& t) {
  const auto parts = [](const Flat& one, const Flat& other) {
    for (size_t k = 0; k < 3; ++k) {
      bool beyond = true;
      for (const dvec2& corner : other) beyond = beyond && turn(one[k], one[(k + 1) % 3], corner) <= 0;
      if (beyond) return true;
    }
    return false;
  };
  return !parts(s, t) && !parts(t, s);
}

/// Every triangle of the mesh once; in a chart corners are one where triangles share an edge and a position,
/// and never where positions differ.
void expect_whole(const Charted& c) {
  std::set<uint32_t> seen;
  for (const Chart& chart : c.charts) {
    ASSERT_EQ(chart.faces.size(), chart.triangles.size());
    std::map<uint32_t, uint32_t> position_of;
    for (size_t i = 0; i < chart.triangles.size(); ++i) {
      ASSERT_TRUE(seen.insert(chart.triangles[i]).second);
      for (int k = 0; k < 3; ++k) {
        ASSERT_LT(chart.faces[i][k], chart.coordinates.size());
        const uint32_t position = c.tree.mesh.triangles[chart.triangles[i]][k];
        EXPECT_EQ(position_of.emplace(chart.faces[i][k], position).first->second, position);
      }
    }
  }
  EXPECT_EQ(seen.size(), c.tree.mesh.triangles.size());
}

void expect_injective(const Charted& c) {
  for (const Chart& chart : c.charts)
    for (size_t i = 0; i < chart.faces.size(); ++i) {
      const Flat one = flat(chart, i);
      ASSERT_GT(turn(one[0], one[1], one[2]), 0);
      for (size_t j = 0; j < i; ++j) ASSERT_FALSE(overlap(one, flat(chart, j))) << i << " and " << j;
    }
}

/// As large as its surface, but for what the grid takes.
void expect_areas(const Charted& c) {
  for (const Chart& chart : c.charts) {
    double surface = 0, plane = 0;
    for (size_t i = 0; i < chart.faces.size(); ++i) {
      const Flat t = flat(chart, i);
      surface += c.area(chart.triangles[i]);
      plane += turn(t[0], t[1], t[2]) / 2;
    }
    EXPECT_NEAR(plane / surface, 1, 0.2);
    EXPECT_LE(chart.stretch, 2.0001f);
  }
}

void expect_valid(const Charted& c) {
  expect_whole(c);
  expect_injective(c);
  expect_areas(c);
}

TEST(Charts, AFlatGridIsOneChartAndKeepsItsLengths) {
  const Charted c(shapes::flat_grid(8));
  ASSERT_EQ(c.charts.size(), 1u);
  expect_valid(c);
  EXPECT_NEAR(c.charts[0].stretch, 1, 1e-5);
  for (size_t i = 0; i < c.charts[0].faces.size(); ++i) {
    const Flat t = flat(c.charts[0], i);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(
          length(t[size_t(k)] - t[size_t(k + 1) % 3]),
          length(c.position(c.charts[0].triangles[i], k) - c.position(c.charts[0].triangles[i], (k + 1) % 3)),
          1e-5);
  }
}

TEST(Charts, ACubeIsUnfoldedWithoutMuchStretch) {
  const Charted c(shapes::cube(4));
  expect_valid(c);
  EXPECT_LE(c.charts.size(), 6u);
  EXPECT_NEAR(c.stats.area, 6, 1e-4);
}

TEST(Charts, WhatCanBeUnrolledIsNotStretched) {
  // Half a cylinder, and a quarter of a cone.
  shapes::Soup half = shapes::flat_grid(16);
  for (vec3& p : half.positions) p = vec3(std::cos(kPi * p.x), p.y, std::sin(kPi * p.x));
  const Charted cylinder(half);
  expect_valid(cylinder);
  ASSERT_EQ(cylinder.charts.size(), 1u);
  EXPECT_NEAR(cylinder.charts[0].stretch, 1, 0.01);
  shapes::Soup quarter = shapes::flat_grid(16);
  for (vec3& p : quarter.positions) {
    const float radius = 0.5f + p.y, angle = kPi / 2 * p.x;
    p = vec3(radius * std::cos(angle), radius, radius * std::sin(angle));
  }
  const Charted cone(quarter);
  expect_valid(cone);
  ASSERT_EQ(cone.charts.size(), 1u);
  EXPECT_NEAR(cone.charts[0].stretch, 1, 0.02);
}

TEST(Charts, ASphereIsCutUntilItsPiecesLieFlat) {
  const Charted c(shapes::sphere(24));
  expect_valid(c);
  EXPECT_GE(c.charts.size(), 2u);
  EXPECT_LE(c.charts.size(), 24u);
  const Charted strict(shapes::sphere(24), 1.1f);
  expect_valid(strict);
  EXPECT_GT(strict.charts.size(), c.charts.size());
  for (const Chart& chart : strict.charts) EXPECT_LE(chart.stretch, 1.1001f);
}

TEST(Charts, WhatHasOneSideIsCut) {
  const Charted c(shapes::moebius(24));
  expect_valid(c);
  EXPECT_GE(c.charts.size(), 2u);
}

TEST(Charts, HolesStayHoles) {
  // A frame: a grid without its middle.
  shapes::Soup frame = shapes::flat_grid(6);
  std::vector<uint32_t> kept;
  for (size_t i = 0; i < frame.indices.size(); i += 6) {
    const size_t quad = i / 6, x = quad % 6, y = quad / 6;
    if (x > 1 && x < 4 && y > 1 && y < 4) continue;
    kept.insert(kept.end(), frame.indices.begin() + std::ptrdiff_t(i),
                frame.indices.begin() + std::ptrdiff_t(i + 6));
  }
  frame.indices = kept;
  const Charted c(frame);
  expect_valid(c);
  EXPECT_EQ(c.charts.size(), 1u);
}

TEST(Charts, ASpiralRampThatLiesOverItselfIsCut) {
  // Two and a half turns: each triangle could lie flat, all of them together would lie on each other.
  shapes::Soup ramp = shapes::grid(60, [](float, float) { return 0.0f; });
  for (vec3& p : ramp.positions) {
    const float angle = 5 * kPi * p.x, radius = 1 + p.y;
    p = vec3(radius * std::cos(angle), radius * std::sin(angle), 0.02f * angle);
  }
  const Charted c(ramp);
  expect_valid(c);
  EXPECT_GE(c.charts.size(), 3u);
  EXPECT_LE(c.charts.size(), 12u);
  EXPECT_GT(c.stats.overlapping, 0u);
}

TEST(Charts, WhatLeavesTooMuchOfItsBoxFreeIsDivided) {
  // A thin cross: most of its box is empty.
  shapes::Soup cross = shapes::flat_grid(9);
  std::vector<uint32_t> kept;
  for (size_t i = 0; i < cross.indices.size(); i += 6)
    if (i / 6 % 9 == 4 || i / 6 / 9 == 4)
      kept.insert(kept.end(), cross.indices.begin() + std::ptrdiff_t(i),
                  cross.indices.begin() + std::ptrdiff_t(i + 6));
  cross.indices = kept;
  EXPECT_EQ(Charted(cross).charts.size(), 1u);
  const FaceClusterTree tree = build_face_clusters(cross.weld());
  ChartStats stats;
  const std::vector<Chart> charts = make_charts(tree, {2, 0.3f}, kNever, stats);
  EXPECT_GE(charts.size(), 2u);
  EXPECT_GT(stats.sprawling, 0u);
  for (const Chart& chart : charts) {
    vec2 high(0);
    double area = 0;
    for (const vec2& at : chart.coordinates) high = glm::max(high, at);
    for (const uint32_t t : chart.triangles) {
      const UVec3& c = tree.mesh.triangles[t];
      area += double(
          length(area_vector(tree.mesh.positions[c.x], tree.mesh.positions[c.y], tree.mesh.positions[c.z])));
    }
    EXPECT_LE(double(high.x * high.y) - area, 0.3 + 1e-5);
  }
}

TEST(Charts, SizeAndPoseDoNotMatter) {
  const shapes::Soup plain = shapes::wavy_grid(12);
  const Charted before(plain);
  for (const float scale : {1e-3f, 1e3f}) {
    shapes::Soup moved = plain;
    const mat3 turned(glm::mat4_cast(glm::angleAxis(0.7f, normalize(vec3(1, 2, 3)))));
    for (vec3& p : moved.positions) p = scale * (turned * p + vec3(0.2f, -0.1f, 0.4f));
    const Charted after(moved);
    expect_valid(after);
    ASSERT_EQ(after.charts.size(), before.charts.size());
    EXPECT_NEAR(after.stats.most_stretch, before.stats.most_stretch, 1e-3);
    EXPECT_NEAR(after.stats.area / (double(scale) * double(scale)), before.stats.area, 1e-3);
  }
}

TEST(Charts, AThousandMeshesOfAllKinds) {
  std::mt19937 random(1);
  for (uint32_t round = 0; round < 1000; ++round) {
    shapes::Soup soup;
    switch (round % 5) {
      case 0:
        soup = shapes::random_soup(round, 1 + random() % 40, 3 + random() % 20);
        break;
      case 1: {  // a torn and crumpled sheet
        const float crumple = 0.02f * float(random() % 20);
        soup = shapes::grid(3 + random() % 8,
                            [&](float, float) { return crumple * float(random() % 100) / 100; });
        for (size_t i = soup.indices.size(); i >= 3; i -= 3)
          if (random() % 6 == 0)
            soup.indices.erase(soup.indices.begin() + std::ptrdiff_t(i - 3),
                               soup.indices.begin() + std::ptrdiff_t(i));
        break;
      }
      case 2:  // a ball that is dented, some of its triangles turned over
        soup = shapes::sphere(3 + random() % 6);
        for (vec3& p : soup.positions) p *= 1 - 0.3f * float(random() % 100) / 100;
        for (size_t i = 0; i + 2 < soup.indices.size(); i += 3)
          if (random() % 10 == 0) std::swap(soup.indices[i], soup.indices[i + 1]);
        break;
      case 3:  // needles
        soup = shapes::strip(4 + random() % 30);
        for (vec3& p : soup.positions) p = vec3(p.x * 100, p.y * 1e-4f, float(random() % 10) * 1e-5f);
        break;
      default:
        soup = round % 2 ? shapes::spiked_plate(3 + random() % 5) : shapes::fan(3 + random() % 30);
    }
    const Charted c(soup);
    expect_whole(c);
    expect_injective(c);
    if (HasFailure()) FAIL() << "mesh " << round;
  }
}

TEST(Charts, ThreadsLeaveNoTrace) {
  const auto with_threads = [](size_t threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    return Charted(shapes::sphere(40)).charts;
  };
  const std::vector<Chart> one = with_threads(1), two = with_threads(2);
  ASSERT_EQ(one.size(), two.size());
  for (size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].triangles, two[i].triangles);
    EXPECT_EQ(one[i].coordinates, two[i].coordinates);
  }
}

TEST(Charts, NothingHasNone) {
  EXPECT_TRUE(Charted(shapes::Soup()).charts.empty());
}

}  // namespace
}  // namespace goldthread
