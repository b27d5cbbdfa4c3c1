// What the eye sees of a texel: its colour times its light, and what it sends out itself.
#include "represent/outgoing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/colour.h"
#include "scene/small_scenes.h"

namespace goldthread {
namespace {

constexpr uint32_t kSize = 16;

/// A square on most of a page, lit evenly by 2 lux.
struct Sheet {
  Scene scene;
  LightAtlas atlas;

  explicit Sheet(const Material& material, bool back = false) {
    test::add(scene, test::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), material);
    Primitive& source = scene.meshes[0].primitives[0];
    for (const vec3& p : source.positions) source.texcoords[0].push_back(vec2(p));
    MappedMesh mesh;
    mesh.source_mesh = false;
    mesh.back = back;
    for (uint32_t t = 0; t < 2; ++t) {
      for (uint32_t k = 0; k < 3; ++k) {
        mesh.origins.push_back({t, vec2(k == 1, k == 2)});
        mesh.coordinates.push_back((2.0f + 12.0f * vec2(source.positions[source.indices[3 * t + k]])) /
                                   float(kSize));
      }
      mesh.faces.push_back(UVec3(3 * t, 3 * t + 1, 3 * t + 2));
      mesh.face_parents.push_back(t);
    }
    atlas.meshes.push_back(mesh);
    AtlasPage& page = atlas.pages.emplace_back();
    page.irradiance.width = page.irradiance.height = kSize;
    page.irradiance.pixels.assign(kSize * kSize, vec3(2));
    page.covered.assign(kSize * kSize, 1);
  }
  OutgoingPage page() const { return outgoing_pages(atlas, scene, 2)[0]; }
};

vec3 texel(const OutgoingPage& page, uint32_t x, uint32_t y) {
  return page.nits.pixels[y * kSize + x];
}

TEST(Outgoing, ColourTimesLightOverPi) {
  Material paint = test::diffuse(vec3(0.5f, 0.25f, 0.125f));
  paint.metallic = 0.5f;
  const OutgoingPage page = Sheet(paint).page();
  for (uint32_t i = 0; i < kSize; ++i)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(texel(page, i, i)[c], 0.5f * paint.base_colour[c] * 2 / kPi, 1e-6) << i;
  for (const float alpha : page.alpha) EXPECT_NEAR(alpha, 1, 1e-6);
}

TEST(Outgoing, EmissionIsOnTheSideThatShines) {
  Material lamp = test::diffuse(vec3(0), vec3(3 * kPi));
  EXPECT_NEAR(texel(Sheet(lamp).page(), 5, 5).x, 3, 1e-5);
  EXPECT_NEAR(texel(Sheet(lamp, true).page(), 5, 5).x, 0, 1e-6);
  lamp.double_sided = true;
  EXPECT_NEAR(texel(Sheet(lamp, true).page(), 5, 5).x, 3, 1e-5);
}

TEST(Outgoing, TexturesAreReadWhereTheyLie) {
  // Left half red, right half green and see-through.
  Material paint = test::diffuse(vec3(1));
  paint.base_colour_texture.image = 0;
  paint.alpha_mode = AlphaMode::kBlend;
  Sheet sheet(paint);
  Image image;
  image.width = 64;
  image.height = 1;
  for (uint32_t x = 0; x < 64; ++x) {
    const bool left = x < 32;
    for (const int byte : {left ? 255 : 0, left ? 0 : 255, 0, left ? 255 : 51})
      image.rgba.push_back(uint8_t(byte));
  }
  sheet.scene.images.push_back(image);
  const OutgoingPage page = sheet.page();
  EXPECT_NEAR(texel(page, 4, 8).x, 2 / kPi, 1e-4);
  EXPECT_NEAR(texel(page, 4, 8).y, 0, 1e-6);
  EXPECT_NEAR(texel(page, 11, 8).x, 0, 1e-6);
  EXPECT_NEAR(texel(page, 11, 8).y, 2 / kPi, 1e-4);
  EXPECT_NEAR(page.alpha[8 * kSize + 4], 1, 1e-5);
  EXPECT_NEAR(page.alpha[8 * kSize + 11], 0.2, 1e-3);
  // Round the chart its own: no black, no wrong colour on either side.
  EXPECT_NEAR(texel(page, 1, 8).x, 2 / kPi, 1e-4);
  EXPECT_NEAR(texel(page, 14, 8).y, 2 / kPi, 1e-4);
}

TEST(Outgoing, LightThatChangesIsReadBetweenTexels) {
  Sheet sheet(test::diffuse(vec3(1)));
  for (uint32_t i = 0; i < kSize * kSize; ++i)
    sheet.atlas.pages[0].irradiance.pixels[i] = vec3(float(i % kSize));
  const OutgoingPage page = sheet.page();
  for (uint32_t x = 3; x < 13; ++x) EXPECT_NEAR(texel(page, x, 8).x, float(x) / kPi, 1e-4);
}

}  // namespace
}  // namespace goldthread
