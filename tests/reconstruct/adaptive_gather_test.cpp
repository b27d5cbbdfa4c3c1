// Where the mesh is cut for the light's sake, and how wrong it is then.
#include "reconstruct/adaptive_gather.h"

#include <gtest/gtest.h>

#include <functional>

#include "reconstruct/buried.h"
#include "reconstruct/triangulate.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

/// A black floor, and a plate above it that keeps the light of a lamp without size from half of it. Nobody
/// asks for the plate's own light.
Scene half_in_shadow() {
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0.0f));
  Material plate = test::diffuse(0.0f);
  plate.unlit = true;
  test::add(scene, test::parallelogram({0.1f, -3, 1}, {3, 0, 0.2f}, {0.5f, 6, 0}), std::move(plate));
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {0, 0, 2}));
  return scene;
}

/// Lux at places of the floor: 0 where the plate lies between.
double truth_on_floor(const dvec3& p) {
  const dvec3 d = dvec3(0, 0, 2) - p;
  // The plate's plane through its corner, spanned by (3, 0, 0.2) and (0.5, 6, 0).
  const dvec3 n = glm::cross(dvec3(3, 0, 0.2), dvec3(0.5, 6, 0)), corner(0.1, -3, 1);
  const double t = glm::dot(n, corner - p) / glm::dot(n, d);
  const dvec3 q = p + t * d - corner;
  const double v = q.y / 6, u = (q.x - 0.5 * v) / 3;
  const double squared = glm::dot(d, d);
  return u > 0 && u < 1 && v > 0 && v < 1 ? 0 : 100 * 2 / (squared * std::sqrt(squared));
}

struct Found {
  double error = 0, told = 0;  // root mean square over the mean: true and as the gather says
  size_t elements = 0;
};

/// Interpolated over the floor's triangles and held against the truth on a fine raster.
Found measure(Scene scene, const std::function<double(const dvec3&)>& truth, double tolerance,
              double growth = ReconstructOptions().growth) {
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  ReconstructOptions options;
  options.error = tolerance;
  options.growth = growth;
  ReconstructStats stats;
  AdaptiveGather gather(*solved.solver, options, CancelToken(), stats);
  gather.run();
  const PartPoints& points = gather.points(0);
  const std::vector<vec3>& light = gather.light(0, false);
  double squares = 0, sum = 0, area = 0;
  for (uint32_t f = 0; f + 1 < points.corner_first.size(); ++f) {
    const uint32_t first = points.corner_first[f];
    std::vector<vec3> loop;
    for (uint32_t c = first; c < points.corner_first[f + 1]; ++c)
      loop.push_back(points.points[points.corners[c]].position);
    std::vector<UVec3> triangles;
    triangulate_face(loop, triangles);
    for (const UVec3& t : triangles) {
      const std::array<uint32_t, 3> corner{points.corners[first + t.x], points.corners[first + t.y],
                                           points.corners[first + t.z]};
      const std::array<dvec3, 3> at{points.points[corner[0]].position, points.points[corner[1]].position,
                                    points.points[corner[2]].position};
      const double piece = glm::length(glm::cross(at[1] - at[0], at[2] - at[0])) / 2;
      constexpr int kFine = 12;
      for (int i = 0; i < kFine; ++i) {
        for (int j = 0; j < kFine - i; ++j) {
          const double u = (i + 1 / 3.0) / kFine, v = (j + 1 / 3.0) / kFine, w = 1 - u - v;
          const double exact = truth(u * at[0] + v * at[1] + w * at[2]);
          const double said = u * double(light[corner[0]].x) + v * double(light[corner[1]].x) +
                              w * double(light[corner[2]].x);
          const double weight = piece * 2 / (kFine * (kFine + 1));
          squares += weight * (said - exact) * (said - exact);
          sum += weight * exact;
          area += weight;
        }
      }
    }
  }
  return {std::sqrt(squares / area) / (sum / area), stats.error, solved.pool().size()};
}

TEST(AdaptiveGather, TheErrorIsWhatWasAskedFor) {
  size_t before = 0;
  for (const double tolerance : {0.3, 0.15, 0.08}) {
    const Found found = measure(half_in_shadow(), truth_on_floor, tolerance);
    EXPECT_LT(found.error, tolerance);
    EXPECT_LT(found.told, tolerance);
    EXPECT_GT(found.elements, before);
    before = found.elements;
  }
}

// Of the thousands of leaves along a shadow's edge right below a lamp each holds little of the error, and
// they need few places each, bright as they are.
TEST(AdaptiveGather, FewPlacesTellWhatIsLeftOfTheBrightest) {
  Scene scene;
  test::add(scene, test::square(0.05f, 0, true), test::diffuse(0.0f));
  test::add(scene, test::square(2, -1, true), test::diffuse(0.0f));
  Material screen = test::diffuse(0.0f);
  screen.unlit = true;
  test::add(scene, test::parallelogram({0.0025f, -0.075f, 0.025f}, {0.075f, 0, 0.005f}, {0.0125f, 0.15f, 0}),
            std::move(screen));
  scene.lights.push_back(test::lamp(LightKind::kPoint, 5, {0, 0, 0.05f}));
  Solved solved(std::move(scene), test::quick());
  solved.solve();
  ReconstructOptions options;
  options.error = 0.02;
  options.growth = 1000;
  ReconstructStats stats;
  AdaptiveGather gather(*solved.solver, options, CancelToken(), stats);
  gather.run();
  EXPECT_LT(stats.error, 0.02);
  EXPECT_LT(stats.places, 6 * stats.points);
}

TEST(AdaptiveGather, APatternHidesSomeOfTheError) {
  const auto cuts = [](bool patterned) {
    Scene scene = half_in_shadow();
    Image checks;
    checks.width = checks.height = 32;
    for (uint32_t i = 0; i < 1024; ++i) {
      const auto grey = static_cast<uint8_t>(patterned && (i / 2 + i / 64) % 2 == 0 ? 80 : 200);
      checks.rgba.insert(checks.rgba.end(), {grey, grey, grey, 255});
    }
    scene.images.push_back(checks);
    Primitive& floor = scene.meshes[0].primitives[0];
    scene.materials[floor.material].base_colour = vec4(1);
    scene.materials[floor.material].base_colour_texture.image = 0;
    for (const vec3& p : floor.positions) floor.texcoords[0].emplace_back(p.x / 4 + 0.5f, p.y / 4 + 0.5f);
    Solved solved(std::move(scene), test::quick());
    solved.solve();
    const size_t before = solved.pool().size();
    ReconstructOptions options;
    options.error = 0.08;
    ReconstructStats stats;
    AdaptiveGather gather(*solved.solver, options, CancelToken(), stats);
    gather.run();
    EXPECT_LT(stats.error, options.error);
    return static_cast<double>(solved.pool().size() - before);
  };
  const double plain = cuts(false), patterned = cuts(true);
  EXPECT_LT(patterned, 0.7 * plain);
  EXPECT_GT(patterned, 0.05 * plain);
}

TEST(AdaptiveGather, LeavesEvenLightAlone) {
  Solved solved(test::procedural("furnace", 1200), test::quick());
  solved.solve();
  const size_t before = solved.pool().size();
  ReconstructStats stats;
  ReconstructOptions options;
  options.error = 0.03;
  AdaptiveGather gather(*solved.solver, options, CancelToken(), stats);
  gather.run();
  EXPECT_EQ(solved.pool().size(), before);
  EXPECT_LT(stats.error, 0.03);
  for (const vec3& e : gather.light(0, false)) EXPECT_NEAR(e.x, 2, 0.1f);
}

// A plate of a hundred-thousandth of the area, a millimetre below a lamp, holds nearly all of the squared
// error. It is cut however small its pieces are.
TEST(AdaptiveGather, APlateJustBelowALampIsResolved) {
  constexpr double kHeight = 0.001, kIntensity = 0.05, kSun = 50;
  Scene scene;
  test::add(scene, test::square(0.005f, 0, true), test::diffuse(0.0f));
  test::add(scene, test::square(2, -1, true), test::diffuse(0.0f));
  scene.lights.push_back(test::lamp(LightKind::kPoint, kIntensity, {0.001f, 0.0015f, float(kHeight)}));
  scene.lights.push_back(test::lamp(LightKind::kDirectional, kSun, vec3(0)));
  const auto truth = [](const dvec3& p) {
    const dvec3 d = dvec3(0.001, 0.0015, kHeight) - p;
    return kSun + kIntensity * kHeight / std::pow(glm::dot(d, d), 1.5);
  };
  // The plate's own error over its own light, which is 70 times as much as the floor's.
  EXPECT_LT(measure(scene, truth, 0.02, 100).error, 0.1);
}

TEST(AdaptiveGather, CancelledGivesTheMeansOfLeaves) {
  Solved solved(half_in_shadow(), test::quick());
  solved.solve();
  CancelToken stop;
  stop.cancel();
  ReconstructStats stats;
  AdaptiveGather gather(*solved.solver, ReconstructOptions(), stop, stats);
  gather.run();
  EXPECT_EQ(stats.points, 0u);
  EXPECT_FALSE(gather.light(0, false).empty());
}

TEST(Buried, InsideSolidsAndNotInGaps) {
  // Two boxes that stand 2 mm apart on a floor, under a lamp.
  Scene scene;
  test::add(scene, test::square(2, 0, true), test::diffuse(0.5f));
  for (const float x : {-0.501f, 0.501f})
    test::add(scene, shapes::cube(1), test::diffuse(0.5f), test::move({x - 0.5f, -0.5f, 0}));
  scene.lights.push_back(test::lamp(LightKind::kPoint, 100, {0, 0, 3}));
  Solved solved(std::move(scene), test::quick());
  const auto buried = [&](const vec3& x, const vec3& n) {
    RayCount rays;
    const bool answer = is_buried(solved.pool(), solved.solver->visibility(), x, n, rays);
    EXPECT_LE(rays.rays, 32u);
    return answer;
  };
  const vec3 up(0, 0, 1);
  EXPECT_TRUE(buried({0.5f, 0, 0}, up));                // the floor beneath a box
  EXPECT_FALSE(buried({0, 0, 0}, up));                  // between the boxes
  EXPECT_FALSE(buried({-0.001f, 0, 0.5f}, {1, 0, 0}));  // one looking at the other
  EXPECT_FALSE(buried({1.5f, 0, 0}, up));               // in the open
}

}  // namespace
}  // namespace goldthread
