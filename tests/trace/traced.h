// A path tracer over small scenes, and what its estimates are held to.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "scene/small_scenes.h"
#include "trace/irradiance_estimate.h"

namespace goldthread::test {

/// A scene with its path tracer; keeps all where they are.
struct Traced {
  std::unique_ptr<Scene> scene;
  std::unique_ptr<TracedScene> traced;
  std::unique_ptr<PathTracer> tracer;

  explicit Traced(Scene s) : scene(std::make_unique<Scene>(std::move(s))) {
    traced = std::make_unique<TracedScene>(*scene);
    tracer = std::make_unique<PathTracer>(*traced);
  }

  Receiver receiver(const vec3& point, const vec3& normal) const {
    const PlacedReceiver placed = place_receiver(*traced, point, normal);
    EXPECT_LE(placed.distance, on_surface_distance(*traced));
    return placed.receiver;
  }

  std::vector<IrradianceSums> sums(std::vector<Receiver> receivers, uint64_t samples,
                                   uint64_t seed = 0) const {
    IrradianceEstimate estimate(*tracer, std::move(receivers), seed);
    EXPECT_EQ(estimate.run({.samples = samples}, CancelToken()), StopReason::kSamples);
    return estimate.sums();
  }

  IrradianceValue at(const vec3& point, const vec3& normal, uint64_t samples = 4096,
                     uint64_t seed = 0) const {
    return evaluate(sums({receiver(point, normal)}, samples, seed)[0]);
  }

  /// The mean over points, whose errors are independent.
  IrradianceValue mean(const std::vector<Receiver>& receivers, uint64_t samples, uint64_t seed = 0) const {
    IrradianceValue mean;
    dvec3 squares(0);
    const auto count = static_cast<double>(receivers.size());
    for (const IrradianceSums& point : sums(receivers, samples, seed)) {
      const IrradianceValue one = evaluate(point);
      mean.mean += one.mean / count;
      squares += one.standard_error * one.standard_error;
    }
    mean.standard_error = glm::sqrt(squares) / count;
    return mean;
  }
};

/// Within three standard errors of the truth, and these small enough to mean anything. `slack` is the truth's
/// own error where it is that of a smooth shape; besides, rays start an epsilon above their surface.
inline void expect_estimates(const IrradianceValue& value, const dvec3& truth, double largest_error = 0.02,
                             double slack = 1e-4) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(value.mean[k], truth[k], 3 * value.standard_error[k] + slack * truth[k]) << "channel " << k;
    EXPECT_LE(value.standard_error[k], largest_error * truth[k]) << "channel " << k;
  }
}
inline void expect_estimates(const IrradianceValue& value, double truth) {
  expect_estimates(value, dvec3(truth));
}

}  // namespace goldthread::test
