// Light at places: closed forms, shadows to the millimetre, and places that have no light.
#include "reconstruct/place_gather.h"

#include <gtest/gtest.h>

#include "math/form_factor.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

/// On instance 0, whose triangles lie in the plane z = 0.
SurfacePlace on_floor(float x, float y, uint32_t triangle) {
  return {0, 0, triangle, false, {x, y, 0}, {0, 0, 1}};
}
/// The same on `square`, whose two triangles meet in the line x = y.
SurfacePlace on_square(float x, float y) {
  return on_floor(x, y, x > y ? 0 : 1);
}

std::vector<std::optional<vec3>> light_at(Solved& solved, const std::vector<SurfacePlace>& places) {
  ReconstructStats stats;
  ShownLight shown(solved.solver->state());
  reconstruct(*solved.solver, ReconstructOptions(), CancelToken(), stats, &shown);
  return gather_places(*solved.solver, shown, places, ReconstructOptions(), CancelToken(), stats);
}

TEST(PlaceGather, PointLightIsExact) {
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0.5f));
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {0.3f, 0.2f, 1.5f}));
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  std::vector<SurfacePlace> places;
  for (float x = -1.9f; x < 2; x += 0.37f)
    for (float y = -1.83f; y < 2; y += 0.41f) places.push_back(on_square(x, y));
  const auto light = light_at(solved, places);
  for (size_t i = 0; i < places.size(); ++i) {
    ASSERT_TRUE(light[i]);
    const dvec3 d = dvec3(0.3, 0.2, 1.5) - dvec3(places[i].position);
    const double squared = glm::dot(d, d);
    EXPECT_NEAR(double(light[i]->y), 100 * 1.5 / (squared * std::sqrt(squared)), 1e-3);
  }
}

TEST(PlaceGather, LampOfAnAreaIsExactWhereNothingHidesIt) {
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0.5f));
  test::add(scene, test::square(0.4f, 1, false), test::diffuse(0.0f, 1000));
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  const std::vector<vec3> lamp{{-0.4f, -0.4f, 1}, {-0.4f, 0.4f, 1}, {0.4f, 0.4f, 1}, {0.4f, -0.4f, 1}};
  std::vector<SurfacePlace> places;
  for (float x = -1.9f; x < 2; x += 0.53f) places.push_back(on_square(x, 0.31f * x + 0.05f));
  const auto light = light_at(solved, places);
  for (size_t i = 0; i < places.size(); ++i) {
    const vec3 n(0, 0, 1);
    const float exact = 1000 * dot(n, polygon_form_factor(places[i].position, n, lamp));
    ASSERT_GT(exact, 1);
    // A source that is far for its size is a point with a second-order term: right to 1e-4 as a form factor.
    EXPECT_NEAR(light[i]->x, exact, 1e-4f * 1000) << places[i].position.x;
  }
}

TEST(PlaceGather, HardShadowsEndWhereTheyDo) {
  // A plate a metre up hides the lamp two metres up from what lies beyond x = 0.2.
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0.5f));
  Material plate = test::diffuse(0.5f);
  plate.double_sided = true;
  test::add(scene, test::parallelogram({0.1f, -3, 1}, {3, 0, 0}, {0, 6, 0}), std::move(plate));
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {0, 0, 2}));
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  const auto light = light_at(solved, {on_square(0.199f, 0), on_square(0.201f, 0)});
  EXPECT_GT(light[0]->x, 24);                  // 25 lux but for the cosine, and what the plate sends back
  EXPECT_LT(light[1]->x, 0.2f * light[0]->x);  // only what comes by way of plate and floor
}

// A glowing ceiling above two black plates with a slit between them, which the few rays of a link miss. That all
// of them met a plate is no reason to cast few more: the error would be twice as large.
TEST(PlaceGather, ASliverOfABrightCeilingIsNotMissed) {
  constexpr float kSlit = 0.002f;
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0));
  test::add(scene, test::square(2, 2, false), test::diffuse(0, 1000));
  Material plate = test::diffuse(0);
  plate.double_sided = true;
  test::add(scene, test::parallelogram({0.3f + kSlit, -9, 1}, {9, 0, 0}, {0, 18, 0}), Material(plate));
  test::add(scene, test::parallelogram({-9, -9, 1}, {9.3f, 0, 0}, {0, 18, 0}), std::move(plate));
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  std::vector<SurfacePlace> places;
  for (float x = -0.4f; x < 1; x += 0.03f) places.push_back(on_square(x, 0.3f * x - 0.11f));
  const auto light = light_at(solved, places);
  double squares = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    const vec3& p = places[i].position;
    const float left = 0.6f - p.x, right = left + 2 * kSlit;  // the slit's edges, cast on the ceiling
    const std::vector<vec3> seen{{left, -2, 2}, {left, 2, 2}, {right, 2, 2}, {right, -2, 2}};
    const float exact = 1000 * dot(vec3(0, 0, 1), polygon_form_factor(p, {0, 0, 1}, seen));
    squares += std::pow(double(light[i]->x / exact) - 1, 2);
  }
  EXPECT_LT(std::sqrt(squares / double(places.size())), 0.2);
}

// A lamp lights a wall; by an edge of the wall a black floor sees little but the few centimetres above it,
// which get a hundredth of what the wall's middle gets, and lie in the same leaf.
TEST(PlaceGather, WallsAreReadWithinTheirLeaves) {
  Scene scene;
  Material wall = test::diffuse(0.5f);
  test::add(scene, test::parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}), test::diffuse(0));  // faces +z
  test::add(scene, test::parallelogram({-1, -1, 0}, {0, 2, 0}, {0, 0, 2}), std::move(wall));   // faces +x
  const dvec3 lamp(-0.8, 0, 1);
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, vec3(lamp)));
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  for (const double away : {0.02, 0.1, 0.5}) {
    const dvec3 x(-1 + away, 0.3, 0);
    SurfacePlace place = on_floor(float(x.x), float(x.y), x.x > x.y ? 0 : 1);
    const auto light = light_at(solved, {place});
    ASSERT_TRUE(light[0]);
    // Both inverse-square laws over the wall, on a grid that is finer where the floor is nearer.
    constexpr int kCells = 1000;
    double by_way_of_wall = 0;
    for (int i = 0; i < kCells; ++i)
      for (int j = 0; j < kCells; ++j) {
        const double z0 = 2.0 * i / kCells * i / kCells, z1 = 2.0 * (i + 1) / kCells * (i + 1) / kCells;
        const dvec3 y(-1, -1 + 2 * (j + 0.5) / kCells, (z0 + z1) / 2);
        const dvec3 to_lamp = lamp - y, to_floor = x - y;
        const double a = glm::dot(to_lamp, to_lamp), b = glm::dot(to_floor, to_floor);
        const double landing = 100 * to_lamp.x / (a * std::sqrt(a));
        by_way_of_wall += 0.5 * landing * to_floor.x * y.z / (3.14159265 * b * b) * (z1 - z0) * 2 / kCells;
      }
    const dvec3 d = lamp - x;
    const double direct = 100 * d.z / (glm::dot(d, d) * glm::length(d));
    EXPECT_NEAR(double(light[0]->y), direct + by_way_of_wall, 0.02 * by_way_of_wall) << away;
  }
}

TEST(PlaceGather, PlacesWithoutLight) {
  Scene scene;
  test::add(scene, test::square(1, 0, true), test::diffuse(0.5f));
  Material unlit = test::diffuse(0.5f);
  unlit.unlit = true;
  test::add(scene, test::square(0.1f, 0.5f, true), unlit);
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {0, 0, 2}));
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  SurfacePlace back = on_square(0.5f, 0.2f), beyond = back, elsewhere = back, dark = back;
  back.back = true;
  beyond.triangle = 2;
  elsewhere.instance = 7;
  dark.instance = 1;
  const auto light = light_at(solved, {on_square(0.5f, 0.2f), back, beyond, elsewhere, dark});
  EXPECT_TRUE(light[0]);
  for (size_t i = 1; i < light.size(); ++i) EXPECT_FALSE(light[i]) << i;
}

/// On `square`, with a normal that leans by 45 degrees to +x.
SurfacePlace leaning(float x, float y) {
  SurfacePlace place = on_square(x, y);
  place.normal = normalize(vec3(1, 0, 1));
  place.surface = {0, 0, 1};
  return place;
}

TEST(PlaceGather, BentNormalsGetTheirOwnCosine) {
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0.5f));
  const vec3 low = normalize(vec3(-1, 0, 0.01f)), across = normalize(vec3(2, 1, 2));
  scene.lights = {test::lamp(LightKind::kDirectional, 1000, vec3(0), -across),
                  test::lamp(LightKind::kDirectional, 500, vec3(0), -low)};  // behind the bent plane
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  const auto light = light_at(solved, {leaning(0.3f, -0.4f)});
  ASSERT_TRUE(light[0]);
  EXPECT_NEAR(double(light[0]->x), 1000 * double(dot(across, normalize(vec3(1, 0, 1)))), 0.1);
}

TEST(PlaceGather, ABentNormalLooksInVainBelowItsSurface) {
  for (const float reflectance : {0.0f, 0.8f}) {
    Scene scene;
    test::add(scene, test::square(2, 0, true), test::diffuse(reflectance));
    scene.sky.radiance = vec3(100);
    Solved solved(std::move(scene), test::quick());
    solved.solve();
    const auto light = light_at(solved, {leaning(0.3f, -0.4f)});
    ASSERT_TRUE(light[0]);
    const double truth = 100 * double(kPi) * (1 + std::sqrt(0.5)) / 2;
    EXPECT_NEAR(double(light[0]->x), truth, 0.01 * truth);
  }
}

// A lit wall stands in the floor and reaches as far below it; by shafts all that the floor may see is seen.
TEST(PlaceGather, OfAWallThatGoesOnBelowTheFloorABentNormalSeesWhatIsAbove) {
  for (const bool shafts : {false, true}) {
    Scene scene;
    test::add(scene, test::square(2, 0, true), test::diffuse(0));
    test::add(scene, test::parallelogram({1, -1, -1}, {0, 0, 2}, {0, 2, 0}), test::diffuse(0, 1000));
    SolveOptions options = test::quick();
    options.shafts = shafts;
    Solved solved(std::move(scene), options);
    solved.solve();
    const SurfacePlace place = leaning(0.3f, -0.4f);
    const auto light = light_at(solved, {place});
    ASSERT_TRUE(light[0]);
    const std::vector<vec3> above{{1, -1, 0}, {1, -1, 1}, {1, 1, 1}, {1, 1, 0}};
    const double truth =
        1000 * double(dot(place.normal, polygon_form_factor(place.position, place.normal, above)));
    EXPECT_NEAR(double(light[0]->x), truth, 0.02 * truth) << shafts;
  }
}

}  // namespace
}  // namespace goldthread
