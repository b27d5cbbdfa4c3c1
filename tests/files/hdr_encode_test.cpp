// What is written as a Radiance picture comes back as it was, to half a 256th of each pixel's brightest
// channel.
#include "files/hdr_encode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "files/hdr_decode.h"

namespace goldthread {
namespace {

TEST(HdrEncode, ComesBackAsItWas) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> power(-20, 20), share(0, 1);
  FloatImage image{31, 17, {}};
  for (uint32_t i = 0; i < 31 * 17; ++i) {
    const float scale = std::exp2(power(random));
    image.pixels.push_back(scale * vec3(share(random), share(random), 1));
  }
  image.pixels[3] = vec3(0.9999f, 0.5f, 0);  // whose mantissa rounds up to 256
  image.pixels[4] = vec3(0);
  const Result<FloatImage> back = decode_radiance_picture(encode_hdr(image));
  ASSERT_TRUE(back) << back.error().line();
  ASSERT_EQ(back->width, 31u);
  ASSERT_EQ(back->height, 17u);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const vec3& pixel = image.pixels[i];
    const float most = std::max({pixel.x, pixel.y, pixel.z});
    // The mantissa is 128 to 255, and some readers add a half to it.
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(back->pixels[i][c], pixel[c], most / 128) << i;
  }
}

TEST(HdrEncode, WhatIsNoLightIsBlack) {
  FloatImage image{3, 1, {vec3(std::nanf("")), vec3(-1, -2, -3), vec3(INFINITY)}};
  const Result<FloatImage> back = decode_radiance_picture(encode_hdr(image));
  ASSERT_TRUE(back);
  for (const vec3& pixel : back->pixels) EXPECT_EQ(pixel, vec3(0));
}

}  // namespace
}  // namespace goldthread
