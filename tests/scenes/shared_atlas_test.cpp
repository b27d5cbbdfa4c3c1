// Charts of real scenes: no two triangles of one chart overlap, as a test sees it that knows nothing of how
// charts are made. Coordinates are multiples of a power of two below 2^24 of them, so that signs of areas in
// double are exact.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <unordered_map>

#include "files/scene_read.h"
#include "represent/atlas_layout.h"

namespace goldthread {
namespace {

using Flat = std::array<dvec2, 3>;

double turn(const dvec2& a, const dvec2& b, const dvec2& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether a side of one has all of the other beyond it or on it.
bool parts(const Flat& one, const Flat& other) {
  for (size_t k = 0; k < 3; ++k)
    if (std::all_of(other.begin(), other.end(),
                    [&](const dvec2& p) { return turn(one[k], one[(k + 1) % 3], p) <= 0; }))
      return true;
  return false;
}

/// Pairs of a chart's triangles with an inner point in common; those without a positive area count, too.
/// Triangles are compared where they share a cell of a grid.
size_t count_faults(const Chart& chart) {
  std::vector<Flat> triangles;
  dvec2 high(0);
  size_t faults = 0;
  for (const UVec3& face : chart.faces) {
    Flat t;
    for (int k = 0; k < 3; ++k) t[size_t(k)] = dvec2(chart.coordinates[face[k]]);
    faults += !(turn(t[0], t[1], t[2]) > 0);
    for (const dvec2& p : t) high = glm::max(high, p);
    triangles.push_back(t);
  }
  const double cell = std::max(1e-30, std::sqrt(high.x * high.y / double(triangles.size())));
  std::unordered_map<uint64_t, std::vector<uint32_t>> cells;
  for (uint32_t i = 0; i < triangles.size(); ++i) {
    const Flat& t = triangles[i];
    const dvec2 low = glm::floor(glm::min(t[0], glm::min(t[1], t[2])) / cell);
    const dvec2 top = glm::floor(glm::max(t[0], glm::max(t[1], t[2])) / cell);
    for (auto y = uint64_t(low.y); y <= uint64_t(top.y); ++y)
      for (auto x = uint64_t(low.x); x <= uint64_t(top.x); ++x) {
        std::vector<uint32_t>& here = cells[y << 32 | x];
        for (const uint32_t j : here) faults += !parts(t, triangles[j]) && !parts(triangles[j], t);
        here.push_back(i);
      }
  }
  return faults;
}

class SharedAtlas : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedAtlas, NoTriangleOfAChartLiesOverAnother) {
  const std::string file = std::string(GOLDTHREAD_SHARED) + "/scenes/" + GetParam() + ".glb";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "the shared scenes are not here";
  const Result<Scene> scene = read_scene(file);
  ASSERT_TRUE(scene) << scene.error().line();
  const CancelToken never;
  size_t triangles = 0, charted = 0, faults = 0;
  ChartStats stats;
  for (const Mesh& mesh : scene->meshes)
    for (const Primitive& primitive : mesh.primitives) {
      const FaceClusterTree tree = build_face_clusters(weld(primitive.positions, primitive.indices));
      triangles += tree.mesh.triangles.size();
      for (const Chart& chart : make_charts(tree, {}, never, stats)) {
        charted += chart.faces.size();
        faults += count_faults(chart);
      }
    }
  EXPECT_EQ(charted, triangles);
  EXPECT_EQ(faults, 0u);
  EXPECT_LE(stats.most_stretch, 2.0001f);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SharedAtlas,
                         ::testing::Values("as1-oc-214", "bathroom", "chess-room", "conference-lit",
                                           "cornell-sphere", "engine-room", "house", "jpm", "small-house",
                                           "sponza", "sportscar-room"),
                         [](const auto& scene) {
                           std::string name = scene.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace goldthread
