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
  std::vector<std::pair<uint32_t, uint32_t>> coincident() const {
    return find_coincident(positions, triangles, caster());
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
  EXPECT_EQ(world.coincident(), (Pairs{{0, 2}, {0, 3}, {1, 2}, {1, 3}}));
}

TEST(Coincident, ASmallPlateInTheMiddleOfAWall) {
  World world;
  world.quad({0, 0, 0}, {10, 0, 0}, {0, 10, 0});
  world.quad({6, 2, 0}, {0.1f, 0, 0}, {0, 0.1f, 0});  // beneath the wall's diagonal
  EXPECT_EQ(world.coincident(), (Pairs{{0, 2}, {0, 3}}));
}

TEST(Coincident, WhicheverWayTheyFace) {
  World world;
  world.quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  world.quad({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, true);
  EXPECT_EQ(world.coincident().size(), 4u);
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
