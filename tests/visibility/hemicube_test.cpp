#include "visibility/hemicube.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "math/form_factor.h"
#include "math/shared_cases.h"

namespace goldthread {
namespace {

struct World {
  std::vector<vec3> positions;
  std::vector<UVec3> triangles;

  void triangle(const vec3& a, const vec3& b, const vec3& c) {
    const auto n = uint32_t(positions.size());
    positions.insert(positions.end(), {a, b, c});
    triangles.push_back({n, n + 1, n + 2});
  }
  /// A convex polygon, as a fan.
  void polygon(const std::vector<vec3>& corners) {
    for (size_t i = 1; i + 1 < corners.size(); ++i) triangle(corners[0], corners[i], corners[i + 1]);
  }
  /// A room with walls that face inwards: floor first, then ceiling.
  void room(const vec3& low, const vec3& high) {
    const auto at = [&](int x, int y, int z) {
      return vec3(x != 0 ? high.x : low.x, y != 0 ? high.y : low.y, z != 0 ? high.z : low.z);
    };
    polygon({at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0)});
    polygon({at(0, 0, 1), at(0, 1, 1), at(1, 1, 1), at(1, 0, 1)});
    polygon({at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1)});
    polygon({at(1, 0, 0), at(1, 0, 1), at(1, 1, 1), at(1, 1, 0)});
    polygon({at(0, 0, 0), at(0, 0, 1), at(1, 0, 1), at(1, 0, 0)});
    polygon({at(0, 1, 0), at(1, 1, 0), at(1, 1, 1), at(0, 1, 1)});
  }
  RayCaster caster() const { return {positions, triangles}; }
  /// Unoccluded, from the front.
  double exact(uint32_t t, const vec3& x, const vec3& n) const {
    const std::vector<vec3> corners{positions[triangles[t].x], positions[triangles[t].y],
                                    positions[triangles[t].z]};
    return double(dot(n, polygon_form_factor(x, n, corners)));
  }
  double exact_behind(uint32_t t, const vec3& x, const vec3& n) const {
    const std::vector<vec3> corners{positions[triangles[t].x], positions[triangles[t].z],
                                    positions[triangles[t].y]};
    return double(dot(n, polygon_form_factor(x, n, corners)));
  }
};

struct Random {
  std::mt19937 engine;
  float in(float low, float high) {
    return low + (high - low) * static_cast<float>(engine() >> 8) * 0x1p-24f;
  }
  vec3 point() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
  vec3 direction() {
    for (;;)
      if (const vec3 p = point(); length(p) > 0.1f && length(p) < 1) return normalize(p);
  }
  /// One triangle, anywhere over or beside the point at zero but not at it, partly below the horizon z = 0.
  World one_triangle() {
    World world;
    const vec3 centre(in(-1, 1), in(-1, 1), in(0.2f, 1.5f));
    do {
      world = {};
      world.triangle(centre + 0.7f * point(), centre + 0.7f * point(), centre + 0.7f * point());
    } while (factor(world) < 0.002);
    return world;
  }
  static double factor(const World& world) {
    const vec3 x(0), n(0, 0, 1);
    return world.exact(0, x, n) + world.exact_behind(0, x, n);
  }
};

const vec3 kUp(0, 0, 1);

double total(const HemisphereScan& scan) {
  double sum = scan.environment + scan.missing;
  for (const SeenShare& share : scan.seen) sum += share.front + share.back;
  return sum;
}

SeenShare share_of(const HemisphereScan& scan, uint32_t triangle) {
  for (const SeenShare& share : scan.seen)
    if (share.triangle == triangle) return share;
  return {triangle};
}

TEST(Hemicube, EmptyWorldIsAllEnvironment) {
  const RayCaster caster({}, {});
  for (const uint32_t across : {1u, 3u}) {
    const DirectionGrid plane = DirectionGrid::single_plane(9, 2);
    const HemisphereScan scan = scan_hemisphere(caster, plane, vec3(0), kUp, {across});
    EXPECT_TRUE(scan.seen.empty());
    EXPECT_NEAR(scan.environment + plane.missing(), 1, 1e-12);
    EXPECT_EQ(scan.missing, plane.missing());
    EXPECT_EQ(scan.environment_error, 0);
    EXPECT_EQ(scan.rays, 81u * across * across);
  }
}

TEST(Hemicube, FrontsAndBacksAreKeptApart) {
  World world;
  world.triangle({-1, -1, 1}, {1, -1, 1}, {0, 1, 1});  // faces up: seen from behind
  world.triangle({-1, -1, 3}, {0, 1, 3}, {1, -1, 3});
  world.triangle({-9, -9, 4}, {0, 9, 4}, {9, -9, 4});
  const HemisphereScan scan = scan_hemisphere(world.caster(), DirectionGrid::hemicube(64), vec3(0), kUp, {2});
  EXPECT_EQ(share_of(scan, 0).front, 0);
  EXPECT_NEAR(share_of(scan, 0).back, world.exact_behind(0, vec3(0), kUp), share_of(scan, 0).error);
  EXPECT_EQ(share_of(scan, 1).front + share_of(scan, 1).back, 0);  // in the first one's shadow
  EXPECT_EQ(share_of(scan, 2).back, 0);
  EXPECT_NEAR(share_of(scan, 2).front, world.exact(2, vec3(0), kUp) - world.exact_behind(0, vec3(0), kUp),
              share_of(scan, 2).error);
  EXPECT_NEAR(scan.environment, 1 - world.exact(2, vec3(0), kUp), scan.environment_error);
  EXPECT_NEAR(total(scan), 1, 1e-12);
}

TEST(Hemicube, ABlendTakesItsShareOfTheRays) {
  World world;
  world.triangle({-1, -1, 1}, {0, 1, 1}, {1, -1, 1});
  const std::vector<uint8_t> see_through{1};
  const RayCaster caster(world.positions, world.triangles, see_through,
                         [](uint32_t, vec2, const Ray&) { return 0.75f; });
  const HemisphereScan scan = scan_hemisphere(caster, DirectionGrid::hemicube(64), vec3(0), kUp, {3});
  EXPECT_NEAR(share_of(scan, 0).front, 0.25 * world.exact(0, vec3(0), kUp), 1.5 * share_of(scan, 0).error);
  EXPECT_GT(share_of(scan, 0).error, 0);
}

TEST(Hemicube, RowsOfAClosedRoomSumToOne) {
  World world;
  world.room({-1, -2, 0}, {3, 2, 2.5f});
  const RayCaster caster = world.caster();
  Random random{std::mt19937(5)};
  for (uint32_t i = 0; i < 20; ++i) {
    const vec3 x(random.in(-0.9f, 2.9f), random.in(-1.9f, 1.9f), 0);
    for (const DirectionGrid& grid :
         {DirectionGrid::hemicube(10 + i), DirectionGrid::cubic_tetrahedron(10 + i)}) {
      const HemisphereScan scan = scan_hemisphere(caster, grid, x, kUp, {1 + i % 3, 0.3f * float(i), i});
      double fronts = 0;
      for (const SeenShare& share : scan.seen) {
        fronts += share.front;
        EXPECT_GE(share.triangle, 2u);  // not the floor that it lies on
        EXPECT_EQ(share.back, 0);
      }
      EXPECT_NEAR(fronts, 1, 1e-12);
      EXPECT_EQ(scan.environment, 0);
    }
  }
}

TEST(Hemicube, SinglePlaneSeesAPolygonAndMissesTheRest) {
  World world;
  world.polygon({{-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}, {1, -1, 1}});  // what a plane of half width 1 sees
  const RayCaster caster = world.caster();
  const vec3 close(0, 0, 0.5f);
  for (const double half_width : {0.5, 1.0, 1.9}) {
    const DirectionGrid grid = DirectionGrid::single_plane(64, half_width);
    const HemisphereScan scan = scan_hemisphere(caster, grid, close, kUp);
    EXPECT_NEAR(scan.environment, 0, 1e-12);
    EXPECT_NEAR(share_of(scan, 0).front + share_of(scan, 1).front, 1 - grid.missing(), 1e-12);
    EXPECT_NEAR(total(scan), 1, 1e-12);
  }
}

/// The root mean square error over random triangles, each seen with another turn.
double error_at(const DirectionGrid& grid, uint32_t samples_across, uint32_t cases) {
  std::vector<double> squares(cases);
  parallel_for(cases, [&](size_t i) {
    Random random{std::mt19937(static_cast<uint32_t>(100 + i))};
    const World world = random.one_triangle();
    const HemisphereScan scan = scan_hemisphere(world.caster(), grid, vec3(0), kUp,
                                                {samples_across, random.in(0, 6), static_cast<uint32_t>(i)});
    const SeenShare share = share_of(scan, 0);
    squares[i] = std::pow(share.front + share.back - Random::factor(world), 2);
  });
  double sum = 0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / cases);
}

/// The same of squares that lie along the grid, as walls do, where all cells of an edge err together.
double error_along_grid(uint32_t resolution, uint32_t samples_across, uint32_t cases) {
  const DirectionGrid grid = DirectionGrid::hemicube(resolution);
  std::vector<double> squares(cases);
  parallel_for(cases, [&](size_t i) {
    Random random{std::mt19937(static_cast<uint32_t>(900 + i))};
    const vec2 low(random.in(-0.8f, -0.1f), random.in(-0.8f, -0.1f)),
        high(random.in(0.1f, 0.8f), random.in(0.1f, 0.8f));
    World world;
    world.polygon({{low.x, low.y, 1}, {low.x, high.y, 1}, {high.x, high.y, 1}, {high.x, low.y, 1}});
    const HemisphereScan scan =
        scan_hemisphere(world.caster(), grid, vec3(0), kUp, {samples_across, 0, static_cast<uint32_t>(i)});
    const double exact = world.exact(0, vec3(0), kUp) + world.exact(1, vec3(0), kUp);
    squares[i] = std::pow(1 - scan.environment - exact, 2);
  });
  double sum = 0;
  for (const double square : squares) sum += square;
  return std::sqrt(sum / cases);
}

/// The exponent p in error = c n^-p, through two measurements.
double order(double coarse, double fine, double ratio) {
  return std::log(coarse / fine) / std::log(ratio);
}

TEST(Hemicube, ConvergesInTheFirstOrderAlongTheGridAndFasterWithJitter) {
  const double plain = order(error_along_grid(12, 1, 300), error_along_grid(96, 1, 300), 8);
  const double jittered = order(error_along_grid(12, 3, 150), error_along_grid(48, 3, 150), 4);
  RecordProperty("plain_order", std::to_string(plain));
  RecordProperty("jittered_order", std::to_string(jittered));
  EXPECT_GT(plain, 0.8);
  EXPECT_LT(plain, 1.25);
  EXPECT_GT(jittered, 1.25);  // 3/2: the errors of cells are independent
}

TEST(Hemicube, ConvergesForTrianglesInAnyPlace) {
  for (const bool cube : {true, false}) {
    const auto grid = [&](uint32_t n) {
      return cube ? DirectionGrid::hemicube(n) : DirectionGrid::cubic_tetrahedron(n);
    };
    const double coarse = error_at(grid(12), 1, 300), fine = error_at(grid(72), 1, 300);
    const double plain = order(coarse, fine, 6);
    RecordProperty(cube ? "hemicube_order" : "tetrahedron_order", std::to_string(plain));
    EXPECT_GT(plain, 1);  // no less than along the grid
    EXPECT_LT(plain, 2);
    const double jittered = error_at(grid(12), 4, 300);
    EXPECT_LT(jittered, coarse / 4);
  }
}

/// Over random triangles and grids: how often the error is as small as its estimate, and the ratio of the
/// mean estimate to the root mean square error.
struct Trust {
  double held = 0, excess = 0;
};

Trust trust(bool jittered) {
  Random random{std::mt19937(11)};
  int held = 0, count = 0;
  double squares = 0, estimates = 0;
  for (int i = 0; i < 600; ++i) {
    const World world = random.one_triangle();
    const auto n = static_cast<uint32_t>(random.in(4, 40));
    const DirectionGrid grid = i % 2 == 0 ? DirectionGrid::hemicube(n) : DirectionGrid::cubic_tetrahedron(n);
    const ScanOptions options{jittered ? 2 + static_cast<uint32_t>(i) % 3 : 1, random.in(0, 6),
                              static_cast<uint32_t>(random.engine())};
    const SeenShare share = share_of(scan_hemisphere(world.caster(), grid, vec3(0), kUp, options), 0);
    if (share.error == 0) continue;  // no ray met it
    const double error = std::abs(share.front + share.back - Random::factor(world));
    held += error <= share.error + 1e-6 ? 1 : 0;
    ++count;
    squares += error * error;
    estimates += share.error * share.error;
  }
  EXPECT_GT(count, 540);
  return {double(held) / count, std::sqrt(estimates / squares)};
}

TEST(Hemicube, ErrorsAreWithinTheirEstimates) {
  const Trust plain = trust(false), jittered = trust(true);
  RecordProperty("plain_held", std::to_string(plain.held));
  RecordProperty("plain_excess", std::to_string(plain.excess));
  RecordProperty("jittered_held", std::to_string(jittered.held));
  RecordProperty("jittered_excess", std::to_string(jittered.excess));
  EXPECT_GE(plain.held, 0.95);
  EXPECT_GE(jittered.held, 0.95);
  // And the estimates are worth something.
  EXPECT_LT(plain.excess, 12);
  EXPECT_LT(jittered.excess, 8);
}

World clutter(Random& random, int count) {
  World world;
  for (int i = 0; i < count; ++i) {
    const vec3 centre = 1.5f * random.direction();
    world.triangle(centre + 0.6f * random.point(), centre + 0.6f * random.point(),
                   centre + 0.6f * random.point());
  }
  return world;
}

World turned(World world, const mat3& rotation) {
  for (vec3& p : world.positions) p = rotation * p;
  return world;
}

TEST(Hemicube, TurnsWithTheScene) {
  Random random{std::mt19937(3)};
  const World world = clutter(random, 60);
  for (const float angle : {0.4f, 2.0f, -1.3f}) {
    const mat3 about_normal = glm::mat3_cast(glm::angleAxis(angle, kUp));
    const DirectionGrid grid = DirectionGrid::cubic_tetrahedron(40);
    const HemisphereScan straight = scan_hemisphere(world.caster(), grid, vec3(0), kUp, {2, 0.1f});
    const HemisphereScan same =
        scan_hemisphere(turned(world, about_normal).caster(), grid, vec3(0), kUp, {2, 0.1f + angle});
    // The same rays but for rounding, which moves a few that pass close to an edge.
    double moved = std::abs(straight.environment - same.environment);
    for (uint32_t t = 0; t < 60; ++t)
      moved += std::abs(share_of(straight, t).front - share_of(same, t).front) +
               std::abs(share_of(straight, t).back - share_of(same, t).back);
    EXPECT_LT(moved, 1e-3);
  }
}

TEST(Hemicube, ARotatedSceneGivesTheSameFormFactors) {
  Random random{std::mt19937(4)};
  int held = 0, count = 0;
  for (int i = 0; i < 20; ++i) {
    const World world = clutter(random, 40);
    const mat3 rotation = glm::mat3_cast(glm::angleAxis(random.in(0, 6), random.direction()));
    const vec3 normal = random.direction();
    const DirectionGrid grid = DirectionGrid::hemicube(24);
    const ScanOptions options{1 + static_cast<uint32_t>(i) % 2};
    const HemisphereScan one = scan_hemisphere(world.caster(), grid, vec3(0), normal, options);
    const HemisphereScan other =
        scan_hemisphere(turned(world, rotation).caster(), grid, vec3(0), rotation * normal, options);
    EXPECT_NEAR(one.environment, other.environment, one.environment_error + other.environment_error);
    for (uint32_t t = 0; t < 40; ++t) {
      const SeenShare a = share_of(one, t), b = share_of(other, t);
      if (a.error == 0 && b.error == 0) continue;
      ++count;
      held += std::abs(a.front + a.back - b.front - b.back) <= a.error + b.error ? 1 : 0;
    }
  }
  EXPECT_GE(held, 0.95 * count);
  EXPECT_GT(count, 200);
}

/// On the diagonal between the floor's two triangles; at the foot of the wall x = 1, triangles 6 and 7; in
/// the corner of that and the wall y = 1, triangles 10 and 11. The room stands straight, or turned so that
/// rounding puts receivers on either side of the walls.
TEST(Hemicube, ReceiversOnEdgesOfTheScene) {
  Random random{std::mt19937(6)};
  World straight;
  straight.room({-1, -1, 0}, {1, 1, 2});
  const DirectionGrid grid = DirectionGrid::hemicube(48);
  for (int i = 0; i < 40; ++i) {
    const mat3 rotation =
        i == 0 ? mat3(1) : glm::mat3_cast(glm::angleAxis(random.in(0, 6), random.direction()));
    const World world = turned(straight, rotation);
    const RayCaster caster = world.caster();
    const vec3 normal = rotation * kUp;
    for (const vec3& local : {vec3(0.25f, 0.25f, 0), vec3(1, random.in(-0.9f, 0.9f), 0), vec3(1, 1, 0)}) {
      const vec3 x = rotation * local;
      const HemisphereScan scan = scan_hemisphere(caster, grid, x, normal, {1, 0.7f});
      EXPECT_NEAR(total(scan), 1, 1e-12);
      double touched = 0, error = 0, lost = scan.environment;
      for (const SeenShare& share : scan.seen) {
        EXPECT_GE(share.triangle, 2u);  // not the floor
        lost += share.back;
        if ((local.x == 1 && share.triangle / 2 == 3) || (local.y == 1 && share.triangle / 2 == 5)) {
          touched += share.front;
          error += share.error;
        } else {
          EXPECT_NEAR(share.front, world.exact(share.triangle, x, normal), 1.5 * share.error + 1e-5)
              << share.triangle;
        }
      }
      // Rounding is some hundredths of epsilon here: rays within such an angle of the wall may pass its edge.
      EXPECT_LT(lost, i == 0 ? 1e-12 : 0.015);
      // A wall fills half the view of a point at its foot, two walls three quarters of it in their corner.
      EXPECT_NEAR(touched, local.y == 1 ? 0.75 : local.x == 1 ? 0.5 : 0.0, error);
    }
  }
}

TEST(Hemicube, SameBytesInAnyThread) {
  Random random{std::mt19937(8)};
  const World world = clutter(random, 80);
  const RayCaster caster = world.caster();
  const DirectionGrid grid = DirectionGrid::hemicube(16);
  const auto scan = [&](size_t i) {
    const ScanOptions options{1 + static_cast<uint32_t>(i) % 2, 0.1f * static_cast<float>(i), 7};
    return scan_hemisphere(caster, grid, vec3(0), kUp, options);
  };
  std::vector<HemisphereScan> together(32);
  parallel_for(together.size(), [&](size_t i) { together[i] = scan(i); });
  for (size_t i = 0; i < together.size(); ++i) {
    const HemisphereScan alone = scan(i);
    EXPECT_EQ(alone.environment, together[i].environment);
    ASSERT_EQ(alone.seen.size(), together[i].seen.size());
    for (size_t k = 0; k < alone.seen.size(); ++k) {
      EXPECT_EQ(alone.seen[k].triangle, together[i].seen[k].triangle);
      EXPECT_EQ(alone.seen[k].front, together[i].seen[k].front);
      EXPECT_EQ(alone.seen[k].error, together[i].seen[k].error);
    }
  }
}

TEST(Hemicube, TheSeedMovesTheJitter) {
  Random random{std::mt19937(9)};
  const World world = clutter(random, 30);
  const RayCaster caster = world.caster();
  const DirectionGrid grid = DirectionGrid::hemicube(12);
  const double one = scan_hemisphere(caster, grid, vec3(0), kUp, {2, 0, 1}).environment;
  EXPECT_NE(one, scan_hemisphere(caster, grid, vec3(0), kUp, {2, 0, 2}).environment);
  EXPECT_EQ(one, scan_hemisphere(caster, grid, vec3(0), kUp, {2, 0, 1}).environment);
}

/// Points and polygons of the shared collection, with what stands between.
TEST(Hemicube, SharedPointToPolygonFactors) {
  const test::Json cases = test::shared_cases("view_factors.json");
  if (cases.is_null()) GTEST_SKIP() << test::kNoSharedCases;
  size_t checked = 0, occluded = 0;
  for (const auto& c : cases) {
    if (c["from"]["type"] != "point" || c["to"]["type"] != "polygon") continue;
    World world;
    world.polygon(test::corners_of<vec3>(c["to"]));
    const auto target = static_cast<uint32_t>(world.triangles.size());
    for (const auto& occluder : c["occluders"]) world.polygon(test::corners_of<vec3>(occluder));
    const RayCaster caster = world.caster();
    const vec3 x = test::vector_of<vec3>(c["from"]["position"]),
               n = normalize(test::vector_of<vec3>(c["from"]["normal"]));
    for (const ScanOptions& options : {ScanOptions{1, 0.5f}, ScanOptions{4, 0.5f, 1}}) {
      const HemisphereScan scan = scan_hemisphere(caster, DirectionGrid::hemicube(64), x, n, options);
      double seen = 0, error = 1e-5;
      for (uint32_t t = 0; t < target; ++t) {
        seen += share_of(scan, t).front;
        error += share_of(scan, t).error;
      }
      EXPECT_NEAR(seen, c["value"].get<double>(), error) << c["id"];
      EXPECT_LT(error, 0.05) << c["id"];
    }
    ++checked;
    occluded += c["occluders"].empty() ? 0 : 1;
  }
  EXPECT_GE(checked, 10u);
  EXPECT_GE(occluded, 4u);
}

}  // namespace
}  // namespace goldthread
