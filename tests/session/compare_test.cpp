// Errors of known size, measured.
#include "goldthread/compare.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <sstream>

#include "files/image_write.h"
#include "files/solution_file.h"
#include "session/baked.h"
#include "session/error_measure.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::HasSubstr;

TEST(ErrorMeasure, OfKnownErrors) {
  std::vector<Measured> places;
  for (int i = 0; i < 100; ++i) places.push_back({dvec3(i, 0, 0), 1.1, 1.0, 0});
  for (int i = 0; i < 100; ++i) places.push_back({dvec3(i, 1, 0), 2.7, 3.0, 0});
  places[150].value = 6;  // twice as much
  const ErrorFigures f = measure_errors(places);
  EXPECT_EQ(f.points, 200u);
  EXPECT_NEAR(f.mean_truth, 2, 1e-12);
  EXPECT_NEAR(f.relative_rmse, std::sqrt((100 * 0.01 + 99 * 0.09 + 9) / 200) / 2, 1e-12);
  EXPECT_NEAR(f.bias, (100 * 0.1 - 99 * 0.3 + 3) / 200 / 2, 1e-12);
  EXPECT_NEAR(f.median, 0.1, 1e-12);
  EXPECT_NEAR(f.p99, 0.1, 1e-12);
  EXPECT_NEAR(f.worst_error, 1, 1e-12);
  EXPECT_EQ(f.worst.position, dvec3(50, 1, 0));
}

TEST(ErrorMeasure, TheReferencesNoiseIsTakenOff) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<Measured> right, wrong;
  for (int i = 0; i < 20000; ++i) {
    const double truth = 2 + noise(random);
    right.push_back({dvec3(0), 2, truth, 0.1});
    wrong.push_back({dvec3(0), i % 2 == 0 ? 2.08 : 1.92, truth, 0.1});
  }
  const ErrorFigures exact = measure_errors(right), off = measure_errors(wrong);
  EXPECT_NEAR(exact.reference_noise, 0.05, 1e-4);
  EXPECT_LT(exact.relative_rmse, 0.007);
  EXPECT_NEAR(exact.raw_rmse, 0.05, 0.001);
  EXPECT_NEAR(off.relative_rmse, 0.04, 0.002);
  EXPECT_NEAR(exact.bias, 0, 4 * exact.bias_error);
}

TEST(ErrorMeasure, OfNothingAndOfDarkness) {
  EXPECT_EQ(measure_errors({}).relative_rmse, 0);
  const ErrorFigures dark = measure_errors({{dvec3(0), 1, 0, 0}});
  EXPECT_EQ(dark.relative_rmse, 0);  // nothing to relate it to
}

TEST(ErrorColour, GreyRightBlueUnderRedOver) {
  EXPECT_EQ(error_colour(0, 0.2, 0.4f), vec3(0.4f));
  const vec3 over = error_colour(0.5, 0.2, 0.4f), under = error_colour(-0.2, 0.2, 0.4f);
  EXPECT_GT(over.x, 4 * over.z);
  EXPECT_GT(under.z, 4 * under.x);
}

CompareResult compared(const CompareOptions& options, const BakeListener& listener = {}) {
  Result<CompareResult> result = compare(options, listener);
  if (result) return *std::move(result);
  ADD_FAILURE() << result.error().line();
  return {};
}

std::string gold(const TempFolder& folder, const std::string& name, Quality quality = Quality::kDraft) {
  BakeOptions options;
  options.input = made(folder, name);
  options.outputs = {folder.path(name + ".gold")};
  options.quality = quality;
  baked(options);
  return options.outputs[0];
}

TEST(Compare, ASolutionWithItselfAndWithTwiceItself) {
  const TempFolder folder;
  const std::string file = gold(folder, "cornell-box");
  Result<Solution> solution = read_solution(file);
  ASSERT_TRUE(solution);
  for (LitPrimitive& lit : solution->lighting.primitives)
    for (vec3& e : lit.irradiance) e *= 1.25f;
  ASSERT_TRUE(write_solution(folder.path("bright.gold"), *solution));
  CompareOptions options;
  options.first = options.second = file;
  options.json_file = "-";
  const nlohmann::json same = nlohmann::json::parse(compared(options).json);
  EXPECT_EQ(same["relative_rmse"], 0);
  EXPECT_EQ(same["bias"], 0);
  options.first = folder.path("bright.gold");
  options.picture = folder.path("diff.png");
  options.picture_width = 40;
  const CompareResult result = compared(options);
  const nlohmann::json bright = nlohmann::json::parse(result.json);
  EXPECT_NEAR(bright["bias"].get<double>(), 0.25, 1e-6);
  EXPECT_NEAR(bright["median_relative_error"].get<double>(), 0.25, 1e-6);
  EXPECT_GT(bright["points"].get<double>(), 900);
  EXPECT_GT(bright["points_inside_solids"].get<int>(), 0);  // the floor beneath the blocks
  EXPECT_THAT(result.written, ::testing::Contains(options.picture));
  EXPECT_EQ(bytes_of_file(options.picture).substr(1, 3), "PNG");
}

TEST(Compare, EveryPointIsALine) {
  const TempFolder folder;
  CompareOptions options;
  options.first = options.second = gold(folder, "cornell-box");
  options.points = 100;
  options.csv_file = folder.path("points.csv");
  const nlohmann::json figures = nlohmann::json::parse(compared(options).json);
  std::istringstream lines(bytes_of_file(options.csv_file));
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "x,y,z,nx,ny,nz,value,truth,standard_error,inside_solid");
  int inside = 0, all = 0;
  while (std::getline(lines, line)) {
    ++all;
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    double x, y, z, nx, ny, nz, value, truth, error, in_solid;
    numbers >> x >> y >> z >> nx >> ny >> nz >> value >> truth >> error >> in_solid;
    ASSERT_TRUE(numbers) << line;
    EXPECT_NEAR(nx * nx + ny * ny + nz * nz, 1, 1e-3);
    EXPECT_EQ(value, truth);
    inside += in_solid == 1;
  }
  EXPECT_EQ(all - inside, figures["points"].get<int>());
  EXPECT_EQ(inside, figures["points_inside_solids"].get<int>());
}

TEST(Compare, WhatTheCameraSees) {
  const TempFolder folder;
  CompareOptions options;
  options.first = options.second = gold(folder, "cornell-box");
  options.seen = true;
  options.picture_width = 32;
  options.picture_height = 32;
  options.csv_file = folder.path("points.csv");
  const nlohmann::json figures = nlohmann::json::parse(compared(options).json);
  // The box fills the picture but for a margin around its mouth.
  EXPECT_GT(figures["points"].get<int>(), 700);
  EXPECT_LE(figures["points"].get<int>(), 1024);
  EXPECT_EQ(figures["points_inside_solids"].get<int>(), 0);
  // Nothing that faces away is asked about: the camera looks along +z from before the box.
  std::istringstream lines(bytes_of_file(options.csv_file));
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream numbers(line);
    dvec3 place, normal;
    numbers >> place.x >> place.y >> place.z >> normal.x >> normal.y >> normal.z;
    EXPECT_GT(glm::dot(normal, dvec3(0.278, 0.273, -0.8) - place), 0) << line;
  }
}

TEST(Compare, ACameraThatSeesNothingIsNamed) {
  const TempFolder folder;
  Result<Solution> solution = read_solution(gold(folder, "cornell-box"));
  ASSERT_TRUE(solution);
  ASSERT_EQ(solution->scene.cameras.size(), 1u);
  solution->scene.cameras[0].forward *= -1.0f;
  CompareOptions options;
  options.first = folder.path("away.gold");
  ASSERT_TRUE(write_solution(options.first, *solution));
  options.reference = options.seen = true;
  options.samples = 1;
  const Result<CompareResult> result = compare(options);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().line(), HasSubstr("camera"));
}

TEST(Compare, AFurnaceIsRightToTheReferencesNoise) {
  const TempFolder folder;
  CompareOptions options;
  options.first = gold(folder, "furnace", Quality::kMedium);
  options.reference = true;
  options.points = 200;
  options.samples = 1024;
  const nlohmann::json figures = nlohmann::json::parse(compared(options).json);
  EXPECT_LT(figures["relative_rmse"].get<double>(), 0.01);
  EXPECT_LT(std::abs(figures["bias"].get<double>()), 0.005);
  EXPECT_NEAR(figures["mean"].get<double>(), 2, 0.01);
  EXPECT_GT(figures["reference_noise"].get<double>(), 0);
  EXPECT_EQ(figures["samples"], 1024);
}

TEST(Compare, Pictures) {
  const TempFolder folder;
  FloatImage image{4, 2, std::vector<vec3>(8, vec3(0.5f))};
  ASSERT_TRUE(write_exr(folder.path("a.exr"), image));
  ASSERT_TRUE(write_png(folder.path("a.png"), image));
  image.pixels[6] = vec3(1);
  ASSERT_TRUE(write_exr(folder.path("b.exr"), image));
  CompareOptions options;
  options.first = folder.path("b.exr");
  options.second = folder.path("a.exr");
  options.picture = folder.path("d.png");
  const nlohmann::json figures = nlohmann::json::parse(compared(options).json);
  EXPECT_EQ(figures["points"], 8);
  EXPECT_NEAR(figures["bias"].get<double>(), 0.125, 1e-6);
  EXPECT_NEAR(figures["relative_rmse"].get<double>(), std::sqrt(1 / 8.0), 1e-6);
  EXPECT_EQ(figures["worst"]["position"][0], 2);
  EXPECT_EQ(figures["worst"]["position"][1], 1);
  options.first = folder.path("a.png");
  options.picture.clear();
  EXPECT_LT(nlohmann::json::parse(compared(options).json)["relative_rmse"].get<double>(), 0.01);
}

std::string error_of(const CompareOptions& options, ErrorCode code) {
  const Result<CompareResult> result = compare(options);
  if (result) return "none";
  EXPECT_EQ(result.error().code, code) << result.error().line();
  return result.error().line();
}

TEST(Compare, WhatCannotBeCompared) {
  const TempFolder folder;
  const std::string box = gold(folder, "furnace"), other = gold(folder, "sphere");
  FloatImage small{2, 2, std::vector<vec3>(4)}, large{3, 2, std::vector<vec3>(6)};
  ASSERT_TRUE(write_exr(folder.path("s.exr"), small));
  ASSERT_TRUE(write_exr(folder.path("l.exr"), large));
  folder.write("broken.exr", "not a picture");
  CompareOptions options;
  options.first = box;
  EXPECT_THAT(error_of(options, ErrorCode::kUsage), HasSubstr("--reference"));
  options.second = other;
  EXPECT_THAT(error_of(options, ErrorCode::kBadInput), HasSubstr("another scene"));
  options.second = folder.path("s.exr");
  EXPECT_THAT(error_of(options, ErrorCode::kUsage), HasSubstr("not of a kind"));
  options.first = folder.path("l.exr");
  EXPECT_THAT(error_of(options, ErrorCode::kBadInput), HasSubstr("2 x 2"));
  options.first = folder.path("broken.exr");
  EXPECT_THAT(error_of(options, ErrorCode::kBadInput), HasSubstr("broken.exr"));
  options.first = folder.path("nowhere.gold");
  options.second = box;
  EXPECT_THAT(error_of(options, ErrorCode::kBadInput), HasSubstr("nowhere.gold"));
  options.first = "scene.glb";
  EXPECT_THAT(error_of(options, ErrorCode::kUsage), HasSubstr("scene.glb"));
  options.first = box;
  options.picture = folder.path("d.jpg");
  EXPECT_THAT(error_of(options, ErrorCode::kUsage), HasSubstr(".png"));
}

TEST(Compare, StoppedItComparesWhatThereIs) {
  const TempFolder folder;
  CompareOptions options;
  options.first = gold(folder, "furnace");
  options.reference = true;
  options.samples = uint64_t{1} << 30;
  options.points = 50;
  int polled = 0;
  BakeListener listener;
  listener.cancelled = [&] { return ++polled > 25; };
  const CompareResult result = compared(options, listener);
  EXPECT_TRUE(result.cancelled);
  EXPECT_GT(nlohmann::json::parse(result.json)["samples"].get<uint64_t>(), 0u);
}

}  // namespace
}  // namespace goldthread
