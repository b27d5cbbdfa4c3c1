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

SolveOptions with_shafts(bool shafts = true) {
  SolveOptions options = test::quick();
  options.shafts = shafts;
  return options;
}

Sight sight(Scene scene, bool shafts = true) {
  const Solved solved(std::move(scene), with_shafts(shafts));
  const std::span<const ElementId> roots = solved.pool().surface_roots();
  return certain_sight(solved.pool(), solved.solver->visibility(), roots[0], roots[1]);
}

TEST(Sight, ClearWhereNothingStandsBetween) {
  EXPECT_EQ(sight(between(0)), Sight::kClear);
  EXPECT_EQ(sight(between(0.01f)), Sight::kSampled);  // rays may miss it
}

TEST(Sight, NothingIsCertainThroughGlassOrWithoutShafts) {
  EXPECT_EQ(sight(between(1.1f, true)), Sight::kSampled);
  EXPECT_EQ(sight(between(0), false), Sight::kSampled);
}

/// Mean irradiance on the floor, rays, and links that are certain.
struct Outcome {
  double light = 0;
  uint64_t rays = 0, certain = 0;
};
Outcome solved(float half, bool shafts) {
  Solved s(between(half), with_shafts(shafts));
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

// Every clear link of rooms full of things, held against rays between points of both ends.
TEST(Sight, ClearLinksStopNoRay) {
  for (const char* name : {"cornell-box", "office"}) {
    Solved s(test::procedural(name, 0), with_shafts());
    s.solve();
    const Visibility& visibility = s.solver->visibility();
    uint64_t clear = 0, stopped = 0, cast = 0;
    for (const Link& link : s.solver->links().all()) {
      if (link.sight != Sight::kClear || !is_surface(s.pool()[link.source].kind)) continue;
      ++clear;
      for (uint32_t i = 0; i < 16; ++i) {
        const float u = (float(i) + 0.5f) / 16, v = std::fmod(float(i) * 0.618034f, 1.0f);
        const SurfacePoint x = s.pool().sample_at(link.receiver, u, v),
                           y = s.pool().sample_at(link.source, v, u);
        if (dot(y.position - x.position, x.normal) <= 0 || dot(x.position - y.position, y.normal) <= 0)
          continue;
        const vec3 from = x.position + visibility.epsilon * x.normal,
                   to = y.position + visibility.epsilon * y.normal;
        stopped += visibility.caster->transmittance({from, to - from, 0, 1 - 1e-4f}) < 1;
        ++cast;
      }
    }
    EXPECT_GT(clear, 100u) << name;
    EXPECT_EQ(stopped, 0u) << name << ": of " << cast;
  }
}

}  // namespace
}  // namespace goldthread
