// One test for each way a file can be bad: a single Error that says where, never a crash or endless memory.
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::HasSubstr;

Error error_of(const std::string& bytes, const char* name = "bad.gltf") {
  TempFolder folder;
  const std::string file = folder.write(name, bytes);
  const Result<Scene> scene = read_scene(file);
  if (scene) {
    ADD_FAILURE() << "was read";
    return {};
  }
  EXPECT_EQ(scene.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(scene.error().file, file);
  EXPECT_FALSE(scene.error().cure.empty());
  return scene.error();
}

void expect_error(const GltfBuilder& builder, const std::string& place, const std::string& message) {
  const Error error = error_of(builder.text());
  EXPECT_EQ(error.place, place);
  EXPECT_THAT(error.message, HasSubstr(message));
}

/// A good file to be spoiled: accessor 0 positions, accessor 1 indices.
GltfBuilder good() {
  GltfBuilder b;
  b.triangle();
  return b;
}

TEST(BadInput, NoSuchFile) {
  const Result<Scene> scene = read_scene("/nowhere/scene.glb");
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(scene.error().line(), HasSubstr("/nowhere/scene.glb: cannot open"));
}

TEST(BadInput, AFolder) {
  TempFolder folder;
  folder.write("scene.glb/inside", "");
  const Result<Scene> scene = read_scene(folder.path("scene.glb"));
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("cannot open"));
}

TEST(BadInput, UnsupportedExtensionNamesTheSupportedOnes) {
  EXPECT_THAT(error_of("hello", "scene.blend").line(), HasSubstr(".gltf, .glb, .obj"));
}

TEST(BadInput, EmptyFile) {
  EXPECT_THAT(error_of("").message, HasSubstr("empty"));
}

TEST(BadInput, NotGltf) {
  EXPECT_THAT(error_of("this is prose").message, HasSubstr("not a glTF file"));
  EXPECT_THAT(error_of("[1, 2]").message, HasSubstr("not a glTF file"));
  EXPECT_THAT(error_of("{}").message, HasSubstr("not a glTF file"));
  EXPECT_THAT(error_of(std::string(64, '\0'), "bad.glb").message, HasSubstr("not a glTF file"));
}

TEST(BadInput, OldVersions) {
  EXPECT_EQ(error_of(R"({"asset": {"version": "1.0"}})").place, "asset");
  std::string glb = to_glb(good());
  glb[4] = 1;
  EXPECT_EQ(error_of(glb, "bad.glb").place, "GLB header");
}

TEST(BadInput, TruncatedAnywhere) {
  const std::string glb = to_glb(good()), text = good().text();
  for (size_t size = 1; size < glb.size(); size += 7) error_of(glb.substr(0, size), "bad.glb");
  for (size_t size = 1; size < text.size(); size += 7) error_of(text.substr(0, size));
}

TEST(BadInput, ChunkLongerThanTheFile) {
  std::string glb = to_glb(good());
  glb[12 + 3] = 0x7f;
  EXPECT_EQ(error_of(glb, "bad.glb").place, "GLB chunk");
}

TEST(BadInput, DeepJson) {
  const std::string deep = std::string(100000, '[') + std::string(100000, ']');
  EXPECT_THAT(error_of(R"({"asset": {"version": "2.0"}, "extras": )" + deep + "}").message,
              HasSubstr("nested"));
}

TEST(BadInput, SectionsOfTheWrongKind) {
  GltfBuilder b = good();
  b.doc["nodes"] = {7};
  expect_error(b, "node 0", "not an object");
  b.doc["nodes"] = "all of them";
  expect_error(b, "nodes", "not an array");
}

TEST(BadInput, MissingBufferFile) {
  GltfBuilder b = good();
  b.doc["buffers"] = {{{"byteLength", 42}, {"uri", "gone.bin"}}};
  expect_error(b, "buffer 0", "gone.bin");
}

TEST(BadInput, BufferWithoutAnything) {
  GltfBuilder b = good();
  b.doc["buffers"] = {{{"byteLength", 42}}};
  expect_error(b, "buffer 0", "no uri");
}

TEST(BadInput, BufferShorterThanStated) {
  GltfBuilder b = good();
  b.doc["buffers"] = {{{"byteLength", 1000000000000}, {"uri", "data:;base64,AAAA"}}};
  expect_error(b, "buffer 0", "3 of its 1000000000000 bytes");
}

TEST(BadInput, BrokenDataUri) {
  GltfBuilder b = good();
  b.doc["buffers"] = {{{"byteLength", 4}, {"uri", "data:;base64,$$$$"}}};
  expect_error(b, "buffer 0", "base64");
}

TEST(BadInput, BufferViewBeyondItsBuffer) {
  GltfBuilder b = good();
  b.doc["bufferViews"][1]["byteOffset"] = 18446744073709551615u;
  expect_error(b, "bufferView 1", "beyond");
  b = good();
  b.doc["bufferViews"][1]["buffer"] = 3;
  expect_error(b, "bufferView 1", "no buffer 3");
}

TEST(BadInput, HugeCountsAreRefusedBeforeMemoryIsTaken) {
  for (const uint64_t count : {uint64_t(4), uint64_t(4000000000), uint64_t(18446744073709551615u)}) {
    GltfBuilder b = good();
    b.doc["accessors"][0]["count"] = count;
    expect_error(b, "accessor 0", "beyond");
  }
}

TEST(BadInput, HugeCountWithoutAnyData) {
  GltfBuilder b = good();
  b.doc["accessors"][0].erase("bufferView");
  b.doc["accessors"][0]["count"] = 4000000000;
  expect_error(b, "accessor 0", "fills the memory");
}

TEST(BadInput, SmallDataRepeatedWithoutEnd) {
  GltfBuilder b = good();
  b.doc["accessors"][0].erase("bufferView");
  b.doc["accessors"][0]["count"] = 10000000;
  const json primitive = b.doc["meshes"][0]["primitives"][0];
  for (int i = 0; i < 100; ++i) b.doc["meshes"][0]["primitives"].push_back(primitive);
  EXPECT_THAT(error_of(b.text()).message, HasSubstr("fills the memory"));
}

TEST(BadInput, StrideBeyondTheBuffer) {
  GltfBuilder b = good();
  b.doc["bufferViews"][0]["byteStride"] = 252;
  expect_error(b, "accessor 0", "252 apart");
}

TEST(BadInput, NegativeNumbers) {
  GltfBuilder b = good();
  b.doc["accessors"][0]["count"] = -3;
  expect_error(b, "accessor 0", "count");
  b = good();
  b.doc["bufferViews"][0]["byteLength"] = -1;
  expect_error(b, "bufferView 0", "byteLength");
}

TEST(BadInput, VertexIndexBeyondTheVertices) {
  GltfBuilder b = good();
  b.doc["meshes"][0]["primitives"][0]["indices"] = b.indices({0, 1, 65535});
  expect_error(b, "mesh 0 primitive 0", "65535");
}

TEST(BadInput, SparseIndexBeyondTheAccessor) {
  GltfBuilder b = good();
  const int at = b.view(bytes_of<uint8_t>({3})), values = b.view(bytes_of<float>({5, 6, 7}));
  b.doc["accessors"][0]["sparse"] = {{"count", 1},
                                     {"indices", {{"bufferView", at}, {"componentType", kUnsignedByte}}},
                                     {"values", {{"bufferView", values}}}};
  expect_error(b, "accessor 0", "sparse index 3");
  b.doc["accessors"][0]["sparse"]["count"] = 2000000000;
  expect_error(b, "accessor 0 sparse indices", "beyond");
}

TEST(BadInput, NumbersOfThingsThatDoNotExist) {
  const auto spoiled = [](const std::string& path, const json& value) {
    GltfBuilder b = good();
    b.doc[json::json_pointer(path)] = value;
    return b;
  };
  expect_error(spoiled("/meshes/0/primitives/0/attributes/POSITION", 99), "accessor 99", "no such");
  expect_error(spoiled("/meshes/0/primitives/0/indices", 99), "accessor 99", "no such");
  expect_error(spoiled("/accessors/0/bufferView", 99), "accessor 0", "no bufferView 99");
  expect_error(spoiled("/nodes/0/mesh", 99), "node 0", "no mesh 99");
  expect_error(spoiled("/nodes/0/skin", 99), "node 0", "no skin 99");
  expect_error(spoiled("/nodes/0/camera", 99), "node 0", "no camera 99");
  expect_error(spoiled("/nodes/0/children", {99}), "node 0", "no node 99");
  expect_error(spoiled("/nodes/0/extensions/KHR_lights_punctual/light", 99), "node 0", "no light 99");
  expect_error(spoiled("/scenes", {{{"nodes", {99}}}}), "scene 0", "no node 99");
  expect_error(spoiled("/scene", 5), "scene 5", "no such scene");
  expect_error(spoiled("/meshes/0/primitives/0/material", 99), "mesh 0 primitive 0", "no material 99");
  expect_error(spoiled("/meshes/0/primitives/0/mode", 9), "mesh 0 primitive 0", "mode 9");
}

TEST(BadInput, TexturesAndPicturesThatDoNotExist) {
  GltfBuilder b = good();
  b.push("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 4}}}}}});
  expect_error(b, "material 0", "no texture 4");
  for (int i = 0; i < 5; ++i) b.push("textures", {{"source", 6}});
  expect_error(b, "texture 4", "no image 6");
  b.doc["textures"][4]["sampler"] = 2;
  expect_error(b, "texture 4", "no sampler 2");
}

TEST(BadInput, WrongAccessorTypes) {
  GltfBuilder b = good();
  b.doc["accessors"][0]["type"] = "VEC2";
  expect_error(b, "accessor 0", "2 components where 3 are needed");
  b = good();
  b.doc["accessors"][1]["componentType"] = kFloat;
  b.doc["accessors"][1]["count"] = 1;
  expect_error(b, "accessor 1", "no unsigned integer");
  b = good();
  b.doc["accessors"][0]["componentType"] = kUnsignedInt;
  expect_error(b, "accessor 0", "cannot hold positions");
  b = good();
  b.doc["accessors"][0]["componentType"] = 5127;
  expect_error(b, "accessor 0", "component type 5127");
}

TEST(BadInput, NodesInACircle) {
  GltfBuilder b = good();
  b.push("nodes", {{"children", {2}}});
  b.push("nodes", {{"children", {1}}});
  expect_error(b, "node 1", "its own ancestor");
  b.doc["nodes"][0]["children"] = {0};
  expect_error(b, "node 0", "its own ancestor");
}

TEST(BadInput, NodeWithTwoParents) {
  GltfBuilder b = good();
  b.push("nodes", {{"children", {0}}});
  b.push("nodes", {{"children", {0}}});
  expect_error(b, "node 0", "child of node 1 and again of node 2");
}

TEST(BadInput, TransformOfTheWrongLength) {
  GltfBuilder b = good();
  b.doc["nodes"][0]["matrix"] = {1, 0, 0};
  expect_error(b, "node 0", "transform");
}

TEST(BadInput, PrimitiveWithoutAttributes) {
  GltfBuilder b = good();
  b.doc["meshes"][0]["primitives"][0].erase("attributes");
  expect_error(b, "mesh 0 primitive 0", "no attributes");
}

TEST(BadInput, JointThatTheSkinLacks) {
  GltfBuilder b;
  json& primitive = b.triangle({{"skin", 0}});
  primitive["attributes"]["JOINTS_0"] =
      b.accessor<uint8_t>(std::vector<uint8_t>(12, 7), "VEC4", kUnsignedByte);
  primitive["attributes"]["WEIGHTS_0"] = b.accessor<float>(std::vector<float>(12, 0.25f), "VEC4", kFloat);
  const int bind = b.accessor<float>(std::vector<float>(16, 1), "MAT4", kFloat);
  b.push("skins", {{"joints", {0}}, {"inverseBindMatrices", bind}});
  expect_error(b, "mesh 0 primitive 0", "names a joint that its skin lacks");
  b.doc["skins"][0]["joints"] = {0, 0};
  expect_error(b, "skin 0", "1 inverse bind matrices for 2 joints");
  b.doc["skins"][0]["joints"] = {44};
  expect_error(b, "skin 0", "no node 44");
}

TEST(BadInput, DataOnlyInAnUnknownExtension) {
  GltfBuilder b = good();
  b.doc["extensionsRequired"] = {"ACME_mesh_compression"};
  b.doc["accessors"][0].erase("bufferView");
  expect_error(b, "accessor 0", "ACME_mesh_compression");
}

TEST(BadInput, WhatTinygltfItselfRefuses) {
  GltfBuilder b = good();
  b.push("cameras", {{"type", "fisheye"}});
  EXPECT_THAT(error_of(b.text()).message, HasSubstr("tinygltf"));
}

}  // namespace
}  // namespace goldthread
