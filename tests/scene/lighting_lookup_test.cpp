// Light at any point of a surface, from the light at its vertices.
#include "scene/lighting_lookup.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

/// Two triangles over the unit square, in one primitive of one instance.
Scene square() {
  Scene scene;
  Primitive primitive;
  primitive.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  primitive.indices = {0, 1, 2, 0, 2, 3};
  scene.materials.resize(1);
  scene.meshes.push_back({"square", {primitive}});
  scene.instances.push_back({});
  return scene;
}

/// A field that is linear in the square's coordinates.
vec3 field(float x, float y) {
  return vec3(1 + x, 2 * y, x - y + 3);
}

TEST(LightingLookup, BetweenTheVerticesOfTheSource) {
  const Scene scene = square();
  Lighting lighting;
  lighting.primitives.resize(1);
  lighting.primitives[0].irradiance = {field(0, 0), field(1, 0), field(1, 1), field(0, 1)};
  const LightingLookup lookup(scene, lighting);
  for (const vec2 w : {vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0.2f, 0.3f)}) {
    const std::optional<vec3> first = lookup.irradiance(0, 0, 0, w, false);
    ASSERT_TRUE(first);
    EXPECT_LT(glm::distance(*first, field(w.x + w.y, w.y)), 1e-5f);
    EXPECT_LT(glm::distance(*lookup.irradiance(0, 0, 1, w, false), field(w.x, w.x + w.y)), 1e-5f);
  }
}

TEST(LightingLookup, NothingWhereNothingIsLit) {
  const Scene scene = square();
  Lighting lighting;
  lighting.primitives.resize(1);
  lighting.primitives[0].irradiance.resize(4, vec3(1));
  const LightingLookup lookup(scene, lighting);
  EXPECT_FALSE(lookup.irradiance(0, 0, 0, vec2(0.2f), true));  // its back
  EXPECT_FALSE(lookup.irradiance(0, 1, 0, vec2(0.2f), false));
  EXPECT_FALSE(lookup.irradiance(1, 0, 0, vec2(0.2f), false));
}

TEST(LightingLookup, BackAndFrontApart) {
  const Scene scene = square();
  Lighting lighting;
  lighting.primitives.resize(1);
  lighting.primitives[0].irradiance.resize(4, vec3(1));
  lighting.primitives[0].irradiance_back.resize(4, vec3(2));
  const LightingLookup lookup(scene, lighting);
  EXPECT_EQ(lookup.irradiance(0, 0, 0, vec2(0.2f), true)->x, 2);
  EXPECT_EQ(lookup.irradiance(0, 0, 0, vec2(0.2f), false)->x, 1);
}

TEST(LightingLookup, WithinTheFacesOfARefinedMesh) {
  // The first triangle is cut at the middle of each side, the second at the middle of its longest, which the
  // first one names as its own.
  const Scene scene = square();
  Lighting lighting;
  lighting.primitives.resize(1);
  LitPrimitive& lit = lighting.primitives[0];
  lit.source_mesh = false;
  lit.origins = {{0, {0, 0}},    {0, {1, 0}},       {0, {0, 1}},   {1, {0, 1}},
                 {0, {0.5f, 0}}, {0, {0.5f, 0.5f}}, {0, {0, 0.5f}}};
  lit.faces = {{0, 4, 6}, {0, 6, 3}, {4, 1, 5}, {6, 2, 3}, {6, 5, 2}, {4, 5, 6}};
  lit.face_parents = {0, 1, 0, 1, 0, 0};
  const vec2 places[7] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0.5f, 0}, {1, 0.5f}, {0.5f, 0.5f}};
  for (const vec2& p : places) lit.irradiance.push_back(field(p.x, p.y));
  // Only the middle of the diagonal breaks the plane.
  lit.irradiance[6] += vec3(10);
  const LightingLookup lookup(scene, lighting);
  const auto at = [&](uint32_t t, float x, float y) {
    const vec2 weights = t == 0 ? vec2(x - y, y) : vec2(x, y - x);
    const std::optional<vec3> e = lookup.irradiance(0, 0, t, weights, false);
    EXPECT_TRUE(e);
    return e.value_or(vec3(-1));
  };
  EXPECT_LT(glm::distance(at(0, 0.5f, 0.5f), field(0.5f, 0.5f) + vec3(10)), 1e-4f);
  EXPECT_LT(glm::distance(at(1, 0.5f, 0.5f), field(0.5f, 0.5f) + vec3(10)), 1e-4f);
  EXPECT_LT(glm::distance(at(0, 0.25f, 0.25f), field(0.25f, 0.25f) + vec3(5)), 1e-4f);
  EXPECT_LT(glm::distance(at(0, 0.9f, 0.1f), field(0.9f, 0.1f)), 1e-4f);
  EXPECT_LT(glm::distance(at(1, 0.1f, 0.5f), field(0.1f, 0.5f) + vec3(2)), 1e-4f);
}

TEST(LightingLookup, TrianglesWithoutFacesAreDark) {
  const Scene scene = square();
  Lighting lighting;
  lighting.primitives.resize(1);
  LitPrimitive& lit = lighting.primitives[0];
  lit.source_mesh = false;
  lit.origins = {{0, {0, 0}}, {0, {1, 0}}, {0, {0, 1}}};
  lit.faces = {{0, 1, 2}};
  lit.face_parents = {0};
  lit.irradiance.resize(3, vec3(1));
  const LightingLookup lookup(scene, lighting);
  EXPECT_TRUE(lookup.irradiance(0, 0, 0, vec2(0.3f), false));
  EXPECT_FALSE(lookup.irradiance(0, 0, 1, vec2(0.3f), false));
}

}  // namespace
}  // namespace goldthread
