// Real scenes made by others, baked at draft quality: they end well, in balance, and valid.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "files/solution_file.h"
#include "math/colour.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;

struct SharedScene {
  const char* name;
  bool sky;  ///< has no lamps of its own
};
void PrintTo(const SharedScene& scene, std::ostream* out) {
  *out << scene.name;
}

class Shared : public ::testing::TestWithParam<SharedScene> {};
class SharedPower : public Shared {};

/// Options for the scene that the test is about, or none when it is not here.
std::optional<BakeOptions> options_for(const SharedScene& scene, const TempFolder& folder, Quality quality) {
  const std::string input = std::string(GOLDTHREAD_SHARED) + "/scenes/" + scene.name + ".glb";
  if (!std::filesystem::exists(input)) return {};
  BakeOptions options = draft(input, {folder.path("lit.glb")});
  options.quality = quality;
  if (scene.sky) options.sky = {1000, 1000, 1000};
  return options;
}

/// The power that is unaccounted for, as a share of what is emitted.
double lost_power(const nlohmann::json& report) {
  const double emitted = report["power_lm"]["emitted"];
  EXPECT_GT(emitted, 0);
  return report["power_lm"]["residual"].get<double>() / emitted;
}

TEST_P(Shared, BakesAtDraft) {
  const TempFolder folder;
  const auto options = options_for(GetParam(), folder, Quality::kDraft);
  if (!options) GTEST_SKIP() << "the shared scenes are not here";
  const BakeResult result = baked(*options);
  ASSERT_FALSE(result.json.empty());
  const nlohmann::json report = nlohmann::json::parse(result.json);
  EXPECT_TRUE(report["converged"].get<bool>());
  EXPECT_LE(std::abs(lost_power(report)), 0.25);  // a sketch; medium has to keep its books
  const WrittenGltf lit(options->outputs[0]);
  size_t values = 0;
  for (const auto& mesh : lit.json["meshes"])
    for (const auto& primitive : mesh["primitives"]) {
      if (!primitive["attributes"].contains("_IRRADIANCE")) continue;
      for (const float v : lit.values(primitive["attributes"]["_IRRADIANCE"])) {
        ASSERT_TRUE(std::isfinite(v) && v >= 0) << v;
        ++values;
      }
    }
  EXPECT_GT(values, 0u);
}

/// Where a vertex of a lit primitive lies in the world.
vec3 position(const Scene& scene, const LitPrimitive& lit, uint32_t vertex) {
  const Instance& instance = scene.instances[lit.instance];
  const Primitive& source = scene.meshes[instance.mesh].primitives[lit.primitive];
  vec3 at(0);
  if (lit.source_mesh) {
    at = source.positions[vertex];
  } else {
    const VertexOrigin& origin = lit.origins[vertex];
    const uint32_t* corner = &source.indices[3 * size_t{origin.triangle}];
    at = (1 - origin.weights.x - origin.weights.y) * source.positions[corner[0]] +
         origin.weights.x * source.positions[corner[1]] + origin.weights.y * source.positions[corner[2]];
  }
  return vec3(instance.transform * vec4(at, 1));
}

// The roof of the atrium, under which ledges as long as it run just below its plane.
TEST(SharedSponza, WhatSeesTheSkyAloneHasAllOfIt) {
  const TempFolder folder;
  const auto options = options_for({"sponza", true}, folder, Quality::kDraft);
  if (!options) GTEST_SKIP() << "the shared scenes are not here";
  BakeOptions open = *options;
  open.outputs = {folder.path("lit.gold")};
  open.sky = {10000, 10000, 10000};
  open.sun = LightOptions::Sun();
  baked(open);
  const Result<Solution> solution = read_solution(open.outputs[0]);
  ASSERT_TRUE(solution) << solution.error().line();
  const Scene& scene = solution->scene;
  float top = -INFINITY;
  for (const LitPrimitive& lit : solution->lighting.primitives)
    for (uint32_t v = 0; v < lit.irradiance.size(); ++v) top = std::max(top, position(scene, lit, v).y);
  const double whole = 100000 * std::sqrt(0.5) + 10000 * static_cast<double>(kPi);
  size_t vertices = 0;
  for (const LitPrimitive& lit : solution->lighting.primitives) {
    const Primitive& source = scene.meshes[scene.instances[lit.instance].mesh].primitives[lit.primitive];
    const size_t faces = lit.source_mesh ? source.triangle_count() : lit.faces.size();
    for (size_t f = 0; f < faces; ++f) {
      UVec3 face(0);
      for (int k = 0; k < 3; ++k)
        face[k] = lit.source_mesh ? source.indices[3 * f + static_cast<size_t>(k)] : lit.faces[f][k];
      vec3 corner[3];
      for (int k = 0; k < 3; ++k) corner[k] = position(scene, lit, face[k]);
      const vec3 normal = cross(corner[1] - corner[0], corner[2] - corner[0]);
      if (!(normal.y > 0) || std::min({corner[0].y, corner[1].y, corner[2].y}) < top - 1e-3f) continue;
      for (int k = 0; k < 3; ++k) {
        EXPECT_NEAR(luminance(lit.irradiance[face[k]]), whole, 0.02 * whole)
            << corner[k].x << " " << corner[k].z;
        ++vertices;
      }
    }
  }
  EXPECT_GT(vertices, 100u);
}

TEST_P(SharedPower, IsKeptAtMedium) {
  const TempFolder folder;
  const auto options = options_for(GetParam(), folder, Quality::kMedium);
  if (!options) GTEST_SKIP() << "the shared scenes are not here";
  const BakeResult result = baked(*options);
  ASSERT_FALSE(result.json.empty());
  EXPECT_NEAR(lost_power(nlohmann::json::parse(result.json)), 0, 0.01);
}

std::string test_name(const ::testing::TestParamInfo<SharedScene>& info) {
  std::string name(info.param.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

const SharedScene kQuick[] = {
    {"cornell-original", false}, {"cornell-sphere", false}, {"sponza", true}, {"conference-lit", false},
    {"small-house", false},      {"chess-room", false},     {"house", true},  {"jpm", true},
    {"as1-oc-214", true}};
const SharedScene kSlow[] = {{"bathroom", false}, {"sportscar-room", false}, {"engine-room", false}};

INSTANTIATE_TEST_SUITE_P(Scenes, Shared, ::testing::ValuesIn(kQuick), test_name);
INSTANTIATE_TEST_SUITE_P(SlowScenes, Shared, ::testing::ValuesIn(kSlow), test_name);
INSTANTIATE_TEST_SUITE_P(Scenes, SharedPower, ::testing::ValuesIn(kQuick), test_name);
INSTANTIATE_TEST_SUITE_P(SlowScenes, SharedPower, ::testing::ValuesIn(kSlow), test_name);

}  // namespace
}  // namespace goldthread
