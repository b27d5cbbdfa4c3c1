// Which pixel is where, and what becomes of pixels that are no light.
#include "scene/environment_map.h"

#include <cmath>
#include <limits>

#include "scene/sky_grid.h"
#include "scene/small_skies.h"

namespace goldthread {
namespace {

using test::even_picture;
using test::sky_of;
using test::towards;

/// Pixel (column, row) is (column, row, 1).
FloatImage numbered(uint32_t width, uint32_t height) {
  FloatImage picture = even_picture(width, height, vec3(1));
  for (uint32_t y = 0; y < height; ++y)
    for (uint32_t x = 0; x < width; ++x) picture.pixels[y * width + x] = vec3(float(x), float(y), 1);
  return picture;
}

TEST(EnvironmentMap, MiddleIsNorthAndRightIsEast) {
  const Sky sky = sky_of(numbered(36, 18));
  // Ten degrees a pixel; the middle lies between columns 17 and 18.
  EXPECT_EQ(sky.radiance_towards(towards(5, 5)), vec3(18, 8, 1));
  EXPECT_EQ(sky.radiance_towards(towards(5, -5)), vec3(17, 8, 1));
  EXPECT_EQ(sky.radiance_towards(towards(-5, 95)), vec3(27, 9, 1));
  EXPECT_EQ(sky.radiance_towards(towards(85, 185)), vec3(0, 0, 1));
  EXPECT_EQ(sky.radiance_towards(7.0f * towards(-85, 175)), vec3(35, 17, 1));
  EXPECT_EQ(sky.radiance_towards(vec3(0, 1, 0)).y, 0);
  EXPECT_EQ(sky.radiance_towards(vec3(0, -1, 0)).y, 17);
}

TEST(EnvironmentMap, RotationTurnsNorthToEast) {
  const Sky plain = sky_of(numbered(36, 18)), turned = sky_of(numbered(36, 18), 1, kPi / 2);
  for (int azimuth = 5; azimuth < 360; azimuth += 10)
    EXPECT_EQ(turned.radiance_towards(towards(15, azimuth + 90)),
              plain.radiance_towards(towards(15, azimuth)));
}

TEST(EnvironmentMap, ScaleMultiplies) {
  EXPECT_EQ(sky_of(even_picture(2, 1, vec3(1, 2, 3)), 10).radiance_towards(vec3(1, 0, 0)), vec3(10, 20, 30));
  EXPECT_FALSE(sky_of(even_picture(2, 1, vec3(1)), 0).present());
}

TEST(EnvironmentMap, PixelsThatAreNoLightAreDarkAndCounted) {
  FloatImage picture = even_picture(4, 2, vec3(5));
  picture.pixels[0].x = std::numeric_limits<float>::quiet_NaN();
  picture.pixels[1].y = -3;
  picture.pixels[2] = vec3(std::numeric_limits<float>::infinity());
  picture.pixels[3].z = 2e12f;
  EnvironmentMap::Repairs repairs;
  const Result<EnvironmentMap> map = EnvironmentMap::make(picture, 1, 0, &repairs);
  ASSERT_TRUE(map);
  EXPECT_EQ(repairs.pixels, 4u);
  EXPECT_EQ(map->picture().pixels[0], vec3(0, 5, 5));
  EXPECT_EQ(map->picture().pixels[1], vec3(5, 0, 5));
  EXPECT_EQ(map->picture().pixels[2], vec3(0));
  EXPECT_EQ(map->picture().pixels[3], vec3(5, 5, 0));
  EXPECT_EQ(map->picture().pixels[4], vec3(5));
}

TEST(EnvironmentMap, RefusesWhatHasNoLuminance) {
  EXPECT_FALSE(EnvironmentMap::make(FloatImage(), 1, 0));
  EXPECT_FALSE(EnvironmentMap::make(even_picture(2, 2, vec3(-1)), 1, 0));
  EXPECT_FALSE(EnvironmentMap::make(even_picture(2, 2, vec3(1)), -1, 0));
  EXPECT_FALSE(EnvironmentMap::make(even_picture(2, 2, vec3(1)), std::numeric_limits<float>::infinity(), 0));
  EXPECT_FALSE(EnvironmentMap::make(even_picture(2, 2, vec3(1)), 1, std::numeric_limits<float>::quiet_NaN()));
}

double luminance_integral(const SkyGrid& grid, int channel, double* solid_angle) {
  double sum = 0;
  *solid_angle = 0;
  for (uint32_t y = 0; y < grid.height; ++y)
    for (uint32_t x = 0; x < grid.width; ++x) {
      const double size = double(grid.piece(x, y).solid_angle());
      *solid_angle += size;
      sum += size * double(grid.nits[y * grid.width + x][channel]);
    }
  return sum;
}

TEST(SkyGrid, AveragesOfWidePicturesSendWhatThePixelsDo) {
  // A bright pixel that is a thousandth of a block's width from vanishing between samples.
  FloatImage picture = even_picture(3 * 2048, 3 * 16, vec3(1));
  picture.pixels[20 * picture.width + 1000] = vec3(1e6f, 1, 1);
  const SkyGrid grid = grid_of(sky_of(picture, 1, 0.3f));
  EXPECT_EQ(grid.width, 2048u);
  EXPECT_EQ(grid.height, 16u);
  double all = 0;
  const double sent = luminance_integral(grid, 0, &all), kSphere = 4 * double(kPi);
  EXPECT_NEAR(all, kSphere, 1e-5);
  const double top = std::sin(double(kPi) * (0.5 - 20.0 / 48)),
               bottom = std::sin(double(kPi) * (0.5 - 21.0 / 48));
  const double pixel = (top - bottom) * 2 * double(kPi) / picture.width;
  EXPECT_NEAR(sent, kSphere + pixel * (1e6 - 1), 1e-3 * sent);
}

TEST(SkyGrid, HoldsThePixelsOfPicturesTurnedAnyWay) {
  const FloatImage picture = numbered(40, 20);
  for (const float turn : {0.0f, 1.0f, -4.0f}) {
    const SkyGrid grid = grid_of(sky_of(picture, 1, turn));
    EXPECT_EQ(grid.nits, picture.pixels);
  }
}

}  // namespace
}  // namespace goldthread
