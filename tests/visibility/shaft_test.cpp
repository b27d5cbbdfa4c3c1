// Shafts against rays: where a shaft is clear no ray between the two may be stopped, and it is clear where
// nothing is near.
#include "visibility/shaft.h"

#include <gtest/gtest.h>

#include <random>

#include "visibility/ray_caster.h"
#include "visibility/triangle_tree.h"

namespace goldthread {
namespace {

constexpr float kEpsilon = 1e-5f;

vec3 random_vector(std::mt19937& random, float size) {
  std::uniform_real_distribution<float> u(-size, size);
  return {u(random), u(random), u(random)};
}

std::vector<vec3> random_square(std::mt19937& random, const vec3& centre, float size) {
  const vec3 u = size * normalize(random_vector(random, 1)),
             v = size * normalize(cross(u, random_vector(random, 1)));
  return {centre - u - v, centre + u - v, centre + u + v, centre - u + v};
}

vec3 somewhere(std::mt19937& random, const std::vector<vec3>& square) {
  std::uniform_real_distribution<float> u(0, 1);
  return square[0] + u(random) * (square[1] - square[0]) + u(random) * (square[3] - square[0]);
}

TEST(Shaft, WhatIsClearLetsEveryRayThrough) {
  std::mt19937 random(1);
  int clear = 0, met = 0;
  for (int i = 0; i < 3000; ++i) {
    const std::vector<vec3> a = random_square(random, random_vector(random, 1), 0.5f),
                            b = random_square(random, vec3(4, 0, 0) + random_vector(random, 1), 0.5f);
    std::vector<vec3> corners;
    std::vector<UVec3> triangles;
    for (uint32_t t = 0; t < 4; ++t) {
      const vec3 at = vec3(2, 0, 0) + random_vector(random, 2);
      for (int k = 0; k < 3; ++k) corners.push_back(at + random_vector(random, 0.5f));
      triangles.emplace_back(3 * t, 3 * t + 1, 3 * t + 2);
    }
    const TriangleTree tree(corners, triangles);
    const RayCaster caster(corners, triangles);
    const bool is_clear = tree.is_clear(Shaft(a, b, kEpsilon));
    bool stopped = false;
    for (int r = 0; r < 200; ++r) {
      const vec3 p = somewhere(random, a), q = somewhere(random, b);
      stopped |= caster.transmittance({p, q - p, 0, 1}) == 0;
    }
    EXPECT_FALSE(is_clear && stopped) << i;
    clear += is_clear;
    met += stopped;
  }
  // And it says so in most cases where it could: rays here miss some that stand in the way, too.
  EXPECT_GT(met, 300);
  EXPECT_GT(clear, 0.8 * (3000 - met));
}

TEST(Shaft, WallsThatTouchItsSidesAreOutside) {
  // Floor and ceiling of a corridor, and its walls.
  const std::vector<vec3> floor{{0, 0, 0}, {1, 0, 0}, {1, 5, 0}, {0, 5, 0}},
      ceiling{{0, 0, 2}, {0, 5, 2}, {1, 5, 2}, {1, 0, 2}};
  const std::vector<vec3> corners{{0, 0, 0}, {0, 5, 0},    {0, 0, 2},    {1, 0, 0},
                                  {1, 5, 0}, {1, 0, 2},    {0, 0, 0},    {1, 0, 0},
                                  {0, 5, 0}, {0.5f, 2, 1}, {0.6f, 2, 1}, {0.5f, 2.1f, 1}};
  const std::vector<UVec3> walls{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}}, hanging{{9, 10, 11}};
  EXPECT_TRUE(TriangleTree(corners, walls).is_clear(Shaft(floor, ceiling, kEpsilon)));
  EXPECT_FALSE(TriangleTree(corners, hanging).is_clear(Shaft(floor, ceiling, kEpsilon)));
}

TEST(Shaft, CapsLeaveOutWhatIsBehind) {
  // Two squares whose planes cross: the hull reaches below both.
  const std::vector<vec3> floor{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}},
      tilted{{3, 0, -1}, {3, 2, -1}, {3, 2, 1}, {3, 0, 1}};
  const std::vector<vec3> corners{{2.4f, 0.5f, -0.3f}, {2.6f, 0.5f, -0.3f}, {2.5f, 1.5f, -0.2f}};
  const std::vector<UVec3> below{{0, 1, 2}};
  const TriangleTree tree(corners, below);
  Shaft shaft(floor, tilted, kEpsilon);
  EXPECT_FALSE(tree.is_clear(shaft));
  shaft.add_cap({0, 0, 0}, {0, 0, 1});
  EXPECT_TRUE(tree.is_clear(shaft));
}

TEST(TriangleTree, NothingIsClear) {
  EXPECT_TRUE(
      TriangleTree({}, {}).is_clear(Shaft(std::vector<vec3>{{0, 0, 0}}, std::vector<vec3>{{1, 0, 0}}, 0)));
}

}  // namespace
}  // namespace goldthread
