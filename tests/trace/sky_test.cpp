// Skies that are not the same all over, by path tracing: against their integrals and each other.
#include "scene/small_skies.h"
#include "trace/directions.h"
#include "trace/sky_table.h"
#include "trace/traced.h"

namespace goldthread {
namespace {

using test::add;
using test::diffuse;
using test::even_picture;
using test::expect_estimates;
using test::sky_of;
using test::towards;
using test::Traced;

/// A square of 2 by 2 round the origin, facing the unit `normal`.
Scene open_square(const Sky& sky, const vec3& normal) {
  const vec3 across =
      normalize(std::abs(normal.x) > 0.6f ? cross(normal, vec3(0, 1, 0)) : cross(normal, vec3(1, 0, 0)));
  const vec3 up = cross(normal, across);
  Scene scene;
  scene.sky = sky;
  add(scene, test::parallelogram(-across - up, 2.0f * across, 2.0f * up), diffuse(0));
  return scene;
}

IrradianceValue open_light(const Sky& sky, const vec3& normal, uint64_t samples = 4096) {
  const Traced t(open_square(sky, normal));
  return t.at(vec3(0), normal, samples);
}

TEST(SkyTable, DensityIntegratesToOneAndIsThatOfTheSamples) {
  for (const auto& [name, sky] : test::many_skies()) {
    SCOPED_TRACE(name);
    const SkyTable table(sky);
    double sum = 0;
    int differ = 0;
    constexpr uint32_t kCount = 1u << 16;
    for (uint32_t i = 0; i < kCount; ++i) {
      const SobolPoint p = sobol_point(i, 7);
      sum += double(table.density(even_direction(p)));
      const SkyDirection drawn = table.sample(unit_double(p.u), unit_double(p.v));
      EXPECT_NEAR(length(drawn.direction), 1, 1e-6f);
      // At the edge of a piece rounding may put the direction into the next.
      differ += std::abs(table.density(drawn.direction) / drawn.density - 1) > 1e-3f ? 1 : 0;
    }
    EXPECT_NEAR(sum * 4 * double(kPi) / kCount, 1, 0.02);
    EXPECT_LT(differ, int(kCount / 200));
  }
}

TEST(SkyTable, DrawsByLuminance) {
  // One bright pixel beside a dim rest of the same power: half of all samples go to it.
  FloatImage picture = even_picture(64, 32, vec3(1));
  const double pixel =
      2 * double(kPi) / 64 * (std::sin(double(kPi) * 6 / 32) - std::sin(double(kPi) * 5 / 32));
  picture.pixels[10 * 64 + 20] = vec3(float((4 * double(kPi) - pixel) / pixel));
  const SkyTable table(sky_of(picture));
  int found = 0;
  for (uint32_t i = 0; i < 4096; ++i) {
    const SobolPoint p = sobol_point(i, 1);
    if (table.sample(unit_double(p.u), unit_double(p.v)).density > 1) ++found;
  }
  EXPECT_NEAR(found, 2048, 8);
}

TEST(TracedSky, OpenGroundGetsTheModelsIlluminance) {
  for (const auto& [name, sky] : test::many_skies()) {
    SCOPED_TRACE(name);
    expect_estimates(open_light(sky, vec3(0, 1, 0)), dvec3(sky.model->horizontal_illuminance()), 0.005);
  }
}

TEST(TracedSky, WallsGetWhatTheirHalfOfTheSkySends) {
  for (const auto& [name, sky] : test::many_skies()) {
    SCOPED_TRACE(name);
    for (const vec3& normal : {towards(0, 140), towards(0, -20), towards(40, 60)})
      expect_estimates(open_light(sky, normal), test::open_illuminance(sky, normal), 0.01, 1e-3);
  }
}

TEST(TracedSky, GroundLightsWhatLooksDown) {
  const Result<SkyModel> overcast = SkyModel::overcast(SkyLevel::horizontal_illuminance(vec3(10000)));
  ASSERT_TRUE(overcast);
  const Sky sky = sky_of(overcast->with_ground(vec3(0.2f, 0.3f, 0.4f)));
  expect_estimates(open_light(sky, vec3(0, -1, 0)), dvec3(2000, 3000, 4000), 0.005);
}

TEST(TracedSky, EvenPictureIsAUniformSky) {
  Sky uniform;
  uniform.radiance = vec3(100, 200, 300);
  const Sky picture = sky_of(even_picture(16, 8, vec3(1, 2, 3)), 100, 0.7f);
  const dvec3 truth = double(kPi) * dvec3(100, 200, 300);
  expect_estimates(open_light(picture, towards(30, 50)), truth, 0.005);
  expect_estimates(open_light(uniform, towards(30, 50)), truth, 0.005);
}

TEST(TracedSky, TurningThePictureIsTurningTheReceiver) {
  FloatImage picture = even_picture(64, 32, vec3(1));
  for (uint32_t y = 4; y < 12; ++y)
    for (uint32_t x = 10; x < 20; ++x) picture.pixels[y * 64 + x] = vec3(50, 20, 10);
  const IrradianceValue plain = open_light(sky_of(picture), towards(0, -90)),
                        turned = open_light(sky_of(picture, 1, kPi / 2), vec3(towards(0, 0)));
  EXPECT_GT(plain.mean.x, 10);  // where the bright piece is
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(plain.mean[k], turned.mean[k],
                4 * std::hypot(plain.standard_error[k], turned.standard_error[k]) + 1e-4 * plain.mean[k]);
}

TEST(TracedSky, ASmallSunInThePictureIsFound) {
  // Half a degree, ten times all else: with the cosine alone one sample in ten thousand would meet it.
  FloatImage picture = even_picture(720, 360, vec3(10));
  const uint32_t row = 100, column = 400;
  picture.pixels[row * 720 + column] = vec3(1e7f);
  const Sky sky = sky_of(picture);
  const vec3 sun = towards(90 - (row + 0.5) / 2, (column + 0.5) / 2 - 180);
  const double top = double(kPi) * (0.5 - row / 360.0), bottom = double(kPi) * (0.5 - (row + 1) / 360.0);
  const double size = (std::sin(top) - std::sin(bottom)) * 2 * double(kPi) / 720;
  expect_estimates(open_light(sky, vec3(0, 1, 0)),
                   dvec3(double(kPi) * 10 + size * (1e7 - 10) * double(sun.y)), 0.005, 1e-3);
}

TEST(TracedSky, AnotherSkyIsAnotherFingerprint) {
  std::vector<uint64_t> prints;
  for (const auto& [name, sky] : test::many_skies())
    prints.push_back(Traced(open_square(sky, vec3(0, 1, 0))).traced->fingerprint());
  prints.push_back(
      Traced(open_square(sky_of(even_picture(4, 2, vec3(1))), vec3(0, 1, 0))).traced->fingerprint());
  prints.push_back(
      Traced(open_square(sky_of(even_picture(4, 2, vec3(1)), 1, 1), vec3(0, 1, 0))).traced->fingerprint());
  std::sort(prints.begin(), prints.end());
  EXPECT_EQ(std::adjacent_find(prints.begin(), prints.end()), prints.end());
}

}  // namespace
}  // namespace goldthread
