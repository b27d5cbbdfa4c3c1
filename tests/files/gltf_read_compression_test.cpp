// Files compressed here by the libraries' own encoders, and read back.
#include <gmock/gmock.h>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wextra"
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#pragma GCC diagnostic pop
#include <meshoptimizer.h>

#include "files/gltf_builder.h"
#include "files/gltf_load.h"
#include "files/scene_read.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kMeshopt = "EXT_meshopt_compression";

std::string encoded_vertices(const void* data, size_t count, size_t stride) {
  std::string out(meshopt_encodeVertexBufferBound(count, stride), '\0');
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), data, count,
                                        stride));
  return out;
}

/// Moves a view's place into buffer 1, the fallback without data, and its bytes into buffer 0 compressed.
int meshopt_view(GltfBuilder& b, const std::string& packed, size_t count, size_t stride, const char* mode,
                 const char* filter = "NONE") {
  const int index = b.view(packed);
  json& view = b.doc["bufferViews"][size_t(index)];
  json extension = {{"buffer", 0},
                    {"byteOffset", view["byteOffset"]},
                    {"byteLength", packed.size()},
                    {"byteStride", stride},
                    {"count", count},
                    {"mode", mode}};
  if (std::string(filter) != "NONE") extension["filter"] = filter;
  view = {{"buffer", 1},
          {"byteOffset", 0},
          {"byteLength", count * stride},
          {"extensions", {{kMeshopt, extension}}}};
  if (std::string(mode) == "ATTRIBUTES") view["byteStride"] = stride;
  return index;
}

/// A square of two triangles, all of it under meshopt.
GltfBuilder meshopt_square(bool index_sequence) {
  GltfBuilder b;
  const std::vector<float> corners = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::vector<uint32_t> indices = {0, 1, 2, 0, 2, 3};
  const int positions = meshopt_view(b, encoded_vertices(corners.data(), 4, 12), 4, 12, "ATTRIBUTES");
  std::string packed(1000, '\0');
  auto* out = reinterpret_cast<unsigned char*>(packed.data());
  packed.resize(index_sequence ? meshopt_encodeIndexSequence(out, packed.size(), indices.data(), 6)
                               : meshopt_encodeIndexBuffer(out, packed.size(), indices.data(), 6));
  const int faces = meshopt_view(b, packed, 6, 2, index_sequence ? "INDICES" : "TRIANGLES");
  b.push("accessors", {{"bufferView", positions}, {"componentType", kFloat}, {"count", 4}, {"type", "VEC3"}});
  b.push("accessors",
         {{"bufferView", faces}, {"componentType", kUnsignedShort}, {"count", 6}, {"type", "SCALAR"}});
  b.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", 1}});
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {kMeshopt};
  return b;
}

std::string finished(const GltfBuilder& b) {
  json doc = b.doc;
  doc["buffers"] = {
      {{"byteLength", b.bytes.size()}, {"uri", "data:application/octet-stream;base64," + base64(b.bytes)}},
      {{"byteLength", 4096}, {"extensions", {{kMeshopt, {{"fallback", true}}}}}}};
  return doc.dump();
}

Result<Scene> read_text(const std::string& text) {
  TempFolder folder;
  return read_scene(folder.write("scene.gltf", text));
}

/// Triangles as their corners' positions, each from its least corner: what is left when vertices are
/// renumbered.
std::vector<std::vector<std::array<float, 3>>> shape(const Primitive& primitive) {
  std::vector<std::vector<std::array<float, 3>>> triangles;
  for (size_t t = 0; t < primitive.triangle_count(); ++t) {
    std::vector<std::array<float, 3>> corners;
    for (size_t c = 0; c < 3; ++c) {
      const vec3 p = primitive.positions[primitive.indices[3 * t + c]];
      corners.push_back({p.x, p.y, p.z});
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    triangles.push_back(corners);
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

const std::vector<std::vector<std::array<float, 3>>> kSquare = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}},
                                                                {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}};

TEST(Meshopt, AttributesTrianglesAndIndices) {
  for (const bool sequence : {false, true}) {
    const Result<Scene> scene = read_text(finished(meshopt_square(sequence)));
    ASSERT_TRUE(scene) << scene.error().line();
    EXPECT_EQ(shape(scene->meshes[0].primitives[0]), kSquare);
    EXPECT_EQ(scene->meshes[0].primitives[0].positions[2], vec3(1, 1, 0));
  }
}

TEST(Meshopt, LoadedModelIsPlain) {
  TempFolder folder;
  const Result<tinygltf::Model> model =
      load_gltf_model(folder.write("s.gltf", finished(meshopt_square(false))));
  ASSERT_TRUE(model) << model.error().line();
  EXPECT_TRUE(model->extensionsRequired.empty());
  EXPECT_TRUE(model->extensionsUsed.empty());
  EXPECT_EQ(model->buffers.size(), 3u);
  EXPECT_TRUE(model->buffers[1].data.empty());
  for (const tinygltf::BufferView& view : model->bufferViews) {
    EXPECT_EQ(view.buffer, 2);
    EXPECT_TRUE(view.extensions.empty());
  }
}

TEST(Meshopt, FiltersAreUndone) {
  GltfBuilder b = meshopt_square(false);
  const float normals[4][4] = {{0, 0, 1, 0}, {1, 0, 0, 0}, {0, -1, 0, 0}, {0.6f, 0, 0.8f, 0}};
  std::vector<int8_t> octahedral(16);
  meshopt_encodeFilterOct(octahedral.data(), 4, 4, 8, normals[0]);
  const float texcoords[8] = {0, 0.5f, 1, 0.25f, 3, -2, 0.125f, 8};
  std::vector<uint32_t> exponential(8);
#if MESHOPTIMIZER_VERSION >= 190
  meshopt_encodeFilterExp(exponential.data(), 4, 8, 15, texcoords, meshopt_EncodeExpSharedVector);
#else
  meshopt_encodeFilterExp(exponential.data(), 4, 8, 15, texcoords);
#endif
  const int normal_view =
      meshopt_view(b, encoded_vertices(octahedral.data(), 4, 4), 4, 4, "ATTRIBUTES", "OCTAHEDRAL");
  const int uv_view =
      meshopt_view(b, encoded_vertices(exponential.data(), 4, 8), 4, 8, "ATTRIBUTES", "EXPONENTIAL");
  json& attributes = b.doc["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = b.push("accessors", {{"bufferView", normal_view},
                                              {"componentType", kByte},
                                              {"count", 4},
                                              {"normalized", true},
                                              {"type", "VEC3"}});
  attributes["TEXCOORD_0"] = b.push(
      "accessors", {{"bufferView", uv_view}, {"componentType", kFloat}, {"count", 4}, {"type", "VEC2"}});
  const Result<Scene> scene = read_text(finished(b));
  ASSERT_TRUE(scene) << scene.error().line();
  const Primitive& primitive = scene->meshes[0].primitives[0];
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_LT(length(primitive.normals[i] - vec3(normals[i][0], normals[i][1], normals[i][2])), 0.02f) << i;
    EXPECT_LT(length(primitive.texcoords[0][i] - vec2(texcoords[2 * i], texcoords[2 * i + 1])), 0.001f) << i;
  }
}

TEST(Meshopt, QuaternionsOfInstances) {
  GltfBuilder b = meshopt_square(false);
  const float half = std::sqrt(0.5f);
  const float turns[2][4] = {{0, 0, 0, 1}, {0, 0, half, half}};
  std::vector<int16_t> packed(8);
  meshopt_encodeFilterQuat(packed.data(), 2, 8, 16, turns[0]);
  const int view = meshopt_view(b, encoded_vertices(packed.data(), 2, 8), 2, 8, "ATTRIBUTES", "QUATERNION");
  const int rotation = b.push("accessors", {{"bufferView", view},
                                            {"componentType", kShort},
                                            {"count", 2},
                                            {"normalized", true},
                                            {"type", "VEC4"}});
  b.doc["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"ROTATION", rotation}}}}}};
  const Result<Scene> scene = read_text(finished(b));
  ASSERT_TRUE(scene) << scene.error().line();
  ASSERT_EQ(scene->instances.size(), 2u);
  EXPECT_LT(length(vec3(scene->instances[1].transform[0]) - vec3(0, 1, 0)), 1e-3f);
}

TEST(Meshopt, BrokenDataAndLies) {
  const auto spoiled = [](const char* member, const json& value) {
    GltfBuilder b = meshopt_square(false);
    b.doc["bufferViews"][0]["extensions"][kMeshopt][member] = value;
    const Result<Scene> scene = read_text(finished(b));
    EXPECT_FALSE(scene) << member;
    if (scene) return;
    EXPECT_EQ(scene.error().code, ErrorCode::kBadInput);
    EXPECT_EQ(scene.error().place, "bufferView 0") << member;
  };
  spoiled("count", 2000000000);
  spoiled("count", 300);
  spoiled("count", -1);
  spoiled("byteStride", 13);
  spoiled("byteStride", 0);
  spoiled("byteLength", 3);
  spoiled("byteLength", 1000000);
  spoiled("buffer", 7);
  spoiled("buffer", 1);
  spoiled("mode", "MAGIC");
  spoiled("filter", "OCTAHEDRAL");
}

/// The square as a Draco stream, with unique ids of its positions and normals.
std::string draco_square(int& position_id, int& normal_id) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  position_id = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  normal_id = builder.AddAttribute(draco::GeometryAttribute::NORMAL, 3, draco::DT_FLOAT32);
  const float p[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, n[3] = {0, 0, 1};
  builder.SetAttributeValuesForFace(position_id, draco::FaceIndex(0), p[0], p[1], p[2]);
  builder.SetAttributeValuesForFace(position_id, draco::FaceIndex(1), p[0], p[2], p[3]);
  for (uint32_t f = 0; f < 2; ++f) builder.SetAttributeValuesForFace(normal_id, draco::FaceIndex(f), n, n, n);
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  position_id = int(mesh->attribute(position_id)->unique_id());
  normal_id = int(mesh->attribute(normal_id)->unique_id());
  return std::string(buffer.data(), buffer.size());
}

GltfBuilder draco_file() {
  GltfBuilder b;
  int position_id = 0, normal_id = 0;
  const int view = b.view(draco_square(position_id, normal_id));
  b.push("accessors", {{"componentType", kFloat}, {"count", 4}, {"type", "VEC3"}});
  b.push("accessors", {{"componentType", kFloat}, {"count", 4}, {"type", "VEC3"}});
  b.push("accessors", {{"componentType", kUnsignedShort}, {"count", 6}, {"type", "SCALAR"}});
  b.mesh({{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}},
          {"indices", 2},
          {"extensions",
           {{"KHR_draco_mesh_compression",
             {{"bufferView", view}, {"attributes", {{"POSITION", position_id}, {"NORMAL", normal_id}}}}}}}});
  b.doc["extensionsUsed"] = b.doc["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  return b;
}

TEST(Draco, SquareComesBack) {
  const Result<Scene> scene = read_text(draco_file().text());
  ASSERT_TRUE(scene) << scene.error().line();
  const Primitive& primitive = scene->meshes[0].primitives[0];
  EXPECT_EQ(shape(primitive), kSquare);
  ASSERT_EQ(primitive.normals.size(), primitive.positions.size());
  EXPECT_EQ(primitive.normals[0], vec3(0, 0, 1));
}

TEST(Draco, PrimitivesMayShareAStream) {
  GltfBuilder b = draco_file();
  b.doc["meshes"][0]["primitives"].push_back(b.doc["meshes"][0]["primitives"][0]);
  const Result<Scene> scene = read_text(b.text());
  ASSERT_TRUE(scene) << scene.error().line();
  EXPECT_EQ(shape(scene->meshes[0].primitives[0]), kSquare);
  EXPECT_EQ(shape(scene->meshes[0].primitives[1]), kSquare);
}

TEST(Draco, BrokenStreams) {
  for (size_t at = 0; at < 60; ++at) {
    GltfBuilder b = draco_file();
    b.bytes[at] = char(~b.bytes[at]);
    const Result<Scene> scene = read_text(b.text());  // some bytes do no harm; none may crash
    if (!scene) {
      EXPECT_EQ(scene.error().code, ErrorCode::kBadInput);
    }
  }
  GltfBuilder b = draco_file();
  b.doc["bufferViews"][0]["byteLength"] = 20;
  const Result<Scene> cut = read_text(b.text());
  ASSERT_FALSE(cut);
  EXPECT_EQ(cut.error().place, "mesh 0 primitive 0");
  EXPECT_THAT(cut.error().message, HasSubstr("broken"));
}

TEST(Draco, AttributeThatTheStreamLacks) {
  GltfBuilder b = draco_file();
  b.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["NORMAL"] =
      77;
  const Result<Scene> scene = read_text(b.text());
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().place, "mesh 0 primitive 0 NORMAL");
}

}  // namespace
}  // namespace goldthread
