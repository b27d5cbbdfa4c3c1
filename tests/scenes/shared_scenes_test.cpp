// Real scenes made by others, baked at draft quality: they end well, in balance, and valid.
#include <gtest/gtest.h>

#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;

struct SharedScene {
  const char* name;
  bool sky;  ///< has no lamps of its own
};

class Shared : public ::testing::TestWithParam<SharedScene> {};

TEST_P(Shared, BakesAtDraft) {
  const std::string input = std::string(GOLDTHREAD_SHARED) + "/scenes/" + GetParam().name + ".glb";
  if (!std::filesystem::exists(input)) GTEST_SKIP() << "the shared scenes are not here: " << input;
  const TempFolder folder;
  BakeOptions options = draft(input, {folder.path("lit.glb")});
  options.time_limit = 60;
  if (GetParam().sky) options.sky = {1000, 1000, 1000};
  const BakeResult result = baked(options);
  ASSERT_FALSE(result.json.empty());
  const nlohmann::json report = nlohmann::json::parse(result.json);
  const double emitted = report["power_lm"]["emitted"], residual = report["power_lm"]["residual"];
  EXPECT_GT(emitted, 0);
  // One percent is the promise of medium; draft may have three times that.
  EXPECT_LE(std::abs(residual), 0.03 * emitted) << 100 * residual / emitted << "%";
  const WrittenGltf lit(options.outputs[0]);
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
