// Scenes whose light is known in closed form.
#include "trace/path_tracer.h"

#include <set>

#include "math/form_factor.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

const vec3 kUp(0, 0, 1);

/// A floor that reflects `reflectance`, alone.
Scene floor_scene(float reflectance = 0.5f) {
  Scene scene;
  add(scene, square(2, 0, true), diffuse(reflectance));
  return scene;
}

/// Lambert's form factor of the square above the origin.
double square_factor(float half, float height) {
  const std::array<vec3, 4> corners{vec3(-half, -half, height), vec3(-half, half, height),
                                    vec3(half, half, height), vec3(half, -half, height)};
  return double(dot(kUp, polygon_form_factor(vec3(0), kUp, corners)));
}

// B = E / (1 - rho) in any closed room: 1 / (1 - 0.5) lm/m2, which is also the irradiance.
TEST(PathTracer, FurnaceAndSphereHaveTwoLuxEverywhere) {
  for (const char* name : {"furnace", "sphere"}) {
    const Traced t(procedural(name));
    const std::vector<Receiver> points = random_receivers(*t.traced, 32, 1);
    expect_estimates(t.mean(points, 512), dvec3(2), 0.003);
  }
}

TEST(PathTracer, PointOverBlackFloor) {
  Scene scene = floor_scene(0);
  scene.lights.push_back(lamp(LightKind::kPoint, 100, vec3(0, 0, 2)));
  const Traced t(std::move(scene));
  EXPECT_NEAR(t.at(vec3(0), kUp, 16).mean.x, 25, 1e-3);
  // I cos / d^2 with d^2 = 5 and cos = 2 / sqrt 5.
  EXPECT_NEAR(t.at(vec3(1, 0, 0), kUp, 16).mean.x, 100 * 2 / std::pow(5, 1.5), 1e-3);
  EXPECT_EQ(t.at(vec3(0), -kUp, 16).mean.x, 0);
}

TEST(PathTracer, SpotOverBlackFloor) {
  Scene scene = floor_scene(0);
  scene.lights.push_back(lamp(LightKind::kSpot, 100, vec3(0, 0, 2)));
  scene.lights.back().inner_cone = 0;
  scene.lights.back().outer_cone = kPi / 3;
  const Traced t(std::move(scene));
  EXPECT_NEAR(t.at(vec3(0), kUp, 16).mean.x, 25, 1e-3);
  const double cosine = 2 / std::sqrt(5.0), cone = (cosine - 0.5) / 0.5;
  EXPECT_NEAR(t.at(vec3(1, 0, 0), kUp, 16).mean.x, 100 * cosine * cone * cone / 5, 1e-3);
}

TEST(PathTracer, SunAndItsShadow) {
  Scene scene = floor_scene(0);
  scene.lights.push_back(lamp(LightKind::kDirectional, 1000, vec3(0), normalize(vec3(1, 0, -1))));
  add(scene, square(0.5f, 1, true), diffuse(0));  // shades -0.5..0.5, moved by 1 along x
  const Traced t(std::move(scene));
  EXPECT_NEAR(t.at(vec3(0), kUp, 16).mean.x, 1000 / std::sqrt(2), 0.1);
  EXPECT_EQ(t.at(vec3(1, 0, 0), kUp, 16).mean.x, 0);
}

// Lamps are chosen by what they would bring; whatever the choice, their sum is what counts.
TEST(PathTracer, ManyLampsAddUp) {
  Scene scene = floor_scene(0);
  double truth = 0;
  for (int i = 1; i <= 20; ++i) {
    const float z = 0.3f * static_cast<float>(i);
    scene.lights.push_back(lamp(LightKind::kPoint, 10, vec3(1.5f, 0, z)));
    truth += 10 * double(z) / std::pow(2.25 + double(z * z), 1.5);
  }
  scene.lights.push_back(lamp(LightKind::kPoint, 1e6, vec3(0, 0, -1)));  // below the floor
  const Traced t(std::move(scene));
  // Nothing is in between, so that every choice brings the very same.
  EXPECT_NEAR(t.at(vec3(0), kUp, 16).mean.x, truth, 1e-3 * truth);
}

TEST(PathTracer, OpenSkyBringsPiTimesItsLuminance) {
  Scene scene = floor_scene(0.8f);
  scene.sky.radiance = vec3(100, 200, 300);
  const Traced t(std::move(scene));
  const dvec3 truth = double(kPi) * dvec3(100, 200, 300);
  expect_estimates(t.at(vec3(0), kUp, 256), truth);
  expect_estimates(t.at(vec3(0), -kUp, 256), truth);  // light arrives on black backs as well
}

TEST(PathTracer, SkyBesideALid) {
  Scene scene = floor_scene(0);
  scene.sky.radiance = vec3(100);
  add(scene, square(1, 1, false), diffuse(0));
  const Traced t(std::move(scene));
  expect_estimates(t.at(vec3(0), kUp), 100 * double(kPi) * (1 - square_factor(1, 1)));
}

TEST(PathTracer, LampOfArea) {
  Scene scene = floor_scene(0);
  add(scene, square(1, 1, false), diffuse(0, 10));
  const Traced t(std::move(scene));
  expect_estimates(t.at(vec3(0), kUp), 10 * square_factor(1, 1));
}

// A lamp that nearly touches: all by itself, sampling its area would be useless there.
TEST(PathTracer, LampThatNearlyTouches) {
  Scene scene = floor_scene(0);
  add(scene, square(1, 0.01f, false), diffuse(0, 10));
  const Traced t(std::move(scene));
  expect_estimates(t.at(vec3(0), kUp), 10 * square_factor(1, 0.01f));
}

// Rays start a little above the point; what they bring must be the point's. Twice the lift over the distance
// would be half a percent here.
TEST(PathTracer, TheLiftOfRaysDoesNotShow) {
  for (const float shift : {0.0f, 0.003f}) {
    Scene scene;
    add(scene, polygon({vec3(-4, -6, 0), vec3(6, -4, 0), vec3(0, 6, 0)}), diffuse(0));
    add(scene, square(0.004f, 0.01f, false), diffuse(0, 1));
    const Traced t(std::move(scene));
    ASSERT_GT(t.traced->epsilon(), 2e-5f);
    const std::array<vec3, 4> lamp_corners{vec3(-0.004f, -0.004f, 0.01f), vec3(-0.004f, 0.004f, 0.01f),
                                           vec3(0.004f, 0.004f, 0.01f), vec3(0.004f, -0.004f, 0.01f)};
    const vec3 x(shift, 0, 0);
    const auto exact = double(dot(kUp, polygon_form_factor(x, kUp, lamp_corners)));
    const IrradianceValue value = t.at(x, kUp, 1 << 16);
    EXPECT_NEAR(value.mean.x, exact, 3 * value.standard_error.x + 2e-5 * exact);
    EXPECT_LT(value.standard_error.x, 1e-4 * exact);
  }
}

TEST(PathTracer, OneSidedBacksAreBlackAndBlock) {
  Scene scene = floor_scene(0);
  add(scene, square(1, 1, true), diffuse(0.9f, 10));  // shines up, away from the floor
  scene.lights.push_back(lamp(LightKind::kPoint, 100, vec3(0, 0, 3)));
  EXPECT_EQ(Traced(scene).at(vec3(0), kUp, 1024).mean.x, 0);
  scene.materials.back().double_sided = true;
  expect_estimates(Traced(scene).at(vec3(0), kUp), 10 * square_factor(1, 1));
}

// A one-sided reflector throws light down only if it faces down; rho F E, lit by a lamp below it.
TEST(PathTracer, OneSidedReflectorsReflectFromTheirFrontOnly) {
  for (const bool facing_down : {true, false}) {
    Scene scene = floor_scene(0);
    add(scene, square(50, 1, !facing_down), diffuse(0.5f));
    scene.sky.radiance = vec3(0);
    Light sun =
        lamp(LightKind::kDirectional, 1000, vec3(0), vec3(0, 0, 1));  // from below, through the floor's rim
    scene.lights.push_back(sun);
    const Traced t(std::move(scene));
    const IrradianceValue e = t.at(vec3(0), kUp);
    if (!facing_down) {
      EXPECT_EQ(e.mean.x, 0);
      continue;
    }
    // All of the reflector but the shadow of the floor (4 x 4 m, straight above).
    expect_estimates(e, 0.5 * 1000 * (square_factor(50, 1) - square_factor(2, 1)));
  }
}

TEST(PathTracer, MirroredInstancesKeepTheirFront) {
  mat4 mirror(1);
  mirror[0][0] = -1;
  Scene scene = floor_scene(0);
  add(scene, square(1, 1, false), diffuse(0, 10), mirror);
  expect_estimates(Traced(scene).at(vec3(0), kUp), 10 * square_factor(1, 1));
  scene.meshes.back().primitives[0].indices = turned(square(1, 1, false)).indices;
  EXPECT_EQ(Traced(scene).at(vec3(0), kUp, 256).mean.x, 0);
}

TEST(PathTracer, OfTwoSurfacesInOnePlaneTheFirstIsThere) {
  // A plate over a lamp, in one or two paints; cut differently, so that rays could meet either.
  const auto under = [](std::vector<float> reflectances) {
    Scene scene;
    uint32_t cuts = 1;
    for (const float reflectance : reflectances) {
      Material paint = diffuse(reflectance);
      paint.double_sided = true;
      add(scene, parallelogram(vec3(-2, 2, -2), vec3(4, 0, 0), vec3(0, 0, 4), cuts), add(scene, paint));
      cuts += 2;
    }
    add(scene, square(3, 0, true), add(scene, diffuse(0)));
    scene.lights.push_back(lamp(LightKind::kPoint, 100, vec3(0, 1, 0)));
    return Traced(std::move(scene)).at(vec3(1, 0, 0), kUp, 4096);
  };
  const IrradianceValue white = under({0.8f}), black = under({0});
  ASSERT_GT(white.mean.y, 1.2 * black.mean.y);
  expect_estimates(under({0.8f, 0}), white.mean, 0.02, 0.02);
  expect_estimates(under({0, 0.8f}), black.mean, 0.02, 1e-4);
}

TEST(PathTracer, OfThreeLampsInOnePlaneTheBrightestIsThere) {
  const auto under = [](std::vector<float> lights, bool two_sided, uint32_t more_cuts) {
    Scene scene;
    uint32_t cuts = 1;
    for (const float light : lights) {
      Material lamp = diffuse(0.5f, light);
      lamp.double_sided = two_sided;
      add(scene, parallelogram(vec3(-1, 2, -1), vec3(2, 0, 0), vec3(0, 0, 2), cuts), add(scene, lamp));
      cuts += more_cuts;
    }
    add(scene, square(3, 0, true), add(scene, diffuse(0.5f)));
    return Traced(std::move(scene)).at(vec3(1, 0, 0), kUp, 4096);
  };
  for (const bool two_sided : {false, true}) {
    const IrradianceValue bright = under({100}, two_sided, 1);
    ASSERT_GT(bright.mean.y, 1);
    for (const uint32_t more_cuts : {0u, 1u, 2u}) {
      SCOPED_TRACE(more_cuts);
      expect_estimates(under({10, 30, 100}, two_sided, more_cuts), bright.mean, 0.02, 0.01);
      expect_estimates(under({10, 100, 30}, two_sided, more_cuts), bright.mean, 0.02, 0.01);
    }
  }
}

TEST(PathTracer, UnlitSurfacesBlockAndNeitherShineNorReflect) {
  Scene scene = floor_scene(0);
  add(scene, square(1, 1, false), diffuse(0.9f, 10));
  scene.materials.back().unlit = true;
  scene.sky.radiance = vec3(100);
  expect_estimates(Traced(scene).at(vec3(0), kUp), 100 * double(kPi) * (1 - square_factor(1, 1)));
}

/// A material with a texture of two texels side by side, the left half of a square white, the right `right`.
void add_halves(Scene& scene, Primitive& primitive, uint8_t right, uint8_t right_alpha = 255) {
  Image image;
  image.width = 2;
  image.height = 1;
  image.rgba = {255, 255, 255, 255, right, right, right, right_alpha};
  scene.images.push_back(image);
  // Texel centres at the borders, clamped: a sharp edge would need many texels, so the halves blend over half
  // of the width, evenly: the mean is that of both.
  for (const vec3& p : primitive.positions) primitive.texcoords[0].emplace_back(p.x > 0 ? 1.0f : 0.0f, 0.5f);
}

// The texture falls from white to black along x, symmetrically about the middle: right above it the light is
// that of an even lamp half as bright.
TEST(PathTracer, TexturedLamp) {
  Scene scene = floor_scene(0);
  Primitive& lamp = add(scene, square(1, 1, false), diffuse(0, 10));
  add_halves(scene, lamp, 0);
  scene.materials.back().emission_texture.image = 0;
  scene.materials.back().emission_texture.wrap_u = Wrap::kClamp;
  expect_estimates(Traced(scene).at(vec3(0), kUp), 5 * square_factor(1, 1));
}

TEST(PathTracer, TexturedReflectance) {
  Scene scene = floor_scene(0);
  Primitive& ceiling = add(scene, square(50, 1, false), diffuse(0.8f));
  add_halves(scene, ceiling, 0);
  scene.materials.back().base_colour_texture.image = 0;
  scene.materials.back().base_colour_texture.wrap_u = Wrap::kClamp;
  scene.lights.push_back(lamp(LightKind::kDirectional, 1000, vec3(0), vec3(0, 0, 1)));
  expect_estimates(Traced(scene).at(vec3(0), kUp), 0.4 * 1000 * (square_factor(50, 1) - square_factor(2, 1)));
}

// Between a painted floor and an even ceiling that shines, what paths meet differs from each to the next.
TEST(PathTracer, PathsDoNotDependOnThoseBeside) {
  Scene scene;
  Primitive& floor = add(scene, square(2, 0, true), diffuse(0.8f));
  add_halves(scene, floor, 0);
  scene.materials.back().base_colour_texture.image = 0;
  add(scene, square(1, 1, false), diffuse(0.6f, 10));
  const Traced t(std::move(scene));
  std::vector<PathStart> starts;
  for (uint32_t i = 0; i < PathTracer::kBundle + 7; ++i)
    starts.push_back({vec3(0.1f, 0.2f, 0.001f), kUp, {i, 1}});
  std::vector<vec3> together(starts.size());
  PathCost count;
  t.tracer->irradiance(starts, together, count);
  std::set<float> different;
  for (size_t i = 0; i < starts.size(); ++i) {
    vec3 alone(0);
    t.tracer->irradiance({&starts[i], 1}, {&alone, 1}, count);
    EXPECT_EQ(together[i], alone) << i;
    different.insert(alone.x);
  }
  EXPECT_GT(different.size(), starts.size() / 2);
}

TEST(PathTracer, AlphaLetsItsShareThrough) {
  for (const AlphaMode mode : {AlphaMode::kBlend, AlphaMode::kMask}) {
    Scene scene = floor_scene(0);
    add(scene, square(1, 1, false), diffuse(0, 10));
    // Its diagonal does not lie over the point: a ray through it would pass both triangles.
    add(scene, polygon({vec3(-2, -2, 0.5f), vec3(2.5f, -2, 0.5f), vec3(2.5f, 2, 0.5f), vec3(-2, 2, 0.5f)}),
        diffuse(0));
    scene.materials.back().alpha_mode = mode;
    scene.materials.back().alpha = 0.25f;
    scene.lights.push_back(lamp(LightKind::kPoint, 100, vec3(0, 0, 0.9f)));
    const double open = 10 * square_factor(1, 1) + 100 / 0.81;
    // A blend of alpha 0.25 takes a quarter, a mask below its cutoff nothing.
    const double share = mode == AlphaMode::kBlend ? 0.75 : 1;
    expect_estimates(Traced(scene).at(vec3(0), kUp), share * open);
  }
}

// Of a lamp that is half there, half of the light.
TEST(PathTracer, BlendedLampShinesByItsAlpha) {
  Scene scene = floor_scene(0);
  add(scene, square(1, 1, false), diffuse(0, 10));
  scene.materials.back().alpha_mode = AlphaMode::kBlend;
  scene.materials.back().alpha = 0.5f;
  expect_estimates(Traced(scene).at(vec3(0), kUp), 5 * square_factor(1, 1));
}

TEST(PathTracer, ReflectanceIsClampedAndMetalReflectsNothing) {
  Scene scene;
  add(scene, square(1, 0, true), diffuse(vec3(1, 0.5f, 0.25f)));
  scene.materials.back().metallic = 0.5f;
  Primitive& painted = add(scene, square(1, 1, true), diffuse(1));
  painted.colours.assign(4, vec4(0.5f, 1, 2, 1));
  const Traced t(std::move(scene));
  EXPECT_EQ(t.traced->diffuse(0, vec2(0)).back, vec3(0.5f, 0.25f, 0.125f));
  EXPECT_EQ(t.traced->diffuse(2, vec2(0.3f)).back, vec3(0.5f, kMaxReflectance, kMaxReflectance));
}

// Twice the light, twice the irradiance, to the last bit but rounding; and nothing changes when the room is
// moved.
TEST(PathTracer, LinearInLight) {
  Scene scene = procedural("cornell-box");
  const Traced once(scene);
  for (Material& m : scene.materials) m.emission *= 2;
  const Traced twice(std::move(scene));
  const std::vector<Receiver> points = random_receivers(*once.traced, 8, 1);
  const IrradianceValue a = once.mean(points, 64), b = twice.mean(points, 64);
  EXPECT_GT(a.mean.x, 0);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(b.mean[k] / a.mean[k], 2, 1e-4);
}

TEST(PathTracer, CameraSeesEmissionAndReflectedLight) {
  Scene scene = floor_scene(0.5f);
  scene.materials[0].emission = vec3(7);
  scene.lights.push_back(lamp(LightKind::kDirectional, 1000, vec3(0)));
  add(scene, square(2, 3, true), diffuse(0.9f));  // seen from behind: looked through by the camera
  scene.lights[0].direction = normalize(vec3(10, 0, -1));
  const Traced t(std::move(scene));
  Ray ray;
  ray.origin = vec3(0.1f, 0.2f, 5);
  ray.direction = vec3(0, 0, -1);
  PathCost count;
  const auto seen = [&] {
    vec3 nits(0);
    t.tracer->radiance({{CameraPath{ray, {0, 1}}}}, {&nits, 1}, count);
    return nits;
  };
  const vec3 lid = seen();
  ray.origin.z = 2;
  const vec3 floor = seen();
  const float sun = 1000 / std::sqrt(101.0f) / kPi;
  EXPECT_NEAR(lid.x, 0.9f * sun, 1e-2f);
  EXPECT_NEAR(floor.x, 7 + 0.5f * sun, 1e-2f);
  ray.direction = kUp;
  EXPECT_EQ(seen(), vec3(0));  // through the lid's back, to the dark
  EXPECT_GT(count.rays, 5u);
}

}  // namespace
}  // namespace goldthread
