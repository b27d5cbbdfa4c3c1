// Light in four bytes: what an engine unpacks by the formula is the light, as nearly as the bytes allow.
#include "files/light_map_pack.h"

#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "math/colour.h"

namespace goldthread {
namespace {

/// As the declaration says, for anybody who reads the files.
dvec3 unpacked(const PackedLight& packed, MapEncoding encoding, size_t texel) {
  const uint8_t* b = &packed.bytes[texel * packed.channels];
  dvec3 light(0);
  for (int c = 0; c < 3; ++c) {
    const double value = b[c] / 255.0, scale = packed.scale;
    if (encoding == MapEncoding::kRgbm) light[c] = value * (b[3] / 255.0) * scale;
    if (encoding == MapEncoding::kRgbd) light[c] = value / (b[3] / 255.0) * scale;
    if (encoding == MapEncoding::kRgbe) light[c] = b[3] == 0 ? 0 : b[c] * std::exp2(b[3] - 136.0);
    if (encoding == MapEncoding::kSrgb) light[c] = scale * srgb_to_linear(float(value));
  }
  return light;
}

/// Texels from a thousandth of a lux to a hundred thousand.
FloatImage any_light() {
  FloatImage image;
  image.width = 7;
  image.height = 5;
  for (int i = 0; i < 35; ++i) {
    const auto channel = [] {
      return *rc::gen::inRange(0, 10) == 0 ? 0.0f
                                           : std::pow(10.0f, float(*rc::gen::inRange(-300, 501)) / 100);
    };
    image.pixels.push_back(vec3(channel(), channel(), channel()));
  }
  return image;
}

double most_of(const FloatImage& image) {
  double most = 0;
  for (const vec3& texel : image.pixels) most = std::max<double>(most, std::max({texel.x, texel.y, texel.z}));
  return most;
}

RC_GTEST_PROP(PackLight, WhatIsUnpackedIsTheLight, ()) {
  const FloatImage image = any_light();
  const double page = most_of(image);
  for (const MapEncoding encoding : {MapEncoding::kRgbm, MapEncoding::kRgbd, MapEncoding::kRgbe}) {
    const PackedLight packed = pack_light(image, encoding, 1);
    RC_ASSERT(packed.channels == 4u);
    RC_ASSERT(packed.bytes.size() == 4 * image.pixels.size());
    for (size_t i = 0; i < image.pixels.size(); ++i) {
      const dvec3 light(image.pixels[i]), found = unpacked(packed, encoding, i);
      const double most = std::max({light.x, light.y, light.z});
      // Half a step of the texel's own range, which is at most one step of the multiplier above its light.
      double allowed = (most / 255 + page / 65025) / 2;
      if (encoding == MapEncoding::kRgbd) allowed = std::max(most / 255, page / 65025 / 2);
      if (encoding == MapEncoding::kRgbe) allowed = most / 256;
      for (int c = 0; c < 3; ++c) RC_ASSERT(std::abs(found[c] - light[c]) <= allowed * 1.0001 + 1e-30);
    }
  }
}

TEST(PackLight, ScreenBytesClipAboveWhiteAlone) {
  FloatImage image;
  image.width = 4;
  image.height = 1;
  image.pixels = {vec3(0), vec3(50, 100, 200), vec3(199.9f), vec3(1e6f)};
  const PackedLight packed = pack_light(image, MapEncoding::kSrgb, 200);
  EXPECT_EQ(packed.channels, 3u);
  EXPECT_EQ(packed.scale, 200);
  for (int c = 0; c < 3; ++c) EXPECT_EQ(unpacked(packed, MapEncoding::kSrgb, 0)[c], 0);
  EXPECT_NEAR(unpacked(packed, MapEncoding::kSrgb, 1).x, 50, 1);
  EXPECT_NEAR(unpacked(packed, MapEncoding::kSrgb, 1).y, 100, 1);
  EXPECT_EQ(packed.bytes[9], 255);
}

TEST(PackLight, BrokenTexelsAreBlackAndSpoilNoOthers) {
  FloatImage image;
  image.width = 3;
  image.height = 1;
  const float infinite = std::numeric_limits<float>::infinity();
  image.pixels = {vec3(std::nanf("")), vec3(infinite, -1, 10), vec3(10)};
  for (const MapEncoding encoding : {MapEncoding::kRgbm, MapEncoding::kRgbd, MapEncoding::kRgbe}) {
    const PackedLight packed = pack_light(image, encoding, 1);
    EXPECT_EQ(unpacked(packed, encoding, 0), dvec3(0));
    EXPECT_EQ(unpacked(packed, encoding, 1).x, 0);
    EXPECT_EQ(unpacked(packed, encoding, 1).y, 0);
    EXPECT_NEAR(unpacked(packed, encoding, 1).z, 10, 0.05);
    EXPECT_NEAR(unpacked(packed, encoding, 2).x, 10, 0.05);
  }
  FloatImage dark;
  dark.width = dark.height = 1;
  dark.pixels = {vec3(0)};
  for (const MapEncoding encoding : {MapEncoding::kRgbm, MapEncoding::kRgbd, MapEncoding::kRgbe})
    EXPECT_EQ(unpacked(pack_light(dark, encoding, 1), encoding, 0), dvec3(0));
}

}  // namespace
}  // namespace goldthread
