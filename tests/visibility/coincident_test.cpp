// Triangles in one place, and the query they are found by.
#include "visibility/coincident.h"

#include <gtest/gtest.h>

#include <set>

namespace goldthread {
namespace {

struct World {
  std::vector<vec3> positions;
  std::vector<UVec3> triangles;

  /// A parallelogram of two triangles; `other_way` cuts it along its other diagonal.
  void quad(const vec3& corner, const vec3& across, const vec3& up, bool other_way = false) {
    const auto n = uint32_t(positions.size());
    positions.insert(positions.end(), {corner, corner + across, corner + across + up, corner + up});
    if (other_way) {
      triangles.insert(triangles.end(), {{n, n + 1, n + 3}, {n + 1, n + 2, n + 3}});
    } else {
      triangles.insert(triangles.end(), {{n, n + 1, n + 2}, {n, n + 2, n + 3}});
    }
  }
  RayCaster caster() const { return {positions, triangles}; }
  /// All contend, and the lower number owns.
  std::vector<std::pair<uint32_t, uint32_t>> coincident() const {
    return coincident({[](uint32_t) { return true; }, [](uint32_t a, uint32_t b) { return a < b; }});
  }
  std::vector<std::pair<uint32_t, uint32_t>> coincident(const PlaceClaims& claims) const {
    return find_coincident(positions, triangles, caster(), claims, CancelToken());
  }
};

using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;

TEST(RayCasterNear, VisitsWhatIsWithinTheRadius) {
  World world;
  for (int k = 0; k < 50; ++k) world.quad({0, 0, float(k)}, {1, 0, 0}, {0, 1, 0});
  const RayCaster caster = world.caster();
  std::set<uint32_t> seen;
  caster.near({0.3f, 0.4f, 2.1f}, 0.2f, [&](uint32_t t) { seen.insert(t); });
  EXPECT_TRUE(seen.contains(4) && seen.contains(5));
  EXPECT_LT(seen.size(), 20u);
}

TEST(RayCasterNear, NumbersSeeThroughTrianglesAsGiven) {
  World world;
  world.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  world.quad({0, 0, 1}, {1, 0, 0}, {0, 1, 0});
  const std::vector<uint8_t> see_through{1, 1, 0, 0};
  const RayCaster caster(world.positions, world.triangles, see_through,
                         [](uint32_t, vec2, const Ray&) { return 1.0f; });
  for (const float z : {0.0f, 1.0f}) {
    std::set<uint32_t> seen;
    caster.near({0.4f, 0.4f, z}, 0.1f, [&](uint32_t t) { seen.insert(t); });
    // Its neighbours may come, too.
    EXPECT_TRUE(seen.contains(z > 0 ? 2 : 0) && seen.contains(z > 0 ? 3 : 1));
  }
}

TEST(RayCasterEpsilon, GrowsWithTheWorldAndItsDistanceFromTheOrigin) {
  World small, large, far;
  small.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  large.quad({0, 0, 0}, {100, 0, 0}, {0, 100, 0});
  far.quad({5000, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(large.caster().epsilon() / small.caster().epsilon(), 100, 0.1);
  // At 5000 single precision steps by 0.0005.
  EXPECT_GT(far.caster().epsilon(), 0.001f);
}

TEST(Coincident, TheSameQuadCutBothWays) {
  World world;
  world.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  world.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0}, true);
  EXPECT_EQ(world.coincident(), (Pairs{{2, 0}, {2, 1}, {3, 0}, {3, 1}}));
}

TEST(Coincident, ASmallPlateInTheMiddleOfAWall) {
  World world;
  world.quad({0, 0, 0}, {10, 0, 0}, {0, 10, 0});
  world.quad({6, 2, 0}, {0.1f, 0, 0}, {0, 0.1f, 0});  // beneath the wall's diagonal
  EXPECT_EQ(world.coincident(), (Pairs{{2, 0}, {3, 0}}));
}

TEST(Coincident, WhicheverWayTheyFace) {
  World world;
  world.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  world.quad({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, true);
  EXPECT_EQ(world.coincident().size(), 4u);
}

TEST(Coincident, CopiesBelongToTheBestOfThemAndToNoOther) {
  World world;
  constexpr uint32_t kCopies = 300;
  for (uint32_t k = 0; k < kCopies; ++k) world.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  const Pairs pairs = world.coincident();
  ASSERT_EQ(pairs.size(), 2 * (kCopies - 1));  // not a pair for every two of them
  for (const auto& [covered, owner] : pairs) EXPECT_EQ(owner, covered % 2);
}

TEST(Coincident, WhatAnOwnerLeavesOpenBelongsToTheNext) {
  World world;
  world.quad({0, 0, 0}, {1, 0, 0}, {0, 4, 0});  // owns what it covers
  world.quad({0, 0, 0}, {2, 0, 0}, {0, 4, 0});  // and this what is left of the widest
  world.quad({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
  const Pairs pairs = world.coincident();
  const auto has = [&](uint32_t first, uint32_t second) {
    return std::find(pairs.begin(), pairs.end(), std::pair(first, second)) != pairs.end();
  };
  EXPECT_TRUE(has(2, 0) && has(3, 1));
  EXPECT_TRUE(has(4, 2) || has(4, 3));
  for (const auto& [covered, owner] : pairs) EXPECT_GT(covered, owner);
}

TEST(Coincident, OnlyContendersCount) {
  World world;
  for (int k = 0; k < 3; ++k) world.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  const Pairs pairs =
      world.coincident({[](uint32_t t) { return t >= 2; }, [](uint32_t a, uint32_t b) { return a > b; }});
  EXPECT_EQ(pairs, (Pairs{{2, 4}, {3, 5}}));
}

TEST(Coincident, FacesThatNeitherBeatTheOtherBothStay) {
  World world;
  for (int k = 0; k < 4; ++k) world.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  // Even quads face up, odd ones down.
  const auto beats = [](uint32_t a, uint32_t b) { return a < b && a / 2 % 2 == b / 2 % 2; };
  const Pairs pairs = world.coincident({[](uint32_t) { return true; }, beats});
  EXPECT_EQ(pairs, (Pairs{{4, 0}, {5, 1}, {6, 2}, {7, 3}}));
}

TEST(Coincident, StopsWhenCancelled) {
  World world;
  for (int k = 0; k < 3; ++k) world.quad({0, 0, 0}, {2, 0, 0}, {0, 1, 0});
  CancelToken stop;
  stop.cancel();
  const PlaceClaims claims{[](uint32_t) { return true; }, [](uint32_t a, uint32_t b) { return a < b; }};
  EXPECT_TRUE(find_coincident(world.positions, world.triangles, world.caster(), claims, stop).empty());
}

TEST(Coincident, NeitherNeighboursNorNearbyNorCrossing) {
  World world;
  world.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});       // with its own other half
  world.quad({1, 0, 0}, {1, 0, 0}, {0, 1, 0});       // beside it
  world.quad({0, 0, 0.001f}, {1, 0, 0}, {0, 1, 0});  // a millimetre above
  world.quad({0, 0.3f, -1}, {1, 0, 0}, {0, 0, 2});   // through both
  EXPECT_EQ(world.coincident(), Pairs{});
}

}  // namespace
}  // namespace goldthread
