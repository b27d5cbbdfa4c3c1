// Bakes that are stopped: by the user, by the clock, by memory.
#include <gmock/gmock.h>

#include <chrono>

#include "session/baked.h"
#include "session/report.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::Contains;
using ::testing::HasSubstr;
using Clock = std::chrono::steady_clock;

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// A bake that takes minutes if it is let.
BakeOptions long_bake(const TempFolder& folder) {
  BakeOptions options;
  options.input = made(folder, "car", 60000);
  options.outputs = {folder.path("lit.glb"), folder.path("lit.gold")};
  options.quality = Quality::kFinal;
  options.report_file = folder.path("report.json");
  return options;
}

TEST(BakeStops, CancelledWhileSolvingKeepsTheBestSoFar) {
  const TempFolder folder;
  const BakeOptions options = long_bake(folder);
  std::string stage;
  Clock::time_point began, stopped;
  bool solving = false, asked = false;
  BakeListener listener;
  listener.on_progress = [&](const BakeEvent& event) {
    if (event.stage == "solve" && !solving) {
      solving = true;
      began = Clock::now();
    }
  };
  listener.cancelled = [&] {
    if (!solving || since(began) < 1.5) return false;
    if (!asked) stopped = Clock::now();
    asked = true;
    return true;
  };
  const BakeResult result = baked(options, listener);
  ASSERT_TRUE(asked);
  EXPECT_LT(since(stopped), 2);  // a second is promised; writing to a busy disk may take another
  EXPECT_TRUE(result.cancelled);
  EXPECT_EQ(result.written, options.outputs);
  const nlohmann::json report = nlohmann::json::parse(bytes_of_file(options.report_file));
  EXPECT_FALSE(report["converged"].get<bool>());
  const WrittenGltf lit(options.outputs[0]);
  size_t lit_primitives = 0;
  for (const auto& mesh : lit.json["meshes"])
    for (const auto& primitive : mesh["primitives"])
      lit_primitives += primitive["attributes"].contains("_IRRADIANCE");
  EXPECT_GT(lit_primitives, 0u);
  EXPECT_FALSE(bytes_of_file(options.outputs[1]).empty());
}

TEST(BakeStops, CancelledBeforeThereIsLight) {
  const TempFolder folder;
  const BakeOptions options = draft(made(folder, "cornell-box"), {folder.path("lit.glb")});
  BakeListener listener;
  listener.cancelled = [] { return true; };
  const Result<BakeResult> result = bake(options, listener);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(names_in(folder.path("")), std::set<std::string>{"cornell-box.glb"});
}

TEST(BakeStops, TimeLimitIsKeptAndTold) {
  const TempFolder folder;
  BakeOptions options = long_bake(folder);
  options.time_limit = 6;
  const auto start = Clock::now();
  const BakeResult result = baked(options);
  EXPECT_LT(since(start), 7.5);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("time limit")));
  EXPECT_FALSE(nlohmann::json::parse(result.json)["converged"].get<bool>());
  EXPECT_FALSE(result.cancelled);
  EXPECT_EQ(result.written, options.outputs);
}

TEST(BakeStops, MemoryLimitIsKeptAndTold) {
  const TempFolder folder;
  BakeOptions options = long_bake(folder);
  const uint64_t before = peak_memory();
  options.max_memory = before + (uint64_t{100} << 20);
  options.time_limit = 120;
  const BakeResult result = baked(options);
  EXPECT_THAT(result.warnings, Contains(HasSubstr("memory limit")));
  EXPECT_LE(peak_memory(), *options.max_memory);
  EXPECT_EQ(result.written, options.outputs);
}

TEST(BakeStops, EventsComeAtLeastOnceASecond) {
  const TempFolder folder;
  BakeOptions options = draft(made(folder, "two-rooms"), {folder.path("lit.glb")});
  options.quality = Quality::kMedium;
  std::vector<BakeEvent> events;
  BakeListener listener;
  listener.on_progress = [&](const BakeEvent& event) { events.push_back(event); };
  baked(options, listener);
  ASSERT_GE(events.size(), 5u);
  std::set<std::string> stages;
  for (size_t i = 0; i < events.size(); ++i) {
    stages.insert(events[i].stage);
    EXPECT_GE(events[i].share, 0);
    EXPECT_LE(events[i].share, 1);
    if (i == 0) continue;
    EXPECT_GE(events[i].share, events[i - 1].share - 1e-9);
    EXPECT_LE(events[i].seconds - events[i - 1].seconds, 1.5)
        << events[i - 1].stage << " to " << events[i].stage;
  }
  EXPECT_EQ(stages, (std::set<std::string>{"load", "preprocess", "solve", "reconstruct", "write"}));
  EXPECT_EQ(events.back().share, 1);
}

}  // namespace
}  // namespace goldthread
