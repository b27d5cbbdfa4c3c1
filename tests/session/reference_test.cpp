// The path tracer from outside: files in, files out, and everything that can be wrong with them.
#include "goldthread/reference.h"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "files/image_read.h"
#include "files/image_write.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::HasSubstr;
using Json = nlohmann::json;

Json json_of(const std::string& file) {
  return Json::parse(bytes_of_file(file));
}

ReferenceResult traced(const ReferenceOptions& options, const BakeListener& listener = {}) {
  Result<ReferenceResult> result = reference(options, listener);
  if (result) return *std::move(result);
  ADD_FAILURE() << result.error().line();
  return {};
}

ReferenceOptions points_of(const std::string& scene, uint64_t count, uint64_t samples) {
  ReferenceOptions options;
  options.input = scene;
  options.random_points = count;
  options.samples = samples;
  return options;
}

TEST(Reference, WritesPointsWithErrors) {
  const TempFolder folder;
  ReferenceOptions options = points_of(made(folder, "furnace"), 40, 1024);
  options.json_file = folder.path("points.json");
  options.report_file = folder.path("report.json");
  const ReferenceResult result = traced(options);
  EXPECT_THAT(result.summary, HasSubstr("40 points, 1024 samples each"));
  const Json json = json_of(options.json_file);
  ASSERT_EQ(json["points"].size(), 40u);
  double sum = 0, squares = 0;
  for (const Json& point : json["points"]) {
    EXPECT_EQ(point["point"].size(), 3u);
    EXPECT_EQ(point["normal"].size(), 3u);
    EXPECT_EQ(point["samples"], 1024);
    sum += point["irradiance"][1].get<double>();
    squares += std::pow(point["standard_error"][1].get<double>(), 2);
  }
  EXPECT_NEAR(sum / 40, 2, 3 * std::sqrt(squares) / 40);
  for (const char* file : {"points.json", "report.json"}) {
    const Json figures = json_of(folder.path(file));
    EXPECT_GT(figures["rays"].get<double>(), 40 * 1024);
    EXPECT_GT(figures["seconds"].get<double>(), 0);
    EXPECT_NEAR(figures["mrays_per_second"].get<double>(),
                figures["rays"].get<double>() / figures["seconds"].get<double>() * 1e-6, 1e-6);
    EXPECT_GT(figures["ray_time_share"].get<double>(), 0);
    EXPECT_LE(figures["ray_time_share"].get<double>(), 1);
    EXPECT_EQ(figures["seed"], 0);
    EXPECT_EQ(figures["stopped_by"], "samples");
  }
  EXPECT_EQ(json_of(options.report_file).count("points"), 0u);
}

TEST(Reference, ResumedFilesHoldTheSameNumbers) {
  const TempFolder folder;
  ReferenceOptions options = points_of(made(folder, "cornell-box"), 10, 512);
  options.seed = 5;
  options.json_file = folder.path("whole.json");
  traced(options);
  options.samples = 256;
  options.json_file = folder.path("part.json");
  traced(options);
  ReferenceOptions more;
  more.input = options.input;
  more.resume_file = options.json_file;
  more.json_file = options.json_file;  // in place
  more.samples = 512;
  traced(more);
  const Json whole = json_of(folder.path("whole.json")), resumed = json_of(more.json_file);
  EXPECT_EQ(resumed["points"], whole["points"]);
  EXPECT_EQ(resumed["rays"], whole["rays"]);
  EXPECT_EQ(resumed["seed"], 5);
}

TEST(Reference, ResumesOnlyWhatIsTheSame) {
  const TempFolder folder;
  ReferenceOptions options = points_of(made(folder, "furnace"), 2, 16);
  options.json_file = folder.path("points.json");
  traced(options);
  ReferenceOptions more;
  more.input = options.input;
  more.resume_file = options.json_file;
  const auto error_line = [&] {
    const Result<ReferenceResult> result = reference(more);
    return result ? std::string() : result.error().line();
  };
  EXPECT_EQ(error_line(), "");
  more.seed = 1;
  EXPECT_THAT(error_line(), HasSubstr("--seed 1"));
  more.seed.reset();
  more.sky = {{1, 1, 1}};
  EXPECT_THAT(error_line(), HasSubstr("points.json: was made of another scene"));
  more.sky.reset();
  more.input = made(folder, "sphere");
  EXPECT_THAT(error_line(), HasSubstr("points.json: was made of another scene"));
  more.input = options.input;
  Json spoiled = json_of(options.json_file);
  spoiled["points"][1]["batch_sums"].erase(3);
  more.resume_file = folder.write("spoiled.json", spoiled.dump());
  EXPECT_THAT(error_line(), HasSubstr("spoiled.json: point 1"));
  more.resume_file = folder.write("other.json", "{}");
  EXPECT_THAT(error_line(), HasSubstr("other.json"));
}

TEST(Reference, MeasuresGivenPoints) {
  const TempFolder folder;
  ReferenceOptions options;
  options.input = made(folder, "furnace");
  options.points_file = folder.write("points.json", R"([{"point": [0.1, -0.5, 0.2], "normal": [0, 3, 0]},
                                      {"point": [0.5, 0, 0], "normal": [-1, 0, 0]}])");
  options.samples = 1024;
  options.json_file = folder.path("out.json");
  traced(options);
  const Json json = json_of(options.json_file);
  ASSERT_EQ(json["points"].size(), 2u);
  EXPECT_EQ(json["points"][0]["normal"], Json({0.0, 1.0, 0.0}));
  for (const Json& point : json["points"])
    EXPECT_NEAR(point["irradiance"][0].get<double>(), 2, 3 * point["standard_error"][0].get<double>());
}

TEST(Reference, MeasuresVertices) {
  const TempFolder folder;
  ReferenceOptions options;
  options.input = made(folder, "furnace");
  options.vertices = true;
  options.samples = 256;
  options.json_file = folder.path("out.json");
  traced(options);
  const Json json = json_of(options.json_file);
  ASSERT_GE(json["points"].size(), 8u);
  double sum = 0, squares = 0;
  for (const Json& point : json["points"]) {
    EXPECT_TRUE(point.contains("vertex"));
    sum += point["irradiance"][0].get<double>();
    squares += std::pow(point["standard_error"][0].get<double>(), 2);
  }
  const auto count = static_cast<double>(json["points"].size());
  EXPECT_NEAR(sum / count, 2, 3 * std::sqrt(squares) / count);  // in the corners of the cube, too
}

TEST(Reference, PaintsPictures) {
  const TempFolder folder;
  ReferenceOptions options;
  options.input = made(folder, "cornell-box");
  options.pictures = {folder.path("box.png"), folder.path("box.exr")};
  options.picture_width = 32;
  options.samples = 16;
  const ReferenceResult result = traced(options);
  EXPECT_EQ(result.written, options.pictures);
  EXPECT_EQ(bytes_of_file(options.pictures[0]).substr(1, 3), "PNG");
  EXPECT_GT(bytes_of_file(options.pictures[1]).size(), 32u * 12);
}

TEST(Reference, PicturesAreGoneOnWith) {
  const TempFolder folder;
  ReferenceOptions options;
  options.input = made(folder, "cornell-box");
  options.pictures = {folder.path("whole.exr")};
  options.picture_width = 24;
  options.samples = 96;
  options.seed = 5;
  traced(options);
  options.pictures = {folder.path("part.exr")};
  options.samples = 32;
  traced(options);
  options.picture_width = ReferenceOptions().picture_width;
  options.seed = {};
  options.resume_file = options.pictures[0];
  options.samples = 96;
  const Json report = Json::parse(traced(options).report);
  EXPECT_EQ(report["samples"]["least"], 96);
  EXPECT_EQ(report["seed"], 5);
  const FloatImage whole = *read_picture(folder.path("whole.exr")), part = *read_picture(options.pictures[0]);
  ASSERT_EQ(part.pixels.size(), whole.pixels.size());
  for (size_t i = 0; i < part.pixels.size(); ++i)
    for (int k = 0; k < 3; ++k)
      EXPECT_NEAR(part.pixels[i][k], whole.pixels[i][k], 1e-6f * whole.pixels[i][k]) << i;
}

TEST(Reference, StopsWhenAskedAndWritesWhatThereIs) {
  const TempFolder folder;
  ReferenceOptions options = points_of(made(folder, "cornell-box"), 100, 1'000'000'000);
  options.json_file = folder.path("points.json");
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  BakeListener listener;
  listener.cancelled = [&] { return elapsed() > 0.5; };
  const ReferenceResult result = traced(options, listener);
  EXPECT_TRUE(result.cancelled);
  EXPECT_LT(elapsed(), 1.5);
  const Json json = json_of(options.json_file);
  EXPECT_EQ(json["stopped_by"], "cancelled");
  EXPECT_GT(json["points"][0]["samples"], 0);
  options.time_limit = 0.5;
  options.samples.reset();
  EXPECT_EQ(Json::parse(traced(options).report)["stopped_by"], "time_limit");
  options.time_limit.reset();
  options.target_error = 0.1;
  const Json report = Json::parse(traced(options).report);
  EXPECT_EQ(report["stopped_by"], "target_error");
  EXPECT_LE(report["mean_relative_error"].get<double>(), 0.1);
}

/// The error, and that nothing is left behind.
Error error_of(const ReferenceOptions& options, const TempFolder& folder) {
  const std::set<std::string> before = names_in(folder.path(""));
  const Result<ReferenceResult> result = reference(options);
  EXPECT_EQ(names_in(folder.path("")), before);
  if (result) {
    ADD_FAILURE() << "was traced";
    return {};
  }
  EXPECT_EQ(result.error().line().find('\n'), std::string::npos);
  EXPECT_FALSE(result.error().cure.empty());
  return result.error();
}

TEST(ReferenceBadInput, PointsAreNamed) {
  const TempFolder folder;
  ReferenceOptions options;
  options.input = made(folder, "furnace");
  options.json_file = folder.path("out.json");
  const auto expect_error = [&](const std::string& text, const std::string& place, const std::string& what) {
    options.points_file = folder.write("list.json", text);
    const Error error = error_of(options, folder);
    EXPECT_EQ(error.code, ErrorCode::kBadInput) << text;
    EXPECT_THAT(error.line(), HasSubstr("list.json")) << text;
    EXPECT_THAT(error.line(), HasSubstr(place)) << text;
    EXPECT_THAT(error.line(), HasSubstr(what)) << text;
  };
  const std::string good = R"({"point": [0, -0.5, 0], "normal": [0, 1, 0]})";
  expect_error("[" + good + R"(, {"point": [0, -0.25, 0], "normal": [0, 1, 0]}])", "point 1",
               "nearest is 0.25 m away");
  expect_error("[" + good + "," + good + R"(, {"point": [0, -0.5, 0], "normal": [0, 0, 0]}])", "point 2",
               "no length");
  expect_error(R"([{"point": [0, -0.5, 0], "normal": [0, null, 0]}])", "point 0", "normal");
  expect_error(R"([{"point": [0, -0.5], "normal": [0, 1, 0]}])", "point 0", "point");
  expect_error(R"([{"point": [0, -0.5, 1e999], "normal": [0, 1, 0]}])", "list.json", "number");
  expect_error(R"([{"point": [0, -0.5, 1e300], "normal": [0, 1, 0]}])", "point 0", "point");
  expect_error(R"([{"normal": [0, 1, 0]}])", "point 0", "point");
  expect_error("[7]", "point 0", "point");
  expect_error("[]", "", "no list");
  expect_error("{}", "", "no list");
  expect_error(R"([{"point": [0, )", "byte", "no JSON");
  expect_error(R"([{"point": [0, -0.5, NaN], "normal": [0, 1, 0]}])", "byte", "no JSON");
  options.points_file = folder.path("absent.json");
  EXPECT_THAT(error_of(options, folder).line(), HasSubstr("absent.json"));
  options.points_file = folder.path("");
  EXPECT_EQ(error_of(options, folder).code, ErrorCode::kBadInput);
}

TEST(ReferenceBadInput, WishesThatMakeNoSense) {
  const TempFolder folder;
  ReferenceOptions options;
  options.input = made(folder, "furnace");
  EXPECT_EQ(error_of(options, folder).code, ErrorCode::kUsage);  // nothing to measure
  options.vertices = true;
  options.random_points = 3;
  EXPECT_EQ(error_of(options, folder).code, ErrorCode::kUsage);  // two things
  options.random_points = 0;
  options.vertices = false;
  options.pictures = {folder.path("x.jpg")};
  EXPECT_EQ(error_of(options, folder).code, ErrorCode::kUsage);
  options.pictures = {folder.path("gone/x.png")};
  EXPECT_EQ(error_of(options, folder).code, ErrorCode::kCannotWrite);
  options = points_of(folder.write("dark.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), 3, 16);
  EXPECT_EQ(error_of(options, folder).code, ErrorCode::kNothingToBake);
  options.input = folder.path("absent.glb");
  EXPECT_EQ(error_of(options, folder).code, ErrorCode::kBadInput);
}

TEST(ReferenceBadInput, PicturesThatCannotBeGoneOnWith) {
  const TempFolder folder;
  ReferenceOptions options;
  options.input = made(folder, "cornell-box");
  options.pictures = {folder.path("a.exr")};
  options.picture_width = 16;
  options.samples = 16;
  traced(options);
  ReferenceOptions more = options;
  more.resume_file = folder.path("a.exr");
  more.pictures.clear();
  EXPECT_THAT(error_of(more, folder).line(), HasSubstr("add -o " + more.resume_file));
  more.pictures = {folder.path("b.exr")};
  more.picture_width = 20;
  EXPECT_EQ(error_of(more, folder).code, ErrorCode::kUsage);
  more.picture_width = 16;
  more.seed = 9;
  EXPECT_EQ(error_of(more, folder).code, ErrorCode::kUsage);
  more.seed = {};
  more.sky = std::array<float, 3>{1, 1, 1};
  EXPECT_EQ(error_of(more, folder).code, ErrorCode::kBadInput);
  more.sky = {};
  ASSERT_TRUE(write_exr(folder.path("plain.exr"), FloatImage{1, 1, {vec3(1)}}));
  more.resume_file = folder.path("plain.exr");
  EXPECT_EQ(error_of(more, folder).code, ErrorCode::kBadInput);
  LayeredImage broken{FloatImage{1, 1, {vec3(1)}}, {{"samples", {7}}, {"error", {0}}}, {}};
  broken.notes = {{"goldthread.seed", "0"}, {"goldthread.scene", "12"}};
  ASSERT_TRUE(write_layered_exr(folder.path("broken.exr"), broken));
  more.resume_file = folder.path("broken.exr");
  EXPECT_EQ(error_of(more, folder).code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace goldthread
