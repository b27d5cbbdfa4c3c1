// What arrives at points and what links say of it.
#include "solve/hierarchical/link.h"

#include "solve/hierarchical/point_transfer.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "base/rng.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Elements;
using test::Random;

ElementId surface_of_part(const ElementPool& pool, uint32_t part) {
  for (const ElementId id : pool.surface_roots())
    if (pool[id].part == part) return id;
  return kNoElement;
}

/// The sum over the real triangles of a surface, each by Lambert's formula.
vec3 exact_transfer(const ElementPool& pool, ElementId surface, const vec3& x, const vec3& n) {
  const Element& e = pool[surface];
  const Part& part = pool.surfaces().parts[e.part];
  vec3 sum(0);
  for (const UVec3& t : pool.surfaces().tree(part).mesh.triangles) {
    std::array<vec3, 3> corners{part.positions[t.x], part.positions[t.y], part.positions[t.z]};
    if ((part.winding < 0) != e.back) std::swap(corners[1], corners[2]);
    sum += polygon_form_factor(x, n, corners);
  }
  return sum;
}

RC_GTEST_PROP(PointTransfer, AClusterIsTheSumOfItsTriangles, (uint32_t seed)) {
  Random random(seed);
  Scene scene;
  Material material = test::diffuse(0.5f);
  material.double_sided = seed % 3 == 0;
  const uint32_t paint = test::add(scene, material);
  const mat4 place =
      test::turn(random.in(0, 6), random.direction()) * test::scale(vec3(seed % 2 == 0 ? 1.0f : -1.0f, 1, 1));
  test::add(scene, seed % 5 == 0 ? shapes::sphere(8) : shapes::wavy_grid(12), paint, place);
  const Elements elements(std::move(scene));
  for (const ElementId surface : elements.pool->surface_roots()) {
    for (int i = 0; i < 20; ++i) {
      const vec3 x = random.in(0.05f, 4) * random.direction(), n = random.direction();
      const vec3 exact = exact_transfer(*elements.pool, surface, x, n);
      const vec3 m = point_transfer(*elements.pool, surface, x, n);
      // Each piece may err by 4e-4 of a form factor, and their errors are of either sign.
      RC_ASSERT(std::abs(dot(m - exact, n)) < 0.01f + 0.03f * dot(exact, n));
    }
  }
}

TEST(PointTransfer, FarClustersAreExactInTheLimit) {
  Scene scene;
  test::add(scene, shapes::wavy_grid(20), test::add(scene, test::diffuse(0.5f)));
  const Elements elements(std::move(scene));
  const ElementId surface = elements.pool->surface_roots()[0];
  for (const float distance : {3.0f, 10.0f, 100.0f}) {
    const vec3 x = vec3(0.5f, 0.5f, 0) + distance * normalize(vec3(0.2f, 0.3f, 1)), n(0, 0, -1);
    const float exact = dot(exact_transfer(*elements.pool, surface, x, n), n);
    EXPECT_NEAR(dot(point_transfer(*elements.pool, surface, x, n), n) / exact, 1, 0.01f) << distance;
  }
}

TEST(PointTransfer, OfALampThatTheHorizonCutsThePartAboveIt) {
  // A lamp of a square metre seen by what is turned all but away from it: a wall below, its edge to the lamp.
  // Its form factor is some 1e-4, and may well be all of the wall's direct light.
  for (const uint32_t n : {1u, 3u}) {
    Scene scene;
    test::add(scene, test::parallelogram({-0.5f, -0.5f, 0}, {0, 1, 0}, {1, 0, 0}, n),
              test::add(scene, test::diffuse(0.5f, 1)));
    const Elements elements(std::move(scene));
    const ElementId lamp = elements.pool->surface_roots()[0];
    for (const float tilt : {-0.08f, -0.03f, 0.0f, 0.05f, 0.1f}) {
      const vec3 x(0.1f, 0.05f, -4), normal = normalize(vec3(1, 0.2f, tilt));
      const float exact = dot(exact_transfer(*elements.pool, lamp, x, normal), normal);
      ASSERT_GT(exact, 1e-5f);
      EXPECT_NEAR(dot(point_transfer(*elements.pool, lamp, x, normal), normal) / exact, 1, 0.02f)
          << n << " " << tilt << " " << exact;
    }
  }
}

TEST(PointTransfer, PatchesAddUpToTheirTriangle) {
  Scene scene;
  test::add(scene, test::polygon({{0, 0, 0}, {2, 0, 0}, {0.3f, 1, 0}}),
            test::add(scene, test::diffuse(0.5f)));
  Elements elements(std::move(scene));
  elements.expand(6);
  const ElementPool& pool = *elements.pool;
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const vec3 x =
        vec3(0.7f, 0.4f, 0.05f) + random.in(0, 2) * vec3(random.in(-1, 1), random.in(-1, 1), random.in(0, 1));
    const vec3 n = random.direction();
    float sum = 0;
    for (const ElementId id : elements.leaves())
      sum += std::max(0.0f, dot(point_transfer(pool, id, x, n), n));
    const float whole = std::max(0.0f, dot(point_transfer(pool, pool.root(), x, n), n));
    EXPECT_NEAR(sum, whole, 2e-3f + 0.01f * whole) << i;
  }
}

TEST(PointTransfer, InsideAClosedSurfaceItIsOne) {
  for (const uint32_t rings : {4u, 12u, 40u}) {
    Scene scene;
    test::add(scene, test::turned(shapes::sphere(rings)), test::add(scene, test::diffuse(0.5f)));
    const Elements elements(std::move(scene));
    Random random(rings);
    for (int i = 0; i < 50; ++i) {
      const vec3 x = random.in(0, 0.8f) * random.direction(), n = random.direction();
      EXPECT_NEAR(dot(point_transfer(*elements.pool, elements.pool->root(), x, n), n), 1, 0.01f) << rings;
    }
  }
}

/// A F from one to the other through many points on the receiver.
double flux(const ElementPool& pool, ElementId receiver, ElementId source) {
  constexpr uint32_t kPoints = 4000;
  double sum = 0;
  for (uint32_t i = 0; i < kPoints; ++i) {
    const UnitSquarePoint uv = r2_point(i, 1);
    const SurfacePoint p = pool.sample_at(receiver, uv.u, uv.v);
    sum += double(std::max(0.0f, dot(point_transfer(pool, source, p.position, p.normal), p.normal)));
  }
  return sum / kPoints * double(pool[receiver].area);
}

RC_GTEST_PROP(Link, ReciprocityOfUnoccludedPairs, (uint32_t seed)) {
  Random random(seed);
  Scene scene;
  const uint32_t paint = test::add(scene, test::diffuse(0.5f));
  test::add(scene, shapes::wavy_grid(6), paint);
  test::add(scene, test::turned(shapes::wavy_grid(5)), paint,
            test::move({random.in(-1, 1), random.in(-1, 1), random.in(0.8f, 3)}) *
                test::turn(random.in(-0.6f, 0.6f), {1, random.in(-1, 1), 0}));
  const Elements elements(std::move(scene));
  const ElementId a = surface_of_part(*elements.pool, 0), b = surface_of_part(*elements.pool, 1);
  const double ab = flux(*elements.pool, a, b), ba = flux(*elements.pool, b, a);
  // Each way errs by its own pieces, 4e-4 of a form factor each.
  RC_ASSERT(std::abs(ab - ba) < 0.02 * std::max(ab, ba) + 4e-4);
}

TEST(Link, AgreesWithTheClosedFormOfParallelSquares) {
  // Two unit squares one apart: F = 0.1998248957 (Howell C-11).
  Scene scene;
  const uint32_t paint = test::add(scene, test::diffuse(0.5f));
  test::add(scene, test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4), paint);
  test::add(scene, test::parallelogram({0, 0, 1}, {0, 1, 0}, {1, 0, 0}, 4), paint);
  test::Solved solved(std::move(scene));
  const ElementPool& pool = solved.pool();
  const ElementId a = surface_of_part(pool, 0), b = surface_of_part(pool, 1);
  EXPECT_NEAR(flux(pool, a, b), 0.1998248957, 1e-3);
  RayCount rays;
  solved.caster->prepare_shafts();
  for (const bool shafts : {false, true}) {
    Visibility visibility = solved.solver->visibility();
    visibility.shafts = shafts;
    rays = {};
    const Link link = make_link(pool, visibility, a, b, 8, 4, rays);
    EXPECT_NEAR(link.mean, 0.1998f, 0.02f);  // eight points
    EXPECT_EQ(link.visibility, 255);
    EXPECT_EQ(rays.rays == 0, shafts);
    EXPECT_NEAR(link.unoccluded, 0.1998f, 0.02f);
  }
}

TEST(Link, AWallBetweenBlocksAll) {
  Scene scene;
  const uint32_t paint = test::add(scene, test::diffuse(0.5f));
  test::add(scene, test::parallelogram({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4), paint);
  test::add(scene, test::parallelogram({0, 0, 1}, {0, 1, 0}, {1, 0, 0}, 4), paint);
  test::add(scene, test::parallelogram({-5, -5, 0.5f}, {10, 0, 0}, {0, 10, 0}), paint);
  test::Solved solved(std::move(scene));
  RayCount rays;
  const Link link = make_link(solved.pool(), solved.solver->visibility(), surface_of_part(solved.pool(), 0),
                              surface_of_part(solved.pool(), 1), 8, 4, rays);
  EXPECT_EQ(link.visibility, 0);
  EXPECT_EQ(link.mean, 0);
  EXPECT_NEAR(link.unoccluded, 0.1998f, 0.02f);
}

TEST(Visibility, HalfASourceBehindAScreen) {
  // Seen from below, a screen hides the part of the panel with x > 0.
  Scene scene;
  const uint32_t paint = test::add(scene, test::diffuse(0.5f));
  test::add(scene, test::parallelogram({-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, 4), paint);
  test::add(scene, test::parallelogram({0, -3, 1}, {3, 0, 0}, {0, 6, 0}), paint);
  test::Solved solved(std::move(scene));
  const ElementId panel = surface_of_part(solved.pool(), 0);
  double sum = 0;
  for (uint32_t seed = 0; seed < 200; ++seed) {
    RayCount rays;
    const float seen =
        solved.solver->visibility().fraction(solved.pool(), panel, vec3(0), {0, 0, 1}, 16, seed, rays);
    EXPECT_GE(seen, 0);
    EXPECT_LE(seen, 1);
    sum += double(seen) / 200;
  }
  EXPECT_NEAR(sum, 0.5, 0.02);
}

TEST(Visibility, TwoRaysAreRightOnTheAverage) {
  // A closed, curved source close by, half of it behind a screen and half of it its own back: what two rays
  // see and what is hidden from them adds up to Lambert's formula, and the screen hides half.
  Scene scene;
  const uint32_t paint = test::add(scene, test::diffuse(0.5f));
  test::add(scene, shapes::sphere(12), paint, test::move({0, 0, 1.5f}));
  test::add(scene, test::parallelogram({0, -3, 0.2f}, {3, 0, 0}, {0, 6, 0}), paint);
  test::Solved solved(std::move(scene));
  const ElementId ball = surface_of_part(solved.pool(), 0);
  const vec3 x(0), n(0, 0, 1);
  const float all = dot(n, exact_transfer(solved.pool(), ball, x, n));
  double seen = 0, hidden = 0;
  constexpr uint32_t kSeeds = 4000;
  for (uint32_t seed = 0; seed < kSeeds; ++seed) {
    RayCount rays;
    const SeenShare share = solved.solver->visibility().look(solved.pool(), ball, x, n, 2, seed, rays);
    seen += double(share.seen) / kSeeds;
    hidden += double(share.hidden) / kSeeds;
  }
  EXPECT_NEAR((seen + hidden) / double(all), 1, 0.03);
  EXPECT_NEAR(seen / double(all), 0.5, 0.03);
}

TEST(Visibility, ASourceThatNoRayTellsOfIsAsTheCallerSays) {
  // Amid the source, in its own plane.
  Scene scene;
  test::add(scene, test::parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 4),
            test::add(scene, test::diffuse(0.5f)));
  test::Solved solved(std::move(scene));
  const ElementId floor = surface_of_part(solved.pool(), 0);
  for (const float unknown : {0.0f, 0.25f, 1.0f}) {
    RayCount rays;
    EXPECT_EQ(solved.solver->visibility().fraction(solved.pool(), floor, vec3(0.1f, 0.2f, 0), {0, 0, 1}, 8, 3,
                                                   rays, unknown),
              unknown);
  }
}

TEST(Link, ItsViewHoldsOnlyWhatIsSeen) {
  // As above; the solution has cut the panel.
  Scene scene;
  test::add(scene, test::parallelogram({-1, -1, 2}, {0, 2, 0}, {2, 0, 0}, 4),
            test::add(scene, test::diffuse(0.5f, 1)));
  const uint32_t paint = test::add(scene, test::diffuse(0.5f));
  test::add(scene, test::parallelogram({0, -3, 1}, {3, 0, 0}, {0, 6, 0}), paint);
  test::add(scene, test::parallelogram({-0.05f, -0.05f, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}), paint);
  test::Solved solved(std::move(scene));
  solved.solve();
  const ElementPool& pool = solved.pool();
  const ElementId panel = surface_of_part(pool, 0), floor = surface_of_part(pool, 2);
  ASSERT_NE(pool[panel].first_child, kNoElement);
  RayCount rays;
  Link link = make_link(pool, solved.solver->visibility(), floor, panel, 8, 4, rays);
  std::vector<SourceView> views(1);
  measure_link(pool, solved.solver->visibility(), link, 0.001f, views.data(), rays);
  link.view = 0;
  std::vector<vec3> shown(pool.size(), vec3(0));
  for (const ElementId id : solved.leaves())
    if (pool[id].centre.x > 0.2f) shown[id] = vec3(1);  // bright where nobody sees it
  EXPECT_EQ(seen_radiosity(link, views, shown), vec3(0));
  for (const ElementId id : solved.leaves()) shown[id] = vec3(pool[id].centre.x < 0.2f ? 3.0f : 0.0f);
  EXPECT_EQ(seen_radiosity(link, views, shown), vec3(3));
  EXPECT_NEAR(link.mean / link.unoccluded, 0.5f, 0.1f);
}

TEST(LightDistribution, SpotFallsFromInnerToOuterCone) {
  Light spot;
  spot.kind = LightKind::kSpot;
  spot.direction = {0, -1, 0};
  spot.inner_cone = 0.3f;
  spot.outer_cone = 0.6f;
  const auto at = [&](float angle) {
    return light_distribution(spot, {std::sin(angle), -std::cos(angle), 0});
  };
  EXPECT_FLOAT_EQ(at(0), 1);
  EXPECT_FLOAT_EQ(at(0.29f), 1);
  EXPECT_FLOAT_EQ(at(0.61f), 0);
  EXPECT_FLOAT_EQ(at(3), 0);
  // KHR_lights_punctual: ((cos - cos outer) / (cos inner - cos outer))^2.
  const float t = (std::cos(0.45f) - std::cos(0.6f)) / (std::cos(0.3f) - std::cos(0.6f));
  EXPECT_NEAR(at(0.45f), t * t, 1e-5f);
  spot.kind = LightKind::kPoint;
  EXPECT_FLOAT_EQ(at(3), 1);
}

TEST(LightDistribution, RangeCutsOff) {
  Light light;
  EXPECT_FLOAT_EQ(light_range_factor(light, 1e6f), 1);
  light.range = 10;
  EXPECT_FLOAT_EQ(light_range_factor(light, 5), 1 - 1 / 16.0f);
  EXPECT_FLOAT_EQ(light_range_factor(light, 10), 0);
  EXPECT_FLOAT_EQ(light_range_factor(light, 20), 0);
}

}  // namespace
}  // namespace goldthread
