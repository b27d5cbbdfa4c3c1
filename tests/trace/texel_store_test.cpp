#include "trace/texel_store.h"

#include <vector>

#include "trace/traced.h"

namespace goldthread {
namespace {

using namespace test;

Image noise(uint32_t width, uint32_t height) {
  Image image;
  image.width = width;
  image.height = height;
  for (uint32_t i = 0; i < width * height * 4; ++i) image.rgba.push_back(uint8_t(hash(i, width) & 255));
  return image;
}

Texture use_of(int32_t image, Wrap wrap) {
  Texture texture;
  texture.image = image;
  texture.wrap_u = texture.wrap_v = wrap;
  texture.scale = {3, -2};
  texture.rotation = 0.3f;
  return texture;
}

// Small ones that are copied, one that stays, an empty one between them, and those that are not there.
TEST(TexelStore, LookupsAreThoseOfTheImages) {
  const std::vector<Image> images{noise(16, 16), Image(), noise(5, 7), noise(2048, 1025), noise(3, 1)};
  const TexelStore store(images);
  for (int32_t image = -1; image <= 5; ++image)
    for (const Wrap wrap : {Wrap::kRepeat, Wrap::kClamp, Wrap::kMirror})
      for (uint32_t i = 0; i < 200; ++i) {
        const Texture texture = use_of(image, wrap);
        const SobolPoint p = sobol_point(i, 1);
        const vec2 uv = 4.0f * vec2(unit_double(p.u), unit_double(p.v)) - 2.0f;
        const TextureLookup lookup(texture, store[texture], uv);
        EXPECT_EQ(lookup.colour(), sample_texture(texture, images, uv)) << image;
        EXPECT_EQ(lookup.data(), sample_data_texture(texture, images, uv)) << image;
        for (int c = 0; c < 4; ++c) EXPECT_EQ(lookup.data(c), lookup.data()[c]) << image;
      }
  EXPECT_EQ(store[use_of(3, Wrap::kRepeat)].rgba, images[3].rgba.data());
  EXPECT_NE(store[use_of(2, Wrap::kRepeat)].rgba, images[2].rgba.data());
}

/// A square whose colour is a picture's, stretched over it.
Scene pictured(float metallic) {
  Scene scene;
  scene.images.push_back(noise(8, 8));
  Primitive& floor = add(scene, square(1, 0, true), diffuse(0.5f));
  for (const vec3& p : floor.positions) floor.texcoords[0].push_back(vec2(p.x, p.y));
  Material& m = scene.materials.back();
  m.base_colour = {0.5f, 1, 0.25f};
  m.metallic = metallic;
  m.base_colour_texture.image = 0;
  return scene;
}

/// What TracedScene makes of the picture at some points of the first triangle is `expected` of its colour.
template <typename Expected>
void expect_diffuse(const Scene& scene, const Expected& expected) {
  const TracedScene traced(scene);
  const Texture& texture = scene.materials.back().base_colour_texture;
  for (uint32_t i = 0; i < 50; ++i) {
    const SobolPoint p = sobol_point(i, 2);
    const vec2 weights(float(unit_double(p.u)) / 2, float(unit_double(p.v)) / 2);
    const vec3 point = traced.point(0, weights);
    const vec3 colour(sample_texture(texture, scene.images, vec2(point.x, point.y)));
    const Diffuse at_once = traced.diffuse(0, weights);
    Meeting met;
    met.triangle = 0;
    met.part = &traced.parts()[0];
    met.weights = weights;
    const Diffuse begun = traced.diffuse(met, traced.begin_lookup(met));
    EXPECT_LT(length(at_once.back - expected(colour)), 1e-5f) << i;
    EXPECT_EQ(begun.back, at_once.back);
    EXPECT_EQ(begun.through, at_once.through);
  }
}

TEST(TexelStore, TexturesColourWhatIsReflected) {
  const vec3 base(0.5f, 1, 0.25f);
  Scene scene = pictured(0.25f);
  expect_diffuse(scene,
                 [&](const vec3& colour) { return glm::min(base * colour * 0.75f, vec3(kMaxReflectance)); });
  scene.materials.back().diffuse_transmission = 0.5f;
  expect_diffuse(scene, [&](const vec3& colour) { return base * colour * 0.75f * 0.5f; });
  scene.materials.back().diffuse_transmission = 0;
  scene.materials.back().unlit = true;
  expect_diffuse(scene, [](const vec3&) { return vec3(0); });
}

}  // namespace
}  // namespace goldthread
