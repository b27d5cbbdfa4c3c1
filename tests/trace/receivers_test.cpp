#include "trace/receivers.h"

#include <cmath>
#include <map>

#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

/// A one-sided square of 4 m2, a two-sided one of 1 m2, an unlit one.
Scene three_squares() {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(0.5f));
  add(scene, square(0.5f, 1, true), diffuse(0.5f));
  scene.materials.back().double_sided = true;
  add(scene, square(3, 2, true), diffuse(0.5f));
  scene.materials.back().unlit = true;
  return scene;
}

TEST(Receivers, RandomOnesFollowArea) {
  const Traced t(three_squares());
  constexpr size_t kCount = 6000;
  const std::vector<Receiver> points = random_receivers(*t.traced, kCount, 5);
  std::map<std::pair<float, float>, int> sides;  // height, side
  dvec3 sum(0);
  for (const Receiver& r : points) {
    ++sides[{std::round(r.point.z), r.normal.z}];
    EXPECT_NEAR(r.point.z, std::round(r.point.z), 1e-6f);
    EXPECT_NEAR(length(r.origin - r.point - t.traced->epsilon() * r.normal), 0, 1e-6f);
    sum += dvec3(r.point);
  }
  // Shares 4, 1 and 1 of 6, within four deviations.
  const auto expect_count = [&](float z, float side, double share) {
    EXPECT_NEAR((sides[{z, side}]), share * kCount, 4 * std::sqrt(share * (1 - share) * kCount));
  };
  expect_count(0, 1, 4 / 6.0);
  expect_count(1, 1, 1 / 6.0);
  expect_count(1, -1, 1 / 6.0);
  EXPECT_EQ(sides.size(), 3u);
  EXPECT_NEAR(sum.x / kCount, 0, 4 * 0.6 / std::sqrt(double(kCount)));
  // More points begin with the same ones.
  const std::vector<Receiver> more = random_receivers(*t.traced, kCount + 10, 5);
  EXPECT_EQ(more[kCount - 1].point, points[kCount - 1].point);
  EXPECT_NE(random_receivers(*t.traced, 1, 6)[0].point, points[0].point);
}

TEST(Receivers, VerticesOfAllInstances) {
  Scene scene = three_squares();
  mat4 mirror(1);
  mirror[2][2] = -1;
  mirror[3] = vec4(0, 0, 10, 1);
  scene.instances.push_back({0, mirror, 0, {}});
  scene.meshes[0].primitives[0].positions.emplace_back(99.0f);  // no triangle uses it
  const Traced t(std::move(scene));
  const std::vector<Receiver> points = vertex_receivers(*t.traced);
  ASSERT_EQ(points.size(), 4u + 8u + 4u);
  EXPECT_EQ(points[0].point, vec3(-1, -1, 0));
  EXPECT_EQ(points[0].normal, vec3(0, 0, 1));
  EXPECT_EQ(points[0].vertex, 0u);
  EXPECT_TRUE(points[5].back);
  EXPECT_EQ(points[5].normal, vec3(0, 0, -1));
  EXPECT_EQ(points[12].instance, 3u);
  EXPECT_EQ(points[12].point, vec3(-1, -1, 10));
  EXPECT_EQ(points[12].normal, vec3(0, 0, -1));
  // Off the corner, so that rays do not run in the plane of a wall that stands there.
  EXPECT_GT(points[0].origin.x, -1);
  EXPECT_GT(points[0].origin.z, 0);
  EXPECT_LT(length(points[0].origin - points[0].point), 10 * t.traced->epsilon());
}

TEST(Receivers, NormalsOfTheFileAreTransformed) {
  Scene scene;
  Primitive& p = add(scene, square(1, 0, true), diffuse(0.5f));
  p.normals.assign(4, normalize(vec3(1, 0, 1)));
  scene.instances[0].transform[0][0] = 2;  // twice as wide: normals lean half as much
  const Traced t(std::move(scene));
  const vec3 n = vertex_receivers(*t.traced)[0].normal;
  EXPECT_LT(length(n - normalize(vec3(0.5f, 0, 1))), 1e-6f);
}

// A square whose vertex normals lean outwards, as on a pillow.
TEST(Receivers, TurnToWhatLiesBetweenVertexNormals) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(0.5f));
  scene.materials.back().double_sided = true;
  Primitive& primitive = scene.meshes[0].primitives[0];
  for (const vec3& p : primitive.positions) primitive.normals.push_back(normalize(vec3(0.5f * p.x, 0, 1)));
  const Traced t(std::move(scene));
  for (Receiver r : random_receivers(*t.traced, 50, 5)) {
    const vec3 flat = r.normal;
    turn_to_shading_normal(*t.traced, r);
    // Sines are linear between the sides, cosines alike all over.
    const vec3 expected = normalize(vec3(0.5f * r.point.x, 0, 1)) * flat.z;
    EXPECT_NEAR(length(r.normal - expected), 0, 1e-5f) << r.point.x;
    EXPECT_EQ(r.surface, flat);
    EXPECT_GT(dot(r.normal, flat), 0);
  }
}

TEST(Receivers, KeepTheFacesNormalWhereTheFileIsMistaken) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(0.5f));
  add(scene, square(1, 1, true), diffuse(0.5f));
  scene.meshes[0].primitives[0].normals.assign(4, vec3(0, 0, -1));
  const Traced t(std::move(scene));
  for (Receiver r : random_receivers(*t.traced, 50, 5)) {
    turn_to_shading_normal(*t.traced, r);
    EXPECT_EQ(r.normal, vec3(0, 0, 1));
    EXPECT_EQ(r.surface, vec3(0));
  }
}

vec3 turned(const vec3& v) {
  return {-v.y, v.x, v.z};
}

// The floor beneath a box, with normals as of a pillow: what looks below the floor meets the floor itself.
TEST(Receivers, AreBuriedUnderABoxHoweverTheyAreTurned) {
  Scene scene;
  Primitive& floor = add(scene, square(1, 0, true), diffuse(0.5f));
  floor.normals.assign(4, normalize(vec3(1, 0, 1)));
  for (const vec3& side : {vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0)})
    add(scene, parallelogram(0.5f * (side - turned(side)), turned(side), {0, 0, 1}), diffuse(0.5f));
  add(scene, square(0.5f, 1, true), diffuse(0.5f));
  const Traced t(std::move(scene));
  int beneath = 0;
  for (Receiver r : random_receivers(*t.traced, 400, 5)) {
    if (r.point.z != 0 || r.normal.z < 0.5f || std::max(std::abs(r.point.x), std::abs(r.point.y)) > 0.45f)
      continue;
    turn_to_shading_normal(*t.traced, r);
    EXPECT_NE(r.surface, vec3(0));
    EXPECT_TRUE(is_buried(*t.traced, r));
    ++beneath;
  }
  EXPECT_GT(beneath, 5);
}

TEST(Receivers, PlacedOnTheNearestSurface) {
  const Traced t(three_squares());
  const PlacedReceiver on = place_receiver(*t.traced, vec3(0.3f, 0.2f, 0), vec3(0, 0, 1));
  EXPECT_EQ(on.distance, 0);
  EXPECT_GT(on.receiver.origin.z, 0);
  EXPECT_LT(on.receiver.origin.z, 1e-3f);
  EXPECT_NEAR(place_receiver(*t.traced, vec3(0.3f, 0.2f, 0.25f), vec3(0, 0, 1)).distance, 0.25f, 1e-6f);
  EXPECT_NEAR(place_receiver(*t.traced, vec3(7, 0, 2), vec3(0, 0, 1)).distance, 4, 1e-5f);
  EXPECT_NEAR(place_receiver(*t.traced, vec3(6, 7, 2), vec3(0, 0, 1)).distance, 5, 1e-5f);
  // Rounding that has left it a little below is made good.
  const PlacedReceiver below = place_receiver(*t.traced, vec3(0.3f, 0.2f, -2e-4f), vec3(0, 0, 1));
  EXPECT_LT(below.distance, on_surface_distance(*t.traced));
  EXPECT_GT(below.receiver.origin.z, 0);
}

// Where a floor meets a wall the point belongs to both; the normal decides.
TEST(Receivers, OnAnEdgeTheNormalDecides) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(0.5f));
  add(scene, polygon({vec3(-1, -1, 0), vec3(-1, 1, 0), vec3(-1, 1, 2), vec3(-1, -1, 2)}), diffuse(0.5f));
  const Traced t(std::move(scene));
  const vec3 up(0, 0, 1), across(1, 0, 0), corner(-1, 0.1f, 0);
  const vec3 floor = place_receiver(*t.traced, corner, up).receiver.origin - corner;
  const vec3 wall = place_receiver(*t.traced, corner, across).receiver.origin - corner;
  EXPECT_GT(floor.x, floor.z);
  EXPECT_GT(wall.z, wall.x);
  EXPECT_GT(std::min({floor.x, floor.z, wall.x, wall.z}), 0);
}

}  // namespace
}  // namespace goldthread
