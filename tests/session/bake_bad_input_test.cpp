// Everything that can be wrong with a bake's input and output ends in one line and leaves nothing behind.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "goldthread/reference.h"
#include "session/baked.h"

namespace goldthread {
namespace {

using namespace test;
using ::testing::HasSubstr;

/// The bake's error. Nothing but what was there may be left in the folder.
Error error_of(const TempFolder& folder, const BakeOptions& options) {
  const std::set<std::string> before = names_in(folder.path(""));
  const Result<BakeResult> result = bake(options);
  EXPECT_EQ(names_in(folder.path("")), before);
  if (result) {
    ADD_FAILURE() << "was baked";
    return {};
  }
  const std::string line = result.error().line();
  EXPECT_EQ(line.find('\n'), std::string::npos);
  EXPECT_FALSE(result.error().message.empty());
  EXPECT_FALSE(result.error().cure.empty()) << line;
  return result.error();
}

Error error_of_file(const std::string& bytes, const char* name = "bad.gltf") {
  const TempFolder folder;
  const std::string file = folder.write(name, bytes);
  const Error error = error_of(folder, draft(file, {folder.path("lit.glb")}));
  EXPECT_THAT(error.line(), HasSubstr(file));
  return error;
}

TEST(BakeBadInput, FilesThatMakeNoSense) {
  const std::string good = to_glb(lit_floor());
  EXPECT_EQ(error_of_file("", "empty.glb").code, ErrorCode::kBadInput);
  EXPECT_EQ(error_of_file("certainly not a scene", "text.glb").code, ErrorCode::kBadInput);
  for (const size_t length : {size_t{5}, size_t{40}, good.size() / 2, good.size() - 4})
    EXPECT_EQ(error_of_file(good.substr(0, length), "cut.glb").code, ErrorCode::kBadInput) << length;
}

TEST(BakeBadInput, CountsAndNumbersBeyondWhatIsThere) {
  GltfBuilder huge = lit_floor();
  huge.doc["accessors"][0]["count"] = 4000000000u;
  EXPECT_EQ(error_of_file(huge.text()).code, ErrorCode::kBadInput);
  GltfBuilder index = lit_floor();
  index.mesh({{"attributes", {{"POSITION", 0}}}, {"indices", index.indices({0, 1, 999})}});
  EXPECT_EQ(error_of_file(index.text()).code, ErrorCode::kBadInput);
  GltfBuilder buffer = lit_floor();
  buffer.doc["buffers"] = json::array({{{"byteLength", buffer.bytes.size()}, {"uri", "missing.bin"}}});
  EXPECT_THAT(error_of_file(buffer.text()).line(), HasSubstr("missing.bin"));
  GltfBuilder circle = lit_floor();
  circle.doc["nodes"][0]["children"] = {1};
  circle.doc["nodes"][1]["children"] = {0};
  EXPECT_EQ(error_of_file(circle.text()).code, ErrorCode::kBadInput);
}

TEST(BakeBadInput, MissingFile) {
  const TempFolder folder;
  const Error error = error_of(folder, draft(folder.path("none.glb"), {folder.path("lit.glb")}));
  EXPECT_EQ(error.code, ErrorCode::kBadInput);
}

TEST(BakeBadInput, NothingToBake) {
  GltfBuilder none;
  none.push("nodes", {{"name", "alone"}});
  EXPECT_EQ(error_of_file(none.text()).code, ErrorCode::kNothingToBake);
  GltfBuilder dark = lit_floor();
  dark.doc["materials"][1].erase("emissiveFactor");
  const Error error = error_of_file(dark.text());
  EXPECT_EQ(error.code, ErrorCode::kNothingToBake);
  EXPECT_THAT(error.line(), HasSubstr("--sky"));
}

TEST(BakeBadInput, OnlyBadTriangles) {
  const float nan = std::nanf("");
  GltfBuilder b;
  const int positions = b.vec3s({nan, 0, 0, 1, 0, 0, 0, 1, 0, 2, 2, 2, 2, 2, 2, 2, 2, 2});
  b.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", b.indices({0, 1, 2, 3, 4, 5})}});
  EXPECT_EQ(error_of_file(b.text()).code, ErrorCode::kNothingToBake);
}

TEST(BakeBadInput, AnEmitterWithoutArea) {
  GltfBuilder b = lit_floor();
  const int points = b.vec3s({0, 1, 0, 1, 1, 0, 2, 1, 0});
  b.doc["meshes"][1]["primitives"][0]["attributes"]["POSITION"] = points;
  b.doc["meshes"][1]["primitives"][0]["indices"] = b.indices({0, 1, 2});
  EXPECT_EQ(error_of_file(b.text()).code, ErrorCode::kNothingToBake);
}

TEST(BakeBadInput, SomeBadTrianglesAreSkippedAndCountedOnce) {
  GltfBuilder b = lit_floor();
  const float nan = std::nanf("");
  const int positions = b.vec3s({nan, 0, 0, 1, 0.5f, 0, 0, 0.5f, 1, 2, 2, 2, 2, 2, 2, 2, 2, 2});
  b.mesh({{"attributes", {{"POSITION", positions}}},
          {"indices", b.indices({0, 1, 2, 3, 4, 5})},
          {"material", 0}});
  const TempFolder folder;
  const BakeResult result = baked(draft(folder.write("scene.gltf", b.text()), {folder.path("lit.glb")}));
  int degenerate = 0, not_finite = 0;
  for (const std::string& warning : result.warnings) {
    degenerate += warning.find("degenerate") != std::string::npos;
    not_finite += warning.find("not finite") != std::string::npos;
  }
  EXPECT_EQ(degenerate, 1);
  EXPECT_EQ(not_finite, 1);
  const WrittenGltf lit(result.written.at(0));
  EXPECT_TRUE(lit.primitive(0)["attributes"].contains("_IRRADIANCE"));
}

TEST(BakeBadInput, NormalsWithoutDirectionAreFlatAndNamed) {
  const float nan = std::nanf(""), infinite = std::numeric_limits<float>::infinity();
  const TempFolder folder;
  const auto light_with = [&](const std::vector<float>& normals, int& named) {
    GltfBuilder b = lit_floor();
    if (!normals.empty()) b.doc["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = b.vec3s(normals);
    const BakeResult result = baked(draft(folder.write("scene.gltf", b.text()), {folder.path("lit.glb")}));
    named = 0;
    for (const std::string& warning : result.warnings)
      named += warning.find("of 4 normals have no direction") != std::string::npos;
    return WrittenGltf(result.written.at(0)).attribute("_IRRADIANCE");
  };
  int named = 0;
  const std::vector<float> flat = light_with({}, named);
  EXPECT_EQ(named, 0);
  for (const std::vector<float>& normals :
       {std::vector<float>(12, 0.0f), std::vector<float>(12, nan),
        std::vector<float>{0, 1, 0, nan, 0, 0, 0, 0, 0, 0, infinite, 0}}) {
    EXPECT_EQ(light_with(normals, named), flat);
    EXPECT_EQ(named, 1);
  }
}

/// A one-sided box above the middle of the floor, from 0.1 to 1 m, and a lamp at a height.
GltfBuilder box_with_lamp(double height) {
  GltfBuilder b = lit_floor();
  const float s = 0.5f;
  const int positions = b.vec3s({-s, 0.1f, -s, s, 0.1f, -s, s, 0.1f, s, -s, 0.1f, s,  //
                                 -s, 1,    -s, s, 1,    -s, s, 1,    s, -s, 1,    s});
  const int indices = b.indices({0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6, 0, 4, 5, 0, 5, 1,
                                 1, 5, 6, 1, 6, 2, 2, 6, 7, 2, 7, 3, 3, 7, 4, 3, 4, 0});
  b.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"material", 0}});
  b.doc["extensionsUsed"] = {"KHR_lights_punctual"};
  b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"name", "lost"}}};
  b.push("nodes",
         {{"translation", {0, height, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return b;
}

TEST(BakeBadInput, LampsInsideSolidsAreNamed) {
  const TempFolder folder;
  const auto named = [](const std::vector<std::string>& warnings) {
    int count = 0;
    for (const std::string& warning : warnings)
      count += warning.find("\"lost\" is inside a closed solid") != std::string::npos;
    return count;
  };
  for (const double height : {0.5, 1.5}) {
    const std::string file = folder.write("scene.gltf", box_with_lamp(height).text());
    ReferenceOptions options;
    options.input = file;
    options.random_points = 1;
    options.samples = 16;
    options.json_file = folder.path("r.json");
    const Result<ReferenceResult> traced = reference(options);
    ASSERT_TRUE(traced) << traced.error().line();
    EXPECT_EQ(named(traced->warnings), height < 1 ? 1 : 0);
    EXPECT_EQ(named(baked(draft(file, {folder.path("lit.glb")})).warnings), height < 1 ? 1 : 0);
  }
}

TEST(BakeBadInput, WrongOptions) {
  const TempFolder folder;
  const std::string input = folder.write("scene.glb", to_glb(lit_floor()));
  EXPECT_EQ(error_of(folder, draft(input, {})).code, ErrorCode::kUsage);
  EXPECT_EQ(error_of(folder, draft(input, {folder.path("lit.jpeg2000")})).code, ErrorCode::kUsage);
}

TEST(BakeBadOutput, IsFoundOutBeforeAnythingIsRead) {
  const TempFolder folder;
  // The input does not exist either: the output is looked at first.
  for (const std::string& output : {folder.path("no/such/folder/lit.glb"), std::string("/proc/lit.glb")}) {
    const Error error = error_of(folder, draft(folder.path("none.glb"), {output}));
    EXPECT_EQ(error.code, ErrorCode::kCannotWrite);
    EXPECT_THAT(error.line(), HasSubstr(output));
  }
  BakeOptions report = draft(folder.path("none.glb"), {folder.path("lit.glb")});
  report.report_file = folder.path("no/report.json");
  EXPECT_EQ(error_of(folder, report).code, ErrorCode::kCannotWrite);
}

TEST(BakeBadOutput, ProbingLeavesAnOldFileAlone) {
  const TempFolder folder;
  const std::string old = folder.write("lit.glb", "precious");
  error_of(folder, draft(folder.path("none.glb"), {old}));
  EXPECT_EQ(bytes_of_file(old), "precious");
}

TEST(BakeBadOutput, FullDisk) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const TempFolder folder;
  const std::string input = folder.write("scene.glb", to_glb(lit_floor()));
  std::filesystem::create_symlink("/dev/full", folder.path("lit.glb"));
  const Error error = error_of(folder, draft(input, {folder.path("lit.glb")}));
  EXPECT_EQ(error.code, ErrorCode::kCannotWrite);
}

}  // namespace
}  // namespace goldthread
