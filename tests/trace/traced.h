// Scenes put together in a few words, a path tracer over them, and what its estimates are held to.
#pragma once
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "mesh/shapes.h"
#include "scene/procedural.h"
#include "trace/irradiance_estimate.h"

namespace goldthread::test {

/// A diffuse one-sided material; exitance in lm/m2.
inline Material diffuse(const vec3& reflectance, const vec3& exitance = vec3(0)) {
  Material material;
  material.base_colour = reflectance;
  material.metallic = 0;
  material.emission = exitance / kPi;
  return material;
}
inline Material diffuse(float reflectance, float exitance = 0) {
  return diffuse(vec3(reflectance), vec3(exitance));
}

/// A mesh of one primitive with one instance, which is returned for changes.
inline Primitive& add(Scene& scene, const shapes::Soup& soup, Material material,
                      const mat4& transform = mat4(1)) {
  Primitive primitive;
  primitive.positions = soup.positions;
  primitive.indices = soup.indices;
  primitive.material = static_cast<uint32_t>(scene.materials.size());
  scene.materials.push_back(std::move(material));
  scene.meshes.emplace_back();
  scene.meshes.back().primitives.push_back(std::move(primitive));
  scene.instances.push_back({static_cast<uint32_t>(scene.meshes.size() - 1), transform, 0, {}});
  return scene.meshes.back().primitives.back();
}

/// The polygon's fan of triangles; its front is where it runs counter-clockwise.
inline shapes::Soup polygon(std::vector<vec3> corners) {
  shapes::Soup soup;
  for (uint32_t i = 1; i + 1 < corners.size(); ++i) soup.triangle(0, i, i + 1);
  soup.positions = std::move(corners);
  return soup;
}

/// A square of the plane z = `height` around the z axis that faces up, or down.
inline shapes::Soup square(float half, float height, bool up) {
  const vec3 a(-half, -half, height), b(half, -half, height), c(half, half, height), d(-half, half, height);
  return polygon(up ? std::vector{a, b, c, d} : std::vector{a, d, c, b});
}

inline shapes::Soup turned(shapes::Soup soup) {
  for (size_t i = 0; i < soup.indices.size(); i += 3) std::swap(soup.indices[i + 1], soup.indices[i + 2]);
  return soup;
}

inline Light lamp(LightKind kind, float intensity, const vec3& position, const vec3& direction = {0, 0, -1}) {
  Light light;
  light.kind = kind;
  light.intensity = vec3(intensity);
  light.position = position;
  light.direction = direction;
  return light;
}

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

inline Scene procedural(std::string_view name, uint64_t triangles = 0) {
  Result<Scene> scene = build_procedural(name, triangles);
  if (!scene) throw std::runtime_error(scene.error().line());
  return *std::move(scene);
}

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
