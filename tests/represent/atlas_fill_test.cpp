// From vertices to texels: what the lighting says at a place is what its texel says.
#include "represent/atlas_fill.h"

#include <gtest/gtest.h>

#include <atomic>

#include "scene/light_atlas_lookup.h"
#include "scene/small_scenes.h"

namespace goldthread {
namespace {

constexpr uint32_t kSize = 32;

float ramp(const vec3& p) {
  return 1 + 3 * p.x + p.y;
}

/// A unit square of two triangles, front and back, each on a quarter of one page; the texel of a place is
/// known.
struct MappedSquare {
  Scene scene;
  Lighting lighting;
  LightAtlas atlas;

  static vec2 place(const vec3& p, bool back) { return vec2(back ? 18 : 2, 4) + 12.0f * vec2(p); }

  MappedSquare() {
    test::add(scene, test::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}), test::diffuse(0.5f));
    LitPrimitive lit;
    for (const vec3& p : source().positions) {
      lit.irradiance.push_back(vec3(ramp(p)));
      lit.irradiance_back.push_back(vec3(10 * ramp(p)));
    }
    lighting.primitives.push_back(lit);
    atlas.pages.resize(1);
    for (const bool back : {false, true}) {
      MappedMesh mesh;
      mesh.source_mesh = false;
      mesh.back = back;
      for (uint32_t t = 0; t < 2; ++t) {
        for (uint32_t k = 0; k < 3; ++k) {
          const vec3 p = source().positions[source().indices[3 * t + k]];
          mesh.origins.push_back({t, vec2(k == 1, k == 2)});
          mesh.coordinates.push_back(place(p, back) / float(kSize));
        }
        mesh.faces.push_back(UVec3(3 * t, 3 * t + 1, 3 * t + 2));
        mesh.face_parents.push_back(t);
      }
      atlas.meshes.push_back(mesh);
    }
  }
  const Primitive& source() const { return scene.meshes[0].primitives[0]; }

  void expect_ramp() const {
    const AtlasPage& page = atlas.pages[0];
    for (const bool back : {false, true})
      for (uint32_t y = 0; y < 12; ++y)
        for (uint32_t x = 0; x < 12; ++x) {
          const vec2 corner = place(vec3(0), back);
          const size_t i = (uint32_t(corner.y) + y) * kSize + uint32_t(corner.x) + x;
          const vec3 p((float(x) + 0.5f) / 12, (float(y) + 0.5f) / 12, 0);
          ASSERT_TRUE(page.covered[i]);
          EXPECT_NEAR(page.irradiance.pixels[i].x, ramp(p) * (back ? 10 : 1), 1e-3) << x << " " << y << back;
        }
    size_t covered = 0;
    for (const uint8_t c : page.covered) covered += c;
    EXPECT_EQ(covered, 2u * 12 * 12);
  }
};

TEST(AtlasFill, LightOfTheSourcesVertices) {
  MappedSquare square;
  fill_atlas(square.atlas, square.scene, square.lighting, {kSize, 2, {}});
  square.expect_ramp();
}

TEST(AtlasFill, LightOfARefinedMeshWhoseVerticesNeighboursShare) {
  // Four faces round the middle of the diagonal, whose origin is in the first triangle for both of them.
  MappedSquare square;
  LitPrimitive& lit = square.lighting.primitives[0];
  const Primitive& source = square.source();
  lit.source_mesh = false;
  lit.irradiance.clear();
  lit.irradiance_back.clear();
  const auto add = [&](uint32_t triangle, const vec2& weights) {
    vec3 p(0);
    const float shares[3] = {1 - weights.x - weights.y, weights.x, weights.y};
    for (uint32_t k = 0; k < 3; ++k) p += shares[k] * source.positions[source.indices[3 * triangle + k]];
    lit.origins.push_back({triangle, weights});
    lit.irradiance.push_back(vec3(ramp(p)));
    lit.irradiance_back.push_back(vec3(10 * ramp(p)));
  };
  add(0, {0, 0});     // 0: corner (0, 0)
  add(0, {1, 0});     // 1: corner (1, 0)
  add(0, {0, 1});     // 2: corner (1, 1)
  add(1, {0, 1});     // 3: corner (0, 1)
  add(0, {0, 0.5f});  // 4: the middle
  lit.faces = {UVec3(0, 1, 4), UVec3(1, 2, 4), UVec3(0, 4, 3), UVec3(4, 2, 3)};
  lit.face_parents = {0, 0, 1, 1};
  fill_atlas(square.atlas, square.scene, square.lighting, {kSize, 2, {}});
  square.expect_ramp();
}

TEST(AtlasFill, PaddingIsTheChartsOwnLight) {
  MappedSquare square;
  fill_atlas(square.atlas, square.scene, square.lighting, {kSize, 2, {}});
  // Left of the front's left edge, halfway up.
  const FloatImage& image = square.atlas.pages[0].irradiance;
  const size_t edge = 10 * kSize + 2;
  // The next texel goes on as the light does, a quarter of a lux a texel, so that a filter on the edge is
  // right; the one after it is filled from that.
  EXPECT_NEAR(image.pixels[edge - 1].x, image.pixels[edge].x - 0.25f, 0.02);
  EXPECT_NEAR(image.pixels[edge - 2].x, image.pixels[edge - 1].x, 0.05);
}

TEST(AtlasFill, EdgesShowTheirOwnLight) {
  MappedSquare square;
  for (MappedMesh& mesh : square.atlas.meshes)
    for (vec2& at : mesh.coordinates) at += vec2(0.3f, 0.4f) / float(kSize);  // off the texels' own edges
  fill_atlas(square.atlas, square.scene, square.lighting, {kSize, 2, {}});
  const LightAtlasLookup lookup(square.scene, square.atlas);
  // Within a step of eight bits.
  const auto expect_light = [&](const vec2& weights, bool back, float light) {
    EXPECT_NEAR(lookup.irradiance(0, 0, 0, weights, back)->x, light, light / 255);
  };
  for (float share = 0.02f; share < 1; share += 0.02f) {
    expect_light({share, 0}, false, ramp(vec3(share, 0, 0)));
    expect_light({1 - share, share}, true, 10 * ramp(vec3(1, share, 0)));
  }
}

TEST(AtlasFill, WhatNobodySeesTakesWhatIsAround) {
  // The back is dark all over: where nobody sees it, it takes the front's light, which is all that there is.
  MappedSquare square;
  LitPrimitive& lit = square.lighting.primitives[0];
  lit.irradiance.assign(4, vec3(5));
  lit.irradiance_back.assign(4, vec3(0));  // all of the back
  std::atomic<size_t> asked = 0;
  fill_atlas(square.atlas, square.scene, square.lighting, {kSize, 2, [&](const MappedPlace& place) {
                                                             EXPECT_TRUE(place.mesh->back);
                                                             asked += 1;
                                                             return place.weights.x < 2;
                                                           }});
  EXPECT_GT(asked, 0u);
  const AtlasPage& page = square.atlas.pages[0];
  for (uint32_t y = 5; y < 15; ++y) EXPECT_NEAR(page.irradiance.pixels[y * kSize + 24].x, 5, 1e-3);
  fill_atlas(square.atlas, square.scene, square.lighting,
             {kSize, 2, [](const MappedPlace&) { return false; }});
  for (uint32_t y = 5; y < 15; ++y) EXPECT_EQ(square.atlas.pages[0].irradiance.pixels[y * kSize + 24].x, 0);
}

}  // namespace
}  // namespace goldthread
