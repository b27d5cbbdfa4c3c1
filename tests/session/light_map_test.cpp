// Texels measured from outside: light maps, lists of texels, and what can be wrong with them.
#include "session/light_map.h"

#include <gmock/gmock.h>

#include "files/image_read.h"
#include "goldthread/reference.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Json = nlohmann::json;

/// The floor (instance 0) covers the lower left triangle's half of its square twice over, corner to corner;
/// the lamp (1) has none unless asked.
GltfBuilder unwrapped(bool lamp_too) {
  GltfBuilder b = lit_floor();
  for (size_t mesh = 0; mesh < (lamp_too ? 2 : 1); ++mesh)
    b.doc["meshes"][mesh]["primitives"][0]["attributes"]["TEXCOORD_0"] =
        b.accessor<float>({0, 0, 0.5f, 0, 0.5f, 1, 0, 1}, "VEC2", kFloat);
  return b;
}

ReferenceOptions texels_of(const std::string& scene, int width, int height) {
  ReferenceOptions options;
  options.input = scene;
  options.texels = {width, height, {}};
  options.samples = 64;
  return options;
}

ReferenceResult measured(const ReferenceOptions& options) {
  Result<ReferenceResult> result = reference(options);
  if (result) return *std::move(result);
  ADD_FAILURE() << result.error().line();
  return {};
}

TEST(LightMap, HoldsWhatTheListHolds) {
  const TempFolder folder;
  ReferenceOptions options = texels_of(folder.write("a.gltf", unwrapped(false).text()), 8, 6);
  options.pictures = {folder.path("map.exr")};
  options.json_file = folder.path("map.json");
  const ReferenceResult result = measured(options);
  EXPECT_THAT(result.written, ElementsAre(options.pictures[0], options.json_file));
  EXPECT_THAT(result.warnings,
              ElementsAre(HasSubstr("no texture coordinates and no light map: 1 of 2 lit primitives")));
  const Json json = Json::parse(result.json);
  ASSERT_EQ(json["points"].size(), 24u);  // the left half of the map
  EXPECT_EQ(json["light_maps"].size(), 1u);
  EXPECT_EQ(json["light_maps"][0]["texels"], 24);
  EXPECT_EQ(json["texels"], Json({{"width", 8}, {"height", 6}, {"uv", nullptr}}));
  const LayeredImage map = *read_layered_exr(options.pictures[0]);
  ASSERT_EQ(map.image.width, 8u);
  ASSERT_EQ(map.image.height, 6u);
  std::vector<bool> listed(48, false);
  for (const Json& point : json["points"]) {
    const size_t x = point["texel"][0], y = point["texel"][1], at = 8 * y + x;
    listed[at] = true;
    // u = 0 is x = -1 and u = 1/2 is x = 1; v is z.
    EXPECT_NEAR(point["point"][0].get<float>(), -1 + (float(x) + 0.5f) / 2, 1e-6f);
    EXPECT_NEAR(point["point"][2].get<float>(), -1 + (float(y) + 0.5f) / 3, 1e-6f);
    EXPECT_EQ(point["instance"], 0);
    EXPECT_EQ(point["primitive"], 0);
    EXPECT_EQ(point["back"], false);
    for (int k = 0; k < 3; ++k)
      EXPECT_EQ(map.image.pixels[at][k], float(point["irradiance"][size_t(k)].get<double>()));
    EXPECT_GT(map.image.pixels[at].y, 0);
    EXPECT_EQ(map.layers.at("samples")[at], 64);
    // Grey light: the luminance's error is each channel's.
    EXPECT_NEAR(map.layers.at("error")[at], point["standard_error"][1].get<float>(), 1e-5f);
  }
  for (size_t at = 0; at < 48; ++at) {
    EXPECT_EQ(map.layers.at("A")[at], listed[at] ? 1 : 0);
    if (listed[at]) continue;
    EXPECT_EQ(map.image.pixels[at], vec3(0));
    EXPECT_EQ(map.layers.at("samples")[at] + map.layers.at("error")[at], 0);
  }
}

// Under nothing but an even sky, all of the floor has pi times its luminance.
TEST(LightMap, OfAnOpenFloor) {
  const TempFolder folder;
  GltfBuilder b = unwrapped(false);
  b.doc["nodes"].erase(1);
  ReferenceOptions options = texels_of(folder.write("a.gltf", b.text()), 16, 16);
  options.sky = {{100, 200, 300}};
  options.pictures = {folder.path("map.exr")};
  EXPECT_THAT(measured(options).warnings, IsEmpty());
  const LayeredImage map = *read_layered_exr(options.pictures[0]);
  size_t covered = 0;
  for (size_t i = 0; i < 256; ++i) {
    if (map.layers.at("A")[i] == 0) continue;
    ++covered;
    const vec3 sky(100, 200, 300);
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(map.image.pixels[i][k], kPi * sky[k],
                  4 * map.layers.at("error")[i] * sky[k] / 185.5f + 1e-5f * sky[k]);
  }
  EXPECT_EQ(covered, 128u);
}

TEST(LightMap, SeveralAreNumbered) {
  const TempFolder folder;
  GltfBuilder b = unwrapped(true);
  b.doc["materials"][0]["doubleSided"] = true;
  b.doc["nodes"][1]["name"] = "the lamp";
  ReferenceOptions options = texels_of(folder.write("a.gltf", b.text()), 4, 4);
  options.samples = 16;
  options.pictures = {folder.path("light.map.exr")};
  options.report_file = folder.path("report.json");
  const ReferenceResult result = measured(options);
  EXPECT_THAT(result.written,
              ElementsAre(folder.path("light.map-0-0.exr"), folder.path("light.map-0-0-back.exr"),
                          folder.path("light.map-1-0.exr"), options.report_file));
  EXPECT_FALSE(std::filesystem::exists(options.pictures[0]));
  const Json maps = Json::parse(bytes_of_file(options.report_file))["light_maps"];
  ASSERT_EQ(maps.size(), 3u);
  EXPECT_EQ(maps[1]["back"], true);
  EXPECT_EQ(maps[2]["name"], "the lamp");
  // The floor's back sees nothing, the lamp what the floor sends back.
  EXPECT_EQ(read_layered_exr(folder.path("light.map-0-0-back.exr"))->image.pixels[0], vec3(0));
  EXPECT_GT(read_layered_exr(folder.path("light.map-1-0.exr"))->image.pixels[0].x, 0);
}

TEST(LightMap, IsGoneOnWithFromItsList) {
  const TempFolder folder;
  ReferenceOptions options = texels_of(folder.write("a.gltf", unwrapped(true).text()), 4, 2);
  options.seed = 9;
  options.pictures = {folder.path("whole.exr")};
  measured(options);
  options.samples = 32;
  options.pictures.clear();
  options.json_file = folder.path("part.json");
  measured(options);
  ReferenceOptions more;
  more.input = options.input;
  more.resume_file = options.json_file;
  more.samples = 64;
  more.pictures = {folder.path("resumed.exr")};
  const Json report = Json::parse(measured(more).report);
  EXPECT_EQ(report["light_maps"].size(), 2u);
  EXPECT_EQ(bytes_of_file(folder.path("resumed-1-0.exr")), bytes_of_file(folder.path("whole-1-0.exr")));
  EXPECT_EQ(bytes_of_file(folder.path("resumed-0-0.exr")), bytes_of_file(folder.path("whole-0-0.exr")));
  // A texel beyond the map is no texel.
  Json spoiled = Json::parse(bytes_of_file(options.json_file));
  spoiled["points"][3]["texel"][0] = 4;
  more.resume_file = folder.write("spoiled.json", spoiled.dump());
  EXPECT_THAT(reference(more).error().line(), HasSubstr("spoiled.json: point 3"));
  spoiled["texels"]["width"] = 0;
  more.resume_file = folder.write("spoiled.json", spoiled.dump());
  EXPECT_THAT(reference(more).error().line(), HasSubstr("spoiled.json: texels"));
}

TEST(LightMap, OverlapsAndWhatLiesOutsideAreSaid) {
  const TempFolder folder;
  GltfBuilder b = lit_floor();
  for (size_t mesh = 0; mesh < 2; ++mesh)
    b.doc["meshes"][mesh]["primitives"][0]["attributes"]["TEXCOORD_1"] =
        b.accessor<float>({0, 0, 2, 0, 2, 2, 2, 0.5f}, "VEC2", kFloat);
  const ReferenceResult result = measured(texels_of(folder.write("a.gltf", b.text()), 8, 8));
  EXPECT_THAT(result.warnings,
              ElementsAre(HasSubstr("on top of others, where the first in the file is measured: 2 triangles"),
                          HasSubstr("beyond 0..1, where there are no texels: 4 triangles")));
}

/// The error, and that nothing is left behind.
Error error_of(const ReferenceOptions& options, const TempFolder& folder) {
  const std::set<std::string> before = names_in(folder.path(""));
  const Result<ReferenceResult> result = reference(options);
  EXPECT_EQ(names_in(folder.path("")), before);
  if (result) {
    ADD_FAILURE() << "was measured";
    return {};
  }
  EXPECT_EQ(result.error().line().find('\n'), std::string::npos);
  EXPECT_FALSE(result.error().cure.empty());
  return result.error();
}

TEST(LightMapBadInput, ScenesWithoutTexels) {
  const TempFolder folder;
  const auto expect_error = [&](const ReferenceOptions& options, ErrorCode code, const std::string& what) {
    const Error error = error_of(options, folder);
    EXPECT_EQ(error.code, code);
    EXPECT_THAT(error.line(), HasSubstr(what));
  };
  ReferenceOptions options = texels_of(folder.write("bare.gltf", lit_floor().text()), 8, 8);
  options.pictures = {folder.path("map.exr")};
  expect_error(options, ErrorCode::kBadInput, "bare.gltf: no lit primitive has texture coordinates");
  options.input = folder.write("first.gltf", unwrapped(true).text());
  options.texels->uv = 1;
  expect_error(options, ErrorCode::kBadInput, "no lit primitive has TEXCOORD_1; leave --uv out");
  GltfBuilder collapsed = unwrapped(false);
  collapsed.doc["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] =
      collapsed.accessor<float>({0, 0, 0, 0, 0, 0, 0, 0}, "VEC2", kFloat);
  options.input = folder.write("collapsed.gltf", collapsed.text());
  options.texels->uv.reset();
  expect_error(options, ErrorCode::kBadInput, "2 triangles without area");
}

TEST(LightMapBadInput, WishesThatMakeNoSense) {
  const TempFolder folder;
  const ReferenceOptions good = texels_of(folder.write("a.gltf", unwrapped(true).text()), 8, 8);
  const auto expect_usage = [&](const ReferenceOptions& options, const std::string& what) {
    const Error error = error_of(options, folder);
    EXPECT_EQ(error.code, ErrorCode::kUsage);
    EXPECT_THAT(error.line(), HasSubstr(what));
  };
  ReferenceOptions options = good;
  options.texels = {0, 8, {}};
  expect_usage(options, "--texels");
  options.texels = {8, 20000, {}};
  expect_usage(options, "16384");
  options.texels = {8, 8, 2};
  expect_usage(options, "--uv");
  options = good;
  options.pictures = {folder.path("map.png")};
  expect_usage(options, "map.png: light maps are .exr");
  options = good;
  options.vertices = true;
  expect_usage(options, "--texels");
  options = good;
  options.resume_file = folder.path("map.exr");
  options.pictures = {folder.path("map.exr")};
  expect_usage(options, "--json file");
  ReferenceOptions vertices;
  vertices.input = good.input;
  vertices.vertices = true;
  vertices.samples = 16;
  vertices.json_file = folder.path("vertices.json");
  measured(vertices);
  ReferenceOptions more;
  more.input = good.input;
  more.resume_file = vertices.json_file;
  more.pictures = {folder.path("map.exr")};
  expect_usage(more, "vertices.json: holds no texels");
}

}  // namespace
}  // namespace goldthread
