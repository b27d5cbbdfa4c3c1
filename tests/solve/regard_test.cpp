// What counts: a room does, the plain around it hardly.
#include "solve/hierarchical/regard.h"

#include <gtest/gtest.h>

#include "element/small_elements.h"

namespace goldthread {
namespace {

/// A room of 4 m with a table's worth of triangles, on a plain of so many metres.
Scene room_on_plain(float half, float unit = 1) {
  Scene scene;
  const mat4 size = test::scale(vec3(unit));
  test::add(scene, shapes::cube(3), test::diffuse(0.5f), size * test::scale(vec3(4, 4, 3)));
  test::add(scene, test::square(half, 0, true), test::diffuse(0.2f), size);
  return scene;
}

double area_of(const Scene& scene) {
  const test::Elements elements(scene);
  return regarded_area(*elements.pool, Regard(*elements.set));
}

TEST(Regard, AllOfARoomCounts) {
  const test::Elements elements(test::procedural("cornell-box"));
  const Regard regard(*elements.set);
  for (const ElementId root : elements.pool->surface_roots())
    EXPECT_EQ(regard.of((*elements.pool)[root]), 1.0f);
  EXPECT_EQ(Regard().of((*elements.pool)[0]), 1.0f);
}

TEST(Regard, APlainCountsForNoMoreHoweverFarItGoes) {
  const double small = area_of(room_on_plain(100)), large = area_of(room_on_plain(1000)),
               larger = area_of(room_on_plain(10000));
  EXPECT_LT(small, 1500);  // of 40,000
  EXPECT_GE(large, small);
  EXPECT_LT(larger, 1.5 * small);
}

TEST(Regard, TwoTrianglesOfLandscapeDoNotMakeAScene) {
  // A room as it is drawn for a test of daylight: a plain of 2 among 14 triangles.
  Scene scene;
  test::add(scene, shapes::cube(1), test::diffuse(0.5f), test::scale(vec3(4, 4, 3)));
  test::add(scene, test::square(1000, 0, true), test::diffuse(0.2f));
  EXPECT_LT(area_of(scene), 2000);  // of 4,000,000
}

TEST(Regard, DoesNotDependOnTheUnit) {
  EXPECT_NEAR(area_of(room_on_plain(500, 0.01f)) / area_of(room_on_plain(500)), 1e-4, 1e-8);
}

TEST(Regard, DarknessCountsForMoreButNotWithoutEnd) {
  EXPECT_EQ(weight_of_darkness(100, 100), 1);
  EXPECT_EQ(weight_of_darkness(21, 100), 1);
  // Every share of a stimulus counts alike: half the light, twice the weight.
  for (double light = 19; light > 4; light /= 2)
    EXPECT_NEAR(weight_of_darkness(light / 2, 100), 2 * weight_of_darkness(light, 100), 1e-9);
  EXPECT_EQ(weight_of_darkness(0.01, 100), weight_of_darkness(0, 100));
  EXPECT_NEAR(weight_of_darkness(0, 100), 10, 1e-9);
  EXPECT_EQ(weight_of_darkness(std::numeric_limits<double>::infinity(), 100), 1);
}

TEST(Regard, WhatIsPatternedHidesErrorsByHalfAtMost) {
  EXPECT_EQ(weight_of_masking(0), 1);
  EXPECT_EQ(weight_of_masking(0.05), 1);
  EXPECT_NEAR(weight_of_masking(0.1), std::pow(2, -0.62), 1e-12);
  EXPECT_EQ(weight_of_masking(1), 0.5);
}

}  // namespace
}  // namespace goldthread
