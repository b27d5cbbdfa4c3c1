#include "trace/light_sampling.h"

#include "trace/directions.h"
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

/// `count` times the same place.
Places places(const vec3& x, const vec3& n, size_t count = 1) {
  Places at;
  at.count = count;
  for (size_t i = 0; i < count; ++i) {
    at.points.set(i, x);
    at.normals.set(i, n);
  }
  return at;
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
    const SobolPoint p = point(i);
    LightSamples light;
    t.tracer->lights().sample_emitters(places(x, n), {&p, 1}, light);
    if (light.density[0] == 0) continue;
    Ray ray;
    ray.origin = x;
    ray.direction = normalize(light.ways[0]);
    const Meeting met = t.traced->closest(ray);
    if (met.missed()) continue;  // on the very edge
    ++checked;
    const float density =
        t.tracer->lights().emitter_density(met.triangle, met.distance, -dot(met.normal, ray.direction));
    EXPECT_NEAR(density / light.density[0], 1, 2e-3f);
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
    const SobolPoint p = point(i);
    EmitterPoints one;
    table.sample({&p, 1}, one);
    const vec2 weights = one.weights[0];
    ++drawn[one.emitters[0]->triangle];
    EXPECT_LT(length(one.points[0] - t.traced->point(one.emitters[0]->triangle, weights)), 1e-6f);
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
  std::vector<FloatLanes> sums(lights.lamp_count());
  std::vector<int> drawn(lights.lamp_count(), 0);
  float whole = 0;
  for (const Light& light : t.scene->lights)
    whole += Lamp(light).light_at(vec3(0), up, point(0)).irradiance.x;
  LightSamples light;
  constexpr uint32_t kCount = 10000;
  for (uint32_t i = 0; i < kCount; ++i) {
    const SobolPoint choice{uint32_t((i + 0.5) / kCount * 0x1p32), 0};
    lights.sample_lamps(places(vec3(0), up), {&choice, 1}, {}, sums, light);
    EXPECT_NEAR(light.irradiance[0].x, whole, 1e-5f * whole);
    ++drawn[size_t(std::lround(light.ways[0].x))];
    EXPECT_GT(light.ways[0].z, 0);
  }
  for (size_t i = 0; i < 5; ++i) {
    const float brings = Lamp(t.scene->lights[i]).light_at(vec3(0), up, point(0)).irradiance.x;
    EXPECT_NEAR(drawn[i], kCount * double(brings / whole), 1.5) << i;
  }
  const SobolPoint last{0xffffffffu, 0};
  lights.sample_lamps(places(vec3(0), -up), {&last, 1}, {}, sums, light);
  EXPECT_EQ(light.ways[0].z, -2);
}

/// Places all over the unit cube, facing all ways.
Places many_places(size_t count) {
  Places at;
  at.count = count;
  for (uint32_t i = 0; i < count; ++i) {
    const SobolPoint p = point(i), q = sobol_point(i, 77);
    at.points.set(i, vec3(unit_double(p.u), unit_double(p.v), unit_double(q.u)));
    at.normals.set(i, even_direction(q));
  }
  return at;
}

// A path is not to know how many go with it: one in a bundle of any size is what it is alone.
TEST(LightSampling, ManyDirectionsAreThoseOfEach) {
  for (const size_t count : {size_t{1}, size_t{7}, size_t{21}, kLanes}) {
    const Places at = many_places(count);
    std::array<SobolPoint, kLanes> points;
    for (uint32_t i = 0; i < count; ++i) points[i] = point(100 + i);
    Vec3Lanes directions;
    cosine_directions(at.normals, {points.data(), count}, directions);
    for (size_t i = 0; i < count; ++i) EXPECT_EQ(directions[i], cosine_direction(at.normals[i], points[i]));
  }
}

// About the z axis the second number is the angle, and the first the squared sine.
TEST(LightSampling, DirectionsTurnAllTheWayRound) {
  for (uint32_t i = 0; i < 4096; ++i) {
    const SobolPoint p = i < 64 ? SobolPoint{0xffffffffu - i, i << 26} : point(i);
    const double angle = 2 * M_PI * unit_double(p.v), radius = std::sqrt(unit_double(p.u));
    const vec3 d = cosine_direction(vec3(0, 0, 1), p);
    EXPECT_NEAR(d.x, radius * std::cos(angle), 3e-7) << p.v;
    EXPECT_NEAR(d.y, radius * std::sin(angle), 3e-7) << p.v;
    EXPECT_NEAR(d.z, std::sqrt(1 - unit_double(p.u)), 3e-7) << p.u;
  }
}

void expect_same(const LightSamples& many, size_t i, const LightSamples& one) {
  EXPECT_EQ(many.irradiance[i], one.irradiance[0]) << i;
  EXPECT_EQ(many.ways[i], one.ways[0]) << i;
  EXPECT_EQ(many.far[i], one.far[0]) << i;
  EXPECT_EQ(many.density[i], one.density[0]) << i;
}

TEST(LightSampling, ManyPlacesGetTheLightOfEach) {
  Scene scene = lamps_over_floor();
  Light spot = lamp(LightKind::kSpot, 3, vec3(0.5f, 0.2f, 2)),
        ball = lamp(LightKind::kPoint, 2, vec3(0, 0, 3));
  spot.range = 4;
  ball.radius = 0.2f;
  scene.lights = {lamp(LightKind::kPoint, 1, vec3(1, 1, 1)), spot, ball,
                  lamp(LightKind::kDirectional, 5, vec3(0))};
  scene.sky.radiance = vec3(2);
  const Traced t(std::move(scene));
  const LightSampler& lights = t.tracer->lights();
  std::vector<FloatLanes> sums(lights.lamp_count());
  std::array<SobolPoint, kLanes> choices, points;
  for (uint32_t i = 0; i < kLanes; ++i) {
    choices[i] = point(i);
    points[i] = point(1000 + i);
  }
  const Places at = many_places(kLanes);
  LightSamples emitted, sky, lamps, alone;
  lights.sample_emitters(at, points, emitted);
  lights.sample_sky(at, points, sky);
  lights.sample_lamps(at, choices, points, sums, lamps);
  for (size_t i = 0; i < kLanes; ++i) {
    const Places one = places(at.points[i], at.normals[i]);
    lights.sample_emitters(one, {&points[i], 1}, alone);
    expect_same(emitted, i, alone);
    lights.sample_sky(one, {&points[i], 1}, alone);
    expect_same(sky, i, alone);
    lights.sample_lamps(one, {&choices[i], 1}, {&points[i], 1}, sums, alone);
    expect_same(lamps, i, alone);
  }
}

TEST(LightSampling, SharesOfManyPlacesAreThoseOfEach) {
  Light spot = lamp(LightKind::kSpot, 1, vec3(0.3f, 0.4f, 2));
  spot.inner_cone = 0.2f;
  spot.range = 2;
  Light ball = lamp(LightKind::kPoint, 1, vec3(0.5f, 0.5f, 1.5f));
  ball.radius = 0.3f;
  const Places at = many_places(kLanes - 3);
  for (const Light& light :
       {lamp(LightKind::kPoint, 1, vec3(0.5f)), spot, ball, lamp(LightKind::kDirectional, 1, vec3(0))}) {
    FloatLanes shares;
    Lamp(light).shares_at(at, shares);
    float sum = 0;
    for (size_t i = 0; i < at.count; ++i) {
      EXPECT_EQ(shares[i], Lamp(light).share_at(at.points[i], at.normals[i])) << i;
      sum += shares[i];
    }
    EXPECT_GT(sum, 0);
  }
}

}  // namespace
}  // namespace goldthread
