// Bakes with light maps, whole: what the file shows is the light, on both sides of a seam, and bad wishes are
// told.
#include <gmock/gmock.h>

#include <cmath>
#include <map>

#include "files/image_read.h"
#include "files/solution_file.h"
#include "goldthread/compare.h"
#include "math/colour.h"
#include "math/tone_map.h"
#include "scene/light_atlas_lookup.h"
#include "scene/lighting_lookup.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

BakeOptions mapped(const std::string& input, std::vector<std::string> outputs, uint32_t page = 256) {
  BakeOptions options = draft(input, std::move(outputs));
  options.mode = OutputMode::kLightmap;
  options.lightmap.page_size = page;
  return options;
}

Solution solution_of(const std::string& file) {
  Result<Solution> solution = read_solution(file);
  if (!solution) throw std::runtime_error(solution.error().line());
  return *std::move(solution);
}

TEST(Lightmap, TexelsHoldTheLightThatThePathTracerFinds) {
  const TempFolder folder;
  BakeOptions options = mapped(made(folder, "cornell-box"), {folder.path("a.gold")});
  options.quality = Quality::kMedium;
  baked(options);
  CompareOptions compare_options;
  compare_options.first = options.outputs[0];
  compare_options.reference = compare_options.texels = true;
  compare_options.points = 1500;
  compare_options.samples = 512;
  const Result<CompareResult> result = compare(compare_options);
  ASSERT_TRUE(result) << result.error().line();
  const json figures = json::parse(result->json);
  EXPECT_LT(figures["relative_rmse"].get<double>(), 0.06);
  EXPECT_GT(figures["points"].get<int>(), 1200);
}

TEST(Lightmap, FilesOpenEverywhereAndSayWhatIsInThem) {
  const TempFolder folder;
  BakeOptions options = mapped(made(folder, "two-rooms"), {folder.path("a.glb"), folder.path("b.gltf")});
  options.lightmap.files = folder.path("room.exr");
  options.lightmap.pages = 2;
  options.lightmap.texel_density = 20;
  const BakeResult result = baked(options);
  for (const std::string& file : options.outputs) expect_valid(file);
  const json report = json::parse(result.json), atlas = report["atlas"];
  EXPECT_EQ(atlas["pages"], 2);
  EXPECT_EQ(atlas["texels_per_metre"], 20);
  EXPECT_GT(atlas["use"], 0.3);
  EXPECT_LE(atlas["most_stretch"], 2.001);
  const json list = json::parse(bytes_of_file(folder.path("room.json")));
  ASSERT_EQ(list["pages"].size(), 2u);
  EXPECT_EQ(list["unit"], "lux");
  const WrittenGltf written(options.outputs[0]);
  for (const json& page : list["pages"]) {
    const Result<FloatImage> image = read_picture(folder.path(page["file"]));
    ASSERT_TRUE(image) << image.error().line();
    EXPECT_EQ(image->width, 256u);
  }
  // As the report says: the intensity of a page is no more than its greatest light.
  for (const json& material : written.json["materials"]) {
    if (!material.contains("extensions") || !material["extensions"].contains("MOZ_lightmap")) continue;
    const size_t texture = material["extensions"]["MOZ_lightmap"]["index"];
    const size_t page = written.json["textures"][texture]["name"] == "light map 0" ? 0 : 1;
    EXPECT_LE(material["extensions"]["MOZ_lightmap"]["intensity"].get<double>(),
              list["pages"][page]["most"].get<double>() * 1.00001);
  }
}

TEST(Lightmap, EveryEncodingOfMapFilesSaysHowItIsRead) {
  const TempFolder folder;
  const std::string scene = made(folder, "cornell-box");
  const auto bake_to = [&](const std::string& file, std::optional<MapEncoding> encoding) {
    BakeOptions options = mapped(scene, {}, 64);
    options.lightmap.files = folder.path(file);
    options.lightmap.encoding = encoding;
    baked(options);
    return json::parse(bytes_of_file(folder.path(file.substr(0, file.size() - 4) + ".json")));
  };
  EXPECT_EQ(bake_to("float.exr", {})["encoding"], "linear float");
  EXPECT_EQ(bake_to("half.exr", MapEncoding::kHalf)["encoding"], "linear half");
  const Result<FloatImage> whole = read_picture(folder.path("float-0.exr")),
                           half = read_picture(folder.path("half-0.exr"));
  ASSERT_TRUE(whole && half);
  bool rounded = false;
  for (size_t i = 0; i < whole->pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(half->pixels[i][c], whole->pixels[i][c], whole->pixels[i][c] / 2048 + 1e-6f);
      rounded = rounded || half->pixels[i][c] != whole->pixels[i][c];
    }
  EXPECT_TRUE(rounded);
  const json rgbm = bake_to("m.png", {});
  EXPECT_EQ(rgbm["encoding"], "linear rgbm");
  EXPECT_GT(rgbm["pages"][0]["scale"].get<double>(), 100);
  EXPECT_EQ(bake_to("d.png", MapEncoding::kRgbd)["encoding"], "linear rgbd");
  EXPECT_EQ(bake_to("e.png", MapEncoding::kRgbe)["pages"][0]["scale"], 1);
  EXPECT_EQ(bake_to("s.png", MapEncoding::kSrgb)["encoding"], "srgb");

  BakeOptions bright = mapped(scene, {}, 64);
  bright.sky = {1e6f, 1e6f, 1e6f};
  bright.lightmap.files = folder.path("bright.exr");
  EXPECT_THAT(baked(bright).warnings, Not(Contains(HasSubstr("half floats end"))));
  bright.lightmap.encoding = MapEncoding::kHalf;
  EXPECT_THAT(baked(bright).warnings, Contains(HasSubstr("half floats end at 65504 lx")));

  BakeOptions wrong = mapped(scene, {}, 64);
  wrong.lightmap.files = folder.path("a.exr");
  wrong.lightmap.encoding = MapEncoding::kRgbm;
  const Result<BakeResult> refused = bake(wrong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_THAT(refused.error().line(), HasSubstr(".png rgbm"));
}

/// Two places of one point of the world, on different charts.
struct SeamPair {
  vec3 first, second;
};

/// Along every edge that two triangles share but not their place on a page: what the maps show on both sides,
/// where the light itself is one.
std::vector<SeamPair> seams_of(const Solution& solution) {
  const LightAtlasLookup maps(solution.scene, *solution.atlas);
  const LightingLookup truth(solution.scene, solution.lighting);
  struct Side {
    uint32_t instance, primitive, triangle;
    int corner;
    bool forward;
    vec2 at[2];
  };
  using Key = std::array<float, 6>;
  std::map<Key, std::vector<Side>> edges;
  for (const MappedMesh& mesh : solution.atlas->meshes) {
    if (mesh.back) continue;
    const Instance& instance = solution.scene.instances[mesh.instance];
    const Primitive& source = solution.scene.meshes[instance.mesh].primitives[mesh.primitive];
    for (size_t f = 0; f < mesh.faces.size(); ++f)
      for (int k = 0; k < 3; ++k) {
        const auto corner = [&](int c) {
          return vec3(instance.transform *
                      vec4(source.positions[source.indices[3 * mesh.face_parents[f] + size_t(c % 3)]], 1));
        };
        vec3 a = corner(k), b = corner(k + 1);
        const bool forward = std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
        if (!forward) std::swap(a, b);
        edges[{a.x, a.y, a.z, b.x, b.y, b.z}].push_back(
            {mesh.instance,
             mesh.primitive,
             mesh.face_parents[f],
             k,
             forward,
             {mesh.coordinates[mesh.faces[f][k]], mesh.coordinates[mesh.faces[f][(k + 1) % 3]]}});
      }
  }
  std::vector<SeamPair> pairs;
  for (const auto& [key, sides] : edges) {
    if (sides.size() != 2) continue;
    const Side &one = sides[0], &other = sides[1];
    const int o = one.forward == other.forward ? 0 : 1;
    if (one.at[0] == other.at[o] && one.at[1] == other.at[1 - o]) continue;  // neighbours on one chart
    for (float share = 0.05f; share < 1; share += 0.1f) {
      const auto read = [&](const Side& side, const auto& from) {
        vec3 weights(0);
        weights[side.corner] = side.forward ? 1 - share : share;
        weights[(side.corner + 1) % 3] = side.forward ? share : 1 - share;
        return *from.irradiance(side.instance, side.primitive, side.triangle, vec2(weights.y, weights.z),
                                false);
      };
      if (glm::distance(read(one, truth), read(other, truth)) > 1e-4f * glm::length(read(one, truth)))
        continue;
      pairs.push_back({read(one, maps), read(other, maps)});
    }
  }
  return pairs;
}

TEST(Lightmap, SeamsDoNotShow) {
  // A ball in the box: its charts meet where its light runs on.
  const TempFolder folder;
  const std::string ball = made(folder, "sphere", 2000);
  BakeOptions options = mapped(ball, {folder.path("a.gold")}, 512);
  options.sky = {1000, 1000, 1000};
  options.sun.emplace();
  const Result<BakeResult> result = bake(options);
  ASSERT_TRUE(result) << result.error().line();
  const Solution solution = solution_of(options.outputs[0]);
  const std::vector<SeamPair> pairs = seams_of(solution);
  ASSERT_GT(pairs.size(), 50u);
  std::vector<vec3> shown;
  for (const SeamPair& pair : pairs) shown.push_back(0.5f / kPi * pair.first);
  const ToneMap map = choose_tone_map(shown);
  size_t beyond = 0;
  for (const SeamPair& pair : pairs) {
    const vec3 a = map(0.5f / kPi * pair.first), b = map(0.5f / kPi * pair.second);
    for (int c = 0; c < 3; ++c) beyond += std::abs(linear_to_srgb(a[c]) - linear_to_srgb(b[c])) > 2.0f / 255;
  }
  EXPECT_EQ(beyond, 0u) << "of " << 3 * pairs.size();
}

TEST(Lightmap, BakedScenesShowInAnyViewer) {
  const TempFolder folder;
  BakeOptions options = mapped(made(folder, "cornell-box"), {folder.path("a.glb")}, 128);
  options.mode = OutputMode::kBaked;
  baked(options);
  expect_valid(options.outputs[0]);
  const WrittenGltf written(options.outputs[0]);
  size_t unlit = 0;
  for (const json& mesh : written.json["meshes"])
    for (const json& primitive : mesh["primitives"]) {
      const json& material = written.json["materials"][primitive["material"].get<size_t>()];
      ASSERT_TRUE(material["extensions"].contains("KHR_materials_unlit"));
      const size_t set = material["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"];
      EXPECT_TRUE(primitive["attributes"].contains("TEXCOORD_" + std::to_string(set)));
      ++unlit;
    }
  EXPECT_EQ(unlit, 8u);
}

TEST(Lightmap, TheSameBytesForAnyNumberOfThreads) {
  const TempFolder folder;
  const std::string input = made(folder, "office");
  std::string bytes[2];
  for (int threads = 1; threads <= 2; ++threads) {
    BakeOptions options = mapped(input, {folder.path("a.glb")});
    options.threads = threads;
    options.error = 0.5;
    baked(options);
    bytes[threads - 1] = bytes_of_file(options.outputs[0]);
  }
  EXPECT_FALSE(bytes[0].empty());
  EXPECT_TRUE(bytes[0] == bytes[1]);
}

TEST(Lightmap, WhatDoesNotFitIsRefusedOrLoweredAndTold) {
  const TempFolder folder;
  const std::string input = made(folder, "office");
  BakeOptions options = mapped(input, {folder.path("a.glb")}, 16);
  options.error = 0.5;
  const Result<BakeResult> refused = bake(options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kLimit);
  EXPECT_THAT(refused.error().line(), HasSubstr("--page-size"));
  EXPECT_FALSE(std::filesystem::exists(options.outputs[0]));
  options.lightmap.page_size = 128;
  options.lightmap.texel_density = 1000;
  const BakeResult lowered = baked(options);
  EXPECT_THAT(lowered.warnings, ::testing::Contains(HasSubstr("texels a metre instead of 1000")));
}

TEST(Lightmap, WishesThatMakeNoSense) {
  const TempFolder folder;
  const std::string input = made(folder, "cornell-box");
  const auto line_of = [&](const std::function<void(LightmapOptions&)>& spoil) {
    BakeOptions options = mapped(input, {folder.path("a.glb")});
    spoil(options.lightmap);
    const Result<BakeResult> result = bake(options);
    EXPECT_FALSE(result);
    EXPECT_EQ(result ? ErrorCode::kLimit : result.error().code, ErrorCode::kUsage);
    return result ? std::string() : result.error().line();
  };
  EXPECT_THAT(line_of([](LightmapOptions& o) { o.page_size = 0; }), HasSubstr("--page-size"));
  EXPECT_THAT(line_of([](LightmapOptions& o) { o.page_size = 100000; }), HasSubstr("--page-size"));
  EXPECT_THAT(line_of([](LightmapOptions& o) { o.pages = 0; }), HasSubstr("--pages"));
  EXPECT_THAT(line_of([](LightmapOptions& o) { o.padding = 1000; }), HasSubstr("--padding"));
  EXPECT_THAT(line_of([](LightmapOptions& o) { o.texel_density = -1; }), HasSubstr("--texel-density"));
  EXPECT_THAT(line_of([](LightmapOptions& o) { o.texel_density = std::nan(""); }),
              HasSubstr("--texel-density"));
  EXPECT_THAT(line_of([](LightmapOptions& o) { o.files = "maps.bmp"; }), HasSubstr(".exr, .hdr or .png"));
}

TEST(Lightmap, ASolutionWithoutMapsSaysSo) {
  const TempFolder folder;
  const BakeOptions options = draft(made(folder, "cornell-box"), {folder.path("a.gold")});
  baked(options);
  CompareOptions compare_options;
  compare_options.first = options.outputs[0];
  compare_options.reference = compare_options.light_maps = true;
  const Result<CompareResult> result = compare(compare_options);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().line(), HasSubstr("--output lightmap"));
}

TEST(Lightmap, WhatWasBakedBakesAgainTheSame) {
  // A lamp that is off in the file is on for us, and the map that is there is replaced.
  const TempFolder folder;
  GltfBuilder b = lit_floor();
  b.doc["extensionsUsed"] = {"KHR_lights_punctual"};
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 300.0}}};
  b.push("nodes", {{"translation", {0.5, 1, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const std::string input = folder.write("scene.glb", to_glb(b));
  BakeOptions options = mapped(input, {folder.path("first.glb"), folder.path("first.gold")});
  baked(options);
  options.input = options.outputs[0];
  options.outputs = {folder.path("second.glb"), folder.path("second.gold")};
  baked(options);
  expect_valid(options.outputs[0]);
  const Solution first = solution_of(folder.path("first.gold")),
                 second = solution_of(folder.path("second.gold"));
  ASSERT_EQ(first.atlas->pages.size(), second.atlas->pages.size());
  const auto most = [](const Solution& s) {
    float most = 0;
    for (const vec3& pixel : s.atlas->pages[0].irradiance.pixels) most = std::max(most, pixel.x);
    return most;
  };
  EXPECT_GT(most(first), 50);
  EXPECT_NEAR(most(second) / most(first), 1, 0.02);
}

}  // namespace
}  // namespace goldthread
