// Enclosures whose light is known exactly (Shirley 1991; Szirmay-Kalos et al. 2000), and what must not change
// it.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "solve/hierarchical/push_pull.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;
using test::Summary;

/// An enclosure in which every surface has E = b (1 - rho): then B = b everywhere, whatever its shape.
void expect_uniform(const Solved& solved, float b, double leaf_tolerance, double mean_tolerance) {
  const Summary s = summarise(solved, [&](ElementId id) { return solved.state().radiosity[id].x; });
  EXPECT_NEAR(s.mean / double(b), 1, mean_tolerance);
  EXPECT_NEAR(s.least / double(b), 1, leaf_tolerance);
  EXPECT_NEAR(s.most / double(b), 1, leaf_tolerance);
}

class Enclosure : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(Enclosure, RadiosityIsThatOfTheClosedForm) {
  const auto [name, triangles] = GetParam();
  Solved solved(test::procedural(name, uint64_t(triangles)));
  solved.solve();
  EXPECT_TRUE(solved.solver->stats().converged);
  expect_uniform(solved, 2, 0.03, 0.003);
}

INSTANTIATE_TEST_SUITE_P(KnownAnswers, Enclosure,
                         ::testing::Values(std::pair("furnace", 12), std::pair("furnace", 1200),
                                           std::pair("furnace", 20000), std::pair("sphere", 12),
                                           std::pair("sphere", 1200), std::pair("sphere", 20000)),
                         [](const auto& info) {
                           return std::string(info.param.first) + std::to_string(info.param.second);
                         });

/// A room with a box and a two-sided plate in it, each surface of another reflectance.
Scene mixed_furnace(float b) {
  Scene scene;
  const auto paint = [&](float rho) { return test::add(scene, test::diffuse(rho, b * (1 - rho))); };
  const vec3 x(4, 0, 0), y(0, 3, 0), z(0, 0, 2), o(0);
  const float rho[6] = {0.8f, 0.1f, 0.5f, 0.3f, 0.7f, 0.6f};
  const shapes::Soup walls[6] = {test::parallelogram(o, x, y), test::parallelogram(z, y, x),
                                 test::parallelogram(o, y, z), test::parallelogram(x, z, y),
                                 test::parallelogram(o, z, x), test::parallelogram(y, x, z)};
  for (int i = 0; i < 6; ++i) test::add(scene, walls[i], paint(rho[i]));
  test::add(scene, shapes::cube(2), paint(0.4f), test::move({1, 0.5f, 0.5f}));
  Material plate = test::diffuse(0.2f, b * 0.8f);
  plate.double_sided = true;
  test::add(scene, test::parallelogram({3, 1, 0.5f}, {0, 1, 0}, {0.3f, 0, 1}), test::add(scene, plate));
  return scene;
}

TEST(KnownAnswers, MixedFurnaceIsUniform) {
  // The darkest and the brightest leaf are a matter of luck: they must be right for any. Leaves of the
  // default size are four times as many and each has few rays: their extremes would tell of the number of
  // rays.
  for (const uint32_t seed : {0u, 1u, 2u}) {
    SCOPED_TRACE(seed);
    SolveOptions options;
    options.seed = seed;
    options.least_area = 1e-4;
    Solved solved(mixed_furnace(3), options);
    solved.solve();
    expect_uniform(solved, 3, 0.06, 0.003);
  }
}

/// Irradiance averaged over 7^3 cells of the unit cube, so that solutions with other leaves compare. No
/// surface of small_room() lies on a border between cells.
std::vector<double> cell_means(const Solved& solved, const mat4& to_cells) {
  std::vector<double> sum(343, 0), area(343, 0);
  for (const ElementId id : solved.leaves())
    for (int i = 0; i < 16; ++i) {
      const float u = (float(i / 4) + 0.5f) / 4, v = (float(i % 4) + 0.5f) / 4;
      const vec3 at(to_cells * vec4(solved.pool().sample_at(id, u, v).position, 1));
      const vec3 p = glm::clamp(at, vec3(0), vec3(0.999f));
      const size_t cell = size_t(p.x * 7) * 49 + size_t(p.y * 7) * 7 + size_t(p.z * 7);
      sum[cell] += double(solved.pool()[id].area) * double(solved.state().irradiance[id].y);
      area[cell] += double(solved.pool()[id].area);
    }
  for (size_t i = 0; i < sum.size(); ++i) sum[i] = area[i] > 0 ? sum[i] / area[i] : 0;
  return sum;
}

/// A lit room in the unit cube with a block in it.
Scene small_room() {
  Scene scene;
  const uint32_t white = test::add(scene, test::diffuse({0.7f, 0.6f, 0.5f}));
  test::add(scene, test::turned(shapes::cube(2)), white);
  test::add(scene, shapes::cube(1), white, test::move({0.3f, 0.3f, 0}) * test::scale({0.3f, 0.2f, 0.5f}));
  test::add(scene, test::parallelogram({0.3f, 0.3f, 0.98f}, {0, 0.4f, 0}, {0.4f, 0, 0}),
            test::add(scene, test::diffuse(0.2f, 100)));
  return scene;
}

Scene moved(Scene scene, const mat4& by) {
  for (Instance& instance : scene.instances) instance.transform = by * instance.transform;
  return scene;
}

double difference(const std::vector<double>& a, const std::vector<double>& b) {
  double square = 0, all = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    square += (a[i] - b[i]) * (a[i] - b[i]);
    all += a[i] * a[i];
  }
  return std::sqrt(square / all);
}

TEST(Invariance, TwiceTheLightIsTwiceTheAnswer) {
  Scene bright = small_room();
  for (Material& material : bright.materials) material.emission *= 2;
  Solved once(small_room(), test::quick()), twice(std::move(bright), test::quick());
  once.solve();
  twice.solve();
  ASSERT_EQ(once.pool().size(), twice.pool().size());
  for (const ElementId id : once.leaves())
    EXPECT_NEAR(twice.state().irradiance[id].x, 2 * once.state().irradiance[id].x,
                1e-3f * once.state().irradiance[id].x);
}

TEST(Invariance, AFloorThatIsThereTwiceIsLitOnce) {
  // Once more in the same plane, in another material, cut along the other diagonal.
  Scene doubled = small_room();
  test::add(doubled, test::polygon({{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}}),
            test::add(doubled, test::diffuse(0.9f)));
  Solved once(small_room()), twice(std::move(doubled));
  once.solve();
  twice.solve();
  EXPECT_GT(twice.set->overlapping, 0u);
  EXPECT_NEAR(landing_power(twice.pool(), twice.state()).y / landing_power(once.pool(), once.state()).y, 1,
              0.01);
  // Both copies look lit, and neither lights the room again.
  EXPECT_LT(difference(cell_means(once, mat4(1)), cell_means(twice, mat4(1))), 0.02);
}

TEST(Invariance, PowersOfTwoInScaleChangeNoDecision) {
  Solved once(small_room(), test::quick());
  once.solve();
  for (const float scale : {0x1p-10f, 0x1p+10f}) {
    Solved scaled(moved(small_room(), test::scale(vec3(scale))), test::quick());
    scaled.solve();
    const double noise =
        difference(cell_means(once, mat4(1)), cell_means(scaled, test::scale(vec3(1 / scale))));
    EXPECT_LT(noise, 0.01) << scale;
  }
}

TEST(Invariance, PlaceAndOrientationDoNotMatter) {
  Solved once(small_room());
  once.solve();
  const mat4 by = test::move({40, -7, 3}) * test::turn(1.1f, {1, 2, -1});
  Solved turned(moved(small_room(), by));
  turned.solve();
  // Both are samples of one answer: cells differ by the noise of their few leaves.
  EXPECT_LT(difference(cell_means(once, mat4(1)), cell_means(turned, glm::inverse(by))), 0.03);
}

TEST(Invariance, TheSameBitsForAnyNumberOfThreads) {
  for (const char* name : {"cornell-box", "two-rooms"}) {
    std::vector<std::unique_ptr<Solved>> runs;
    for (const size_t threads : {1u, 2u, 2u}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      runs.push_back(std::make_unique<Solved>(test::procedural(name), test::quick()));
      runs.back()->solve();
    }
    for (const size_t other : {1u, 2u}) {
      const auto &a = *runs[0], &b = *runs[other];
      ASSERT_EQ(a.pool().size(), b.pool().size()) << name;
      ASSERT_EQ(a.solver->stats().rays.rays, b.solver->stats().rays.rays) << name;
      const std::vector<vec3>&x = a.state().irradiance, &y = b.state().irradiance;
      ASSERT_EQ(x.size(), y.size());
      EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(vec3)), 0) << name << " run " << other;
    }
  }
}

TEST(KnownAnswers, OppositeLampsDoNotCancel) {
  // A small ball between two equal, parallel panels: the root's irradiance vectors sum to zero, its light
  // does not.
  const auto lit = [](bool left, bool right) {
    Scene scene;
    test::add(scene, shapes::sphere(10), test::add(scene, test::diffuse(0.5f)), test::scale(vec3(0.1f)));
    const uint32_t lamp = test::add(scene, test::diffuse(0, 1000));
    if (left) test::add(scene, test::parallelogram({-2, -0.5f, -0.5f}, {0, 1, 0}, {0, 0, 1}), lamp);
    if (right) test::add(scene, test::parallelogram({2, -0.5f, -0.5f}, {0, 0, 1}, {0, 1, 0}), lamp);
    return scene;
  };
  const auto power = [](const Solved& solved) {
    double sum = 0;
    for (const ElementId id : solved.leaves())
      if (solved.pool()[id].reflectance.x > 0)
        sum += double(solved.pool()[id].area * solved.state().irradiance[id].x);
    return sum;
  };
  Solved both(lit(true, true)), left(lit(true, false)), right(lit(false, true));
  both.solve();
  left.solve();
  right.solve();
  EXPECT_NEAR(power(both) / (power(left) + power(right)), 1, 0.01);
  // A point of the panel sends cos r^2 / d^2 of its light to a sphere (Howell B-38): in all r^2 times the
  // panel's solid angle at the sphere's centre. The tessellated ball is smaller by the share of area that it
  // lacks.
  const double solid_angle = 4 * std::atan(0.25 / (2 * std::sqrt(4.5)));
  double area = 0;
  for (const ElementId id : left.leaves())
    if (left.pool()[id].reflectance.x > 0) area += double(left.pool()[id].area);
  EXPECT_NEAR(power(left) / (1000 * solid_angle * area / (4 * double(kPi))), 1, 0.01);
}

TEST(Convergence, FallingBoundsBringTheAnswerNearer) {
  SolveOptions fine;
  fine.last_error = 2e-6;
  fine.least_area = 4e-6;
  Solved reference(small_room(), fine);
  reference.solve();
  const std::vector<double> exact = cell_means(reference, mat4(1));
  double before = INFINITY;
  uint64_t links = 0;
  for (const double bound : {1e-3, 1e-4, 1e-5}) {
    SolveOptions options;
    options.last_error = bound;
    options.least_area = 1e-5;
    Solved solved(small_room(), options);
    solved.solve();
    EXPECT_LE(solved.solver->stats().epsilon, bound * 1.001);
    const double error = difference(cell_means(solved, mat4(1)), exact);
    EXPECT_LT(error, before) << bound;
    EXPECT_GT(solved.solver->links().all().size(), links);
    links = solved.solver->links().all().size();
    before = error;
  }
  EXPECT_LT(before, 0.02);
}

}  // namespace
}  // namespace goldthread
