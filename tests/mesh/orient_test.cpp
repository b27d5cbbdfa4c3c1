#include "mesh/orient.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "mesh/dual_graph.h"
#include "mesh/shapes.h"

namespace goldthread {
namespace {

void turn(shapes::Soup& soup, size_t triangle) {
  std::swap(soup.indices[3 * triangle + 1], soup.indices[3 * triangle + 2]);
}

void turn_all(shapes::Soup& soup) {
  for (size_t t = 0; t < soup.indices.size() / 3; ++t) turn(soup, t);
}

Winding winding_of(const shapes::Soup& soup) {
  const TriangleMesh mesh = soup.weld();
  return find_winding(mesh, find_twins(mesh));
}

TEST(Orient, SoundCubeIsLeftAlone) {
  const Winding winding = winding_of(shapes::cube(3));
  ASSERT_EQ(winding.shells.size(), 1u);
  EXPECT_TRUE(winding.shells[0].closed);
  EXPECT_EQ(winding.shells[0].against, 0u);
  EXPECT_NEAR(winding.shells[0].volume, 1, 1e-6);
  EXPECT_NEAR(winding.shells[0].area, 6, 1e-6);
  const auto turned = triangles_to_turn(winding, {});
  EXPECT_EQ(std::count(turned.begin(), turned.end(), 1), 0);
}

TEST(Orient, CubeInsideOutIsTurnedUnlessItIsARoom) {
  shapes::Soup soup = shapes::cube(2);
  turn_all(soup);
  const Winding winding = winding_of(soup);
  EXPECT_TRUE(winding.shells[0].faces_inwards());
  const auto turned = triangles_to_turn(winding, {});
  EXPECT_EQ(size_t(std::count(turned.begin(), turned.end(), 1)), turned.size());
  const uint8_t room = 1;
  const auto kept = triangles_to_turn(winding, {&room, 1});
  EXPECT_EQ(std::count(kept.begin(), kept.end(), 1), 0);
}

TEST(Orient, TurnedTrianglesAreFoundWhereverTheyAre) {
  std::mt19937 random(7);
  for (int round = 0; round < 20; ++round) {
    shapes::Soup soup = round % 2 ? shapes::cube(4) : shapes::wavy_grid(9);
    const size_t count = soup.indices.size() / 3;
    std::vector<uint8_t> wrong(count, 0);
    for (size_t i = 0; i < count / 4; ++i) wrong[random() % count] = 1;
    for (size_t t = 0; t < count; ++t)
      if (wrong[t]) turn(soup, t);
    EXPECT_EQ(triangles_to_turn(winding_of(soup), {}), wrong);
  }
}

TEST(Orient, OpenShellsKeepTheirGreaterPart) {
  shapes::Soup soup = shapes::flat_grid(4);
  turn_all(soup);
  turn(soup, 5);  // now as it was: the one that differs
  const Winding winding = winding_of(soup);
  EXPECT_FALSE(winding.shells[0].closed);
  EXPECT_FALSE(winding.shells[0].faces_inwards());
  const auto turned = triangles_to_turn(winding, {});
  EXPECT_EQ(std::count(turned.begin(), turned.end(), 1), 1);
  EXPECT_EQ(turned[5], 1);
}

TEST(Orient, MoebiusStripIsLeftAlone) {
  shapes::Soup soup;
  constexpr uint32_t kSteps = 24;
  for (uint32_t i = 0; i < kSteps; ++i) {
    const float angle = 2 * kPi * float(i) / kSteps;
    for (const float side : {-0.3f, 0.3f}) {
      const float radius = 1 + side * std::cos(angle / 2);
      soup.positions.push_back(
          {radius * std::cos(angle), radius * std::sin(angle), side * std::sin(angle / 2)});
    }
  }
  for (uint32_t i = 0; i + 1 < kSteps; ++i) soup.quad(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  soup.quad(2 * kSteps - 2, 1, 0, 2 * kSteps - 1);
  const Winding winding = winding_of(soup);
  ASSERT_EQ(winding.shells.size(), 1u);
  EXPECT_FALSE(winding.shells[0].orientable);
  const auto turned = triangles_to_turn(winding, {});
  EXPECT_EQ(std::count(turned.begin(), turned.end(), 1), 0);
}

TEST(Orient, FarFromTheOriginVolumesStayRight) {
  shapes::Soup soup = shapes::cube(2);
  for (vec3& p : soup.positions) p += vec3(20000, -30000, 10000);
  EXPECT_NEAR(winding_of(soup).shells[0].volume, 1, 1e-3);
}

TEST(Orient, NothingComesOfNothing) {
  const Winding winding = find_winding({}, {});
  EXPECT_TRUE(winding.shells.empty());
  EXPECT_TRUE(triangles_to_turn(winding, {}).empty());
}

}  // namespace
}  // namespace goldthread
