// Light into files that are compressed: what changes is written plainly, what does not stays compressed.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <memory>

#include "files/gltf_builder.h"
#include "files/light_samples.h"
#include "files/scene_read.h"
#include "files/scene_write.h"
#include "files/written_gltf.h"

namespace goldthread {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::TempFolder;
using test::WrittenGltf;

constexpr const char* kDraco = "KHR_draco_mesh_compression";
constexpr const char* kMeshopt = "EXT_meshopt_compression";
constexpr SceneWriteOptions kVertexLight{OutputMode::kVertexLight, 1};

std::string draco_triangle(int& position_id) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int attribute = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const float p[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(0), p[0], p[1], p[2]);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  position_id = static_cast<int>(mesh->attribute(attribute)->unique_id());
  return {buffer.data(), buffer.size()};
}

/// Two nodes, each with a Draco mesh of its own over the same stream.
GltfBuilder draco_file() {
  GltfBuilder b;
  int position_id = 0;
  const int view = b.view(draco_triangle(position_id));
  b.push("accessors", {{"componentType", test::kFloat},
                       {"count", 3},
                       {"type", "VEC3"},
                       {"min", {0, 0, 0}},
                       {"max", {1, 1, 0}}});
  b.push("accessors", {{"componentType", test::kUnsignedShort}, {"count", 3}, {"type", "SCALAR"}});
  const json compressed = {{"bufferView", view}, {"attributes", {{"POSITION", position_id}}}};
  for (int i = 0; i < 2; ++i)
    b.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", 1}, {"extensions", {{kDraco, compressed}}}});
  b.push("scenes", {{"nodes", {0, 1}}});
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {kDraco};
  return b;
}

TEST(GltfWriteCompressed, DracoPrimitivesThatChangeAreWrittenPlainly) {
  const TempFolder folder;
  const Result<Scene> scene = read_scene(folder.write("in.gltf", draco_file().text()));
  ASSERT_TRUE(scene) << scene.error().line();
  const std::string out = folder.path("out.glb");
  for (const Lighting& lighting : {test::light_all(*scene), test::light_refined(*scene)}) {
    const Status status = write_lit_scene(out, *scene, lighting, kVertexLight);
    ASSERT_TRUE(status) << status.error().line();
    const WrittenGltf written(out);
    EXPECT_FALSE(written.json.contains("extensionsUsed"));
    EXPECT_FALSE(written.json.contains("extensionsRequired"));
    EXPECT_FALSE(written.primitive(0).contains("extensions"));
    const Result<Scene> again = read_scene(out);
    ASSERT_TRUE(again) << again.error().line();
    const std::vector<vec3>& before = scene->meshes[0].primitives[0].positions;
    const std::vector<vec3>& after = again->meshes[0].primitives[0].positions;
    EXPECT_EQ(std::vector<vec3>(after.begin(), after.begin() + 3), before);
    test::expect_valid(out);
  }
}

TEST(GltfWriteCompressed, DracoStaysWhereNothingChanged) {
  const TempFolder folder;
  const Result<Scene> scene = read_scene(folder.write("in.gltf", draco_file().text()));
  ASSERT_TRUE(scene) << scene.error().line();
  Lighting lighting = test::light_all(*scene);
  lighting.primitives.resize(1);
  ASSERT_TRUE(write_lit_scene(folder.path("out.glb"), *scene, lighting, kVertexLight));
  const WrittenGltf written(folder.path("out.glb"));
  EXPECT_EQ(written.json["extensionsRequired"], json({kDraco}));
  EXPECT_FALSE(written.primitive(0).contains("extensions"));
  EXPECT_TRUE(written.primitive(1)["extensions"].contains(kDraco));
  EXPECT_EQ(read_scene(folder.path("out.glb"))->triangle_count(), 2u);
}

/// A triangle whose positions are under meshopt, with the fallback buffer first: numbers must follow their
/// buffers.
std::string meshopt_file() {
  GltfBuilder b;
  const float corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  std::string packed(meshopt_encodeVertexBufferBound(3, 12), '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                           corners, 3, 12));
  const size_t start = b.bytes.size();
  b.bytes += packed;
  b.push("bufferViews", {{"buffer", 0},
                         {"byteLength", 36},
                         {"byteStride", 12},
                         {"extensions",
                          {{kMeshopt,
                            {{"buffer", 1},
                             {"byteOffset", start},
                             {"byteLength", packed.size()},
                             {"byteStride", 12},
                             {"count", 3},
                             {"mode", "ATTRIBUTES"}}}}}});
  b.push("accessors", {{"bufferView", 0},
                       {"componentType", test::kFloat},
                       {"count", 3},
                       {"type", "VEC3"},
                       {"min", {0, 0, 0}},
                       {"max", {1, 1, 0}}});
  const int indices = b.indices({0, 1, 2});
  b.doc["bufferViews"][1]["buffer"] = 1;
  b.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", indices}});
  b.push("scenes", {{"nodes", {0}}});
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {kMeshopt};
  b.doc["buffers"] = {{{"byteLength", 36}, {"extensions", {{kMeshopt, {{"fallback", true}}}}}},
                      {{"byteLength", b.bytes.size()},
                       {"uri", "data:application/octet-stream;base64," + test::base64(b.bytes)}}};
  return b.text();
}

TEST(GltfWriteCompressed, MeshoptViewsStayReadable) {
  const TempFolder folder;
  const Result<Scene> scene = read_scene(folder.write("in.gltf", meshopt_file()));
  ASSERT_TRUE(scene) << scene.error().line();
  for (const char* name : {"out.glb", "out.gltf"}) {
    const Status status = write_lit_scene(folder.path(name), *scene, test::light_all(*scene), kVertexLight);
    ASSERT_TRUE(status) << status.error().line();
    const WrittenGltf written(folder.path(name));
    EXPECT_EQ(written.json["buffers"].size(), 2u);
    EXPECT_EQ(written.json["extensionsRequired"], json({kMeshopt}));
    EXPECT_EQ(written.attribute("POSITION"), (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
    EXPECT_EQ(written.values(written.primitive(0)["indices"]), (std::vector<float>{0, 1, 2}));
    EXPECT_EQ(written.attribute("_IRRADIANCE").size(), 9u);

    ASSERT_TRUE(write_lit_scene(folder.path(name), *scene, test::light_refined(*scene), kVertexLight));
    EXPECT_EQ(WrittenGltf(folder.path(name)).attribute("POSITION"),
              (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, .5f, .5f, 0}));
  }
}

}  // namespace
}  // namespace goldthread
