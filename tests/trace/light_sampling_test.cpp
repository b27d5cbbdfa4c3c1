#include "trace/light_sampling.h"

#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

/// Even points of the unit square.
SobolPoint point(uint32_t i) {
  return sobol_point(i, 0x1234567u);
}

/// A floor and, above it, lamps of many sizes and brightnesses, one two-sided; none hides another from the
/// floor's middle.
Scene lamps_over_floor() {
  Scene scene;
  add(scene, square(3, 0, true), diffuse(0.5f));
  float x = -2;
  for (const float size : {0.1f, 0.5f, 0.2f, 0.8f}) {
    const vec3 a(x, -size, 1 + size), b(x, size, 1 + size), c(x + size, size, 1.2f), d(x + size, -size, 1.2f);
    add(scene, polygon({a, b, c, d}), diffuse(0, 10 * size)).positions[0].z += 0.1f;
    x += 1.2f;
  }
  scene.materials.back().double_sided = true;
  return scene;
}

TEST(LightSampling, EmitterDensityIntegratesToOne) {
  const Traced t(lamps_over_floor());
  const vec3 x(0.1f, 0.2f, 0.001f);
  constexpr uint32_t kRays = 1u << 18;
  double sum = 0;
  for (uint32_t i = 0; i < kRays; ++i) {
    Ray ray;
    ray.origin = x;
    ray.direction = even_direction(point(i));
    const Meeting met = t.traced->closest(ray);
    if (met.missed() || !met.live) continue;
    sum += double(
        t.tracer->lights().emitter_density(met.triangle, met.distance, -dot(met.normal, ray.direction)));
  }
  EXPECT_NEAR(sum * 4 * double(kPi) / kRays, 1, 0.005);
}

// The other way round: densities of drawn directions are those that a ray in that direction reports.
TEST(LightSampling, DrawnDensityIsTheReportedOne) {
  const Traced t(lamps_over_floor());
  const vec3 x(0.1f, 0.2f, 0.001f), n(0, 0, 1);
  int checked = 0;
  for (uint32_t i = 0; i < 1000; ++i) {
    const LightSample light = t.tracer->lights().sample_emitter(x, n, point(i));
    if (light.density == 0) continue;
    Ray ray;
    ray.origin = x;
    ray.direction = normalize(light.shadow.direction);
    const Meeting met = t.traced->closest(ray);
    if (met.missed()) continue;  // on the very edge
    ++checked;
    const float density =
        t.tracer->lights().emitter_density(met.triangle, met.distance, -dot(met.normal, ray.direction));
    EXPECT_NEAR(density / light.density, 1, 2e-3f);
  }
  EXPECT_GT(checked, 900);
}

TEST(LightSampling, EmittersAreDrawnByPower) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(0, 1));     // 4 lm
  add(scene, square(0.5f, 1, true), diffuse(0, 8));  // 8 lm, and as much from its back
  scene.materials.back().double_sided = true;
  add(scene, square(1, 2, true), diffuse(0.5f));
  const Traced t(std::move(scene));
  const EmitterTable table(*t.traced);
  EXPECT_NEAR(table.density(0), 0.2f / 4, 1e-6f);
  EXPECT_NEAR(table.density(2), 0.8f / 1, 1e-6f);
  EXPECT_EQ(table.density(4), 0);
  std::vector<int> drawn(6, 0);
  for (uint32_t i = 0; i < 10000; ++i) {
    vec2 weights;
    const SobolPoint p = point(i);
    const Emitter& emitter = table.sample(unit_double(p.u), unit_double(p.v), weights);
    ++drawn[emitter.triangle];
    EXPECT_GE(std::min({weights.x, weights.y, 1 - weights.x - weights.y}), -1e-6f);
  }
  EXPECT_NEAR(drawn[0], 1000, 5);
  EXPECT_NEAR(drawn[1], 1000, 5);
  EXPECT_NEAR(drawn[2], 4000, 5);
  EXPECT_NEAR(drawn[3], 4000, 5);
}

// A lamp that lies twice in a file can be met once only: drawing both would bring twice the light.
TEST(LightSampling, LampsOverTheSameCornersAreOne) {
  Scene once;
  add(once, square(5, 0, true), diffuse(0.5f));
  add(once, square(0.5f, 1, false), diffuse(0, 10));
  Scene twice = once;
  twice.instances.push_back(twice.instances.back());
  const vec3 up(0, 0, 1);
  const double expected = Traced(std::move(once)).at(vec3(0), up).mean.x;
  const IrradianceValue got = Traced(std::move(twice)).at(vec3(0), up);
  EXPECT_NEAR(got.mean.x, expected, 4 * got.standard_error.x);
}

TEST(LightSampling, DirectionsFollowTheCosine) {
  for (const vec3& n : {vec3(0, 0, 1), vec3(0, 0, -1), normalize(vec3(1, -2, 3)), vec3(-1, 0, 0)}) {
    dvec3 sum(0);
    double cosine = 0, squared = 0;
    constexpr uint32_t kCount = 1u << 16;
    for (uint32_t i = 0; i < kCount; ++i) {
      const vec3 d = cosine_direction(n, point(i));
      ASSERT_NEAR(length(d), 1, 1e-5f);
      ASSERT_GE(dot(d, n), 0);
      sum += dvec3(d);
      cosine += double(dot(d, n));
      squared += double(dot(d, n) * dot(d, n));
    }
    // The moments of cos / pi over the hemisphere: 2/3 and 1/2; nothing sideways.
    EXPECT_NEAR(cosine / kCount, 2.0 / 3, 1e-3);
    EXPECT_NEAR(squared / kCount, 0.5, 1e-3);
    EXPECT_LT(length(sum / double(kCount) - 2.0 / 3 * dvec3(n)), 1e-3);
  }
}

TEST(LightSampling, SkyDensityIntegratesToOne) {
  Scene scene = lamps_over_floor();
  scene.sky.radiance = vec3(1);
  const Traced t(std::move(scene));
  double sum = 0;
  constexpr uint32_t kCount = 1u << 16;
  for (uint32_t i = 0; i < kCount; ++i) {
    const vec3 d = even_direction(point(i));
    sum += double(t.tracer->lights().sky_density(d, std::max(0.0f, d.z)));
  }
  EXPECT_NEAR(sum * 4 * double(kPi) / kCount, 1, 1e-3);
}

TEST(LightSampling, WeightsOfTwoStrategiesSumToOne) {
  for (const float a : {1e-6f, 0.3f, 1.0f, 50.0f, 1e8f})
    for (const float b : {1e-6f, 0.5f, 2.0f, 1e7f})
      EXPECT_NEAR(power_heuristic(a, b) + power_heuristic(b, a), 1, 1e-6f);
  EXPECT_EQ(power_heuristic(1, 0), 1);
  EXPECT_EQ(power_heuristic(0, 1), 0);
}

// The formulas of KHR_lights_punctual, worked out by hand.
TEST(LightSampling, LampsFollowTheirExtension) {
  Light spot = lamp(LightKind::kSpot, 1, vec3(0));
  spot.inner_cone = 0;
  spot.outer_cone = kPi / 3;  // cosines 1 and 0.5
  spot.position = vec3(0, 0, 1);
  spot.direction = vec3(0, 0, -1);
  // On a plane that faces the lamp from where `way` leads: cone x range / distance squared.
  const auto share = [&](const vec3& way, float distance) {
    return Lamp(spot).share_at(spot.position + distance * way, -way) * distance * distance;
  };
  EXPECT_FLOAT_EQ(share(vec3(0, 0, -1), 1), 1);
  EXPECT_FLOAT_EQ(share(vec3(0, 0.6f, -0.8f), 1), 0.36f);
  EXPECT_FLOAT_EQ(share(vec3(0, 0.9f, -std::sqrt(0.19f)), 1), 0);
  EXPECT_FLOAT_EQ(share(vec3(0, 0, -1), 100), 1);
  spot.range = 2;
  EXPECT_FLOAT_EQ(share(vec3(0, 0, -1), 1), 0.9375f);
  EXPECT_FLOAT_EQ(share(vec3(0, 0, -1), 3), 0);
}

// Each of many lamps, the dimmest included, is drawn as often as what it brings, and brings their sum.
TEST(LightSampling, LampsAreDrawnByWhatTheyBring) {
  Scene scene;
  add(scene, square(5, 0, true), diffuse(0.5f));
  for (int i = 0; i < 5; ++i)
    scene.lights.push_back(lamp(LightKind::kPoint, 1 + 10 * float(i), vec3(i, 0, 2)));
  scene.lights.push_back(lamp(LightKind::kPoint, 500, vec3(0, 0, -2)));  // below the floor
  const Traced t(std::move(scene));
  const LightSampler& lights = t.tracer->lights();
  const vec3 up(0, 0, 1);
  std::vector<float> sums(lights.lamp_count());
  std::vector<int> drawn(lights.lamp_count(), 0);
  float whole = 0;
  for (const Light& light : t.scene->lights)
    whole += Lamp(light).light_at(vec3(0), up, point(0)).irradiance.x;
  constexpr int kCount = 10000;
  for (int i = 0; i < kCount; ++i) {
    const LightSample light = lights.sample_lamp(vec3(0), up, (i + 0.5) / kCount, point(0), sums);
    EXPECT_NEAR(light.irradiance.x, whole, 1e-5f * whole);
    ++drawn[size_t(std::lround(light.shadow.direction.x))];
    EXPECT_GT(light.shadow.direction.z, 0);
  }
  for (size_t i = 0; i < 5; ++i) {
    const float brings = Lamp(t.scene->lights[i]).light_at(vec3(0), up, point(0)).irradiance.x;
    EXPECT_NEAR(drawn[i], kCount * double(brings / whole), 1.5) << i;
  }
  EXPECT_EQ(lights.sample_lamp(vec3(0), -up, 0.999999, point(0), sums).shadow.direction.z, -2);
}

}  // namespace
}  // namespace goldthread
