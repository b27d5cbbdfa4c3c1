// Alpha as visibility: how much light gets through masks and blends.
#include <gtest/gtest.h>

#include "session/light_setup.h"
#include "session/power_balance.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

Image half_holes() {
  Image image;
  image.width = 32;
  image.height = 1;
  for (uint32_t x = 0; x < 32; ++x)
    image.rgba.insert(image.rgba.end(), {0, 0, 0, uint8_t(x % 4 < 2 ? 255 : 0)});
  return image;
}

/// A black floor of 2 by 2, a screen of 4 by 4 a metre above it, a sun that shines straight down.
Scene under_screen(Material screen, bool sun) {
  Scene scene;
  test::add(scene, test::parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 8),
            test::add(scene, test::diffuse(0)));
  screen.double_sided = true;
  const shapes::Soup soup = test::parallelogram({-2, -2, 1}, {4, 0, 0}, {0, 4, 0}, 2);
  test::add(scene, soup, test::add(scene, std::move(screen)));
  for (const vec3& p : soup.positions)
    scene.meshes[1].primitives[0].texcoords[0].push_back(0.25f * vec2(p) + 0.5f);
  scene.images.push_back(half_holes());
  if (sun) {
    Light light;
    light.kind = LightKind::kDirectional;
    light.intensity = vec3(1000);
    light.direction = {0, 0, -1};
    scene.lights.push_back(light);
  } else {
    scene.sky.radiance = vec3(1000 / kPi);
  }
  return scene;
}

/// A black material of which `alpha` is there.
Material blend(float alpha) {
  Material screen = test::diffuse(0);
  screen.alpha_mode = AlphaMode::kBlend;
  screen.alpha = alpha;
  return screen;
}

double floor_mean(Scene scene) {
  Solved solved(std::move(scene), {}, transparency);
  solved.solve();
  double sum = 0, area = 0;
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    if (e.part != 0) continue;
    sum += double(e.area * solved.state().irradiance[id].x);
    area += double(e.area);
  }
  return sum / area;
}

TEST(Alpha, OpaqueScreenLetsNothingThrough) {
  EXPECT_EQ(floor_mean(under_screen(test::diffuse(0), true)), 0);
}

TEST(Alpha, BlendLetsItsShareThrough) {
  for (const float alpha : {0.25f, 0.6f, 0.9f}) {
    EXPECT_NEAR(floor_mean(under_screen(blend(alpha), true)) / 1000, 1 - double(alpha), 1e-4) << alpha;
  }
}

TEST(Alpha, TwoBlendsLetTheProductThrough) {
  const Material screen = blend(0.4f);
  Scene scene = under_screen(screen, true);
  scene.instances.push_back(scene.instances[1]);
  scene.instances[2].transform = test::move({0, 0, 0.7f});
  EXPECT_NEAR(floor_mean(std::move(scene)) / 1000, 0.36, 1e-4);
}

TEST(Alpha, NoSpotOfTheFloorIsNoisy) {
  const Material screen = blend(0.6f);
  Solved solved(under_screen(screen, true), {}, transparency);
  solved.solve();
  const test::Summary floor = summarise(solved, [&](ElementId id) {
    return solved.pool()[id].part == 0 ? solved.state().irradiance[id].x : 400.0f;
  });
  EXPECT_NEAR(floor.least, 400, 0.1);
  EXPECT_NEAR(floor.most, 400, 0.1);
}

TEST(Alpha, MaskLetsLightThroughItsHoles) {
  Material screen = test::diffuse(0);
  screen.alpha_mode = AlphaMode::kMask;
  screen.base_colour_texture.image = 0;
  EXPECT_NEAR(floor_mean(under_screen(screen, true)) / 1000, 0.5, 0.03);
}

TEST(Alpha, MaskOfAWholeMaterial) {
  Material screen = test::diffuse(0);
  screen.alpha_mode = AlphaMode::kMask;
  screen.alpha = 0.4f;  // below the cutoff: all of it is hole
  EXPECT_NEAR(floor_mean(under_screen(screen, true)) / 1000, 1, 1e-3);
  screen.alpha = 0.6f;
  EXPECT_EQ(floor_mean(under_screen(screen, true)), 0);
}

TEST(Alpha, SkyThroughABlend) {
  // The screen takes alpha of its form factor from every point of the floor.
  const Material screen = blend(0.5f);
  const std::vector<vec3> seen{{-2, -2, 1}, {-2, 2, 1}, {2, 2, 1}, {2, -2, 1}};
  double mean = 0;
  for (int i = 0; i < 400; ++i) {
    const vec3 p(-1 + 2 * (float(i % 20) + 0.5f) / 20, -1 + 2 * (float(i / 20) + 0.5f) / 20, 0);
    mean += (1 - 0.5 * double(polygon_form_factor(p, {0, 0, 1}, seen).z)) / 400;
  }
  EXPECT_NEAR(floor_mean(under_screen(screen, false)) / 1000, mean, 0.015);
}

TEST(Alpha, PowerIsKept) {
  Material screen = test::diffuse(0.5f);
  screen.alpha_mode = AlphaMode::kBlend;
  screen.alpha = 0.5f;
  Solved solved(under_screen(screen, true), {}, transparency);
  solved.solve();
  const PowerBalance power = measure_power(*solved.solver, 400000, 1);
  EXPECT_GT(power.emitted, 0);
  EXPECT_LE(std::abs(power.residual), 0.01 * power.emitted);
}

}  // namespace
}  // namespace goldthread
