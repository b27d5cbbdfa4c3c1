// Rectangle and disc lamps, by the hierarchical solver.
#include <gtest/gtest.h>

#include "scene/area_lamps.h"
#include "solve/hierarchical/area_lamp.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::disc_lamp;
using test::rectangle_lamp;
using test::Solved;

const vec3 kUp(0, 0, 1);
constexpr double kNits = 700, kExitance = kNits * double(kPi);

/// Irradiance on a plane of normal n at x, were nothing between.
double brought(const Light& light, const vec3& x, const vec3& n) {
  return double(light.intensity.x * dot(n, area_lamp_transfer(light, x, n)));
}

TEST(AreaLampTransfer, ARectanglesIsExact) {
  for (const vec2 size : {vec2(0.01f, 0.02f), vec2(1, 3), vec2(8, 8)})
    for (const float height : {0.01f, 0.5f, 2.0f, 30.0f, 3000.0f}) {
      const Light light = rectangle_lamp(float(kNits), size, vec3(0, 0, height));
      const dvec2 half = 0.5 * dvec2(size);
      for (const dvec2 place : {dvec2(0), dvec2(0.3, 0.2), dvec2(2, 5)}) {
        const double truth = kExitance * test::parallel_factor(-half - place, half - place, double(height));
        // So far away the closed form itself is a difference of much larger numbers.
        if (height > 100) continue;
        EXPECT_NEAR(brought(light, vec3(place, 0), kUp), truth, 2e-4 * truth)
            << size.x << " at " << height << " from " << place.x;
      }
      const double far = kNits * double(light.area()) / double(height * height);
      if (height > 100) {
        EXPECT_NEAR(brought(light, vec3(0), kUp), far, 1e-4 * far);
      }
    }
}

TEST(AreaLampTransfer, ADiscsIsExactAboveTheHorizon) {
  for (const double height : {0.01, 0.1, 1.0, 3.0, 20.0, 200.0})
    for (const double aside : {0.0, 0.3, 0.9, 1.0, 1.1, 2.0, 30.0}) {
      const Light light = disc_lamp(float(kNits), 2, vec3(0, 0, float(height)));
      const double truth = kExitance * test::disc_factor(1, height, aside);
      EXPECT_NEAR(brought(light, vec3(float(aside), 0, 0), kUp), truth, 1e-4 * truth)
          << height << " " << aside;
    }
}

/// The same by brute force.
double disc_truth(double height, double aside, const dvec3& n) {
  constexpr int kRings = 1000;
  double sum = 0;
  for (int i = 0; i < kRings; ++i)
    for (int j = 0; j < kRings; ++j) {
      const double r = std::sqrt((i + 0.5) / kRings), turn = 2 * double(kPi) * (j + 0.5) / kRings;
      const dvec3 d(r * std::cos(turn) - aside, r * std::sin(turn), height);
      const double squared = glm::dot(d, d);
      sum += std::max(0.0, glm::dot(d, n)) * height / (squared * squared);
    }
  return kNits * double(kPi) * sum / (double(kRings) * kRings);
}

TEST(AreaLampTransfer, ADiscsForLeaningPlanes) {
  for (const dvec3& n :
       {dvec3(0, 0, 1), dvec3(-0.6, 0, 0.8), dvec3(0.6, 0, 0.8), dvec3(1, 0, 0), dvec3(0, 1, 0)})
    for (const double height : {0.3, 1.0, 4.0})
      for (const double aside : {0.2, 1.0, 1.5}) {
        const Light light = disc_lamp(float(kNits), 2, vec3(0, 0, float(height)));
        const bool cut = height * n.z - aside * n.x < std::hypot(n.x, n.y);
        const double whole = kExitance * test::disc_factor(1, height, aside);
        EXPECT_NEAR(brought(light, vec3(float(aside), 0, 0), vec3(n)), disc_truth(height, aside, n),
                    (cut ? 1e-2 : 1e-4) * whole)
            << n.x << " " << height << " " << aside;
      }
}

TEST(AreaLampTransfer, TheHorizonCutsIt) {
  for (const float height : {0.1f, 1.0f}) {
    const double truth = 2 * kExitance * test::upright_factor(3, 2, double(height));
    const Light light = rectangle_lamp(float(kNits), {6, 4}, vec3(0, 0, height));
    EXPECT_NEAR(brought(light, vec3(0), vec3(1, 0, 0)), truth, 1e-4 * truth);
  }
  // A lamp so small that it is a point does not shine from below.
  EXPECT_EQ(brought(rectangle_lamp(float(kNits), vec2(1e-4f), vec3(0, 0, 5)), vec3(0), vec3(0, 0, -1)), 0);
}

TEST(AreaLampTransfer, NothingBehindItAndInItsPlane) {
  const Light light = rectangle_lamp(float(kNits), {2, 2}, vec3(0, 0, 1));
  for (const vec3& n : {kUp, -kUp, vec3(1, 0, 0)})
    for (const float z : {1.0f, 1.5f, 50.0f}) EXPECT_EQ(brought(light, vec3(0.3f, 0.2f, z), n), 0);
}

TEST(AreaLampView, WaysEndOnTheLampAboveTheHorizon) {
  const vec3 n = normalize(vec3(1, 0.2f, 0.3f));
  for (const float height : {0.2f, 9.0f})
    for (const Light& light :
         {rectangle_lamp(10, {2, 1}, vec3(0, 0, height)), disc_lamp(10, 2, vec3(0, 0, height))}) {
      const AreaLampView view(light, vec3(0), n);
      ASSERT_FALSE(view.empty());
      for (int i = 0; i < 100; ++i) {
        float weight = 0;
        const vec3 way = view.way((float(i % 10) + 0.5f) / 10, (float(i) + 0.5f) / 100, weight);
        EXPECT_GE(weight, 0);
        EXPECT_GE(dot(way, n), -1e-4f);
        EXPECT_NEAR(way.z, height, 1e-3f);
        if (light.kind == LightKind::kRectangle) {
          EXPECT_LE(std::abs(way.x), 1.0001f);
          EXPECT_LE(std::abs(way.y), 0.5001f);
        } else {
          EXPECT_LE(length(vec2(way)), 1.01f);
        }
      }
    }
  EXPECT_TRUE(AreaLampView(rectangle_lamp(10, {2, 1}, vec3(0, 0, 1)), vec3(0), vec3(0, 0, -1)).empty());
}

/// A black floor of side 4 round the origin, facing up.
Scene floor_below(const Light& light) {
  Scene scene;
  test::add(scene, test::parallelogram({-2, -2, 0}, {4, 0, 0}, {0, 4, 0}, 8), test::diffuse(0));
  scene.lights = {light};
  return scene;
}

/// Visits the leaves of the first part with their mean irradiance.
template <typename Visit>
void for_each_floor_leaf(const Solved& solved, const Visit& visit) {
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    if (e.part == 0 && !e.back) visit(e, double(solved.state().irradiance[id].x));
  }
}

/// Root mean square of the error at the leaves' centres, relative to the light's.
template <typename Exact>
double relative_error(const Solved& solved, const Exact& exact) {
  double square = 0, all = 0;
  for_each_floor_leaf(solved, [&](const Element& e, double irradiance) {
    const double truth = exact(dvec3(e.centre));
    square += double(e.area) * (irradiance - truth) * (irradiance - truth);
    all += double(e.area) * truth * truth;
  });
  return std::sqrt(square / all);
}

/// Sum over the leaves over that of the light at their centres.
template <typename Exact>
double relative_power(const Solved& solved, const Exact& exact) {
  double sum = 0, all = 0;
  for_each_floor_leaf(solved, [&](const Element& e, double irradiance) {
    sum += double(e.area) * irradiance;
    all += double(e.area) * exact(dvec3(e.centre));
  });
  return sum / all;
}

TEST(AreaLamp, ARectangleOverAFloor) {
  for (const float height : {0.3f, 1.5f}) {
    Solved solved(floor_below(rectangle_lamp(float(kNits), {1, 2}, vec3(0.2f, 0, height))));
    solved.solve();
    const auto exact = [&](const dvec3& p) {
      return kExitance * test::parallel_factor({-0.3 - p.x, -1 - p.y}, {0.7 - p.x, 1 - p.y}, double(height));
    };
    EXPECT_LT(relative_error(solved, exact), 0.02) << height;
    EXPECT_NEAR(relative_power(solved, exact), 1, 0.005) << height;
  }
}

TEST(AreaLamp, ADiscOverAFloor) {
  Solved solved(floor_below(disc_lamp(float(kNits), 1.2f, vec3(0, 0, 1))));
  solved.solve();
  const auto exact = [](const dvec3& p) {
    return kExitance * test::disc_factor(0.6, 1, glm::length(dvec2(p)));
  };
  EXPECT_LT(relative_error(solved, exact), 0.02);
  EXPECT_NEAR(relative_power(solved, exact), 1, 0.005);
}

TEST(AreaLamp, APlateCastsItsPenumbra) {
  Scene scene = floor_below(rectangle_lamp(float(kNits), {1, 1}, vec3(0, 0, 2)));
  Material plate = test::diffuse(0);
  plate.double_sided = true;
  test::add(scene, test::parallelogram({-4, -4, 1}, {4, 0, 0}, {0, 8, 0}), plate);  // its edge above x = 0
  Solved solved(std::move(scene));
  solved.solve();
  const auto exact = [](const dvec3& p) {
    const double first = std::max(-0.5, -p.x);  // of the lamp what lies beyond shows over the edge
    return first < 0.5
               ? kExitance * test::parallel_factor({first - p.x, -0.5 - p.y}, {0.5 - p.x, 0.5 - p.y}, 2)
               : 0.0;
  };
  EXPECT_LT(relative_error(solved, exact), 0.04);
  EXPECT_NEAR(relative_power(solved, exact), 1, 0.01);
}

TEST(AreaLamp, ACeilingThatItIsFlushWithDoesNotHideIt) {
  const Light light = rectangle_lamp(float(kNits), {1, 1}, vec3(0, 0, 1));
  const auto exact = [](const dvec3& p) {
    return kExitance * test::parallel_factor({-0.5 - p.x, -0.5 - p.y}, {0.5 - p.x, 0.5 - p.y}, 1);
  };
  for (const bool shafts : {false, true}) {
    Scene scene = floor_below(light);
    test::add(scene, test::parallelogram({-2, -2, 1}, {0, 4, 0}, {4, 0, 0}), test::diffuse(0));
    SolveOptions options;
    options.shafts = shafts;
    Solved solved(std::move(scene), options);
    solved.solve();
    EXPECT_NEAR(relative_power(solved, exact), 1, 0.005) << shafts;
  }
}

TEST(AreaLamp, AClosedBoxGetsAllOfItsPower) {
  for (const bool disc : {false, true}) {
    Scene scene;
    test::add(scene, test::turned(shapes::cube(4)), test::diffuse(0));
    const vec3 size = scene.bounds().size(), middle = scene.bounds().low + 0.5f * size, tilt(0.3f, -0.5f, -1);
    const Light light = disc ? disc_lamp(float(kNits), 0.4f * size.x, middle, tilt)
                             : rectangle_lamp(float(kNits), 0.2f * size.x * vec2(1, 2), middle, tilt);
    scene.lights = {light};
    Solved solved(std::move(scene));
    solved.solve();
    double power = 0;
    for_each_floor_leaf(solved,
                        [&](const Element& e, double irradiance) { power += double(e.area) * irradiance; });
    EXPECT_NEAR(power / (kExitance * double(light.area())), 1, 0.005);
  }
}

}  // namespace
}  // namespace goldthread
