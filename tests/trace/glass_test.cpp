// Paths through glass, where the light is known.
#include "scene/glass_scenes.h"
#include "trace/path_tracer.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

const vec3 kUp(0, 0, 1);
const vec3 kColour(0.9f, 0.5f, 0.04f);

TEST(TracedGlass, LampThroughPanes) {
  for (int panes = 1; panes <= 2; ++panes) {
    Scene scene = under_panes(glass(kColour, 1), panes);
    scene.lights.push_back(lamp(LightKind::kPoint, 100, vec3(0.3f, 0.1f, 2)));
    const Traced t(std::move(scene));
    // Not on a pane's diagonal: a ray along the edge of two triangles goes through both.
    const IrradianceValue value = t.at(vec3(0.3f, 0.1f, 0), kUp, 16);
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(value.mean[c], 25 * std::pow(double(kColour[c]), panes), 1e-3) << c;
  }
}

// Half of the sky's light is found by paths, which have to end somewhere.
TEST(TracedGlass, SkyThroughPanes) {
  Scene scene = under_panes(glass(kColour, 1), 2);
  scene.sky.radiance = vec3(1000 / kPi);
  const Traced t(std::move(scene));
  const IrradianceValue value = t.at(vec3(0), kUp, 16384);
  for (int c = 0; c < 3; ++c) {
    const double truth = 1000 * double(kColour[c] * kColour[c]);
    // The panes end 20 m away: less than one part in 800 of the hemisphere, and all of its light.
    EXPECT_NEAR(value.mean[c], truth, 4 * value.standard_error[c] + 1.6) << c;
    EXPECT_LE(value.standard_error[c], 0.05 * truth + 1) << c;
  }
}

TEST(TracedGlass, FurnaceIsUniform) {
  const vec3 b(3, 2, 1);
  for (const float transmission : {0.5f, 1.0f}) {
    const Traced t(glazed_furnace(b, {0.8f, 0.5f, 0.2f}, transmission));
    const std::vector<Receiver> points = random_receivers(*t.traced, 32, 1);
    expect_estimates(t.mean(points, 1024), dvec3(b), 0.01);
  }
}

// All light goes through, and yet the pane glows: rays have to find it by a coin that no light asks for.
TEST(TracedGlass, ClearGlassMayGlow) {
  const vec3 b(2);
  Scene scene = glazed_furnace(b, vec3(1), 1);
  scene.materials.back().emission = vec3(0.5f);
  const Traced t(std::move(scene));
  Scene dark = glazed_furnace(b, vec3(1), 1);
  const Traced plain(std::move(dark));
  expect_estimates(plain.mean(random_receivers(*plain.traced, 32, 1), 1024), dvec3(b), 0.01);
  EXPECT_GT(t.mean(random_receivers(*t.traced, 32, 1), 1024).mean.x, 2.1);
}

TEST(TracedGlass, CameraSeesThroughInColour) {
  Scene scene = under_panes(glass(kColour, 1), 1);
  scene.materials[0] = diffuse(0, kPi);
  const Traced t(std::move(scene));
  const CameraPath path{{vec3(0, 0, 3), vec3(0, 0, -1)}, {}};
  dvec3 sum(0);
  constexpr int kPaths = 4000;
  for (int i = 0; i < kPaths; ++i) {
    CameraPath aside = path;
    aside.ray.origin.x = 1e-4f * float(i);
    vec3 nits;
    PathCost cost;
    t.tracer->radiance({&aside, 1}, {&nits, 1}, cost);
    sum += dvec3(nits) / double(kPaths);
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], double(kColour[c]), 0.05) << c;
}

}  // namespace
}  // namespace goldthread
