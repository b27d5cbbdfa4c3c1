#include "trace/preview.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

constexpr float kTolerance = 1e-4f;

/// A square of half side 1 in the plane z = 0 that faces +z, lit with `front` (and `back`) lux.
struct Square {
  Scene scene;
  Lighting lighting;

  Square() {
    Primitive primitive;
    primitive.positions = {vec3(-1, -1, 0), vec3(1, -1, 0), vec3(1, 1, 0), vec3(-1, 1, 0)};
    primitive.indices = {0, 1, 2, 0, 2, 3};
    scene.meshes = {{"square", {primitive}}};
    scene.instances.resize(1);
    Material material;
    material.base_colour = vec3(0.5f, 0.25f, 1);
    material.metallic = 0;
    scene.materials = {material};
    Camera camera;  // sees exactly the square
    camera.position = vec3(0, 0, 5);
    camera.vertical_fov = 0;
    camera.orthographic_height = 2;
    camera.aspect = 1;
    scene.cameras = {camera};
    LitPrimitive lit;
    lit.irradiance.assign(4, vec3(kPi));
    lighting.primitives = {lit};
  }
  Material& material() { return scene.materials[0]; }
  Primitive& primitive() { return scene.meshes[0].primitives[0]; }
  void look_from_behind() {
    scene.cameras[0].position.z = -5;
    scene.cameras[0].forward = vec3(0, 0, 1);
  }
  FloatImage render(int width = 4) const { return render_preview(scene, lighting, {width, 0, 1}); }
  vec3 middle() const { return render(1).pixels[0]; }
};

void expect_near(const vec3& a, const vec3& b) {
  EXPECT_LT(length(a - b), kTolerance) << a.x << " " << a.y << " " << a.z;
}

TEST(Preview, ShowsReflectedAndEmittedLight) {
  Square square;
  expect_near(square.middle(), vec3(0.5f, 0.25f, 1));
  square.material().metallic = 0.5f;
  expect_near(square.middle(), vec3(0.25f, 0.125f, 0.5f));
  square.material().emission = vec3(10, 0, 0);
  expect_near(square.middle(), vec3(10.25f, 0.125f, 0.5f));
  square.lighting.primitives.clear();
  expect_near(square.middle(), vec3(10, 0, 0));
  square.material().unlit = true;
  expect_near(square.middle(), vec3(0.5f, 0.25f, 1));
}

TEST(Preview, InterpolatesBetweenVertices) {
  Square square;
  square.lighting.primitives[0].irradiance = {vec3(0), vec3(kPi), vec3(kPi), vec3(0)};
  square.material().base_colour = vec3(1);
  const FloatImage image = square.render(4);
  for (uint32_t i = 0; i < 16; ++i)
    EXPECT_NEAR(image.pixels[i].x, (static_cast<float>(i % 4) + 0.5f) / 4, kTolerance) << i;
}

TEST(Preview, RowsRunFromTheTop) {
  Square square;
  square.lighting.primitives[0].irradiance = {vec3(0), vec3(0), vec3(kPi), vec3(kPi)};
  const FloatImage image = square.render(2);
  EXPECT_GT(image.pixels[0].x, image.pixels[2].x);
}

TEST(Preview, RefinedFacesAndTheirOwnLight) {
  Square square;
  LitPrimitive& lit = square.lighting.primitives[0];
  square.material().base_colour = vec3(1);
  square.primitive().colours = {vec4(0, 0, 0, 1), vec4(1), vec4(1), vec4(0, 0, 0, 1)};
  lit.source_mesh = false;
  lit.origins = {{0, vec2(0)}, {0, vec2(1, 0)}, {0, vec2(0, 1)}, {1, vec2(0, 1)}};
  lit.faces = {UVec3(0, 1, 2), UVec3(0, 2, 3)};
  lit.face_parents = {0, 1};
  lit.irradiance.assign(4, vec3(2 * kPi));
  const FloatImage image = square.render(4);
  for (uint32_t i = 0; i < 16; ++i)
    EXPECT_NEAR(image.pixels[i].x, 2 * (static_cast<float>(i % 4) + 0.5f) / 4, kTolerance) << i;
}

TEST(Preview, BackFacesOfSingleSidedMaterialsAreLookedThrough) {
  Square square;
  square.scene.sky.radiance = vec3(7, 8, 9);
  square.look_from_behind();
  expect_near(square.middle(), vec3(7, 8, 9));
  square.material().double_sided = true;
  square.lighting.primitives[0].irradiance_back.assign(4, vec3(2 * kPi));
  expect_near(square.middle(), vec3(1, 0.5f, 2));
  square.lighting.primitives[0].irradiance_back.clear();
  expect_near(square.middle(), vec3(0));
}

TEST(Preview, MirroredInstancesKeepTheirFront) {
  Square square;
  square.scene.instances[0].transform[0].x = -1;  // glTF: winding turns with the determinant
  square.scene.sky.radiance = vec3(7);
  expect_near(square.middle(), vec3(0.5f, 0.25f, 1));
}

TEST(Preview, AlphaLetsTheSkyThrough) {
  Square square;
  square.scene.sky.radiance = vec3(2);
  square.material().alpha = 0.25f;
  expect_near(square.middle(), vec3(0.5f, 0.25f, 1));  // opaque ignores alpha
  square.material().alpha_mode = AlphaMode::kBlend;
  expect_near(square.middle(), 0.25f * vec3(0.5f, 0.25f, 1) + 0.75f * vec3(2));
  square.material().alpha_mode = AlphaMode::kMask;
  expect_near(square.middle(), vec3(2));
  square.material().alpha_cutoff = 0.2f;
  expect_near(square.middle(), vec3(0.5f, 0.25f, 1));
}

TEST(Preview, TexturesColourAndPunchHoles) {
  Square square;
  square.scene.images = {{2, 1, {255, 0, 0, 255, 0, 255, 0, 0}, ""}};
  square.material().base_colour = vec3(1);
  square.material().base_colour_texture = {0, 0, Wrap::kClamp, Wrap::kClamp, vec2(0), vec2(1), 0};
  square.material().alpha_mode = AlphaMode::kMask;
  square.primitive().texcoords[0] = {vec2(0, 1), vec2(1, 1), vec2(1, 0), vec2(0, 0)};
  square.scene.sky.radiance = vec3(0, 0, 3);
  const FloatImage image = square.render(4);
  expect_near(image.pixels[0], vec3(1, 0, 0));
  expect_near(image.pixels[3], vec3(0, 0, 3));
}

TEST(Preview, HeightFollowsTheCameraOrSixteenToNine) {
  Square square;
  square.scene.cameras[0].aspect = 2;
  EXPECT_EQ(square.render(8).height, 4u);
  square.scene.cameras[0].aspect = 0;
  EXPECT_EQ(square.render(32).height, 18u);
  EXPECT_EQ(render_preview(square.scene, square.lighting, {5, 7, 4}).pixels.size(), 35u);
}

TEST(Preview, AnEmptySceneIsSky) {
  Scene scene;
  scene.sky.radiance = vec3(1, 2, 3);
  const FloatImage image = render_preview(scene, {}, {4, 3, 4});
  for (const vec3& pixel : image.pixels) expect_near(pixel, vec3(1, 2, 3));
}

/// A box of side 2 around the origin, wound to be seen from inside or outside; one primitive a side.
Scene box_scene(bool inward, bool lid) {
  Scene scene;
  Material material;
  material.metallic = 0;
  scene.materials = {material};
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (float side : {-1.0f, 1.0f}) {
      if (!lid && axis == 2 && side > 0) continue;
      vec3 u(0), v(0), n(0);
      n[axis] = side;
      u[(axis + 1) % 3] = 1;
      v[(axis + 2) % 3] = side;
      Primitive primitive;
      primitive.positions = {n - u - v, n + u - v, n + u + v, n - u + v};
      primitive.indices = {0, 1, 2, 0, 2, 3};
      if (inward) primitive.indices = {0, 2, 1, 0, 3, 2};
      mesh.primitives.push_back(primitive);
    }
  scene.meshes = {mesh};
  scene.instances.resize(1);
  return scene;
}

bool inside(const vec3& p) {
  return glm::all(glm::lessThan(glm::abs(p), vec3(1)));
}

TEST(FrameCamera, StandsInsideARoom) {
  const Scene room = box_scene(true, true);
  const Camera camera = frame_camera(room);
  EXPECT_TRUE(inside(camera.position));
  EXPECT_LT(dot(camera.forward, camera.position), 0);  // towards the far end
  EXPECT_NEAR(length(camera.forward), 1, 1e-5f);
}

TEST(FrameCamera, StandsOutsideAThingAndSeesAllOfIt) {
  const Scene cube = box_scene(false, true);
  const Camera camera = frame_camera(cube);
  EXPECT_FALSE(inside(camera.position));
  EXPECT_GT(camera.position.y, 0);
  EXPECT_GT(camera.position.z, 0);
  Scene seen = cube;
  seen.sky.radiance = vec3(1);
  const FloatImage image = render_preview(seen, {}, {64, 36, 1});
  size_t dark = 0;
  for (uint32_t y = 0; y < 36; ++y)
    for (uint32_t x = 0; x < 64; ++x) {
      const bool hit = image.pixels[y * 64 + x].x == 0;
      dark += hit;
      const bool edge = x == 0 || y == 0 || x == 63 || y == 35;
      EXPECT_FALSE(hit && edge);
    }
  EXPECT_GT(dark, 64u * 36 / 10);
}

TEST(FrameCamera, LooksIntoABoxWithoutLid) {
  const Camera camera = frame_camera(box_scene(true, false));
  EXPECT_LT(camera.forward.z, -0.5f);
}

TEST(FrameCamera, NothingToSeeIsNoTrouble) {
  const Camera camera = frame_camera(Scene());
  EXPECT_TRUE(is_finite(camera.position) && is_finite(camera.forward));
}

}  // namespace
}  // namespace goldthread
