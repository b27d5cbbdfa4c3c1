// Known answers: what the vertices and triangles of tiny files must be.
#include <gmock/gmock.h>

#include "files/gltf_builder.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Scene read_text(const std::string& text, const char* name = "scene.gltf") {
  TempFolder folder;
  Result<Scene> scene = read_scene(folder.write(name, text));
  EXPECT_TRUE(scene) << scene.error().line();
  return scene ? *std::move(scene) : Scene{};
}
Scene read_built(const GltfBuilder& builder) {
  return read_text(builder.text());
}

const Primitive& first(const Scene& scene) {
  return scene.meshes.at(0).primitives.at(0);
}

const std::vector<float> kFivePoints = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 2, 2, 0};

TEST(GltfRead, TriangleWithEverythingAbsent) {
  GltfBuilder b;
  b.triangle();
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.instances.size(), 1u);
  EXPECT_THAT(first(scene).indices, ElementsAre(0, 1, 2));
  EXPECT_EQ(first(scene).positions[1], vec3(1, 0, 0));
  EXPECT_THAT(first(scene).normals, IsEmpty());
  EXPECT_THAT(first(scene).colours, IsEmpty());
  EXPECT_EQ(scene.bounds().high, vec3(1, 1, 0));
  ASSERT_EQ(scene.materials.size(), 1u);  // made up, and said so
  EXPECT_EQ(scene.materials[0].base_colour, vec3(0.8f));
  EXPECT_EQ(scene.materials[0].metallic, 0);
  EXPECT_EQ(scene.warnings.size(), 1u);
}

TEST(GltfRead, GlbHoldsTheSame) {
  GltfBuilder b;
  b.triangle();
  const Scene scene = read_text(to_glb(b), "scene.glb");
  EXPECT_EQ(scene.triangle_count(), 1u);
  EXPECT_EQ(first(scene).positions[2], vec3(0, 1, 0));
}

TEST(GltfRead, GlbUnderAnotherName) {
  GltfBuilder b;
  b.triangle();
  EXPECT_EQ(read_text(to_glb(b), "scene.bin").triangle_count(), 1u);
  EXPECT_EQ(read_text(to_glb(b), "scene.gltf").triangle_count(), 1u);
}

TEST(GltfRead, StripsTurnEveryOtherTriangle) {
  GltfBuilder b;
  const int points = b.vec3s(kFivePoints);
  b.mesh({{"attributes", {{"POSITION", points}}}, {"mode", 5}});
  EXPECT_THAT(first(read_built(b)).indices, ElementsAre(0, 1, 2, 1, 3, 2, 2, 3, 4));
}

TEST(GltfRead, StripsKeepDegenerateTriangles) {
  GltfBuilder b;
  const int points = b.vec3s(kFivePoints);
  b.mesh({{"attributes", {{"POSITION", points}}}, {"mode", 5}, {"indices", b.indices({0, 1, 2, 2, 3, 4})}});
  EXPECT_THAT(first(read_built(b)).indices, ElementsAre(0, 1, 2, 1, 2, 2, 2, 2, 3, 2, 4, 3));
}

TEST(GltfRead, FansTurnAroundTheirFirstVertex) {
  GltfBuilder b;
  const int points = b.vec3s(kFivePoints);
  b.mesh({{"attributes", {{"POSITION", points}}}, {"mode", 6}, {"indices", b.indices({4, 0, 1, 3})}});
  EXPECT_THAT(first(read_built(b)).indices, ElementsAre(0, 1, 4, 1, 3, 4));
}

TEST(GltfRead, ListsWithoutIndicesDropWhatIsNoTriangle) {
  GltfBuilder b;
  b.mesh({{"attributes", {{"POSITION", b.vec3s(kFivePoints)}}}});
  const Scene scene = read_built(b);
  EXPECT_THAT(first(scene).indices, ElementsAre(0, 1, 2));
  EXPECT_EQ(scene.warnings.size(), 2u);
}

TEST(GltfRead, PointsAndLinesAreLeftOutAndNumbersStay) {
  GltfBuilder b;
  const int points = b.vec3s(kFivePoints);
  const json attributes = {{"POSITION", points}};
  b.push("meshes", {{"primitives",
                     {{{"attributes", attributes}, {"mode", 0}},
                      {{"attributes", attributes}, {"mode", 3}},
                      {{"attributes", attributes}, {"mode", 5}}}}});
  b.push("nodes", {{"mesh", 0}});
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.meshes[0].primitives.size(), 1u);
  EXPECT_EQ(first(scene).source_primitive, 2u);
}

TEST(GltfRead, IndicesOfAllThreeTypes) {
  GltfBuilder b;
  const int points = b.vec3s(kFivePoints);
  const int bytes = b.accessor<uint8_t>({0, 1, 2}, "SCALAR", kUnsignedByte);
  const int words = b.accessor<uint32_t>({2, 3, 4}, "SCALAR", kUnsignedInt);
  b.mesh({{"attributes", {{"POSITION", points}}}, {"indices", bytes}});
  b.mesh({{"attributes", {{"POSITION", points}}}, {"indices", words}});
  const Scene scene = read_built(b);
  EXPECT_THAT(scene.meshes[0].primitives[0].indices, ElementsAre(0, 1, 2));
  EXPECT_THAT(scene.meshes[1].primitives[0].indices, ElementsAre(2, 3, 4));
}

TEST(GltfRead, InterleavedVertices) {
  GltfBuilder b;
  const std::vector<float> both = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1};
  const int view = b.view(bytes_of(both), {{"byteStride", 24}});
  const auto part = [&](int offset) {
    return b.push("accessors", {{"bufferView", view},
                                {"byteOffset", offset},
                                {"componentType", kFloat},
                                {"count", 3},
                                {"type", "VEC3"}});
  };
  const int positions = part(0), normals = part(12);
  b.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}});
  const Primitive primitive = first(read_built(b));
  EXPECT_EQ(primitive.positions[1], vec3(1, 0, 0));
  EXPECT_THAT(primitive.normals, ElementsAre(vec3(0, 0, 1), vec3(0, 0, 1), vec3(0, 0, 1)));
}

TEST(GltfRead, SparseOverData) {
  GltfBuilder b;
  b.triangle();
  const int at = b.view(bytes_of<uint8_t>({1})), values = b.view(bytes_of<float>({5, 6, 7}));
  b.doc["accessors"][0]["sparse"] = {{"count", 1},
                                     {"indices", {{"bufferView", at}, {"componentType", kUnsignedByte}}},
                                     {"values", {{"bufferView", values}}}};
  EXPECT_THAT(first(read_built(b)).positions, ElementsAre(vec3(0), vec3(5, 6, 7), vec3(0, 1, 0)));
}

TEST(GltfRead, SparseOverNothingAndSparseIndices) {
  GltfBuilder b;
  b.triangle();
  const int at = b.view(bytes_of<uint16_t>({0, 2})), values = b.view(bytes_of<float>({1, 2, 3, 4, 5, 6}));
  json& positions = b.doc["accessors"][0];
  positions.erase("bufferView");
  positions["sparse"] = {{"count", 2},
                         {"indices", {{"bufferView", at}, {"componentType", kUnsignedShort}}},
                         {"values", {{"bufferView", values}}}};
  const int corners = b.view(bytes_of<uint16_t>({2, 1}));
  json& indices = b.doc["accessors"][1];
  indices.erase("bufferView");  // tinygltf by itself refuses such files
  indices["sparse"] = {{"count", 2},
                       {"indices", {{"bufferView", at}, {"componentType", kUnsignedShort}}},
                       {"values", {{"bufferView", corners}}}};
  const Primitive primitive = first(read_built(b));
  EXPECT_THAT(primitive.positions, ElementsAre(vec3(1, 2, 3), vec3(0), vec3(4, 5, 6)));
  EXPECT_THAT(primitive.indices, ElementsAre(2, 0, 1));
}

TEST(GltfRead, QuantizedPositionsAndNormals) {
  GltfBuilder b;
  b.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
  b.doc["extensionsUsed"] = {"KHR_mesh_quantization"};
  const int plain = b.accessor<int16_t>({0, 0, 0, 100, 0, 0, 0, -200, 0}, "VEC3", kShort);
  const int unit =
      b.accessor<int8_t>({127, 0, 0, 0, -127, 0, 0, 0, -128}, "VEC3", kByte, {{"normalized", true}});
  const int texcoords =
      b.accessor<uint16_t>({0, 0, 65535, 0, 0, 65535}, "VEC2", kUnsignedShort, {{"normalized", true}});
  b.mesh({{"attributes", {{"POSITION", plain}, {"NORMAL", unit}, {"TEXCOORD_0", texcoords}}}});
  const Primitive primitive = first(read_built(b));
  EXPECT_THAT(primitive.positions, ElementsAre(vec3(0), vec3(100, 0, 0), vec3(0, -200, 0)));
  EXPECT_THAT(primitive.normals, ElementsAre(vec3(1, 0, 0), vec3(0, -1, 0), vec3(0, 0, -1)));
  EXPECT_THAT(primitive.texcoords[0], ElementsAre(vec2(0), vec2(1, 0), vec2(0, 1)));
}

TEST(GltfRead, ColoursOfEveryKind) {
  GltfBuilder b;
  const int floats = b.accessor<float>({1, 0.5f, 0, 0, 0, 1, 0, 1, 0}, "VEC3", kFloat);
  const int bytes = b.accessor<uint8_t>({255, 0, 51, 255, 0, 0, 0, 0, 0, 0, 0, 102}, "VEC4", kUnsignedByte,
                                        {{"normalized", true}});
  const int shorts =
      b.accessor<uint16_t>({65535, 0, 0, 13107, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4", kUnsignedShort);
  for (const int colours : {floats, bytes, shorts}) b.triangle()["attributes"]["COLOR_0"] = colours;
  const Scene scene = read_built(b);
  EXPECT_EQ(scene.meshes[0].primitives[0].colours[0], vec4(1, 0.5f, 0, 1));
  EXPECT_EQ(scene.meshes[1].primitives[0].colours[0], vec4(1, 0, 0.2f, 1));
  EXPECT_EQ(scene.meshes[1].primitives[0].colours[2], vec4(0, 0, 0, 0.4f));
  EXPECT_EQ(scene.meshes[2].primitives[0].colours[0], vec4(1, 0, 0, 0.2f));
}

TEST(GltfRead, AttributesOfAnotherLengthAreLeftOut) {
  GltfBuilder b;
  b.triangle()["attributes"]["NORMAL"] = b.vec3s({0, 0, 1});
  const Scene scene = read_built(b);
  EXPECT_THAT(first(scene).normals, IsEmpty());
  EXPECT_THAT(scene.warnings[0], ::testing::HasSubstr("NORMAL has 1 elements for 3 vertices"));
}

TEST(GltfRead, MorphTargetsAtTheWeightsOfMeshOrNode) {
  GltfBuilder b;
  b.triangle()["targets"] = {{{"POSITION", b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1})}},
                             {{"POSITION", b.vec3s({4, 0, 0, 0, 0, 0, 0, 0, 0})}}};
  b.doc["meshes"][0]["weights"] = {0.5, 0.0};
  b.push("nodes", {{"mesh", 0}, {"weights", {0.0, 0.25}}});
  b.push("nodes", {{"mesh", 0}});
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].primitives[0].positions[0], vec3(0, 0, 0.5f));
  EXPECT_EQ(scene.meshes[1].primitives[0].positions[0], vec3(1, 0, 0));
  EXPECT_EQ(scene.instances[0].mesh, scene.instances[2].mesh);
}

TEST(GltfRead, SkinIgnoresItsNodeAndFollowsItsJoints) {
  GltfBuilder b;
  json& primitive = b.triangle({{"translation", {100, 0, 0}}, {"skin", 0}});
  primitive["attributes"]["NORMAL"] = b.vec3s({0, 0, 1, 0, 0, 1, 0, 0, 1});
  primitive["attributes"]["JOINTS_0"] =
      b.accessor<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0}, "VEC4", kUnsignedByte);
  primitive["attributes"]["WEIGHTS_0"] =
      b.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 0}, "VEC4", kFloat);
  b.push("nodes", {{"translation", {0, 0, 10}}});                                   // node 1
  b.push("nodes", {{"rotation", {0, 0.7071067811865476, 0, 0.7071067811865476}}});  // node 2: z to x, x to -z
  const std::vector<float> bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1,
                                   1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 2, 0, 0, 1};
  b.push("skins", {{"joints", {1, 2}}, {"inverseBindMatrices", b.accessor(bind, "MAT4", kFloat)}});
  const Scene scene = read_built(b);
  EXPECT_EQ(scene.instances[0].transform, mat4(1));
  const Primitive& skinned = first(scene);
  const auto near = [](const vec3& a, const vec3& e) { return length(a - e) < 1e-5f; };
  EXPECT_PRED2(near, skinned.positions[0], vec3(0, 0, 10));
  EXPECT_PRED2(near, skinned.positions[1], vec3(0, 0, -3));  // (1 + 2, 0, 0) turned
  // Weights 1 and 1 count as halves: the mean of (0, 1, 10) and (0, 1, -2).
  EXPECT_PRED2(near, skinned.positions[2], vec3(0, 1, 4));
  EXPECT_PRED2(near, skinned.normals[1], vec3(1, 0, 0));
}

TEST(GltfRead, SkinnedNodesGetMeshesOfTheirOwn) {
  GltfBuilder b;
  json& primitive = b.triangle({{"skin", 0}});
  primitive["attributes"]["JOINTS_0"] =
      b.accessor<uint8_t>(std::vector<uint8_t>(12, 0), "VEC4", kUnsignedByte);
  primitive["attributes"]["WEIGHTS_0"] = b.accessor<uint8_t>({255, 0, 0, 0, 255, 0, 0, 0, 255, 0, 0, 0},
                                                             "VEC4", kUnsignedByte, {{"normalized", true}});
  b.push("nodes", {{"mesh", 0}, {"translation", {0, 1, 0}}});
  const int bind = b.accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4", kFloat);
  b.push("skins", {{"joints", {1}}, {"inverseBindMatrices", bind}});
  const Scene scene = read_built(b);
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[0].primitives[0].positions[0], vec3(0, 1, 0));  // where its joint, node 1, is
  EXPECT_EQ(scene.meshes[1].primitives[0].positions[0], vec3(0));
  EXPECT_EQ(scene.instances[1].transform[3], vec4(0, 1, 0, 1));
}

TEST(GltfRead, NotANumberIsKept) {
  GltfBuilder b;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  b.mesh({{"attributes", {{"POSITION", b.vec3s({nan, 0, 0, 1, 0, 0, 0, 1, 0})}}}});
  const Scene scene = read_built(b);
  EXPECT_TRUE(std::isnan(first(scene).positions[0].x));
  EXPECT_EQ(scene.bounds().low, vec3(0));
}

TEST(GltfRead, ExternalBuffersWithSpacesInFolders) {
  GltfBuilder b;
  b.triangle();
  b.doc["buffers"] = {{{"byteLength", b.bytes.size()}, {"uri", "my%20data/a%2Bb%C3%A9.bin"}}};
  TempFolder folder;
  folder.write("my data/a+b\xC3\xA9.bin", b.bytes + "more than is stated");
  const Result<Scene> scene = read_scene(folder.write("a scene.gltf", b.doc.dump()));
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(scene->triangle_count(), 1u);
}

TEST(GltfRead, UnknownRequiredExtensionIsAWarningWhenGeometryCanBeRead) {
  GltfBuilder b;
  b.triangle();
  b.doc["extensionsRequired"] = {"ACME_magic"};
  EXPECT_THAT(read_built(b).warnings, ::testing::Contains(::testing::HasSubstr("ACME_magic")));
}

TEST(GltfRead, NothingInsideIsAnEmptyScene) {
  const Scene scene = read_text(R"({"asset": {"version": "2.0"}})");
  EXPECT_EQ(scene.triangle_count(), 0u);
  EXPECT_TRUE(scene.bounds().empty());
}

}  // namespace
}  // namespace goldthread
