// Where light jumps: the feet of what stands there and the edges of shadows.
#include "solve/hierarchical/discontinuity.h"

#include <gtest/gtest.h>

#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

SolveOptions following(bool discontinuities = true) {
  SolveOptions options = test::quick();
  options.discontinuities = discontinuities;
  return options;
}

/// A floor at height 0, of one triangle: (-2, -2), (6, -2), (-2, 6).
shapes::Soup large_triangle() {
  shapes::Soup soup;
  for (const vec3& p : {vec3(-2, -2, 0), vec3(6, -2, 0), vec3(-2, 6, 0)}) soup.positions.push_back(p);
  soup.indices = {0, 1, 2};
  return soup;
}

Material two_sided() {
  Material material = test::diffuse(0.5f);
  material.double_sided = true;
  return material;
}

/// The floor with an upright sheet from (x, y0) to (x, y1) that reaches from `low` to `high`.
Scene floor_and_sheet(float x, float y0, float y1, float low, float high) {
  Scene scene;
  test::add(scene, large_triangle(), test::diffuse(0.5f));
  test::add(scene, test::parallelogram({x, y0, low}, {0, y1 - y0, 0}, {0, 0, high - low}), two_sided());
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {-1, -1, 3}));
  return scene;
}

ElementId floor_of(const Solved& solved) {
  for (const ElementId id : solved.pool().surface_roots())
    if (solved.pool()[id].part == 0) return id;
  return kNoElement;
}

CutPlane foot_of(Scene scene, bool discontinuities = true) {
  const Solved solved(std::move(scene), following(discontinuities));
  Feet feet;
  feet.grow_to(solved.pool(), solved.solver->visibility());
  return feet.of(floor_of(solved));
}

/// Height of a place above a plane, either way.
double distance(const CutPlane& plane, const dvec3& p) {
  return std::abs(glm::dot(dvec3(plane.normal), p) - double(plane.offset));
}

TEST(Feet, AreFoundWhereASheetStandsOrGoesThrough) {
  for (const float low : {0.0f, -0.5f}) {
    const CutPlane foot = foot_of(floor_and_sheet(1, -2, 3, low, 2));
    ASSERT_TRUE(foot.present()) << low;
    EXPECT_EQ(foot.seam, Seam::kSharp);
    EXPECT_NEAR(distance(foot, {1, -2, 0}), 0, 1e-5);
    EXPECT_NEAR(distance(foot, {1, 3, 0}), 0, 1e-5);
    EXPECT_NEAR(distance(foot, {2, 0, 0}), 1, 1e-5);
  }
}

TEST(Feet, ShortOnesAndOnesBelowAndAboveAreNone) {
  EXPECT_FALSE(foot_of(floor_and_sheet(1, 0, 1, 0, 2)).present());      // a fifth of the cut
  EXPECT_FALSE(foot_of(floor_and_sheet(1, -2, 3, 0.3f, 2)).present());  // a gap
  EXPECT_FALSE(foot_of(floor_and_sheet(1, -2, 3, -1, 0)).present());    // a cellar's wall
  EXPECT_FALSE(foot_of(floor_and_sheet(-2, -2, 6, 0, 2)).present());    // at the floor's own edge
  EXPECT_FALSE(foot_of(floor_and_sheet(1, -2, 3, 0, 2), false).present());
}

// Under what hovers light gets in, but not far: a cut, of which no room lies on the far side.
TEST(Feet, OfWhatHoversAreGaps) {
  const Solved solved(floor_and_sheet(1, -2, 3, 0.02f, 2), following());
  Feet feet;
  feet.grow_to(solved.pool(), solved.solver->visibility());
  const CutPlane foot = feet.of(floor_of(solved));
  ASSERT_TRUE(foot.present());
  EXPECT_EQ(foot.seam, Seam::kGap);
  EXPECT_FALSE(feet.part(floor_of(solved)));
}

/// The floor with a plate just above it, that shines away from it as a lamp on a ceiling does.
Scene floor_and_plate(const vec3& from, const vec3& across, const vec3& up) {
  Scene scene;
  test::add(scene, large_triangle(), test::diffuse(0.5f));
  Material lamp = test::diffuse(0.5f);
  lamp.emission = vec3(100);
  test::add(scene, test::parallelogram(from, across, up), std::move(lamp));
  return scene;
}

// All of a plate is as near as its edges are; what two of its triangles share is none of them.
TEST(Feet, OfAPlateThatHoversAreItsEdges) {
  const CutPlane foot = foot_of(floor_and_plate({1, -3, 0.02f}, {9, 0, 0}, {0, 10, 0}));
  ASSERT_TRUE(foot.present());
  EXPECT_EQ(foot.seam, Seam::kGap);
  EXPECT_NEAR(distance(foot, {1, -2, 0}), 0, 1e-5);
  EXPECT_NEAR(distance(foot, {1, 3, 0}), 0, 1e-5);
  EXPECT_FALSE(foot_of(floor_and_plate({-10, -10, 0.02f}, {20, 0, 0}, {0, 20, 0})).present());
  EXPECT_FALSE(foot_of(floor_and_plate({1, -3, -0.02f}, {9, 0, 0}, {0, 10, 0})).present());
  EXPECT_FALSE(foot_of(floor_and_plate({1, -3, 0.5f}, {9, 0, 0}, {0, 10, 0})).present());
}

// A sheet of which one end goes through the floor while the other hovers: its foot is all of it.
TEST(Feet, OfATiltedSheetIsAllOfIt) {
  Scene scene;
  test::add(scene, large_triangle(), test::diffuse(0.5f));
  test::add(scene, test::parallelogram({1, -2, -0.004f}, {0, 5, 0.014f}, {0, 0, 2}), two_sided());
  const Solved solved(std::move(scene), following());
  Feet feet;
  feet.grow_to(solved.pool(), solved.solver->visibility());
  EXPECT_TRUE(feet.is_long(floor_of(solved)));
  EXPECT_EQ(feet.of(floor_of(solved)).seam, Seam::kGap);
  EXPECT_FALSE(feet.part(floor_of(solved)));
}

// What goes on below the floor leaves no gap, however little of it is there.
TEST(Feet, OfWhatEndsJustBelowAreClosed) {
  for (const float low : {-0.5f, -0.02f, -1e-3f}) {
    const Solved solved(floor_and_sheet(1, -2, 3, low, 2), following());
    Feet feet;
    feet.grow_to(solved.pool(), solved.solver->visibility());
    EXPECT_EQ(feet.of(floor_of(solved)).seam, Seam::kSharp) << low;
    EXPECT_TRUE(feet.part(floor_of(solved))) << low;
  }
}

// A closet in a large floor: none of its walls runs along much of a cut.
TEST(Feet, OfAllWallsTogetherPartRooms) {
  const auto wall = [](Scene& scene, const vec3& from, const vec3& along) {
    test::add(scene, test::parallelogram(from, along, {0, 0, 2}), two_sided());
  };
  const auto parts = [](Scene scene) {
    const Solved solved(std::move(scene), following());
    Feet feet;
    feet.grow_to(solved.pool(), solved.solver->visibility());
    EXPECT_FALSE(feet.is_long(floor_of(solved)));
    return feet.part(floor_of(solved));
  };
  Scene scene;
  test::add(scene, large_triangle(), test::diffuse(0.5f));
  wall(scene, {-1, -1, 0}, {1, 0, 0});
  Scene closet = scene;
  wall(closet, {0, -1, 0}, {0, 1, 0});
  wall(closet, {0, 0, 0}, {-1, 0, 0});
  wall(closet, {-1, 0, 0}, {0, -1, 0});
  EXPECT_FALSE(parts(std::move(scene)));
  EXPECT_TRUE(parts(std::move(closet)));
}

// What is small for the scene is no wall, though its foot is a seam as sharp as any.
TEST(Feet, OfSmallThingsPartNoRooms) {
  Scene scene;
  test::add(scene, test::square(50, -1, true), test::diffuse(0.5f));
  test::add(scene, large_triangle(), test::diffuse(0.5f));
  test::add(scene, test::parallelogram({1, -2, 0}, {0, 5, 0}, {0, 0, 2}), two_sided());
  const Solved solved(std::move(scene), following());
  Feet feet;
  feet.grow_to(solved.pool(), solved.solver->visibility());
  for (const ElementId id : solved.pool().surface_roots()) {
    if (solved.pool()[id].part != 1) continue;
    EXPECT_EQ(feet.of(id).seam, Seam::kSharp);
    EXPECT_FALSE(feet.part(id));
  }
}

// A wall of several triangles: none of them stands along enough of the cut.
TEST(Feet, PiecesOfOneLineAddUp) {
  Scene scene = floor_and_sheet(5, 0, 1, 0, 2);
  for (int k = 0; k < 5; ++k)
    test::add(scene, test::parallelogram({1, -2.0f + float(k), 0}, {0, 1, 0}, {0, 0, 2}), two_sided());
  EXPECT_TRUE(foot_of(std::move(scene)).present());
}

TEST(Feet, OfAClusterAreThoseOfItsTriangles) {
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0.5f));
  test::add(scene, test::parallelogram({0.5f, -2, 0}, {0, 4, 0}, {0, 0, 1}), two_sided());
  const Solved solved(std::move(scene), following());
  Feet feet;
  feet.grow_to(solved.pool(), solved.solver->visibility());
  ASSERT_EQ(solved.pool()[floor_of(solved)].kind, ElementKind::kCluster);
  EXPECT_TRUE(feet.part(floor_of(solved)));
}

/// The floor's cut for a lamp, with a plate at height 1 over x > 1 that shades x > `edge` of it.
CutPlane shadow_on_floor(Light lamp, bool lit_all = false) {
  Scene scene;
  test::add(scene, large_triangle(), test::diffuse(0.5f));
  Material plate = test::diffuse(0.0f);
  plate.double_sided = true;
  const float x = lit_all ? 50.0f : 1.0f;
  test::add(scene, test::parallelogram({x, -50, 1}, {50, 0, 0}, {0, 100, 0}), std::move(plate));
  scene.lights.push_back(std::move(lamp));
  const Solved solved(std::move(scene), following());
  const ElementPool& pool = solved.pool();
  Link link;  // as a solve would find it: some see the lamp and some do not
  link.receiver = floor_of(solved);
  link.source = pool.lights()[0];
  link.visibility = 128;
  link.unoccluded = 1;
  const LampLinks lamps(pool, solved.state(), {&link, 1});
  Feet feet;
  RayCount rays;
  const ElementId id = floor_of(solved);
  const CutPlane cut =
      find_discontinuities(pool, solved.solver->visibility(), {&id, 1}, feet, lamps, rays).front();
  EXPECT_GT(rays.rays, 0u);
  return cut;
}

TEST(ShadowEdges, LieWhereTheLampPutsThem) {
  // From (-1, 0, 3) past the edge at x = 1 and height 1 to x = 2 on the floor.
  const CutPlane point = shadow_on_floor(test::lamp(LightKind::kPoint, 100, {-1, 0, 3}));
  ASSERT_TRUE(point.present());
  EXPECT_EQ(point.seam, Seam::kSharp);
  EXPECT_NEAR(distance(point, {2, -2, 0}), 0, 1e-5);
  EXPECT_NEAR(distance(point, {2, 2, 0}), 0, 1e-5);
  EXPECT_NEAR(distance(point, {3, 0, 0}), 1, 1e-5);
  // A sun at 45 degrees moves the edge by the height.
  const CutPlane sun =
      shadow_on_floor(test::lamp(LightKind::kDirectional, 100, {0, 0, 0}, normalize(vec3(1, 0, -1))));
  ASSERT_TRUE(sun.present());
  EXPECT_EQ(sun.seam, Seam::kSharp);
  EXPECT_NEAR(distance(sun, {2, 1, 0}), 0, 1e-4);
}

// Across a penumbra light bends and does not jump: a cut, but one light on both sides of it.
TEST(ShadowEdges, OfLampsWithSizeAreNoSeams) {
  Light ball = test::lamp(LightKind::kPoint, 100, {-1, 0, 3});
  ball.radius = 0.05f;
  const CutPlane cut = shadow_on_floor(ball);
  ASSERT_TRUE(cut.present());
  EXPECT_EQ(cut.seam, Seam::kNone);
}

TEST(ShadowEdges, NoneWhereAllIsLit) {
  EXPECT_FALSE(shadow_on_floor(test::lamp(LightKind::kPoint, 100, {-1, 0, 3}), true).present());
}

// The solver's own mesh then has no leaf that is lit in part.
TEST(ShadowEdges, LeaveNoLeafHalfInTheShade) {
  Scene scene;
  test::add(scene, large_triangle(), test::diffuse(0.0f));
  test::add(scene, test::parallelogram({1, -50, 1}, {50, 0, 0}, {0, 100, 0}), test::diffuse(0.0f));
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {-1, 0, 3}));
  Solved solved(std::move(scene), following());
  solved.solve();
  for (const ElementId id : solved.leaves()) {
    if (solved.pool()[id].part != 0) continue;
    float least = 1e9f, most = -1e9f;
    const ElementPolygon polygon = solved.pool().polygon(id);
    for (const vec3& p : polygon.span()) {
      least = std::min(least, p.x);
      most = std::max(most, p.x);
    }
    EXPECT_TRUE(most < 2.0001f || least > 1.9999f) << least << " to " << most;
    EXPECT_EQ(solved.state().irradiance[id].x > 0, most < 2.0001f);
  }
}

}  // namespace
}  // namespace goldthread
