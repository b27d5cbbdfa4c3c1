// Cases for `formfactors`: what is read, and how what is wrong is named.
#include "files/form_factor_read.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

namespace goldthread {
namespace {

using ::testing::HasSubstr;

FormFactorInput vs3(const std::string& text) {
  Result<FormFactorInput> input = parse_vs3(text, "a.vs3");
  if (!input) throw std::runtime_error(input.error().line());
  return *std::move(input);
}

std::string vs3_error(const std::string& text) {
  const Result<FormFactorInput> input = parse_vs3(text, "a.vs3");
  EXPECT_TRUE(input || input.error().code == ErrorCode::kBadInput);
  return input ? "none" : input.error().line();
}

const std::string kVertices =
    "T a title\nC encl=1\nF 3\nV 1 0. 0. 0.\nV 2 1. 0. 0. ! a comment\nV 3 1. 1. 0.\nV 4 0. 1. 0.\n";

TEST(Vs3, SurfacesByTheirVertices) {
  const FormFactorInput input = vs3(kVertices +
                                    "! note\r\nS 1 1 2 3 4 0 0 0.9 floor\r\nS 2 1 2 3 0 0 0 0.9\nO 3 4 3 "
                                    "2 1 0 0 0 lid\nEnd of data\n | drawing |\n");
  ASSERT_EQ(input.models.size(), 1u);
  const PolygonModel& model = input.models[0];
  ASSERT_EQ(model.surfaces.size(), 2u);
  EXPECT_EQ(model.surfaces[0].size(), 4u);
  EXPECT_EQ(model.surfaces[1].size(), 3u);
  EXPECT_EQ(model.surfaces[0][2], dvec3(1, 1, 0));
  EXPECT_EQ(model.names, (std::vector<std::string>{"floor", "surface 2"}));
  EXPECT_EQ(model.occluders.size(), 1u);
  EXPECT_TRUE(model.base.empty());
}

TEST(Vs3, BasesAndCombinedSurfacesMayComeLater) {
  const PolygonModel model =
      vs3(kVertices +
          "V 5 .2 .2 0\nV 6 .4 .2 0\nV 7 .4 .4 0\nS 1 5 6 7 0 3 0 .9 a\nS 2 4 3 2 1 0 3 .9 b\n"
          "S 3 1 2 3 4 0 0 .9 c\n")
          .models.at(0);
  EXPECT_EQ(model.base, (std::vector<uint32_t>{2, PolygonModel::kNone, PolygonModel::kNone}));
  EXPECT_EQ(model.combined, (std::vector<uint32_t>{PolygonModel::kNone, 2, PolygonModel::kNone}));
}

TEST(Vs3, MasksAndNullSurfacesArePartsOfTheirBases) {
  const PolygonModel model =
      vs3(kVertices +
          "V 5 .2 .2 0\nV 6 .4 .2 0\nV 7 .4 .4 0\nM 1 7 6 5 0 2 0 .9 rug\nS 2 1 2 3 4 0 0 .9 floor\n"
          "n 3 4 3 1 0 2 0 .9 hole\n")
          .models.at(0);
  EXPECT_EQ(model.cover, (std::vector<Cover>{Cover::kMask, Cover::kNothing, Cover::kNull}));
  EXPECT_EQ(model.base, (std::vector<uint32_t>{1, PolygonModel::kNone, 1}));
  EXPECT_EQ(model.names[0], "rug");
  for (const Polygon& polygon : model.surfaces) EXPECT_GT(area_vector(polygon).z, 0);
}

TEST(Vs3, ObstructionsMayCarrySurfaces) {
  const std::string small = "V 5 .2 .2 0\nV 6 .4 .2 0\nV 7 .4 .4 0\n", lid = "O 9 1 2 3 4 0 0 .9 lid\n";
  const PolygonModel model = vs3(kVertices + small + "S 1 5 6 7 0 9 0 .9 lamp\n" + lid).models.at(0);
  EXPECT_EQ(model.base, std::vector<uint32_t>{PolygonModel::kNone});
  EXPECT_TRUE(model.on_occluders);
  EXPECT_EQ(model.occluders.size(), 1u);
  EXPECT_THAT(vs3_error(kVertices + "V 5 .2 .2 1\nV 6 .4 .2 1\nV 7 .4 .4 1\nS 1 5 6 7 0 9 0 .9\n" + lid),
              HasSubstr("surface 1: it does not lie in its base"));
  EXPECT_THAT(vs3_error(kVertices + small + "S 1 5 6 7 0 0 0 .9\nM 2 7 6 5 0 9 0 .9\n" + lid),
              HasSubstr("surface 2: a mask or null surface cannot lie on an obstruction"));
  EXPECT_EQ(vs3_error(kVertices + small + "S 1 5 6 7 0 9 0 .9\nO 9 1 2 3 4\n"), "none");
}

TEST(Vs3, RectanglesByOriginAzimuthAndTilt) {
  // A wall that faces south (azimuth 180), a floor and a ceiling over the same square.
  const PolygonModel model =
      vs3("F 3a\nS 1 R 0 0 .9 wall\n0 2 0 180 90 3 2\nS 2 q 0 0 .9 floor\n0 0 0 180 0\n"
          "0 0 1 0 1 1 0 1\nS 3 Q 0 0 .9 ceiling\n1 0 3 0 180\n0 0 1 0 1 1 0 1\nend\n")
          .models.at(0);
  const auto normal = [&](size_t s) { return glm::normalize(area_vector(model.surfaces[s])); };
  EXPECT_LT(glm::distance(normal(0), dvec3(0, -1, 0)), 1e-12);
  EXPECT_NEAR(area(model.surfaces[0]), 6, 1e-12);
  EXPECT_LT(glm::distance(model.surfaces[0][2], dvec3(3, 2, 2)), 1e-12);
  EXPECT_LT(glm::distance(normal(1), dvec3(0, 0, 1)), 1e-12);
  EXPECT_LT(glm::distance(normal(2), dvec3(0, 0, -1)), 1e-12);
  EXPECT_LT(glm::distance(model.surfaces[2][2], dvec3(0, 1, 3)), 1e-12);
}

TEST(Vs3, WhatIsWrongIsNamedWithItsLine) {
  const std::string surface = "S 1 1 2 3 4 0 0 0.9 floor\n";
  EXPECT_THAT(vs3_error("F 2\n"), HasSubstr("line 1: geometry format \"2\""));
  EXPECT_THAT(vs3_error(kVertices), HasSubstr("no surfaces"));
  EXPECT_THAT(vs3_error(kVertices + "X 1\n" + surface), HasSubstr("line 8: record \"X\""));
  const std::string square = "V 5 .2 .2 0\nV 6 .4 .2 0\nV 7 .4 .4 0\nV 8 .2 .4 0\nV 9 2 .4 0\n" + surface;
  EXPECT_THAT(vs3_error(kVertices + "M 1 1 2 3 4 0 0 .9\n"), HasSubstr("line 8: surface 1: a mask or null"));
  EXPECT_THAT(vs3_error(kVertices + square + "N 2 5 6 7 8 1 0 .9\n"), HasSubstr("has to face its base"));
  EXPECT_THAT(vs3_error(kVertices + square + "M 2 8 7 6 5 1 1 .9\n"), HasSubstr("cannot be combined"));
  EXPECT_THAT(vs3_error(kVertices + square + "M 2 8 7 9 5 1 0 .9\n"), HasSubstr("not lie within its base"));
  EXPECT_THAT(vs3_error(kVertices + square + "N 2 4 3 2 1 1 0 .9\n"), HasSubstr("leaves nothing"));
  EXPECT_THAT(vs3_error(kVertices + square + "M 2 8 7 6 5 1 0 .9\nM 3 7 6 5 0 2 0 .9\n"),
              HasSubstr("line 15: surface 3: its base surface is itself a mask"));
  EXPECT_THAT(vs3_error(kVertices + square + "M 2 8 7 6 5 1 0 .9\nN 3 8 7 6 5 1 0 .9\n"),
              HasSubstr("surface 3: it lies where the surface of line 14: surface 2"));
  EXPECT_THAT(vs3_error(kVertices + "V 4 0 0 0\n"), HasSubstr("vertex 4 is there twice"));
  EXPECT_THAT(vs3_error(kVertices + "V 5 0 0 nan\n"), HasSubstr("\"nan\" is not a number"));
  EXPECT_THAT(vs3_error(kVertices + "V 5 0 0\n"), HasSubstr("has 4 words, at least 5"));
  EXPECT_THAT(vs3_error(kVertices + "S 1 1 2 3 9 0 0 .9\n"), HasSubstr("line 8: vertex 9 is not there"));
  EXPECT_THAT(vs3_error(kVertices + "S 1 1 2 3 R 0 0 .9\n"), HasSubstr("\"R\" is not a number"));
  EXPECT_THAT(vs3_error(kVertices + surface + surface), HasSubstr("line 9: surface 1: this number"));
  EXPECT_THAT(vs3_error(kVertices + "S 1 1 2 3 4 7 0 .9\n"), HasSubstr("base surface 7 is not there"));
  EXPECT_THAT(vs3_error(kVertices + "S 1 1 2 3 4 0 1 .9\n"), HasSubstr("combined with itself"));
  EXPECT_THAT(vs3_error(kVertices + "V 5 1 1 .1\nS 1 1 2 5 4 0 0 .9\n"),
              HasSubstr("line 9: surface 1: it is not planar"));
  EXPECT_THAT(vs3_error(kVertices + "S 1 1 3 2 4 0 0 .9\n"), HasSubstr("surface 1: it "));
  EXPECT_THAT(vs3_error(kVertices + "V 5 2 0 0\nS 1 1 2 5 0 0 0 .9\n"), HasSubstr("no area"));
  EXPECT_THAT(vs3_error(kVertices + "V 5 0 0 1\nV 6 1 0 1\nV 7 1 1 1\n" + surface + "S 2 5 6 7 0 1 0 .9\n"),
              HasSubstr("surface 2: it does not lie in its base"));
  EXPECT_THAT(vs3_error(kVertices + surface + "S 2 2 3 4 1 0 0 .9\n"),
              HasSubstr("line 9: surface 2: it lies where the surface of line 8: surface 1"));
  EXPECT_EQ(vs3_error(kVertices + surface + "S 2 4 3 2 1 0 0 .9\n"), "none");  // a plate's other face
  EXPECT_THAT(vs3_error("F 3a\nS 1 R 0 0 .9 a\n"), HasSubstr("file ends"));
  EXPECT_THAT(vs3_error("F 3a\nS 1 Z 0 0 .9 a\n0 0 0 0 0 1 1\n"), HasSubstr("shape \"Z\""));
}

std::string json_error(const std::string& text) {
  const Result<FormFactorInput> input = parse_form_factor_json(text, "a.json");
  EXPECT_TRUE(input || input.error().code == ErrorCode::kBadInput);
  return input ? "none" : input.error().line();
}

const std::string kSquare = R"({"type":"polygon","vertices":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]]})";

const std::string kOther = R"({"type":"polygon","vertices":[[0,0,1],[1,0,1],[1,1,1],[0,1,1]]})";

TEST(FormFactorJson, PairsAndModels) {
  const Result<FormFactorInput> input = parse_form_factor_json(
      R"({"cases":[{"id":"a","from":{"type":"point","position":[0,0,0],"normal":[0,0,2]},"to":)" + kSquare +
          R"(,"occluders":[)" + kSquare + R"(]},{"surfaces":[)" + kSquare + "," + kOther +
          R"(],"occluders":[]},{"from":{"type":"disk","centre":[0,0,0],"normal":[1,0,0],"radius":2},"to":)"
          R"({"type":"sphere","centre":[0,0,0],"radius":3,"side":"inside"}}]})",
      "a.json");
  ASSERT_TRUE(input) << input.error().line();
  ASSERT_EQ(input->pairs.size(), 2u);
  EXPECT_EQ(input->pairs[0].id, "a");
  EXPECT_EQ(std::get<PointShape>(input->pairs[0].from).normal, dvec3(0, 0, 1));
  EXPECT_EQ(input->pairs[0].occluders.size(), 1u);
  EXPECT_EQ(input->pairs[1].id, "3");
  EXPECT_TRUE(std::get<SphereShape>(input->pairs[1].to).inside);
  ASSERT_EQ(input->models.size(), 1u);
  EXPECT_EQ(input->models[0].names[1], "surface 2");
}

TEST(FormFactorJson, WhatIsWrongIsNamedWithItsCase) {
  const auto pair = [](const std::string& from) {
    return R"({"id":"q","from":)" + from + R"(,"to":)" + kSquare + "}";
  };
  EXPECT_THAT(json_error("{"), HasSubstr("is not JSON"));
  EXPECT_THAT(json_error("[]"), HasSubstr("not an object"));
  EXPECT_THAT(json_error("{}"), HasSubstr("neither \"surfaces\" nor"));
  EXPECT_THAT(json_error(R"({"cases":[]})"), HasSubstr("holds no cases"));
  EXPECT_THAT(json_error(pair(R"({"type":"cone"})")), HasSubstr("case q: from: shape \"cone\""));
  EXPECT_THAT(json_error(pair(R"({"type":"point","position":[0,0,0],"normal":[0,0,0]})")),
              HasSubstr("no direction"));
  EXPECT_THAT(json_error(pair(R"({"type":"point","position":[0,0],"normal":[0,0,1]})")),
              HasSubstr("three numbers"));
  EXPECT_THAT(json_error(pair(R"({"type":"disk","centre":[0,0,0],"normal":[0,0,1],"radius":-1})")),
              HasSubstr("greater than nought"));
  EXPECT_THAT(json_error(pair(R"({"type":"polygon","vertices":[[0,0,0],[1,0,0],[1,1,0.3],[0,1,0]]})")),
              HasSubstr("case q: from: it is not planar"));
  EXPECT_THAT(json_error(R"({"surfaces":[)" + kSquare + R"(,{"vertices":[[0,0,0],[1,0,0],[2,0,0]]}]})"),
              HasSubstr("surface 2: it has no area"));
  EXPECT_THAT(json_error(R"({"from":)" + kSquare +
                         R"(,"to":{"type":"point","position":[0,0,0],)"
                         R"("normal":[0,0,1]}})"),
              HasSubstr("a point cannot be sent to"));
}

TEST(FormFactorRead, EverySharedFileOfView3d) {
  const std::filesystem::path folder = std::filesystem::path(GOLDTHREAD_SHARED) / "accuracy/view3d/inputs";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no " << folder;
  size_t read = 0, broken = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    // Named as broken where they come from: a surface list of another format, and no geometry at all.
    const bool is_broken = name == "pinney-g4.vs3" || name == "pinney-tri.vs3";
    const Result<FormFactorInput> input = read_form_factor_cases(entry.path());
    EXPECT_EQ(!input, is_broken) << name << (input ? "" : " " + input.error().line());
    ++(input ? read : broken);
  }
  EXPECT_EQ(broken, 2u);
  EXPECT_GE(read, 14u);
}

}  // namespace
}  // namespace goldthread
