// What is certain of the way between two elements, and what a solve makes of it.
#include "solve/hierarchical/sight.h"

#include <gtest/gtest.h>

#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

/// A floor and a ceiling two metres above it, each two metres wide; a plate of `half` metres in between.
Scene between(float half, bool masked = false) {
  Scene scene;
  test::add(scene, test::square(1, 0, true), test::diffuse(0.5f));
  test::add(scene, test::square(1, 2, false), test::diffuse(0.5f, 1));
  if (half > 0) {
    Material plate = test::diffuse(0.5f);
    plate.double_sided = true;
    if (masked) plate.alpha_mode = AlphaMode::kBlend;
    test::add(scene, test::square(half, 1, true), std::move(plate));
  }
  return scene;
}

Sight sight(const Solved& solved) {
  const std::span<const ElementId> roots = solved.pool().surface_roots();
  return certain_sight(solved.pool(), solved.solver->visibility(), roots[0], roots[1]);
}

TEST(Sight, ClearWhereNothingStandsBetween) {
  EXPECT_EQ(sight(Solved(between(0))), Sight::kClear);
  EXPECT_EQ(sight(Solved(between(0.01f))), Sight::kSampled);  // rays may miss it
}

TEST(Sight, NothingIsCertainThroughGlassOrWithoutShafts) {
  EXPECT_EQ(sight(Solved(between(1.1f, true))), Sight::kSampled);
  SolveOptions options;
  options.shafts = false;
  EXPECT_EQ(sight(Solved(between(0), options)), Sight::kSampled);
}

/// Mean irradiance on the floor, rays, and links that are certain.
struct Outcome {
  double light = 0;
  uint64_t rays = 0, certain = 0;
};
Outcome solved(float half, bool shafts) {
  SolveOptions options = test::quick();
  options.shafts = shafts;
  Solved s(between(half), options);
  s.solve();
  Outcome out;
  out.light = double(s.state().irradiance[s.pool().surface_roots()[0]].y);
  out.rays = s.solver->stats().rays.rays;
  for (const Link& link : s.solver->links().all()) out.certain += link.sight != Sight::kSampled;
  return out;
}

TEST(Sight, SavesRaysAndChangesNoLight) {
  for (const float half : {0.0f, 0.3f, 1.5f}) {
    const Outcome with = solved(half, true), without = solved(half, false);
    EXPECT_NEAR(with.light, without.light, 0.01 * without.light + 1e-4) << half;
    EXPECT_GT(with.certain, 0u) << half;
    EXPECT_EQ(without.certain, 0u);
    EXPECT_LT(with.rays, without.rays) << half;
  }
  EXPECT_EQ(solved(0, true).rays, 0u);  // an empty room needs none
}

}  // namespace
}  // namespace goldthread
