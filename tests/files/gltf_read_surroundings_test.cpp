// EXT_lights_image_based: cube maps that light a scene.
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/png_encode.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string png(uint32_t size, std::vector<uint8_t> rgba) {
  std::vector<uint8_t> pixels;
  for (uint32_t i = 0; i < size * size; ++i) pixels.insert(pixels.end(), rgba.begin(), rgba.end());
  const std::vector<uint8_t> bytes = encode_png(size, size, uint32_t(rgba.size()), pixels);
  return {bytes.begin(), bytes.end()};
}

/// A triangle in surroundings that are black but for one white face.
GltfBuilder surrounded(size_t white, json light = json::object()) {
  GltfBuilder b;
  b.push("materials", json::object());
  b.triangle()["material"] = 0;
  json faces = json::array();
  for (size_t i = 0; i < 6; ++i) {
    const uint8_t grey = i == white ? 255 : 0;
    const int view = b.view(png(4, {grey, grey, grey}));
    faces.push_back(b.push("images", {{"bufferView", view}, {"mimeType", "image/png"}}));
  }
  light["specularImages"] = {faces};
  light["specularImageSize"] = 4;
  b.doc["extensionsUsed"] = {"EXT_lights_image_based"};
  b.doc["extensionsRequired"] = {"EXT_lights_image_based"};
  b.doc["extensions"]["EXT_lights_image_based"]["lights"] = {light};
  b.doc["scenes"] = {{{"nodes", {0}}, {"extensions", {{"EXT_lights_image_based", {{"light", 0}}}}}}};
  b.doc["scene"] = 0;
  return b;
}

Scene read_built(const GltfBuilder& builder) {
  TempFolder folder;
  Result<Scene> scene = read_scene(folder.write("scene.gltf", builder.text()));
  EXPECT_TRUE(scene) << scene.error().line();
  return scene ? *std::move(scene) : Scene{};
}

TEST(GltfSurroundings, APaintedFaceShinesFromItsSide) {
  const vec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (size_t white = 0; white < 6; ++white) {
    const Scene scene = read_built(surrounded(white, {{"intensity", 250}}));
    EXPECT_THAT(scene.warnings, IsEmpty());
    for (size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(scene.sky.radiance_towards(axes[i]).y, i == white ? 250 : 0, 1e-3f) << white << i;
  }
}

TEST(GltfSurroundings, RotationIsAQuaternion) {
  const double half = std::sqrt(0.5);
  const Scene scene = read_built(surrounded(5, {{"rotation", {0, half, 0, half}}}));  // -Z to -X
  EXPECT_NEAR(scene.sky.radiance_towards({-1, 0, 0}).x, 1, 1e-5f);
  EXPECT_EQ(scene.sky.radiance_towards({0, 0, -1}).x, 0);
}

TEST(GltfSurroundings, AlphaOfPngIsWhatColourIsDividedBy) {
  GltfBuilder b = surrounded(2);
  const int view = b.view(png(4, {255, 188, 0, 51}));
  b.doc["images"][2]["bufferView"] = view;
  const vec3 up = read_built(b).sky.radiance_towards({0, 1, 0});
  EXPECT_NEAR(up.x, 5, 1e-4f);
  EXPECT_NEAR(up.y, 5 * 0.5029f, 1e-3f);
  EXPECT_EQ(up.z, 0);
}

TEST(GltfSurroundings, WhatCannotBeReadIsNamedAndLeftOut) {
  const auto warning = [](const GltfBuilder& b) {
    const Scene scene = read_built(b);
    EXPECT_FALSE(scene.sky.present());
    return scene.warnings;
  };
  const auto says = [](const char* words) { return ElementsAre(HasSubstr(words)); };
  GltfBuilder b = surrounded(0);
  b.doc["extensions"]["EXT_lights_image_based"]["lights"][0]["specularImages"][0][3] = 17;
  EXPECT_THAT(warning(b), says("there is no image 17: give them as --environment"));
  b.doc["extensions"]["EXT_lights_image_based"]["lights"][0]["specularImages"] = json::array();
  EXPECT_THAT(warning(b), says("six specularImages"));
  b = surrounded(0);
  b.doc["images"][1]["bufferView"] = b.view(png(8, {1, 2, 3}));
  EXPECT_THAT(warning(b), says("squares of one size"));
  b.doc["images"][1]["bufferView"] = b.view("no picture");
  EXPECT_THAT(warning(b), says("image 1"));
  b = surrounded(0, {{"rotation", {0, 0, 0, 0}}});
  EXPECT_THAT(warning(b), says("rotation"));
  b = surrounded(0, {{"intensity", -1}});
  EXPECT_THAT(warning(b), says("scale"));
  b.doc["scenes"][0]["extensions"]["EXT_lights_image_based"]["light"] = 3;
  EXPECT_THAT(warning(b), says("there is no light 3"));
}

TEST(GltfSurroundings, OnlyThoseOfTheShownSceneCount) {
  GltfBuilder b = surrounded(0);
  b.push("scenes", {{"nodes", {0}}});
  b.doc["scene"] = 1;
  const Scene scene = read_built(b);
  EXPECT_FALSE(scene.sky.present());
  EXPECT_THAT(scene.warnings, IsEmpty());
}

}  // namespace
}  // namespace goldthread
