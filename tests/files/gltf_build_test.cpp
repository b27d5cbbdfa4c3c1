// Scenes from nothing as glTF, read back by the reader.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "files/gltf_builder.h"
#include "files/ies_read.h"
#include "files/scene_read.h"
#include "files/scene_write.h"
#include "files/written_gltf.h"
#include "scene/area_lamps.h"
#include "scene/small_profiles.h"
#include "scene/small_scenes.h"

namespace goldthread {
namespace {

using test::expect_valid;
using test::TempFolder;
using test::WrittenGltf;

Scene small_scene() {
  Scene scene;
  scene.images = {{2, 1, {255, 0, 0, 255, 0, 255, 0, 128}, "flag"}};
  Material painted, lamp;
  painted.name = "painted";
  painted.base_colour = vec3(0.7f, 0.2f, 0.1f);
  painted.metallic = 0;
  painted.double_sided = true;
  painted.alpha_mode = AlphaMode::kMask;
  painted.base_colour_texture = {0, 0, Wrap::kClamp, Wrap::kMirror, vec2(0.25f, 0), vec2(2, 1), 0.5f};
  lamp.base_colour = vec3(0);
  lamp.metallic = 0;
  lamp.emission = vec3(100, 50, 25);
  scene.materials = {painted, lamp};
  Primitive quad;
  quad.positions = {vec3(0), vec3(1, 0, 0), vec3(1, 1, 0), vec3(0, 1, 0)};
  quad.normals.assign(4, vec3(0, 0, 2));  // not unit
  quad.indices = {0, 1, 2, 0, 2, 3};
  Primitive triangle = quad;
  triangle.normals.clear();
  triangle.indices = {0, 1, 2};
  triangle.material = 1;
  triangle.colours.assign(4, vec4(1, 0.5f, 0, 1));
  scene.meshes = {{"both", {quad, triangle}}};
  Instance plain, sheared, mirrored;
  plain.name = "plain";
  sheared.transform[1] = vec4(0.5f, 1, 0, 0);
  sheared.transform[3] = vec4(3, 0, 0, 1);
  mirrored.transform = mat4(1);
  mirrored.transform[0] = vec4(0, 0, -2, 0);
  mirrored.transform[1] = vec4(0, 3, 0, 0);
  mirrored.transform[2] = vec4(-1, 0, 0, 0);
  scene.instances = {plain, sheared, mirrored};
  scene.lights = {
      {"bulb", LightKind::kPoint, vec3(10, 20, 40), vec3(1, 2, 3), vec3(0, 0, -1), 0, 0.7f, 9},
      {"torch", LightKind::kSpot, vec3(7), vec3(0), vec3(0, -1, 0), 0.2f, 0.4f, 0},
      {"sun", LightKind::kDirectional, vec3(1e5f), vec3(0), normalize(vec3(1, -1, 1)), 0, 0.7f, 0}};
  scene.cameras = {{"eye", vec3(0, 1, 5), vec3(0, 0, -1), vec3(0, 1, 0), 0.7f, 0, 1.5f},
                   {"plan", vec3(0, 9, 0), vec3(0, -1, 0), vec3(0, 0, -1), 0, 4, 1}};
  return scene;
}

Scene read(const std::string& file) {
  Result<Scene> scene = read_scene(file);
  if (!scene) throw std::runtime_error(scene.error().line());
  return *std::move(scene);
}

TEST(GltfBuild, ASceneComesBackAsItWas) {
  const TempFolder folder;
  const Scene before = small_scene();
  for (const char* name : {"a.glb", "a.gltf"}) {
    const std::string file = folder.path(name);
    const Status status = write_scene(file, before);
    ASSERT_TRUE(status) << status.error().line();
    expect_valid(file);
    const Scene after = read(file);
    ASSERT_EQ(after.instances.size(), 3u);
    for (size_t i = 0; i < 3; ++i)
      for (int c = 0; c < 4; ++c)
        EXPECT_LT(length(after.instances[i].transform[c] - before.instances[i].transform[c]), 1e-5f) << i;
    ASSERT_EQ(after.meshes.size(), 1u);
    ASSERT_EQ(after.meshes[0].primitives.size(), 2u);
    EXPECT_EQ(after.meshes[0].primitives[0].positions, before.meshes[0].primitives[0].positions);
    EXPECT_EQ(after.meshes[0].primitives[0].indices, before.meshes[0].primitives[0].indices);
    EXPECT_EQ(after.meshes[0].primitives[0].normals[0], vec3(0, 0, 1));
    EXPECT_EQ(after.meshes[0].primitives[1].colours, before.meshes[0].primitives[1].colours);
    EXPECT_EQ(after.images[0].rgba, before.images[0].rgba);
  }
}

TEST(GltfBuild, LightProfilesComeBack) {
  const TempFolder folder;
  Scene before = small_scene();
  for (const std::string& text : {test::lopsided_ies(), test::lopsided_type_b_ies()}) {
    Light light = test::lamp(LightKind::kPoint, 500, vec3(1, 2, 3));
    light.intensity = vec3(500, 250, 100);
    light.profile = share_profile(*parse_ies(text, "")).shares;
    aim(light, vec3(0.6f, -0.8f, 0), vec3(0, 0, 1));
    before.lights = {light, light};
    before.lights[1].intensity *= 2;
    ASSERT_TRUE(write_scene(folder.path("a.glb"), before));
    const Scene after = read(folder.path("a.glb"));
    ASSERT_EQ(after.lights.size(), 2u);
    EXPECT_EQ(after.lights[0].profile, after.lights[1].profile);
    EXPECT_LT(length(after.lights[0].intensity - light.intensity), 0.01f);
    EXPECT_LT(length(after.lights[1].intensity - 2.0f * light.intensity), 0.02f);
    EXPECT_LT(length(after.lights[0].direction - light.direction), 1e-5f);
    EXPECT_LT(length(after.lights[0].across - light.across), 1e-5f);
    for (const vec3& d : {vec3(0, 0, -1), vec3(0.6f, 0, -0.8f), vec3(-0.48f, 0.64f, -0.6f)})
      EXPECT_NEAR(after.lights[0].profile->intensity(d), light.profile->intensity(d), 1e-4f);
  }
}

TEST(GltfBuild, NormalTexturesComeBack) {
  const TempFolder folder;
  Scene before = small_scene();
  before.materials[0].normal_texture = before.materials[0].base_colour_texture;
  before.materials[0].normal_scale = 0.5f;
  ASSERT_TRUE(write_scene(folder.path("a.glb"), before));
  const Result<Scene> after = read_scene(folder.path("a.glb"), NormalTextures::kRead);
  ASSERT_TRUE(after) << after.error().line();
  EXPECT_EQ(after->materials[0].normal_texture.image, 0);
  EXPECT_EQ(after->materials[0].normal_texture.rotation, 0.5f);
  EXPECT_EQ(after->materials[0].normal_scale, 0.5f);
  EXPECT_FALSE(after->materials[1].normal_texture.present());
}

TEST(GltfBuild, AreaLampsComeBack) {
  const TempFolder folder;
  Scene before = small_scene();
  before.lights = {test::rectangle_lamp(300, {2, 0.5f}, vec3(1, 2, 3), vec3(0.6f, -0.8f, 0), vec3(0, 0, 1)),
                   test::disc_lamp(50, 0.4f, vec3(4, 5, 6), vec3(0, 1, 0))};
  before.lights[0].name = "panel";
  before.lights[0].intensity *= vec3(1, 0.5f, 0.25f);
  ASSERT_TRUE(write_scene(folder.path("a.glb"), before));
  const Scene after = read(folder.path("a.glb"));
  EXPECT_TRUE(after.warnings.empty());
  ASSERT_EQ(after.lights.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    const Light &a = after.lights[i], &b = before.lights[i];
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_EQ(a.name, b.name);
    EXPECT_LT(length(a.size - b.size), 1e-6f);
    EXPECT_LT(length(a.intensity - b.intensity), 1e-3f);
    EXPECT_LT(length(a.position - b.position), 1e-5f);
    EXPECT_LT(length(a.direction - b.direction), 1e-5f);
    EXPECT_LT(length(a.across - b.across), 1e-5f);
  }
}

TEST(GltfBuild, MaterialsLightsAndCamerasComeBack) {
  const TempFolder folder;
  const Scene before = small_scene();
  ASSERT_TRUE(write_scene(folder.path("a.glb"), before));
  const Scene after = read(folder.path("a.glb"));
  const Material& painted = after.materials[0];
  EXPECT_EQ(painted.base_colour, before.materials[0].base_colour);
  EXPECT_EQ(painted.metallic, 0);
  EXPECT_TRUE(painted.double_sided);
  EXPECT_EQ(painted.alpha_mode, AlphaMode::kMask);
  EXPECT_EQ(painted.base_colour_texture.wrap_v, Wrap::kMirror);
  EXPECT_EQ(painted.base_colour_texture.rotation, 0.5f);
  EXPECT_LT(length(after.materials[1].emission - vec3(100, 50, 25)), 1e-4f);
  ASSERT_EQ(after.lights.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(after.lights[i].kind, before.lights[i].kind);
    EXPECT_LT(length(after.lights[i].intensity - before.lights[i].intensity), 1e-2f);
    EXPECT_LT(length(after.lights[i].direction - before.lights[i].direction), 1e-5f);
    EXPECT_EQ(after.lights[i].position, before.lights[i].position);
  }
  EXPECT_EQ(after.lights[0].range, 9);
  EXPECT_EQ(after.lights[1].outer_cone, 0.4f);
  ASSERT_EQ(after.cameras.size(), 2u);
  EXPECT_EQ(after.cameras[0].vertical_fov, 0.7f);
  EXPECT_EQ(after.cameras[1].vertical_fov, 0);
  EXPECT_LT(length(after.cameras[1].forward - vec3(0, -1, 0)), 1e-5f);
  EXPECT_LT(length(after.cameras[1].up - vec3(0, 0, -1)), 1e-5f);
}

TEST(GltfBuild, BrokenNumbersMakeNoBrokenFile) {
  const TempFolder folder;
  Scene scene = small_scene();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Primitive& quad = scene.meshes[0].primitives[0];
  quad.positions[3].y = nan;
  quad.normals[1] = vec3(0);
  quad.normals[2].x = nan;
  scene.meshes[0].primitives[1].positions.assign(4, vec3(nan));
  scene.instances[2].transform[0].x = nan;
  scene.instances[1].transform[2] = vec4(0);
  scene.materials[0].name = "caf\xe9";
  ASSERT_TRUE(write_scene(folder.path("a.glb"), scene));
  expect_valid(folder.path("a.glb"));
  const WrittenGltf written(folder.path("a.glb"));
  EXPECT_EQ(written.json["meshes"][0]["primitives"].size(), 1u);
  EXPECT_EQ(written.values(written.primitive(0)["indices"]), (std::vector<float>{0, 1, 2}));
}

TEST(GltfBuild, NothingAtAllIsAFileToo) {
  const TempFolder folder;
  for (const char* name : {"a.glb", "a.gltf"}) {
    ASSERT_TRUE(write_scene(folder.path(name), Scene()));
    expect_valid(folder.path(name));
  }
}

TEST(GltfBuild, LightGoesIntoScenesFromNothing) {
  const TempFolder folder;
  const Scene scene = small_scene();
  Lighting lighting;
  LitPrimitive lit;
  lit.instance = 1;
  lit.irradiance.assign(4, vec3(3));
  lit.irradiance_back.assign(4, vec3(4));
  lighting.primitives = {lit};
  lit.instance = 2;
  lit.source_mesh = false;
  lit.origins = {{1, vec2(0)}, {1, vec2(1, 0)}, {1, vec2(0, 1)}, {1, vec2(0.5f)}};
  lit.faces = {UVec3(0, 1, 3), UVec3(0, 3, 2)};
  lit.face_parents = {1, 1};
  lighting.primitives.push_back(lit);
  for (const OutputMode mode : {OutputMode::kVertexLight, OutputMode::kUnlit}) {
    const std::string file = folder.path("a.glb");
    ASSERT_TRUE(write_lit_scene(file, scene, lighting, {mode, 0.1f}));
    expect_valid(file);
    const WrittenGltf written(file);
    EXPECT_EQ(written.json["meshes"].size(), 3u);
    EXPECT_EQ(written.attribute("POSITION", 2), (std::vector<float>{0, 0, 0, 1, 1, 0, 0, 1, 0, .5f, 1, 0}));
    EXPECT_EQ(written.attribute("TEXCOORD_0", 2).size(), 8u);
  }
}

}  // namespace
}  // namespace goldthread
