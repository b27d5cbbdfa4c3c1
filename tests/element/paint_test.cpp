// Reflectance, emission and coverage of elements, plain and textured.
#include <gtest/gtest.h>

#include "element/paint.h"
#include "element/small_elements.h"
#include "math/colour.h"

namespace goldthread {
namespace {

using test::Elements;

/// A square of side 2 with texture coordinates 0..1, n by n quads.
shapes::Soup plate(uint32_t n) {
  return test::parallelogram({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, n);
}

std::vector<vec2> plate_coordinates(const shapes::Soup& soup) {
  std::vector<vec2> uv;
  for (const vec3& p : soup.positions) uv.push_back(0.5f * vec2(p) + 0.5f);
  return uv;
}

Image checks(uint32_t size) {
  Image image;
  image.width = image.height = size;
  for (uint32_t y = 0; y < size; ++y)
    for (uint32_t x = 0; x < size; ++x) {
      const bool on = (x / 4 + y / 4) % 2 == 0;
      const uint8_t grey = on ? 255 : 60;
      image.rgba.insert(image.rgba.end(), {grey, uint8_t(grey / 2), 30, uint8_t(x < size / 2 ? 255 : 0)});
    }
  return image;
}

Scene textured(uint32_t n, const Material& material) {
  Scene scene;
  scene.images.push_back(checks(16));
  const shapes::Soup soup = plate(n);
  test::add(scene, soup, test::add(scene, material));
  scene.meshes[0].primitives[0].texcoords[0] = plate_coordinates(soup);
  return scene;
}

/// The mean over an element of what paint_at says, by dense sampling of its source triangle's polygon.
Paint dense_mean(const Elements& elements, ElementId id) {
  const ElementPool& pool = *elements.pool;
  const Part& part = elements.set->parts[pool[id].part];
  const TriangleMesh& mesh = elements.set->tree(part).mesh;
  constexpr int kRoot = 160;
  Paint mean{vec3(0), vec3(0), 0};
  for (int i = 0; i < kRoot; ++i)
    for (int j = 0; j < kRoot; ++j) {
      const vec3 p = pool.sample_at(id, (float(i) + 0.5f) / kRoot, (float(j) + 0.5f) / kRoot).position;
      // The plate lies in z = 0, so that the triangle is found by its barycentric weights.
      for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const UVec3& c = mesh.triangles[t];
        const vec3 a = part.positions[c.x], e1 = part.positions[c.y] - a, e2 = part.positions[c.z] - a;
        const float whole = e1.x * e2.y - e1.y * e2.x;
        const vec2 w(((p - a).x * e2.y - (p - a).y * e2.x) / whole,
                     (e1.x * (p - a).y - e1.y * (p - a).x) / whole);
        if (w.x < 0 || w.y < 0 || w.x + w.y > 1) continue;
        const Paint one = paint_at(*elements.set, part, t, w);
        const float share = 1.0f / (kRoot * kRoot);
        mean.reflectance += share * one.reflectance;
        mean.exitance += share * one.exitance;
        mean.coverage += share * one.coverage;
        break;
      }
    }
  return mean;
}

TEST(Paint, PlainMaterialsAreExact) {
  Scene scene;
  Material material = test::diffuse({0.2f, 0.5f, 0.99f}, {1, 2, 3});
  material.alpha_mode = AlphaMode::kBlend;
  material.alpha = 0.25f;
  test::add(scene, shapes::cube(2), test::add(scene, material));
  Elements elements(std::move(scene));
  elements.expand(7);
  for (const ElementId id : elements.leaves()) {
    const Element& e = (*elements.pool)[id];
    EXPECT_FLOAT_EQ(e.coverage, 0.25f);
    EXPECT_FLOAT_EQ(e.reflectance.x, 0.25f * 0.2f);
    EXPECT_FLOAT_EQ(e.reflectance.z, 0.25f * kMaxReflectance);  // clamped below 1
    EXPECT_NEAR(e.exitance.y, 0.25f * 2, 1e-6f);
  }
  EXPECT_EQ(elements.set->clamped_materials, 1u);
}

TEST(Paint, MetalReflectsNothingDiffusely) {
  Scene scene;
  Material material = test::diffuse(0.8f);
  material.metallic = 0.75f;
  test::add(scene, shapes::cube(), test::add(scene, material));
  const Elements elements(std::move(scene));
  EXPECT_FLOAT_EQ((*elements.pool)[elements.pool->root()].reflectance.x, 0.2f);
}

TEST(Paint, TexturesAreAveragedOverArea) {
  Material material = test::diffuse({0.9f, 0.8f, 0.7f}, {100, 50, 25});
  material.base_colour_texture.image = 0;
  material.emission_texture.image = 0;
  for (const uint32_t n : {1u, 4u}) {
    Elements elements(textured(n, material));
    const auto expect_mean = [&](ElementId id, float tolerance) {
      const Element& e = (*elements.pool)[id];
      const Paint exact = dense_mean(elements, id);
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(e.reflectance[k], exact.reflectance[k], tolerance * exact.reflectance[k])
            << n << " element " << id;
        EXPECT_NEAR(e.exitance[k], exact.exitance[k], tolerance * exact.exitance[k])
            << n << " element " << id;
      }
    };
    expect_mean(elements.pool->root(), 0.03f);
    elements.expand(3);
    for (const ElementId id : elements.leaves())
      expect_mean(id, 0.25f);  // a patch is a few texels, 16 points
  }
}

TEST(Paint, VertexColoursMultiply) {
  Scene scene;
  const shapes::Soup soup = plate(4);
  test::add(scene, soup, test::add(scene, test::diffuse(0.8f)));
  for (const vec3& p : soup.positions)
    scene.meshes[0].primitives[0].colours.push_back({0.5f * p.x + 0.5f, 0.5f, 1, 1});
  const Elements elements(std::move(scene));
  const Element& root = (*elements.pool)[elements.pool->root()];
  EXPECT_NEAR(root.reflectance.x, 0.4f, 0.01f);
  EXPECT_NEAR(root.reflectance.y, 0.4f, 1e-5f);
  EXPECT_NEAR(root.reflectance.z, 0.8f, 1e-5f);
}

TEST(Paint, ContrastIsTheTexturesOwn) {
  Material material = test::diffuse(0.8f);
  EXPECT_EQ(Elements(textured(4, material)).pool->texture_contrast(0), 0.0f);
  material.base_colour_texture.image = 0;
  Elements elements(textured(4, material));
  elements.expand(11);
  const ElementPool& pool = *elements.pool;
  // Checks of two values in equal parts: half their difference over their mean, whatever the reflectance.
  const float light = srgb_to_linear(1), dark = srgb_to_linear(60 / 255.0f);
  const float contrast = (light - dark) / (light + dark);
  EXPECT_NEAR(pool.texture_contrast(pool.root()), contrast, 0.2f * contrast);
  size_t within_a_check = 0;
  for (const ElementId id : elements.leaves())
    if (pool.texture_contrast(id) < 0.01f) ++within_a_check;
  EXPECT_GT(within_a_check, 10u);
}

TEST(Paint, MaskedHalfCoversHalf) {
  for (const AlphaMode mode : {AlphaMode::kMask, AlphaMode::kBlend, AlphaMode::kOpaque}) {
    Material material = test::diffuse(0.5f);
    material.base_colour_texture.image = 0;
    material.alpha_mode = mode;
    const Elements elements(textured(8, material));
    const Element& root = (*elements.pool)[elements.pool->root()];
    // A texel's width on either side of the cut and at the wrapping edge is blended.
    EXPECT_NEAR(root.coverage, mode == AlphaMode::kOpaque ? 1.0f : 0.5f, 0.03f) << int(mode);
  }
}

TEST(SurfaceSet, AreasPartsAndTrees) {
  Scene scene;
  const uint32_t material = test::add(scene, test::diffuse(0.5f));
  const uint32_t mesh = test::add(scene, shapes::cube(2), material);
  scene.instances.push_back({mesh, test::turn(1, {1, 1, 0}) * test::scale(vec3(-3)), 0, {}});
  scene.instances.push_back({mesh, test::scale({1, 2, 3}), 0, {}});
  const SurfaceSet set = build_surfaces(scene, CancelToken());
  ASSERT_EQ(set.parts.size(), 3u);
  EXPECT_EQ(set.triangles, 3 * 48u);
  EXPECT_NEAR(set.area, 6 + 54 + 22, 1e-3);
  EXPECT_EQ(set.parts[0].tree, set.parts[1].tree);  // similar copies share their clusters
  EXPECT_NE(set.parts[0].tree, set.parts[2].tree);
  EXPECT_EQ(set.parts[1].winding, -1);
  for (uint32_t t = 0; t < set.triangles; ++t) EXPECT_EQ(&part_of_triangle(set, t), &set.parts[t / 48]);
  const WorldTriangles world = world_triangles(set);
  ASSERT_EQ(world.triangles.size(), set.triangles);
  EXPECT_TRUE(world.see_through.empty());
  double area = 0;
  for (const UVec3& t : world.triangles)
    area += double(length(area_vector(world.positions[t.x], world.positions[t.y], world.positions[t.z])));
  EXPECT_NEAR(area, set.area, 1e-3);
}

TEST(SurfaceSet, UnlitBlocksButReceivesNothing) {
  Scene scene;
  Material unlit = test::diffuse(0.5f);
  unlit.unlit = true;
  test::add(scene, shapes::cube(), test::add(scene, unlit));
  Material both = test::diffuse(0.5f);
  both.double_sided = true;
  test::add(scene, shapes::cube(), test::add(scene, both), test::move({3, 0, 0}));
  const SurfaceSet set = build_surfaces(scene, CancelToken());
  EXPECT_EQ(set.triangles, 24u);
  ASSERT_EQ(set.surfaces.size(), 2u);  // the two sides of the second
  EXPECT_NE(set.surfaces[0].back, set.surfaces[1].back);
  EXPECT_EQ(world_triangles(set).triangles.size(), 24u);
}

TEST(SurfaceSet, BadTrianglesAreSkippedAndCounted) {
  Scene scene;
  shapes::Soup soup = shapes::cube();
  const auto n = uint32_t(soup.positions.size());
  soup.positions.push_back({std::nanf(""), 0, 0});
  soup.positions.push_back({INFINITY, 0, 0});
  soup.triangle(0, 1, n);
  soup.triangle(0, n + 1, 2);
  soup.triangle(0, 1, 1);
  const uint32_t material = test::add(scene, test::diffuse(0.5f));
  test::add(scene, soup, material);
  const SurfaceSet set = build_surfaces(scene, CancelToken());
  EXPECT_EQ(set.triangles, 12u);
  EXPECT_EQ(set.skipped.not_finite, 2u);
  EXPECT_EQ(set.skipped.degenerate, 1u);
}

}  // namespace
}  // namespace goldthread
