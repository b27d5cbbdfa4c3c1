// Real scenes made by others, baked at draft quality: they end well, in balance, and valid.
#include <gtest/gtest.h>

#include <optional>

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

TEST_P(Shared, KeepsItsPowerAtMedium) {
  const TempFolder folder;
  const auto options = options_for(GetParam(), folder, Quality::kMedium);
  if (!options) GTEST_SKIP() << "the shared scenes are not here";
  const BakeResult result = baked(*options);
  ASSERT_FALSE(result.json.empty());
  EXPECT_NEAR(lost_power(nlohmann::json::parse(result.json)), 0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Shared,
                         ::testing::Values(SharedScene{"cornell-original", false},
                                           SharedScene{"cornell-sphere", false}, SharedScene{"sponza", true},
                                           SharedScene{"conference-lit", false},
                                           SharedScene{"bathroom", false}, SharedScene{"small-house", false},
                                           SharedScene{"sportscar-room", false},
                                           SharedScene{"engine-room", false},
                                           SharedScene{"chess-room", false}, SharedScene{"house", true},
                                           SharedScene{"jpm", true}, SharedScene{"as1-oc-214", true}),
                         [](const auto& info) {
                           std::string name(info.param.name);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace goldthread
