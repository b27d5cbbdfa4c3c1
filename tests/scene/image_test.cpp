// Known answers of texture lookup.
#include "scene/image.h"

#include <gmock/gmock.h>

#include "math/colour.h"

namespace goldthread {
namespace {

/// Two texels beside one another: black and white, the second half transparent.
std::vector<Image> two_texels() {
  Image image;
  image.width = 2;
  image.height = 1;
  image.rgba = {0, 0, 0, 255, 255, 255, 255, 0};
  return {image};
}

Texture plain() {
  Texture texture;
  texture.image = 0;
  return texture;
}

float red(const Texture& texture, vec2 uv) {
  return sample_data_texture(texture, two_texels(), uv).x;
}

TEST(SampleTexture, AbsentAndEmptyAreWhite) {
  EXPECT_EQ(sample_texture(Texture{}, {}, vec2(0.3f)), vec4(1));
  EXPECT_EQ(sample_texture(plain(), {Image{}}, vec2(0.3f)), vec4(1));
  EXPECT_EQ(sample_texture(plain(), {}, vec2(0.3f)), vec4(1));
}

TEST(SampleTexture, TexelCentresAndBetween) {
  EXPECT_FLOAT_EQ(red(plain(), {0.25f, 0.5f}), 0);
  EXPECT_FLOAT_EQ(red(plain(), {0.75f, 0.5f}), 1);
  EXPECT_FLOAT_EQ(red(plain(), {0.5f, 0.5f}), 0.5f);
  EXPECT_FLOAT_EQ(sample_texture(plain(), two_texels(), {0.5f, 0.5f}).w, 0.5f);
}

TEST(SampleTexture, WrapsAtTheEdges) {
  Texture t = plain();
  EXPECT_FLOAT_EQ(red(t, {0, 0.5f}), 0.5f);  // black beside the repeated white
  EXPECT_FLOAT_EQ(red(t, {-0.25f, 0.5f}), 1);
  EXPECT_FLOAT_EQ(red(t, {7.25f, -3.0f}), 0);
  t.wrap_u = Wrap::kClamp;
  EXPECT_FLOAT_EQ(red(t, {0, 0.5f}), 0);
  EXPECT_FLOAT_EQ(red(t, {5, 0.5f}), 1);
  t.wrap_u = Wrap::kMirror;
  EXPECT_FLOAT_EQ(red(t, {1.25f, 0.5f}), 1);
  EXPECT_FLOAT_EQ(red(t, {1.75f, 0.5f}), 0);
  EXPECT_FLOAT_EQ(red(t, {-0.25f, 0.5f}), 0);
}

TEST(SampleTexture, ColourIsLinearisedBeforeItIsMixed) {
  Image image;
  image.width = image.height = 1;
  image.rgba = {188, 188, 188, 255};
  EXPECT_NEAR(sample_texture(plain(), {image}, vec2(0)).x, srgb_to_linear(188.0f / 255), 1e-6f);
  EXPECT_NEAR(sample_data_texture(plain(), {image}, vec2(0)).x, 188.0f / 255, 1e-6f);
  EXPECT_FLOAT_EQ(sample_texture(plain(), two_texels(), {0.5f, 0.5f}).x, 0.5f);
}

TEST(SampleTexture, TransformScalesTurnsAndMoves) {
  // A column of a gradient along u only: red is u at texel centres.
  Texture t = plain();
  t.wrap_u = t.wrap_v = Wrap::kClamp;
  t.scale = vec2(0.5f, 1);
  EXPECT_FLOAT_EQ(red(t, {1, 0.5f}), 0.5f);
  t.offset = vec2(0.25f, 0);
  EXPECT_FLOAT_EQ(red(t, {1, 0.5f}), 1);
  // A quarter turn counter-clockwise as seen (v down) takes (0, 1) to (1, 0).
  t = plain();
  t.wrap_u = t.wrap_v = Wrap::kClamp;
  t.rotation = kPi / 2;
  EXPECT_NEAR(red(t, {0, 0.75f}), 1, 1e-5f);
  EXPECT_NEAR(red(t, {0, 0.25f}), 0, 1e-5f);
}

TEST(SampleTexture, UndefinedCoordinatesDoNoHarm) {
  const float inf = std::numeric_limits<float>::infinity();
  for (const float bad : {inf, -inf, inf - inf, 1e30f, -1e30f}) {
    const float value = red(plain(), {bad, bad});
    EXPECT_TRUE(value >= 0 && value <= 1) << bad;
  }
}

}  // namespace
}  // namespace goldthread
