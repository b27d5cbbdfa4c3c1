#include "visibility/ray_caster.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <atomic>
#include <random>
#include <vector>

namespace goldthread {
namespace {

struct World {
  std::vector<vec3> positions;
  std::vector<UVec3> triangles;

  void quad(const vec3& a, const vec3& b, const vec3& c, const vec3& d) {
    const auto n = uint32_t(positions.size());
    positions.insert(positions.end(), {a, b, c, d});
    triangles.push_back({n, n + 1, n + 2});
    triangles.push_back({n, n + 2, n + 3});
  }
  /// A 2 by 2 square at height z, facing up.
  void floor_at(float z) { quad({-1, -1, z}, {1, -1, z}, {1, 1, z}, {-1, 1, z}); }
};

struct Random {
  std::mt19937 engine;
  float in(float low, float high) {
    return low + (high - low) * static_cast<float>(engine() >> 8) * 0x1p-24f;
  }
  vec3 point() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
};

World random_world(Random& random, int triangles) {
  World world;
  for (int t = 0; t < triangles; ++t) {
    const vec3 centre = random.point();
    const auto n = uint32_t(world.positions.size());
    for (int k = 0; k < 3; ++k) world.positions.push_back(centre + 0.2f * random.point());
    world.triangles.push_back({n, n + 1, n + 2});
  }
  return world;
}

/// Moeller and Trumbore 1997, in double: the distance along the ray, or a negative number.
double meet(const Ray& ray, const vec3& a, const vec3& b, const vec3& c) {
  const dvec3 e1 = dvec3(b) - dvec3(a), e2 = dvec3(c) - dvec3(a), p = cross(dvec3(ray.direction), e2);
  const double determinant = dot(e1, p);
  if (determinant == 0) return -1;
  const dvec3 s = dvec3(ray.origin) - dvec3(a), q = cross(s, e1);
  const double u = dot(s, p) / determinant, v = dot(dvec3(ray.direction), q) / determinant;
  return u < 0 || v < 0 || u + v > 1 ? -1 : dot(e2, q) / determinant;
}

TEST(RayCaster, NearestHitAndItsFacts) {
  World world;
  world.floor_at(0);
  world.floor_at(1);
  const RayCaster caster(world.positions, world.triangles);
  const Hit hit = caster.closest({{0.5f, -0.25f, 5}, {0, 0, -2}});
  ASSERT_FALSE(hit.missed());
  EXPECT_EQ(hit.triangle, 2u);
  EXPECT_FLOAT_EQ(hit.distance, 2);  // in lengths of the direction
  EXPECT_GT(hit.normal.z, 0);        // by the winding, not by the ray
  const UVec3& t = world.triangles[hit.triangle];
  const vec3 point = (1 - hit.weights.x - hit.weights.y) * world.positions[t.x] +
                     hit.weights.x * world.positions[t.y] + hit.weights.y * world.positions[t.z];
  EXPECT_NEAR(length(point - vec3(0.5f, -0.25f, 1)), 0, 1e-5f);
  EXPECT_GT(caster.closest({{0.5f, -0.25f, -5}, {0, 0, 1}}).normal.z, 0);
  EXPECT_TRUE(caster.closest({{3, 0, 5}, {0, 0, -1}}).missed());
  EXPECT_GT(caster.memory_bytes(), 0u);
}

TEST(RayCaster, NearAndFar) {
  World world;
  world.floor_at(0);
  const RayCaster caster(world.positions, world.triangles);
  const auto ray = [](float near, float far) { return Ray{{0.3f, 0.1f, 1}, {0, 0, -1}, near, far}; };
  EXPECT_EQ(caster.transmittance(ray(0, 1.5f)), 0);
  EXPECT_EQ(caster.transmittance(ray(0, 0.999f)), 1);
  EXPECT_EQ(caster.transmittance(ray(1.001f, 5)), 1);
  EXPECT_TRUE(caster.closest(ray(0, 0.999f)).missed());
  EXPECT_TRUE(caster.closest(ray(1.001f, 5)).missed());
  EXPECT_FALSE(caster.closest(ray(0.999f, 1.001f)).missed());
}

TEST(RayCaster, EmptyWorldBlocksNothing) {
  const RayCaster caster({}, {});
  EXPECT_TRUE(caster.closest({{0, 0, 0}, {0, 0, 1}}).missed());
  const std::vector<Ray> rays(16, Ray{{0, 0, 0}, {0, 0, 1}});
  std::vector<float> passing(rays.size(), -1);
  caster.packet_transmittance(rays, passing);
  EXPECT_EQ(passing, std::vector<float>(rays.size(), 1));
}

RC_GTEST_PROP(RayCaster, AllQuestionsAgreeWithTheDefinition, (uint32_t seed)) {
  Random random{std::mt19937(seed)};
  const World world = random_world(random, 60);
  const RayCaster caster(world.positions, world.triangles);
  std::vector<Ray> rays(1 + seed % 16);
  for (Ray& ray : rays) {
    ray = {2.0f * random.point(), 2.0f * random.point()};
    if (random.in(0, 1) < 0.5f) ray.far = random.in(0.2f, 2);
  }
  std::vector<float> passing(rays.size(), -1);
  caster.packet_transmittance(rays, passing);
  for (size_t i = 0; i < rays.size(); ++i) {
    double nearest = INFINITY;
    for (const UVec3& t : world.triangles) {
      const double d = meet(rays[i], world.positions[t.x], world.positions[t.y], world.positions[t.z]);
      if (d >= 0) nearest = std::min(nearest, d);
    }
    const bool edge = std::abs(nearest - double(rays[i].far)) < 1e-4;
    const Hit hit = caster.closest(rays[i]);
    RC_ASSERT(caster.transmittance(rays[i]) == (hit.missed() ? 1.0f : 0.0f));
    RC_ASSERT(passing[i] == (hit.missed() ? 1.0f : 0.0f));
    if (edge) continue;
    // Rounding at a triangle's rim may decide either way, but then the next hit is another or none: rare.
    if (nearest < double(rays[i].far) && !hit.missed()) RC_ASSERT(double(hit.distance) <= nearest + 1e-3);
    if (nearest >= double(rays[i].far)) RC_ASSERT(hit.missed());
  }
}

TEST(RayCaster, SeeThroughTrianglesAreAsked) {
  World world;
  world.floor_at(2);  // triangles 0 and 1: see-through
  world.floor_at(1);  // 2 and 3: opaque
  world.floor_at(0);  // 4 and 5: see-through
  const std::vector<uint8_t> marks{1, 1, 0, 0, 1, 1};
  std::atomic<int> asked{0}, wrong{0};
  const RayCaster caster(world.positions, world.triangles, marks,
                         [&](uint32_t triangle, vec2 weights, const Ray& ray) {
                           ++asked;
                           const UVec3& t = world.triangles[triangle];
                           const vec3 p = (1 - weights.x - weights.y) * world.positions[t.x] +
                                          weights.x * world.positions[t.y] + weights.y * world.positions[t.z];
                           if (marks[triangle] == 0 || std::abs(p.x - ray.origin.x) > 1e-5f) ++wrong;
                           return p.x < 0 ? 1.0f : 0.0f;  // the left half is a hole
                         });
  const auto down = [](float x, float z, float far) { return Ray{{x, 0.3f, z}, {0, 0, -1}, 0, far}; };
  EXPECT_EQ(caster.closest(down(0.5f, 3, 9)).triangle / 2, 0u);
  EXPECT_EQ(caster.closest(down(-0.5f, 3, 9)).triangle / 2, 1u);  // through the hole onto the opaque one
  EXPECT_TRUE(caster.closest(down(-0.5f, 0.5f, 9)).missed());
  EXPECT_EQ(caster.closest(down(0.5f, 0.5f, 9)).triangle / 2, 2u);
  EXPECT_GT(asked, 0);
  std::vector<Ray> rays;
  for (int i = 0; i < 16; ++i) rays.push_back(down(-0.9f + 0.12f * float(i), 3, 1.5f));
  std::vector<float> passing(rays.size());
  caster.packet_transmittance(rays, passing);
  for (size_t i = 0; i < rays.size(); ++i) {
    EXPECT_EQ(passing[i], rays[i].origin.x < 0 ? 1 : 0) << i;
    EXPECT_EQ(caster.transmittance(rays[i]), passing[i]) << i;
  }
  EXPECT_EQ(wrong, 0);
}

TEST(RayCaster, LightPassesLayersByTheirProduct) {
  World world;
  for (int k = 0; k < 3; ++k) world.floor_at(float(k));  // the lowest opaque
  const std::vector<uint8_t> marks{0, 0, 1, 1, 1, 1};
  const RayCaster caster(world.positions, world.triangles, marks,
                         [](uint32_t triangle, vec2, const Ray&) { return triangle < 4 ? 0.5f : 0.25f; });
  std::vector<Ray> rays;
  std::vector<float> expected;
  for (int i = 0; i < 16; ++i) {
    rays.push_back({{-0.8f + 0.1f * float(i), 0.3f, 3}, {0, 0, -1}, 0, 0.5f + float(i % 4)});
    expected.push_back(std::array{1.0f, 0.25f, 0.125f, 0.0f}[size_t(i % 4)]);
  }
  std::vector<float> passing(rays.size());
  caster.packet_transmittance(rays, passing);
  EXPECT_EQ(passing, expected);
  for (size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(caster.transmittance(rays[i]), expected[i]);
}

TEST(RayCaster, ABlendStopsItsShareOfRays) {
  World world;
  world.floor_at(0);
  const std::vector<uint8_t> marks{1, 1};
  const RayCaster caster(world.positions, world.triangles, marks,
                         [](uint32_t, vec2, const Ray&) { return 0.3f; });
  Random random{std::mt19937(5)};
  int passed = 0;
  constexpr int kRays = 20000;
  for (int i = 0; i < kRays; ++i) {
    const Ray ray{{random.in(-0.9f, 0.9f), random.in(-0.9f, 0.9f), 1}, {0, 0, -1}};
    const bool through = caster.closest(ray).missed();
    EXPECT_EQ(through, caster.closest(ray).missed());  // the same every time
    passed += through ? 1 : 0;
  }
  EXPECT_NEAR(double(passed) / kRays, 0.3, 0.015);
}

TEST(RayCaster, MovesWithItsFilter) {
  World world;
  world.floor_at(0);
  const std::vector<uint8_t> marks{1, 1};
  RayCaster first(world.positions, world.triangles, marks, [](uint32_t, vec2, const Ray&) { return 1.0f; });
  const RayCaster second(std::move(first));
  EXPECT_EQ(second.transmittance({{0.3f, 0.1f, 1}, {0, 0, -1}}), 1);
}

}  // namespace
}  // namespace goldthread
