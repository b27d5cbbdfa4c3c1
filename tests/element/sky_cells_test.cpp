// What cells of the sky owe the sky, and halves their whole.
#include "element/sky_cells.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/rng.h"
#include "math/colour.h"
#include "math/form_factor.h"
#include "scene/small_skies.h"

namespace goldthread {
namespace {

using test::even_picture;
using test::sky_of;
using test::towards;

/// Cuts every cell below `roots` so often; returns the last ones.
std::vector<uint32_t> split_all(SkyCells& cells, std::vector<uint32_t> roots, int times) {
  for (int i = 0; i < times; ++i) {
    std::vector<uint32_t> halves;
    for (const uint32_t cell : roots) {
      const uint32_t first = cells.split(cell);
      halves.insert(halves.end(), {first, first + 1});
    }
    roots = std::move(halves);
  }
  return roots;
}

dvec3 sent_by(const SkyCells& cells, const std::vector<uint32_t>& some) {
  dvec3 sum(0);
  for (const uint32_t cell : some) sum += double(cells[cell].solid_angle) * dvec3(cells[cell].nits);
  return sum;
}

/// Lux on an open plane whose horizon runs along octants.
double lux_of(const SkyCells& cells, const std::vector<uint32_t>& some, const vec3& normal) {
  double sum = 0;
  for (const uint32_t cell : some) {
    const double facing = double(dot(cells[cell].transfer, normal));
    if (facing > 0) sum += double(kPi * luminance(cells[cell].nits)) * facing;
  }
  return sum;
}

FloatImage noise(uint32_t width, uint32_t height) {
  FloatImage picture = even_picture(width, height, vec3(0));
  for (uint32_t i = 0; i < picture.pixels.size(); ++i)
    picture.pixels[i] = vec3(unit_float(hash(i, 1)), unit_float(hash(i, 2)), unit_float(hash(i, 3)));
  return picture;
}

TEST(SkyCells, HalvesSendWhatTheWholeDid) {
  for (const Sky& sky : {sky_of(noise(64, 32)), sky_of(noise(7, 5), 3, 0.4f), test::many_skies()[2].second}) {
    SkyCells cells(sky);
    const std::vector<uint32_t> octants{0, 1, 2, 3, 4, 5, 6, 7};
    const dvec3 whole = sent_by(cells, octants);
    for (int depth = 1; depth <= 9; ++depth) {
      SkyCells fresh(sky);
      const dvec3 parts = sent_by(fresh, split_all(fresh, octants, depth));
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(parts[k] / whole[k], 1, 2e-5) << depth;
    }
  }
}

TEST(SkyCells, LightOfTheWholeSkyIsItsIntegral) {
  for (const auto& [name, sky] : test::many_skies()) {
    SCOPED_TRACE(name);
    for (const vec3& normal : {vec3(0, 1, 0), vec3(1, 0, 0), vec3(0, 0, -1), vec3(0, -1, 0)}) {
      const double truth = double(luminance(vec3(test::open_illuminance(sky, normal))));
      SkyCells cells(sky);
      for (const auto& some : {std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 6, 7}, cells.make_first()})
        EXPECT_NEAR(lux_of(cells, some, normal), truth, 1e-3 * truth + 1e-3) << normal.x << normal.y;
    }
    const double lux = double(luminance(sky.model->horizontal_illuminance()));
    EXPECT_NEAR(lux_of(SkyCells(sky), {0, 1, 2, 3, 4, 5, 6, 7}, {0, 1, 0}), lux, 2e-4 * lux);
  }
}

TEST(SkyCells, EvenPictureIsAnEvenSky) {
  const Sky picture = sky_of(even_picture(30, 15, vec3(3, 4, 5)));
  SkyCells cells(picture);
  for (const uint32_t cell : split_all(cells, cells.make_first(), 6)) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(cells[cell].nits[k], float(k) + 3, 1e-5f);
    EXPECT_LT(cells[cell].unevenness, 1e-5f);
    const vec3 middle = normalize(cells[cell].corners[0] + cells[cell].corners[1] + cells[cell].corners[2]);
    EXPECT_LT(length(cells[cell].transfer - sky_form_factor(middle, cells[cell].corners)),
              1e-5f * cells[cell].solid_angle);
  }
}

TEST(SkyCells, UnevennessIsTheMeanDeviation) {
  // Of two halves, 1 and 3: the mean is 2, and all is 1 away from it.
  FloatImage picture = even_picture(8, 4, vec3(1));
  for (uint32_t x = 0; x < 8; ++x) picture.pixels[x] = picture.pixels[8 + x] = vec3(3);
  SkyCells turned(sky_of(picture));
  EXPECT_FLOAT_EQ(turned[0].unevenness, 0);  // within the upper octants all is even
  FloatImage stripes = even_picture(512, 4, vec3(1));
  for (size_t i = 0; i < stripes.pixels.size(); i += 2) stripes.pixels[i] = vec3(3);
  const Sky sky = sky_of(stripes);
  SkyCells cells(sky);
  EXPECT_NEAR(cells[0].nits.x, 2, 1e-4f);
  EXPECT_NEAR(cells[0].unevenness, 1, 1e-4f);
}

TEST(SkyCells, ASmallSunGetsACellOfItsOwn) {
  // A pixel of 0.7 degrees that outshines all the rest ten times.
  FloatImage picture = even_picture(512, 256, vec3(1));
  picture.pixels[60 * 512 + 130] = vec3(1e6f);
  const Sky sky = sky_of(picture);
  SkyCells cells(sky);
  const std::vector<uint32_t> first = cells.make_first();
  EXPECT_LE(first.size(), 64u);
  const float pixel = 2 * kPi / 512 * kPi / 256;
  const uint32_t brightest = *std::max_element(
      first.begin(), first.end(), [&](uint32_t a, uint32_t b) { return cells[a].nits.x < cells[b].nits.x; });
  EXPECT_LT(cells[brightest].solid_angle, 4 * pixel);
  EXPECT_GT(cells[brightest].nits.x, 1e5f);
}

TEST(SkyCells, CutsEndWhereNoLinkCouldTell) {
  const Sky sky = sky_of(noise(4, 2));
  SkyCells cells(sky);
  uint32_t cell = 0;
  int cuts = 0;
  for (; cells.divisible(cell) && cuts < 100; ++cuts) cell = cells.split(cell);
  EXPECT_LT(cuts, 30);
  EXPECT_LT(cells[cell].solid_angle, 1e-5f);
}

}  // namespace
}  // namespace goldthread
