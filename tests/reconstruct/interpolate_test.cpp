// Light within clusters that the solver never opened.
#include "reconstruct/interpolate.h"

#include <gtest/gtest.h>

#include "reconstruct/adaptive_gather.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

constexpr float kHalfThickness = 0.02f;
constexpr uint32_t kDoor = 0;  // its part

/// A door of two by two metres and four centimetres, finely tessellated, that closes a lit room at x < 0.
/// Beyond it is a room that is black, and nothing that shines.
Scene door_between_rooms() {
  Scene scene;
  const auto thin = test::scale({2 * kHalfThickness, 2, 2});
  test::add(scene, shapes::cube(16), test::diffuse(0.5f), test::move({-kHalfThickness, -1, -1}) * thin);
  for (const float side : {-1.0f, 1.0f}) {
    const float rho = side < 0 ? 0.7f : 0.0f;
    const float near = side < 0 ? -3.0f : 0.0f;
    const vec3 o(near, -1, -1), x(3, 0, 0), y(0, 2, 0), z(0, 0, 2);
    test::add(scene, test::parallelogram(o, x, y), test::diffuse(rho));
    test::add(scene, test::parallelogram(o + z, y, x), test::diffuse(rho));
    test::add(scene, test::parallelogram(o, z, x), test::diffuse(rho));
    test::add(scene, test::parallelogram(o + y, x, z), test::diffuse(rho));
    test::add(scene, side < 0 ? test::parallelogram(o, y, z) : test::parallelogram(o + x, z, y),
              test::diffuse(rho));
  }
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {-1.5f, 0.3f, 0.2f}));
  return scene;
}

/// Mean and greatest illuminance (lux) over some light points.
struct Lit {
  double sum = 0, most = 0;
  size_t count = 0;
  void add(const vec3& light) {
    sum += double(light.x);
    most = std::max(most, double(light.x));
    ++count;
  }
  double mean() const { return sum / double(count); }
};

SolveOptions with_error(double error) {
  SolveOptions options;
  options.first_error = std::max(error, options.first_error);
  options.last_error = error;
  return options;
}

TEST(KeyPoints, TheFarSideOfADoorIsDark) {
  test::Solved solved(door_between_rooms(), with_error(0.3));
  solved.solve();
  ReconstructOptions options;
  options.growth = 0;
  ReconstructStats stats;
  AdaptiveGather gather(*solved.solver, options, CancelToken(), stats);
  gather.run();
  const PartPoints& points = gather.points(kDoor);
  const std::vector<ElementId> leaves = solved.pool().leaf_elements(kDoor, false);
  Lit near_side, far_side;
  for (uint32_t p = 0; p < points.points.size(); ++p) {
    const float side = points.points[p].normal.x;
    if (std::abs(side) < 0.9f) continue;
    (side < 0 ? near_side : far_side).add(gather.light(kDoor, false)[p]);
    // One leaf is all of the door, or the scene no longer tells anything.
    const Element& leaf = solved.pool()[leaves[points.points[p].face]];
    EXPECT_LT(length(leaf.summed_normal), 0.1f * leaf.area);
  }
  EXPECT_LT(stats.points, (near_side.count + far_side.count) / 4);  // or there is nothing to interpolate
  EXPECT_GT(near_side.mean(), 20);
  EXPECT_LT(far_side.most, 1e-6 * near_side.mean());
}

}  // namespace
}  // namespace goldthread
