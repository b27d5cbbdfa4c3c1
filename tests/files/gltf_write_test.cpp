// Light into glTF files: what is added, and above all what is not touched.
#include <gtest/gtest.h>

#include <filesystem>

#include "files/gltf_builder.h"
#include "files/light_samples.h"
#include "files/png_encode.h"
#include "files/scene_read.h"
#include "files/scene_write.h"
#include "files/written_gltf.h"
#include "scene/small_profiles.h"

namespace goldthread {
namespace {

using nlohmann::json;
using test::expect_kept;
using test::expect_valid;
using test::GltfBuilder;
using test::light_all;
using test::light_refined;
using test::TempFolder;
using test::WrittenGltf;

constexpr SceneWriteOptions kVertexLight{OutputMode::kVertexLight, 1};

Scene read(const std::string& file) {
  Result<Scene> scene = read_scene(file);
  if (!scene) throw std::runtime_error(scene.error().line());
  return *std::move(scene);
}

/// A lamp by a photometric file that lies beside.
GltfBuilder profiled_file() {
  GltfBuilder b;
  b.triangle();
  b.doc["accessors"][0]["min"] = {0, 0, 0};
  b.doc["accessors"][0]["max"] = {1, 1, 0};
  b.doc["extensionsUsed"] = {"EXT_lights_ies"};
  b.doc["extensions"]["EXT_lights_ies"]["lights"] = {{{"uri", "lamp.ies"}, {"extras", {{"id", 7}}}}};
  b.push("nodes", {{"extensions", {{"EXT_lights_ies", {{"light", 0}, {"multiplier", 2.5}}}}}});
  return b;
}

/// A file with everything in it that a careless writer loses.
GltfBuilder rich_file() {
  GltfBuilder b;
  b.doc["asset"]["generator"] = "somebody else's";
  b.doc["asset"]["extras"] = {{"licence", "CC0"}, {"deep", {{"list", {1, 2.5, nullptr, "\u00e9"}}}}};
  b.doc["extensionsUsed"] = {"VENDOR_thing", "KHR_lights_punctual", "KHR_texture_transform",
                             "KHR_materials_ior"};
  b.doc["extensions"]["VENDOR_thing"] = {{"big", 18446744073709551615u}, {"precise", 0.1234567890123456}};
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"intensity", 40.0}, {"color", {1.0, 0.5, 0.25}}, {"extras", {{"id", 7}}}}};
  b.doc["extras"] = {{"top", true}};
  json& primitive = b.triangle({{"name", "first"}, {"extras", {{"tag", "n"}}}});
  primitive["attributes"]["TEXCOORD_0"] = b.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", test::kFloat);
  primitive["attributes"]["_CUSTOM"] = b.accessor<float>({1, 2, 3}, "SCALAR", test::kFloat);
  primitive["material"] = 0;
  primitive["extensions"]["VENDOR_thing"] = {{"on", "a primitive"}};
  b.doc["accessors"][0]["min"] = {0, 0, 0};
  b.doc["accessors"][0]["max"] = {1, 1, 0};
  b.push("images", {{"uri", "tex%20ture.png"}, {"name", "outside"}, {"extras", 1}});
  b.push("samplers", {{"magFilter", 9728}, {"minFilter", 9987}, {"wrapS", 33648}, {"extras", {{"s", 1}}}});
  b.push("textures", {{"source", 0}, {"sampler", 0}, {"extensions", {{"VENDOR_thing", json::object()}}}});
  b.push("materials",
         {{"name", "m"},
          {"doubleSided", true},
          {"pbrMetallicRoughness",
           {{"metallicFactor", 0.0},
            {"baseColorTexture",
             {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"scale", {2.0, 2.0}}}}}}}}}},
          {"extensions", {{"KHR_materials_ior", {{"ior", 1.33}}}, {"VENDOR_thing", {{"x", {1, 2}}}}}}});
  const int times = b.accessor<float>({0, 1}, "SCALAR", test::kFloat, {{"min", {0}}, {"max", {1}}});
  const int moves = b.accessor<float>({0, 0, 0, 1, 1, 1}, "VEC3", test::kFloat);
  b.push("animations", {{"name", "slide"},
                        {"samplers", {{{"input", times}, {"output", moves}, {"interpolation", "STEP"}}}},
                        {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
                        {"extras", {{"loop", true}}}});
  b.push("cameras",
         {{"type", "perspective"}, {"perspective", {{"yfov", 0.7}, {"znear", 0.1}}}, {"extras", "c"}});
  b.push("nodes", {{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  b.push("scenes", {{"nodes", {0, 1}}, {"name", "s"}});
  b.doc["scene"] = 0;
  return b;
}

std::string tiny_png() {
  const std::vector<uint8_t> bytes = encode_png(1, 1, 3, std::vector<uint8_t>{255, 255, 255});
  return {bytes.begin(), bytes.end()};
}

TEST(GltfWrite, EverythingElseSurvivesInGlb) {
  const TempFolder folder;
  const GltfBuilder source = rich_file();
  folder.write("tex ture.png", tiny_png());
  const std::string in = folder.write("in.gltf", source.text()), out = folder.path("out.glb");
  const Scene scene = read(in);
  const Status status = write_lit_scene(out, scene, light_all(scene), kVertexLight);
  ASSERT_TRUE(status) << status.error().line();
  const WrittenGltf written(out);
  json expected = json::parse(source.text());
  expected.erase("buffers");  // one buffer, but not the same one

  expected["images"][0].erase("uri");  // the picture itself is inside now
  expect_kept(expected, written.json);
  EXPECT_EQ(written.json["extensions"]["KHR_lights_punctual"]["lights"].size(), 1u);
  EXPECT_EQ(written.json["nodes"].size(), source.doc["nodes"].size());
  EXPECT_EQ(written.json["materials"].size(), 1u);
  EXPECT_EQ(written.json["images"][0]["mimeType"], "image/png");
  const auto& picture = written.model.images[0].image;
  EXPECT_EQ(std::string(picture.begin(), picture.end()), tiny_png());
  EXPECT_EQ(written.attribute("_IRRADIANCE"), (std::vector<float>{1, 0, .5f, 1, 1, .5f, 1, 2, .5f}));
  EXPECT_EQ(written.attribute("_IRRADIANCE_BACK"), written.attribute("_IRRADIANCE"));
  EXPECT_EQ(written.attribute("_CUSTOM"), (std::vector<float>{1, 2, 3}));
  expect_valid(out);
}

TEST(GltfWrite, LightProfilesAreKeptAndGoWithTheFile) {
  const TempFolder folder;
  folder.write("lamp.ies", test::lopsided_ies());
  const GltfBuilder source = profiled_file();
  const Scene scene = read(folder.write("in.gltf", source.text()));
  std::filesystem::create_directories(folder.path("far"));
  for (const std::string name : {"beside.gltf", "far/out.gltf", "out.glb"}) {
    const std::string out = folder.path(name);
    ASSERT_TRUE(write_lit_scene(out, scene, light_all(scene), kVertexLight));
    const WrittenGltf written(out);
    EXPECT_EQ(written.json["nodes"][1], source.doc["nodes"][1]);
    const json& profile = written.json["extensions"]["EXT_lights_ies"]["lights"][0];
    EXPECT_EQ(profile["extras"]["id"], 7);
    EXPECT_EQ(profile.contains("uri"), name == "beside.gltf");
    const Scene again = read(out);
    ASSERT_EQ(again.lights.size(), 1u);
    EXPECT_EQ(again.lights[0].profile->candela, scene.lights[0].profile->candela);
    expect_valid(out);
  }
}

TEST(GltfWrite, GltfOutputHasItsBufferBesideItAndKeepsUrisInTheSameFolder) {
  const TempFolder folder;
  const GltfBuilder source = rich_file();
  folder.write("tex ture.png", tiny_png());
  const std::string in = folder.write("in.gltf", source.text());
  std::filesystem::create_directories(folder.path("far"));
  const Scene scene = read(in);
  for (const std::string name : {"out put.gltf", "far/out.gltf"}) {
    const std::string out = folder.path(name);
    ASSERT_TRUE(write_lit_scene(out, scene, light_all(scene), kVertexLight));
    const WrittenGltf written(out);
    EXPECT_EQ(written.json["buffers"].size(), 1u);
    EXPECT_EQ(written.json["images"][0].contains("uri"), name == "out put.gltf");
    EXPECT_EQ(written.attribute("_IRRADIANCE").size(), 9u);
    expect_valid(out);
  }
  EXPECT_TRUE(std::filesystem::exists(folder.path("out put.bin")));
}

TEST(GltfWrite, SeveralBuffersBecomeOne) {
  const TempFolder folder;
  GltfBuilder b;
  b.triangle();
  b.doc["accessors"][0]["min"] = {0, 0, 0};
  b.doc["accessors"][0]["max"] = {1, 1, 0};
  b.push("scenes", {{"nodes", {0}}});
  folder.write("a.bin", b.bytes.substr(0, 36));
  folder.write("b.bin", b.bytes.substr(36));
  b.doc["buffers"] = {{{"uri", "a.bin"}, {"byteLength", 36}, {"name", "kept"}},
                      {{"uri", "b.bin"}, {"byteLength", b.bytes.size() - 36}}};
  b.doc["bufferViews"][1]["buffer"] = 1;
  b.doc["bufferViews"][1].erase("byteOffset");
  const Scene scene = read(folder.write("in.gltf", b.text()));
  ASSERT_TRUE(write_lit_scene(folder.path("out.glb"), scene, light_all(scene), kVertexLight));
  const WrittenGltf written(folder.path("out.glb"));
  ASSERT_EQ(written.json["buffers"].size(), 1u);
  EXPECT_EQ(written.json["buffers"][0]["name"], "kept");
  EXPECT_EQ(written.attribute("POSITION"), (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(written.values(written.primitive(0)["indices"]), (std::vector<float>{0, 1, 2}));
  expect_valid(folder.path("out.glb"));
}

/// Three nodes with the same mesh.
GltfBuilder three_of_one() {
  GltfBuilder b;
  b.triangle();
  b.doc["accessors"][0]["min"] = {0, 0, 0};
  b.doc["accessors"][0]["max"] = {1, 1, 0};
  b.doc["meshes"][0]["name"] = "tile";
  b.push("nodes", {{"mesh", 0}, {"translation", {2, 0, 0}}});
  b.push("nodes", {{"mesh", 0}, {"translation", {4, 0, 0}}});
  b.push("scenes", {{"nodes", {0, 1, 2}}});
  return b;
}

TEST(GltfWrite, InstancesShareAMeshExactlyWhenTheirLightIsTheSame) {
  const TempFolder folder;
  const Scene scene = read(folder.write("in.gltf", three_of_one().text()));
  Lighting lighting = light_all(scene);
  lighting.primitives[2].irradiance = lighting.primitives[0].irradiance;
  ASSERT_TRUE(write_lit_scene(folder.path("out.glb"), scene, lighting, kVertexLight));
  const WrittenGltf written(folder.path("out.glb"));
  EXPECT_EQ(written.json["meshes"].size(), 2u);
  EXPECT_EQ(written.json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(written.json["nodes"][1]["mesh"], 1);
  EXPECT_EQ(written.json["nodes"][2]["mesh"], 0);
  EXPECT_EQ(written.json["meshes"][1]["name"], "tile_lit2");
  EXPECT_EQ(written.primitive(0)["attributes"]["POSITION"], written.primitive(1)["attributes"]["POSITION"]);
  EXPECT_NE(written.primitive(0)["attributes"]["_IRRADIANCE"],
            written.primitive(1)["attributes"]["_IRRADIANCE"]);
  expect_valid(folder.path("out.glb"));
}

TEST(GltfWrite, AnUnlitInstanceKeepsTheMeshAsItWas) {
  const TempFolder folder;
  const Scene scene = read(folder.write("in.gltf", three_of_one().text()));
  Lighting lighting = light_refined(scene);
  lighting.primitives.erase(lighting.primitives.begin());  // same light on the other two
  ASSERT_TRUE(write_lit_scene(folder.path("out.glb"), scene, lighting, kVertexLight));
  const WrittenGltf written(folder.path("out.glb"));
  ASSERT_EQ(written.json["meshes"].size(), 2u);
  EXPECT_EQ(written.json["nodes"][0]["mesh"], 0);
  EXPECT_EQ(written.json["nodes"][1]["mesh"], 1);
  EXPECT_EQ(written.json["nodes"][2]["mesh"], 1);
  EXPECT_FALSE(written.primitive(0)["attributes"].contains("_IRRADIANCE"));
  EXPECT_EQ(written.attribute("POSITION", 0).size(), 9u);
  EXPECT_EQ(written.attribute("POSITION", 1), (std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, .5f, .5f, 0}));
  expect_valid(folder.path("out.glb"));
}

TEST(GltfWrite, GpuInstancesLitDifferentlyBecomeNodes) {
  const TempFolder folder;
  GltfBuilder b = three_of_one();
  b.doc["nodes"] = json::array({{{"mesh", 0}, {"name", "forest"}}});
  b.doc["scenes"][0]["nodes"] = {0};
  b.doc["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", b.vec3s({0, 0, 0, 2, 0, 0, 4, 0, 0})},
      {"ROTATION", b.accessor<int16_t>({0, 0, 0, 32767, 0, 23170, 0, 23170, 0, 0, 32767, 0}, "VEC4",
                                       test::kShort, {{"normalized", true}})}};
  b.doc["extensionsUsed"] = {"EXT_mesh_gpu_instancing"};
  b.doc["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const Scene scene = read(folder.write("in.gltf", b.text()));
  ASSERT_EQ(scene.instances.size(), 3u);
  ASSERT_TRUE(write_lit_scene(folder.path("out.glb"), scene, light_all(scene), kVertexLight));
  const WrittenGltf written(folder.path("out.glb"));
  EXPECT_FALSE(written.json.contains("extensionsUsed"));
  EXPECT_FALSE(written.json.contains("extensionsRequired"));
  EXPECT_EQ(written.json["nodes"][0]["children"], json({1, 2, 3}));
  EXPECT_EQ(written.json["nodes"][3]["translation"], json({4.0, 0.0, 0.0}));
  expect_valid(folder.path("out.glb"));

  const Scene again = read(folder.path("out.glb"));
  ASSERT_EQ(again.instances.size(), 3u);
  for (size_t i = 0; i < 3; ++i)
    for (int c = 0; c < 4; ++c)
      EXPECT_LT(length(again.instances[i].transform[c] - scene.instances[i].transform[c]), 1e-4f);

  // All alike: the extension may stay.
  Lighting alike = light_all(scene);
  for (LitPrimitive& lit : alike.primitives) lit.irradiance.assign(3, vec3(1));
  ASSERT_TRUE(write_lit_scene(folder.path("alike.glb"), scene, alike, kVertexLight));
  EXPECT_EQ(WrittenGltf(folder.path("alike.glb")).json["nodes"], b.doc["nodes"]);
}

TEST(GltfWrite, RefinedMeshesInterpolateEveryAttribute) {
  const TempFolder folder;
  GltfBuilder b;
  json& p = b.mesh({{"mode", 5}});  // a strip of two triangles: 0 1 2, 2 1 3
  p["attributes"]["POSITION"] =
      b.accessor<int16_t>({0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 10, 10, 0, 0}, "VEC3", test::kShort);
  b.doc["accessors"][0] = {{"bufferView", 0},  {"componentType", test::kShort},
                           {"count", 4},       {"type", "VEC3"},
                           {"min", {0, 0, 0}}, {"max", {10, 10, 0}}};
  b.doc["bufferViews"][0]["byteStride"] = 8;
  p["attributes"]["NORMAL"] = b.vec3s({0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  p["attributes"]["TANGENT"] =
      b.accessor<float>({1, 0, 0, 1, 1, 0, 0, -1, 0, 1, 0, -1, 1, 0, 0, 1}, "VEC4", test::kFloat);
  p["attributes"]["TEXCOORD_0"] = b.accessor<uint16_t>({0, 0, 65535, 0, 0, 65535, 65535, 65535}, "VEC2",
                                                       test::kUnsignedShort, {{"normalized", true}});
  p["attributes"]["JOINTS_0"] =
      b.accessor<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0}, "VEC4", test::kUnsignedByte);
  p["attributes"]["WEIGHTS_0"] =
      b.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", test::kFloat);
  p["attributes"]["_ID"] = b.accessor<uint16_t>({7, 0, 8, 0, 9, 0, 10, 0}, "VEC2", test::kUnsignedShort);
  const int moved = b.push("accessors", {{"componentType", test::kFloat},
                                         {"count", 4},
                                         {"type", "VEC3"},
                                         {"min", {0, 0, 0}},
                                         {"max", {0, 0, 6}}});
  const int where = b.view(test::bytes_of<uint16_t>({1})), what = b.view(test::bytes_of<float>({0, 0, 6}));
  b.doc["accessors"][size_t(moved)]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", where}, {"componentType", test::kUnsignedShort}}},
      {"values", {{"bufferView", what}}}};
  b.doc["meshes"][0]["primitives"][0]["targets"] = {{{"POSITION", moved}}};
  b.doc["extensionsUsed"] = {"KHR_mesh_quantization"};
  b.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
  b.push("scenes", {{"nodes", {0}}});
  const Scene scene = read(folder.write("in.gltf", b.text()));
  ASSERT_EQ(scene.meshes[0].primitives[0].triangle_count(), 2u);
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write_lit_scene(out, scene, light_refined(scene), kVertexLight));
  const WrittenGltf written(out);
  EXPECT_FALSE(written.primitive(0).contains("mode"));
  EXPECT_EQ(written.values(written.primitive(0)["indices"]).size(), 12u);
  // Vertex 3 lies between corners 1 and 2 of the first triangle.
  const auto at = [&](const char* name, size_t components) {
    const std::vector<float> all = written.attribute(name);
    return std::vector<float>(all.begin() + 3 * components, all.begin() + 4 * components);
  };
  EXPECT_EQ(at("POSITION", 3), (std::vector<float>{5, 5, 0}));
  const float half = std::sqrt(0.5f);
  const std::vector<float> normal = at("NORMAL", 3), tangent = at("TANGENT", 4);
  for (size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(normal[c], (std::vector<float>{half, half, 0})[c], 1e-6f);
    EXPECT_NEAR(tangent[c], (std::vector<float>{half, half, 0})[c], 1e-6f);
  }
  EXPECT_EQ(tangent[3], -1);
  EXPECT_EQ(at("TEXCOORD_0", 2), (std::vector<float>{0.5f, 0.5f}));
  EXPECT_EQ(at("JOINTS_0", 4), (std::vector<float>{1, 0, 0, 0}));
  EXPECT_EQ(at("WEIGHTS_0", 4), (std::vector<float>{1, 0, 0, 0}));
  EXPECT_EQ(at("_ID", 2), (std::vector<float>{8, 0}));
  const std::vector<float> target = written.values(written.primitive(0)["targets"][0]["POSITION"]);
  EXPECT_EQ(target[5], 6);   // corner 1 itself
  EXPECT_EQ(target[11], 3);  // half way
  EXPECT_EQ(written.attribute("_IRRADIANCE").size(), 8u * 3);
  expect_valid(out);
}

TEST(GltfWrite, UnlitShowsOutgoingLight) {
  const TempFolder folder;
  GltfBuilder b = three_of_one();
  b.doc["meshes"][0]["primitives"][0]["material"] = 0;
  b.doc["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      b.accessor<float>({1, 1, 1, 1, 1, 1, 1, .5f, 1, 0, 1, 1}, "VEC4", test::kFloat);
  b.push("materials",
         {{"name", "lamp"},
          {"alphaMode", "BLEND"},
          {"emissiveFactor", {0.0, 0.0, 1.0}},
          {"extras", {{"k", 1}}},
          {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 2.0}}}}},
          {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 0.5, 0.5, 0.25}}, {"metallicFactor", 0.5}}}});
  b.doc["extensionsUsed"] = {"KHR_materials_emissive_strength"};
  const Scene scene = read(folder.write("in.gltf", b.text()));
  Lighting lighting = light_all(scene);
  for (LitPrimitive& lit : lighting.primitives) lit.irradiance.assign(3, vec3(8 * kPi, 4 * kPi, 400));
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write_lit_scene(out, scene, lighting, {OutputMode::kUnlit, 0.25f}));
  const WrittenGltf written(out);
  const std::vector<float> colour = written.attribute("COLOR_0");
  ASSERT_EQ(colour.size(), 12u);
  EXPECT_NEAR(colour[0], 0.25f * 0.25f * 8, 1e-6f);  // exposure * reflectance * irradiance / pi
  EXPECT_NEAR(colour[1], 0.25f * 0.25f * 4, 1e-6f);
  EXPECT_EQ(colour[2], 1);  // clamped
  EXPECT_EQ(colour[7], 0.5f);
  EXPECT_EQ(colour[9], 0);  // the vertex colour takes the green
  ASSERT_EQ(written.json["materials"].size(), 2u);
  EXPECT_EQ(written.json["materials"][0], b.doc["materials"][0]);
  const json& unlit = written.json["materials"][1];
  EXPECT_TRUE(unlit["extensions"].contains("KHR_materials_unlit"));
  EXPECT_FALSE(unlit.contains("emissiveFactor"));
  EXPECT_EQ(unlit["alphaMode"], "BLEND");
  EXPECT_EQ(unlit["extras"]["k"], 1);
  EXPECT_EQ(unlit["pbrMetallicRoughness"]["baseColorFactor"], json({1.0, 1.0, 1.0, 0.25}));
  EXPECT_EQ(written.primitive(0)["material"], 1);
  EXPECT_FALSE(written.primitive(0)["attributes"].contains("_IRRADIANCE"));
  expect_valid(out);
}

TEST(GltfWrite, UnlitLeavesTheTextureToTheViewer) {
  const TempFolder folder;
  folder.write("tex ture.png", tiny_png());
  GltfBuilder b = rich_file();
  b.doc["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] = {0.5, 1.0, 1.0, 1.0};
  const Scene scene = read(folder.write("in.gltf", b.text()));
  Lighting lighting = light_all(scene);
  lighting.primitives[0].irradiance.assign(3, vec3(kPi));
  lighting.primitives[0].irradiance_back.assign(3, vec3(0));
  const std::string out = folder.path("out.glb");
  ASSERT_TRUE(write_lit_scene(out, scene, lighting, {OutputMode::kUnlit, 0.5f}));
  const WrittenGltf written(out);
  const json& unlit = written.json["materials"][1];
  EXPECT_EQ(unlit["pbrMetallicRoughness"]["baseColorTexture"],
            b.doc["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]);
  const std::vector<float> colour = written.attribute("COLOR_0");
  EXPECT_NEAR(colour[0], 0.25f, 1e-6f);
  EXPECT_NEAR(colour[1], 0.5f, 1e-6f);
  expect_valid(out);
}

TEST(GltfWrite, AChangedSourceIsAnErrorNotACrash) {
  const TempFolder folder;
  const std::string in = folder.write("in.gltf", three_of_one().text());
  const Scene scene = read(in);
  GltfBuilder smaller;
  smaller.triangle();
  folder.write("in.gltf", smaller.text());
  const Status status = write_lit_scene(folder.path("out.glb"), scene, light_all(scene), kVertexLight);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(status.error().file, in);
  std::filesystem::remove(in);
  EXPECT_FALSE(write_lit_scene(folder.path("out.glb"), scene, light_all(scene), kVertexLight));
  EXPECT_FALSE(std::filesystem::exists(folder.path("out.glb")));
}

TEST(GltfWrite, LightThatDoesNotFitIsAnError) {
  const TempFolder folder;
  const Scene scene = read(folder.write("in.gltf", three_of_one().text()));
  void (*const spoils[])(LitPrimitive&) = {
      [](LitPrimitive& lit) { lit.instance = 3; }, [](LitPrimitive& lit) { lit.primitive = 1; },
      [](LitPrimitive& lit) { lit.irradiance.pop_back(); },
      [](LitPrimitive& lit) { lit.origins[0].triangle = 9; }, [](LitPrimitive& lit) { lit.faces[0].z = 4; }};
  for (const auto& spoil : spoils) {
    Lighting lighting = light_refined(scene);
    spoil(lighting.primitives[0]);
    EXPECT_FALSE(write_lit_scene(folder.path("out.glb"), scene, lighting, kVertexLight));
  }
}

TEST(GltfWrite, RefusesOtherEndingsAndPlaces) {
  Scene scene;
  for (const char* file : {"/tmp/a.obj", "/proc/a.glb", "/proc/a.gltf", "/no/such/folder/a.glb"}) {
    const Status status = write_scene(file, scene);
    ASSERT_FALSE(status);
    EXPECT_EQ(status.error().code, ErrorCode::kCannotWrite) << file;
    EXPECT_EQ(status.error().file, file);
    EXPECT_FALSE(status.error().cure.empty());
  }
}

}  // namespace
}  // namespace goldthread
