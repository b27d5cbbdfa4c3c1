// How hard a bake tries for a tolerated error, and what it says it reached.
#include "session/effort.h"

#include <gmock/gmock.h>

#include "goldthread/compare.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;

TEST(Effort, PresetsAreErrors) {
  for (const Quality q : {Quality::kDraft, Quality::kMedium, Quality::kHigh, Quality::kFinal})
    EXPECT_EQ(effort_for(tolerated_error(q)).reconstruct.error, tolerated_error(q));
  const Effort high = effort_for(0.03);
  EXPECT_EQ(high.solve.last_error, 3e-6);
  EXPECT_EQ(high.solve.least_area, 6e-6);
  EXPECT_EQ(high.reconstruct.light_rays, 256u);
}

// Half the error never takes less of anything; beyond the presets, too.
TEST(Effort, LessErrorTakesMore) {
  Effort before = effort_for(kMostError);
  for (double error = kMostError / 1.1; error > kLeastError; error /= 1.1) {
    const Effort now = effort_for(error);
    EXPECT_LT(now.solve.last_error, before.solve.last_error) << error;
    EXPECT_LT(now.solve.least_area, before.solve.least_area) << error;
    EXPECT_GE(now.reconstruct.light_rays, before.reconstruct.light_rays) << error;
    EXPECT_LE(now.reconstruct.ray_share, before.reconstruct.ray_share) << error;
    EXPECT_GE(now.reconstruct.growth, before.reconstruct.growth) << error;
    before = now;
  }
}

nlohmann::json compared_with_reference(const std::string& gold) {
  CompareOptions options;
  options.first = gold;
  options.reference = true;
  options.points = 2000;
  options.samples = 1024;
  const Result<CompareResult> result = compare(options);
  if (!result) ADD_FAILURE() << result.error().line();
  return result ? nlohmann::json::parse(result->json) : nlohmann::json();
}

class StatedError : public ::testing::TestWithParam<std::pair<const char*, double>> {};

// What the report says the light is off by, against path tracing, which knows nothing of it.
TEST_P(StatedError, IsAboutWhatTheReferenceFinds) {
  const TempFolder folder;
  BakeOptions options;
  options.input = made(folder, GetParam().first);
  options.outputs = {folder.path("x.gold")};
  options.error = GetParam().second;
  const BakeResult result = baked(options);
  const double stated = nlohmann::json::parse(result.json)["solver"]["error_estimate"];
  const double found = compared_with_reference(options.outputs[0])["relative_rmse"];
  EXPECT_GT(stated, 0.6 * found);
  EXPECT_LT(stated, 1.7 * found);
  EXPECT_LT(found, GetParam().second);
}

INSTANTIATE_TEST_SUITE_P(Scenes, StatedError,
                         ::testing::Values(std::pair("cornell-box", 0.15), std::pair("cornell-box", 0.05),
                                           std::pair("two-rooms", 0.1)));

TEST(StatedError, AskedForAndNotReachedItIsSaid) {
  EXPECT_EQ(missed_error(0.02, 0.019), "");
  EXPECT_THAT(missed_error(0.02, 0.031), ::testing::HasSubstr("3.1% off where 2% were asked for"));
  EXPECT_THAT(missed_error(0.02, std::nullopt), ::testing::HasSubstr("stopped before"));
}

TEST(StatedError, StoppedNothingIsStated) {
  const TempFolder folder;
  BakeOptions options;
  options.input = made(folder, "cornell-box");
  options.outputs = {folder.path("x.gold")};
  options.error = 0.004;
  options.time_limit = 2;
  const BakeResult result = baked(options);
  EXPECT_THAT(result.warnings, ::testing::Contains(::testing::HasSubstr("is within 0.4%")));
  EXPECT_TRUE(nlohmann::json::parse(result.json)["solver"]["error_estimate"].is_null());
}

TEST(StatedError, WhatCannotBeAimedAt) {
  const TempFolder folder;
  BakeOptions options;
  options.input = made(folder, "cornell-box");
  options.outputs = {folder.path("x.gold")};
  for (const double error : {0.0, -0.1, 0.001, 2.0, std::nan("")}) {
    options.error = error;
    const Result<BakeResult> result = bake(options);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kUsage);
    EXPECT_THAT(result.error().line(), ::testing::HasSubstr("0.3% to 50%"));
  }
}

}  // namespace
}  // namespace goldthread
