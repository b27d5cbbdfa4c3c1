// The scenes of our own baked at medium quality, judged by what stands in the written files.
#include <gtest/gtest.h>

#include "math/vec.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;

/// Least and greatest component of an attribute over all primitives that have it.
struct Range {
  float least = INFINITY, most = -INFINITY;
  size_t values = 0;
};
Range range_of(const WrittenGltf& file, const char* attribute) {
  Range range;
  for (const auto& mesh : file.json["meshes"])
    for (const auto& primitive : mesh["primitives"]) {
      if (!primitive["attributes"].contains(attribute)) continue;
      for (const float v : file.values(primitive["attributes"][attribute])) {
        range.least = std::min(range.least, v);
        range.most = std::max(range.most, v);
        ++range.values;
      }
    }
  return range;
}

void expect_all_keys(const nlohmann::json& report) {
  const std::vector<std::pair<const char*, std::vector<const char*>>> sections{
      {"scene", {"triangles", "surfaces", "face_clusters", "volume_clusters", "lights", "area_m2"}},
      {"seconds",
       {"load", "preprocess", "face_clusters", "volume_clusters", "ray_bvh", "first_image", "solve",
        "reconstruct", "represent", "write", "total"}},
      {"solver", {"elements", "links", "rays", "ray_time_share", "iterations", "epsilon", "error_estimate"}},
      {"power_lm", {"emitted", "absorbed", "escaped", "residual"}},
      {"irradiance_lx", {"least", "most"}}};
  for (const auto& [section, keys] : sections) {
    ASSERT_TRUE(report.contains(section)) << section;
    for (const char* key : keys) EXPECT_TRUE(report[section].contains(key)) << section << "." << key;
  }
  for (const char* key : {"volume", "face", "patch", "light"})
    EXPECT_TRUE(report["solver"]["elements"].contains(key)) << key;
  EXPECT_GT(report["peak_memory_bytes"].get<uint64_t>(), 0u);
  EXPECT_TRUE(report["threads"].is_number_integer());
  EXPECT_TRUE(report["warnings"].is_array());
  EXPECT_TRUE(report["converged"].is_boolean());
}

class OwnScene : public ::testing::TestWithParam<const char*> {};

TEST_P(OwnScene, BakesWithItsPowerInBalance) {
  const TempFolder folder;
  BakeOptions options;
  options.input = made(folder, GetParam());
  options.outputs = {folder.path("lit.glb")};
  options.report_file = folder.path("report.json");
  const BakeResult result = baked(options);
  const nlohmann::json report = nlohmann::json::parse(bytes_of_file(options.report_file));
  EXPECT_EQ(report, nlohmann::json::parse(result.json));
  expect_all_keys(report);
  EXPECT_TRUE(report["converged"].get<bool>());
  const double emitted = report["power_lm"]["emitted"], residual = report["power_lm"]["residual"];
  EXPECT_GT(emitted, 0);
  EXPECT_LE(std::abs(residual), 0.01 * emitted) << 100 * residual / emitted << "%";
  const auto& seconds = report["seconds"];
  EXPECT_GT(seconds["first_image"].get<double>(), 0);
  EXPECT_LE(seconds["first_image"].get<double>(), seconds["total"].get<double>());
  EXPECT_EQ(result.written, options.outputs);
  EXPECT_FALSE(result.cancelled);
  EXPECT_EQ(names_in(folder.path("")),
            (std::set<std::string>{std::string(GetParam()) + ".glb", "lit.glb", "report.json"}));
  const Range light = range_of(WrittenGltf(options.outputs[0]), "_IRRADIANCE");
  EXPECT_GT(light.values, 0u);
  EXPECT_GE(light.least, 0);
  EXPECT_TRUE(std::isfinite(light.most));
  expect_valid(options.outputs[0]);
}

INSTANTIATE_TEST_SUITE_P(Medium, OwnScene,
                         ::testing::Values("cornell-box", "furnace", "sphere", "office", "two-rooms"),
                         [](const auto& info) {
                           std::string name(info.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

class KnownAnswer : public ::testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(KnownAnswer, IrradianceAtEveryWrittenVertex) {
  // E = 1 lm/m^2 and rho = 0.5 everywhere: 2 lux, within 1%, at each vertex.
  const auto [name, triangles] = GetParam();
  const TempFolder folder;
  BakeOptions options;
  options.input = made(folder, name, uint64_t(triangles));
  options.outputs = {folder.path("lit.glb")};
  baked(options);
  const Range light = range_of(WrittenGltf(options.outputs[0]), "_IRRADIANCE");
  ASSERT_GT(light.values, 0u);
  EXPECT_GE(light.least, 1.98f);
  EXPECT_LE(light.most, 2.02f);
}

INSTANTIATE_TEST_SUITE_P(Medium, KnownAnswer,
                         ::testing::Values(std::pair("furnace", 12), std::pair("furnace", 1200),
                                           std::pair("furnace", 50000), std::pair("furnace", 400000),
                                           std::pair("sphere", 12), std::pair("sphere", 1200),
                                           std::pair("sphere", 50000)),
                         [](const auto& info) {
                           return std::string(info.param.first) + std::to_string(info.param.second);
                         });

TEST(OpenSky, AFaintSunTakesNothingFromIt) {
  // pi * L on an open floor. Links that are too weak for rays must not count as a part of the hemisphere.
  const TempFolder folder;
  GltfBuilder b;
  b.triangle({{"rotation", {-0.70710678, 0, 0, 0.70710678}}});  // faces up
  BakeOptions options = draft(folder.write("floor.glb", to_glb(b)), {folder.path("lit.glb")});
  options.sky = {1000, 1000, 1000};
  options.sun = BakeOptions::Sun{0.03f};
  baked(options);
  const Range light = range_of(WrittenGltf(options.outputs[0]), "_IRRADIANCE");
  ASSERT_GT(light.values, 0u);
  EXPECT_GE(light.least, 0.99f * 1000 * kPi);
  EXPECT_LE(light.most, 1.01f * 1000 * kPi);
}

TEST(Seed, IsAnotherChoiceOfTheSameAnswer) {
  const TempFolder folder;
  const std::string input = made(folder, "cornell-box");
  std::vector<std::string> bytes;  // of the light alone: the report has rays of its own
  std::vector<double> absorbed;
  for (const uint64_t seed : {0, 1, 1}) {
    BakeOptions options = draft(input, {folder.path("lit.glb")});
    options.seed = seed;
    const nlohmann::json report = nlohmann::json::parse(baked(options).json);
    bytes.push_back(bytes_of_file(options.outputs[0]));
    absorbed.push_back(report["power_lm"]["absorbed"].get<double>());
  }
  EXPECT_TRUE(bytes[0] != bytes[1]);
  EXPECT_TRUE(bytes[1] == bytes[2]);
  EXPECT_NEAR(absorbed[1] / absorbed[0], 1, 0.02);
}

class Repeated : public ::testing::TestWithParam<const char*> {};

TEST_P(Repeated, TheSameBytesForAnyThreadsAndAgain) {
  const TempFolder folder;
  const std::string input = made(folder, GetParam());
  std::vector<std::string> glb, gold;
  for (const int threads : {1, 2, 2}) {
    const auto run = std::to_string(glb.size());
    BakeOptions options =
        draft(input, {folder.path("lit" + run + ".glb"), folder.path("lit" + run + ".gold")});
    options.threads = threads;
    baked(options);
    glb.push_back(bytes_of_file(options.outputs[0]));
    gold.push_back(bytes_of_file(options.outputs[1]));
    ASSERT_FALSE(glb.back().empty());
    ASSERT_FALSE(gold.back().empty());
  }
  EXPECT_TRUE(glb[0] == glb[1]) << "one thread and two differ";
  EXPECT_TRUE(glb[1] == glb[2]) << "twice in a row differs";
  EXPECT_TRUE(gold[0] == gold[1]) << "one thread and two differ";
  EXPECT_TRUE(gold[1] == gold[2]) << "twice in a row differs";
}

INSTANTIATE_TEST_SUITE_P(Draft, Repeated,
                         ::testing::Values("cornell-box", "furnace", "sphere", "office", "two-rooms"),
                         [](const auto& info) {
                           std::string name(info.param);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(OutputModes, UnlitCarriesItsColours) {
  const TempFolder folder;
  BakeOptions options = draft(made(folder, "cornell-box"), {folder.path("unlit.glb")});
  options.mode = OutputMode::kUnlit;
  baked(options);
  const WrittenGltf file(options.outputs[0]);
  EXPECT_NE(std::find(file.json["extensionsUsed"].begin(), file.json["extensionsUsed"].end(),
                      "KHR_materials_unlit"),
            file.json["extensionsUsed"].end());
  const Range colour = range_of(file, "COLOR_0");
  ASSERT_GT(colour.values, 0u);
  EXPECT_GE(colour.least, 0);
  EXPECT_LE(colour.most, 1);
  EXPECT_GT(colour.most, 0.2f);  // an exposure at which something is seen
  EXPECT_EQ(range_of(file, "_IRRADIANCE").values, 0u);
  expect_valid(options.outputs[0]);
}

TEST(OutputModes, VertexLightLeavesMaterialsAlone) {
  const TempFolder folder;
  GltfBuilder b = lit_floor();
  b.doc["materials"][0]["doubleSided"] = true;
  const std::string input = folder.write("scene.glb", to_glb(b));
  BakeOptions options = draft(input, {folder.path("lit.glb")});
  baked(options);
  const WrittenGltf before(input), after(options.outputs[0]);
  EXPECT_EQ(before.json["materials"], after.json["materials"]);
  ASSERT_TRUE(after.primitive(0)["attributes"].contains("_IRRADIANCE_BACK"));
  // The lamp is above: light on the front, none on the back.
  float front = 0, back = 0;
  for (const float v : after.attribute("_IRRADIANCE")) front = std::max(front, v);
  for (const float v : after.attribute("_IRRADIANCE_BACK")) back = std::max(back, v);
  EXPECT_GT(front, 0.3f);
  EXPECT_EQ(back, 0);
  expect_valid(options.outputs[0]);
}

TEST(OutputModes, AllKindsOfOutputAtOnce) {
  const TempFolder folder;
  BakeOptions options = draft(made(folder, "cornell-box"), {});
  for (const char* name : {"a.glb", "b.gltf", "c.gold", "d.png", "e.exr"})
    options.outputs.push_back(folder.path(name));
  options.picture_width = 64;
  EXPECT_EQ(baked(options).written, options.outputs);
  EXPECT_EQ(names_in(folder.path("")), (std::set<std::string>{"a.glb", "b.gltf", "b.bin", "c.gold",
                                                              "cornell-box.glb", "d.png", "e.exr"}));
}

}  // namespace
}  // namespace goldthread
