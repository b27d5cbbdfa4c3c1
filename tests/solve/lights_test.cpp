// Lamps, sun and sky over a plane, with and without something in the way.
#include <gtest/gtest.h>

#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

/// A black plane of side 4 round the origin, facing up (+z).
Scene plane(uint32_t quads = 8) {
  Scene scene;
  test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, quads),
            test::add(scene, test::diffuse(0)));
  return scene;
}

/// A black square of side 1 above the middle of the plane, blocking on both sides.
void add_screen(Scene& scene, float height) {
  Material material = test::diffuse(0);
  material.double_sided = true;
  test::add(scene, test::parallelogram({-0.5f, -0.5f, height}, {1, 0, 0}, {0, 1, 0}),
            test::add(scene, material));
}

/// Visits the plane's leaves with their mean irradiance.
template <typename Visit>
void for_each_floor_leaf(const Solved& solved, const Visit& visit) {
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    if (e.part == 0 && !e.back) visit(e, double(solved.state().irradiance[id].x));
  }
}

/// Root mean square of the relative error against a closed form at the leaves' centres, weighted by area.
/// Leaves at the rim of a shadow, where skip(centre, radius) holds, are left out.
template <typename Exact, typename Skip>
double relative_error(const Solved& solved, const Exact& exact, const Skip& skip) {
  double square = 0, all = 0;
  for_each_floor_leaf(solved, [&](const Element& e, double irradiance) {
    if (skip(e.centre, e.radius)) return;
    const double truth = exact(e.centre);
    square += double(e.area) * (irradiance - truth) * (irradiance - truth);
    all += double(e.area) * truth * truth;
  });
  return std::sqrt(square / all);
}
bool skip_none(const vec3&, float) {
  return false;
}

double power(const Solved& solved) {
  double sum = 0;
  for_each_floor_leaf(solved,
                      [&](const Element& e, double irradiance) { sum += double(e.area) * irradiance; });
  return sum;
}

/// Whether the shadow of the screen's square, scaled by `grow` and moved by `by`, has its rim within a leaf.
auto rim_of_shadow(float grow, const vec3& by) {
  return [grow, by](const vec3& c, float radius) {
    const vec3 d = glm::abs(c - by) - vec3(0.5f * grow);
    return std::abs(std::max(d.x, d.y)) < radius;
  };
}

Light point_light(const vec3& position, float candela) {
  Light light;
  light.intensity = vec3(candela);
  light.position = position;
  return light;
}

TEST(PointLight, InverseSquareTimesCosine) {
  Scene scene = plane();
  scene.lights.push_back(point_light({0.3f, 0.2f, 1.5f}, 200));
  Solved solved(std::move(scene));
  solved.solve();
  const auto exact = [](const vec3& p) {
    const vec3 d = vec3(0.3f, 0.2f, 1.5f) - p;
    return 200 * double(d.z) / std::pow(double(dot(d, d)), 1.5);
  };
  EXPECT_LT(relative_error(solved, exact, skip_none), 0.02);
  // All that a quarter solid angle at the lamp holds: the sum over the plane's four corner rectangles.
  double solid_angle = 0;
  for (const double a : {2 - 0.3, 2 + 0.3})
    for (const double b : {2 - 0.2, 2 + 0.2})
      solid_angle += std::atan(a * b / (1.5 * std::sqrt(a * a + b * b + 2.25)));
  EXPECT_NEAR(power(solved) / (200 * solid_angle), 1, 0.005);
}

TEST(PointLight, AScreenCastsItsShadow) {
  Scene scene = plane();
  scene.lights.push_back(point_light({0, 0, 2}, 100));
  add_screen(scene, 1);  // shadow: the square grown twofold
  Solved solved(std::move(scene));
  solved.solve();
  const auto exact = [](const vec3& p) {
    if (std::max(std::abs(p.x), std::abs(p.y)) < 1) return 0.0;
    const vec3 d = vec3(0, 0, 2) - p;
    return 100 * double(d.z) / std::pow(double(dot(d, d)), 1.5);
  };
  EXPECT_LT(relative_error(solved, exact, rim_of_shadow(2, vec3(0))), 0.03);
  const double whole = 4 * std::atan(4 / (2 * std::sqrt(12.0))),
               shaded = 4 * std::atan(1 / (2 * std::sqrt(6.0)));
  EXPECT_NEAR(power(solved) / (100 * (whole - shaded)), 1, 0.02);
}

TEST(SpotLight, LightsItsConeOnly) {
  Scene scene = plane(16);
  Light spot = point_light({0, 0, 2}, 100);
  spot.kind = LightKind::kSpot;
  spot.direction = {0, 0, -1};
  spot.inner_cone = 0.3f;
  spot.outer_cone = 0.6f;
  scene.lights.push_back(spot);
  Solved solved(std::move(scene));
  solved.solve();
  // Integral of ((cos - cos o) / (cos i - cos o))^2 over the ring, and of 1 over the inner cone.
  const double inner = std::cos(0.3), outer = std::cos(0.6);
  const double flux = 100 * 2 * double(kPi) * ((1 - inner) + (inner - outer) / 3);
  EXPECT_NEAR(power(solved) / flux, 1, 0.02);
  for_each_floor_leaf(solved, [&](const Element& e, double irradiance) {
    if (length(vec2(e.centre)) > 2 * std::tan(0.6f) + e.radius) {
      EXPECT_EQ(irradiance, 0);
    }
  });
}

// None of the few places that a link to so large a floor looks at lies in the cone.
TEST(SpotLight, ASmallPoolOnALargeFloorIsFound) {
  Scene scene;
  test::add(scene, test::parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}),
            test::add(scene, test::diffuse(0)));
  Light spot = point_light({7.3f, -4.1f, 1.5f}, 100);
  spot.kind = LightKind::kSpot;
  spot.direction = {0, 0, -1};
  spot.inner_cone = 0.2f;
  spot.outer_cone = 0.3f;
  scene.lights.push_back(spot);
  scene.lights.push_back(point_light({-8, 9, 3}, 20));  // so that there is light without it
  Solved solved(std::move(scene));
  solved.solve();
  const double inner = std::cos(0.2), outer = std::cos(0.3);
  const double flux = 100 * 2 * double(kPi) * ((1 - inner) + (inner - outer) / 3);
  double pool = 0;
  for_each_floor_leaf(solved, [&](const Element& e, double irradiance) {
    if (length(e.centre - vec3(7.3f, -4.1f, 0)) < 1) pool += double(e.area) * irradiance;
  });
  EXPECT_NEAR(pool / flux, 1, 0.05);
}

// What hangs below a ceiling and shines down brings it nothing, and does not have it cut.
TEST(Lights, ACeilingAboveLampsThatShineDownStaysWhole) {
  Scene scene;
  test::add(scene, test::parallelogram({-20, -20, 3}, {0, 40, 0}, {40, 0, 0}),
            test::add(scene, test::diffuse(0)));
  test::add(scene, test::parallelogram({-20, -20, 0}, {40, 0, 0}, {0, 40, 0}),
            test::add(scene, test::diffuse(0)));
  Light spot = point_light({7.3f, -4.1f, 2.9f}, 100), panel = point_light({-6.2f, 3.1f, 2.95f}, 100);
  spot.kind = LightKind::kSpot;
  panel.kind = LightKind::kRectangle;
  panel.size = vec2(0.6f);
  for (const Light& light : {spot, panel}) scene.lights.push_back(light);
  for (Light& light : scene.lights) light.direction = {0, 0, -1};
  Solved solved(std::move(scene));
  solved.solve();
  size_t above = 0, below = 0;
  for (const ElementId id : solved.leaves()) ++(solved.pool()[id].centre.z > 1.5f ? above : below);
  EXPECT_LE(above, 2u);
  EXPECT_GT(below, 50u);
}

TEST(Sun, CosineLawAndShadow) {
  const vec3 direction = normalize(vec3(0.4f, 0, -1));
  for (const bool screen : {false, true}) {
    Scene scene = plane();
    Light sun;
    sun.kind = LightKind::kDirectional;
    sun.intensity = vec3(1000);
    sun.direction = direction;
    scene.lights.push_back(sun);
    if (screen) add_screen(scene, 1);
    Solved solved(std::move(scene));
    solved.solve();
    const double lit = 1000 * double(-direction.z);
    const vec3 shift(0.4f, 0, 0);
    const auto exact = [&](const vec3& p) {
      return screen && std::max(std::abs(p.x - shift.x), std::abs(p.y)) < 0.5f ? 0.0 : lit;
    };
    if (screen) {
      EXPECT_LT(relative_error(solved, exact, rim_of_shadow(1, shift)), 0.01);
      EXPECT_NEAR(power(solved) / (15 * lit), 1, 0.01);
    } else {
      EXPECT_LT(relative_error(solved, exact, skip_none), 1e-4);
    }
  }
}

TEST(Sky, OpenPlaneGetsPiTimesTheLuminance) {
  Scene scene = plane();
  scene.sky.radiance = vec3(100, 200, 300);
  Solved solved(std::move(scene));
  solved.solve();
  EXPECT_LT(relative_error(
                solved, [](const vec3&) { return 100.0 * double(kPi); }, skip_none),
            1e-3);
}

TEST(Sky, AScreenTakesItsFormFactor) {
  Scene scene = plane();
  scene.sky.radiance = vec3(100);
  add_screen(scene, 0.5f);
  Solved solved(std::move(scene));
  solved.solve();
  const std::vector<vec3> seen{
      {-0.5f, -0.5f, 0.5f}, {-0.5f, 0.5f, 0.5f}, {0.5f, 0.5f, 0.5f}, {0.5f, -0.5f, 0.5f}};
  const auto exact = [&](const vec3& p) {
    return 100 * double(kPi) * (1 - double(polygon_form_factor(p, {0, 0, 1}, seen).z));
  };
  EXPECT_LT(relative_error(solved, exact, skip_none), 0.02);
  double truth = 0;
  for (int i = 0; i < 200; ++i)
    for (int j = 0; j < 200; ++j)
      truth += 16.0 / 40000 * exact({-2 + 0.02f * (float(i) + 0.5f), -2 + 0.02f * (float(j) + 0.5f), 0});
  EXPECT_NEAR(power(solved) / truth, 1, 0.005);
}

TEST(Sky, AWallTakesItsFormFactor) {
  // A wall 3 high along one side of the plane hides all that would come through it: the form factor between
  // rectangles at right angles with a common edge (Howell's catalogue, C-14), here with sides 1 and 3/4 of
  // it.
  const double w = 1, h = 0.75, d = w * w + h * h, all = 1 + d;
  const double logs = std::log((1 + w * w) * (1 + h * h) / all) +
                      w * w * std::log(w * w * all / ((1 + w * w) * d)) +
                      h * h * std::log(h * h * all / ((1 + h * h) * d));
  const double hidden =
      (w * std::atan(1 / w) + h * std::atan(1 / h) - std::sqrt(d) * std::atan(1 / std::sqrt(d)) + logs / 4) /
      (double(kPi) * w);
  Scene scene = plane();
  scene.sky.radiance = vec3(100);
  test::add(scene, test::parallelogram({2, -2, 0}, {0, 0, 3}, {0, 4, 0}), test::add(scene, test::diffuse(0)));
  Solved solved(std::move(scene));
  solved.solve();
  EXPECT_NEAR(power(solved) / (16 * 100 * double(kPi) * (1 - hidden)), 1, 0.005);
}

TEST(Panel, LambertsFormulaOnThePlane) {
  // A panel of 1 m^2 at 1 m: the irradiance below it is its exitance times the form factor.
  Scene scene = plane();
  test::add(scene, test::parallelogram({-0.5f, -0.5f, 1}, {0, 1, 0}, {1, 0, 0}),
            test::add(scene, test::diffuse(0, 500)));
  Solved solved(std::move(scene));
  solved.solve();
  const std::vector<vec3> panel{{-0.5f, -0.5f, 1}, {-0.5f, 0.5f, 1}, {0.5f, 0.5f, 1}, {0.5f, -0.5f, 1}};
  const auto exact = [&](const vec3& p) { return 500 * double(polygon_form_factor(p, {0, 0, 1}, panel).z); };
  EXPECT_LT(relative_error(solved, exact, skip_none), 0.02);
}

TEST(Lights, SumOfAllIsTheSumOfEach) {
  const auto lit = [](int which) {
    Scene scene = plane();
    add_screen(scene, 1);
    Light sun;
    sun.kind = LightKind::kDirectional;
    sun.intensity = vec3(50);
    sun.direction = normalize(vec3(0, 0.3f, -1));
    if (which != 1) scene.lights.push_back(point_light({1, 1, 2}, 100));
    if (which != 0) scene.lights.push_back(sun);
    Solved solved(std::move(scene));
    return power(solved.solve());
  };
  EXPECT_NEAR(lit(2) / (lit(0) + lit(1)), 1, 0.01);
}

}  // namespace
}  // namespace goldthread
