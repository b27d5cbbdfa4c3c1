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
