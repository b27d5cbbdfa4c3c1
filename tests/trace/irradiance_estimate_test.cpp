#include "trace/irradiance_estimate.h"

#include <tbb/global_control.h>

#include <numbers>
#include <random>
#include <thread>

#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

/// A room with little light at some places and much at others, all of it by way of several bounces.
Traced box() {
  return Traced(procedural("cornell-box"));
}

void expect_same(const std::vector<IrradianceSums>& a, const std::vector<IrradianceSums>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t p = 0; p < a.size(); ++p) {
    EXPECT_EQ(a[p].samples, b[p].samples);
    for (size_t i = 0; i < kBatches; ++i) EXPECT_EQ(a[p].batches[i], b[p].batches[i]) << p << " " << i;
  }
}

TEST(IrradianceEstimate, EvaluatesMeansAndErrorsOfBatches) {
  IrradianceSums sums;
  sums.samples = 4 * kBatches;
  double squares = 0;
  for (size_t i = 0; i < kBatches; ++i) {
    sums.batches[i] = dvec3(4 * double(i), 4, 0);  // means 0..15, 1, 0
    squares += (double(i) - 7.5) * (double(i) - 7.5);
  }
  const IrradianceValue value = evaluate(sums);
  EXPECT_DOUBLE_EQ(value.mean.x, 7.5);
  EXPECT_DOUBLE_EQ(value.mean.y, 1);
  EXPECT_DOUBLE_EQ(value.standard_error.x, std::sqrt(squares / 15 / 16));
  EXPECT_EQ(value.standard_error.y, 0);
  EXPECT_EQ(evaluate(IrradianceSums{}).mean, dvec3(0));
}

/// The range that holds 99.9% of sums of `count` squares of Student's t with kBatches - 1 degrees of freedom,
/// by drawing many.
std::pair<double, double> range_of_squares(size_t count) {
  std::mt19937 engine(1);
  std::normal_distribution<double> normal;
  std::vector<double> sums(20000, 0);
  for (double& sum : sums)
    for (size_t i = 0; i < count; ++i) {
      double squares = 0;
      for (size_t k = 0; k + 1 < kBatches; ++k) {
        const double x = normal(engine);
        squares += x * x;
      }
      const double x = normal(engine);
      sum += x * x / (squares / (kBatches - 1));
    }
  std::sort(sums.begin(), sums.end());
  return {sums[sums.size() / 2000], sums[sums.size() - 1 - sums.size() / 2000]};
}

// Errors must be as large as they are said to be. Too small a range of errors would show here as well as too
// large a one. Truth is Lambert's formula, the furnace's, and that of an open sky.
TEST(IrradianceEstimate, StandardErrorsAreHonest) {
  constexpr size_t kSeeds = 200;
  const auto [least, most] = range_of_squares(kSeeds);
  const auto sum_of_squares = [&](const Traced& t, const vec3& point, const vec3& normal, double truth) {
    double sum = 0;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      const IrradianceValue e = t.at(point, normal, 256, seed);
      const double deviations = (e.mean.x - truth) / e.standard_error.x;
      sum += deviations * deviations;
    }
    return sum;
  };
  Scene lit;
  add(lit, square(1, 0, true), diffuse(0));
  add(lit, square(0.5f, 1, false), diffuse(0, 1));
  // Howell B-3, four times a corner: F = 2 / pi * (2 x / sqrt(1 + x^2) atan(x / sqrt(1 + x^2))), x = 0.5.
  const double root = std::sqrt(1.25),
               factor = 4 / (2 * std::numbers::pi) * 2 * (0.5 / root) * std::atan(0.5 / root);
  EXPECT_NEAR(factor, 0.23945647046077354, 1e-12);  // gi_scenes.json, gi-p-direct-parallel
  const double lamp = sum_of_squares(Traced(std::move(lit)), vec3(0), vec3(0, 0, 1), factor);
  EXPECT_GT(lamp, least);
  EXPECT_LT(lamp, most);
  const Traced furnace(procedural("furnace"));
  const double glow = sum_of_squares(furnace, vec3(0.1f, -0.5f, 0.2f), vec3(0, 1, 0), 2);
  EXPECT_GT(glow, least);
  EXPECT_LT(glow, most);
  Scene sky;
  sky.sky.radiance = vec3(1);
  add(sky, square(1, 0, true), diffuse(0));
  add(sky, square(0.5f, 1, false), diffuse(0));
  const double open =
      sum_of_squares(Traced(std::move(sky)), vec3(0), vec3(0, 0, 1), std::numbers::pi * (1 - factor));
  EXPECT_GT(open, least);
  EXPECT_LT(open, most);
}

// Scrambled points have to pay: at the same number of samples a smooth integrand's error falls faster than by
// chance, four times the samples leaving less than half of it.
TEST(IrradianceEstimate, ErrorsFallWithSamples) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(0));
  add(scene, square(0.5f, 1, false), diffuse(0, 1));
  const Traced t(std::move(scene));
  double coarse = 0, fine = 0;
  for (uint64_t seed = 0; seed < 20; ++seed) {
    coarse += t.at(vec3(0), vec3(0, 0, 1), 1024, seed).standard_error.x;
    fine += t.at(vec3(0), vec3(0, 0, 1), 16384, seed).standard_error.x;
  }
  EXPECT_LT(fine, coarse / 5);
}

TEST(IrradianceEstimate, SameForAnyNumberOfThreads) {
  const Traced t = box();
  const std::vector<Receiver> points = random_receivers(*t.traced, 20, 3);
  std::vector<std::vector<IrradianceSums>> results;
  for (const size_t threads : {size_t{1}, size_t{2}, size_t{5}}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    results.push_back(t.sums(points, 200));
  }
  EXPECT_EQ(results[0][0].samples, 208u);  // rounded up to whole batches
  expect_same(results[0], results[1]);
  expect_same(results[0], results[2]);
}

// In a dark room what bounces three times is little, and must not be left to the few sequences that happen to
// have a path so long: then it would be missing from most receivers and from their errors.
TEST(IrradianceEstimate, ErrorsAreHonestInDarkRooms) {
  Scene scene = procedural("furnace");
  for (Material& m : scene.materials) {
    m.emission = vec3(0);
    m.base_colour = vec3(0.05f);
  }
  Box box;
  for (const vec3& p : scene.meshes[0].primitives[0].positions)
    box.add(vec3(scene.instances[0].transform * vec4(p, 1)));
  scene.lights.push_back(lamp(LightKind::kPoint, 100, box.centre()));
  const Traced t(std::move(scene));
  const std::vector<Receiver> points = random_receivers(*t.traced, 30, 3);
  const std::vector<IrradianceSums> few = t.sums(points, 16384, 1), many = t.sums(points, 65536, 2);
  for (size_t p = 0; p < points.size(); ++p) {
    const IrradianceValue a = evaluate(few[p]), b = evaluate(many[p]);
    // A quarter of the samples cannot know the light better. Each error is itself known to 18%.
    EXPECT_GT(a.standard_error.x, b.standard_error.x) << p;
    // Student's t with 15 degrees of freedom: beyond 7 once in 200,000.
    EXPECT_LT(std::abs(a.mean.x - b.mean.x), 7 * std::hypot(a.standard_error.x, b.standard_error.x)) << p;
  }
}

TEST(IrradianceEstimate, ResumedEqualsUninterrupted) {
  const Traced t = box();
  const std::vector<Receiver> points = random_receivers(*t.traced, 20, 3);
  const std::vector<IrradianceSums> whole = t.sums(points, 480, 9);
  std::vector<IrradianceSums> part = t.sums(points, 160, 9);
  part[3] = {};  // as after an interruption: points need not have come equally far
  IrradianceEstimate resumed(*t.tracer, points, 9, part);
  EXPECT_EQ(resumed.run({.samples = 480}, CancelToken()), StopReason::kSamples);
  expect_same(resumed.sums(), whole);
  EXPECT_EQ(resumed.run({.samples = 100}, CancelToken()), StopReason::kSamples);  // has more than that
  expect_same(resumed.sums(), whole);
}

TEST(IrradianceEstimate, AnotherSeedAnotherSample) {
  const Traced t = box();
  const std::vector<Receiver> points = random_receivers(*t.traced, 2, 3);
  const auto a = t.sums(points, 64, 1), b = t.sums(points, 64, 2), c = t.sums(points, 64, uint64_t{1} << 40);
  for (const auto& other : {b, c}) EXPECT_NE(a[0].batches[0], other[0].batches[0]);
  EXPECT_NE(a[0].batches[0], a[0].batches[1]);
}

TEST(IrradianceEstimate, StopsAtTheErrorAskedFor) {
  const Traced t = box();
  const std::vector<Receiver> points = random_receivers(*t.traced, 50, 3);
  IrradianceEstimate estimate(*t.tracer, points, 0);
  EXPECT_EQ(estimate.run({.target_error = 0.05}, CancelToken()), StopReason::kTargetError);
  EXPECT_LE(mean_relative_error(estimate.sums()), 0.05);
  // Not long after it was reached: at the look before it was still larger.
  const uint64_t samples = estimate.sums()[0].samples;
  ASSERT_GT(samples, 128u);
  const uint64_t before = (samples & (samples - 1)) == 0 ? samples / 4 * 3 : samples / 3 * 2;
  EXPECT_GT(mean_relative_error(t.sums(points, before)), 0.05);
}

TEST(IrradianceEstimate, StopsInTimeAndWhenCancelled) {
  const Traced t = box();
  const std::vector<Receiver> points = random_receivers(*t.traced, 100, 3);
  IrradianceEstimate timed(*t.tracer, points, 0);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(timed.run({.time_limit = 0.5}, CancelToken()), StopReason::kTimeLimit);
  EXPECT_GT(timed.sums()[0].samples, 0u);
  IrradianceEstimate endless(*t.tracer, points, 0);
  CancelToken cancel;
  std::thread caller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    cancel.cancel();
  });
  EXPECT_EQ(endless.run({}, cancel), StopReason::kCancelled);
  caller.join();
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 3);
  // What an interrupted run leaves is what one with that many samples would.
  for (size_t p = 0; p < points.size(); ++p) {
    const IrradianceSums& sums = endless.sums()[p];
    if (sums.samples > 0 && sums.samples < 2000 && p % 10 == 0) {
      std::vector<Receiver> upto(points.begin(), points.begin() + std::ptrdiff_t(p) + 1);
      EXPECT_EQ(t.sums(upto, sums.samples)[p].batches[5], sums.batches[5]);
    }
  }
}

// So many points that a round over all of them takes longer than anyone would wait.
TEST(IrradianceEstimate, StopsWithinARound) {
  const Traced t = box();
  IrradianceEstimate estimate(*t.tracer, random_receivers(*t.traced, 300000, 3), 0);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(estimate.run({.time_limit = 0.5}, CancelToken()), StopReason::kTimeLimit);
  EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 1.5);
  EXPECT_GT(estimate.sums().front().samples, 0u);
  EXPECT_EQ(estimate.sums().back().samples, 0u);
}

TEST(IrradianceEstimate, CountsRaysAndTheirTime) {
  const Traced t = box();
  IrradianceEstimate estimate(*t.tracer, random_receivers(*t.traced, 20, 3), 0);
  const auto start = std::chrono::steady_clock::now();
  {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    estimate.run({.samples = 1024}, CancelToken());
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const PathCost& count = estimate.rays();
  EXPECT_GE(count.rays, 20u * 1024);
  EXPECT_GT(count.ray_share(), 0);
  EXPECT_LT(count.ray_share(), 1);
  // Of one thread, timed paths are a part of the whole, and rays are a part of these.
  EXPECT_LT(double(count.path_nanoseconds) * 1e-9, seconds);
  EXPECT_LT(count.ray_nanoseconds, count.path_nanoseconds);
}

}  // namespace
}  // namespace goldthread
