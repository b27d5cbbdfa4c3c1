// Pages in eight bits: right on average, and not at the mercy of one bright texel.
#include "files/light_map_encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace goldthread {
namespace {

AtlasPage page_of(uint32_t size, const std::function<float(uint32_t, uint32_t)>& value) {
  AtlasPage page{{size, size, {}}, std::vector<uint8_t>(size_t{size} * size, 1)};
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x) page.irradiance.pixels.push_back(vec3(value(x, y)));
  return page;
}

TEST(LightMapEncode, TheBrightestIsWhiteWhereNothingStandsOut) {
  const AtlasPage page = page_of(64, [](uint32_t x, uint32_t) { return float(x); });
  const EncodedPage encoded = encode_page(page);
  EXPECT_EQ(encoded.intensity, 63);
  EXPECT_EQ(encoded.clipped, 0u);
  EXPECT_EQ(encoded.rgb[3 * 63], 255);
  EXPECT_EQ(encoded.rgb[0], 0);
}

TEST(LightMapEncode, BetweenTwoStepsTheMeanIsRight) {
  // A slow slope: in blocks of the pattern the bytes' mean is the light's, finer than a step.
  const AtlasPage page = page_of(64, [](uint32_t x, uint32_t y) { return x + y == 126 ? 255.0f : 40.3f; });
  const EncodedPage encoded = encode_page(page);
  double sum = 0;
  for (size_t i = 0; i < 32 * 64; ++i) sum += encoded.rgb[3 * i];
  EXPECT_NEAR(sum / (32 * 64) / 255 * double(encoded.intensity), 40.3,
              0.05 * double(encoded.intensity) / 255 + 0.02);
}

TEST(LightMapEncode, OneBrightTexelDoesNotTakeTheStepsFromAllOthers) {
  const AtlasPage page = page_of(256, [](uint32_t x, uint32_t y) {
    return x == 9 && y == 9 ? 1e4f : 1 + 0.5f * std::sin(float(x)) * std::cos(float(y));
  });
  const EncodedPage encoded = encode_page(page);
  EXPECT_LT(encoded.intensity, 1e4f);
  EXPECT_GE(encoded.clipped, 1u);
  // All others lie within 1.5, and are as finely stepped as if it were not there.
  EXPECT_LE(encoded.intensity, 1.5f);
  for (size_t i = 0; i < 3 * size_t{256} * 256; ++i)
    if (i / 3 != 9 * 256 + 9) {
      EXPECT_NEAR(encoded.rgb[i] / 255.0 * double(encoded.intensity), double(page.irradiance.pixels[i / 3].x),
                  0.02);
    }
}

TEST(LightMapEncode, TheErrorToldIsTheErrorMade) {
  const AtlasPage page = page_of(32, [](uint32_t x, uint32_t y) { return 0.01f * float(x * y); });
  const EncodedPage encoded = encode_page(page);
  double squares = 0;
  for (size_t i = 0; i < page.irradiance.pixels.size(); ++i) {
    const double off =
        encoded.rgb[3 * i] / 255.0 * double(encoded.intensity) - double(page.irradiance.pixels[i].x);
    squares += off * off;
  }
  EXPECT_NEAR(encoded.error, std::sqrt(squares / double(page.irradiance.pixels.size())), 1e-6);
  EXPECT_LT(encoded.error, double(encoded.intensity) / 255 / 2);
}

TEST(LightMapEncode, DarkAndBrokenPagesAreBlack) {
  AtlasPage page = page_of(4, [](uint32_t, uint32_t) { return 0.0f; });
  EXPECT_EQ(encode_page(page).rgb, std::vector<uint8_t>(48, 0));
  EXPECT_EQ(encode_page(page).intensity, 1);
  page.irradiance.pixels[3] = vec3(std::nanf(""), -1, 2);
  const EncodedPage encoded = encode_page(page);
  EXPECT_EQ(encoded.rgb[9], 0);
  EXPECT_EQ(encoded.rgb[10], 0);
  EXPECT_EQ(encoded.rgb[11], 255);
}

}  // namespace
}  // namespace goldthread
