#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include <set>
#include <tuple>

#include "mesh/shapes.h"
#include "mesh/validate.h"

namespace goldthread {
namespace {

TriangleMesh weld_valid(const shapes::Soup& soup) {
  TriangleMesh mesh = soup.weld();
  validate(mesh);
  EXPECT_EQ(
      mesh.triangles.size() + mesh.skipped.not_finite + mesh.skipped.degenerate + mesh.skipped.duplicate,
      soup.indices.size() / 3);
  return mesh;
}

TEST(Weld, TwentyFourVerticesOfACubeBecomeEight) {
  const shapes::Soup cube = shapes::cube();
  EXPECT_EQ(cube.positions.size(), 24u);
  const TriangleMesh mesh = weld_valid(cube);
  EXPECT_EQ(mesh.positions.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
}

TEST(Weld, KeepsOrderCornersAndSources) {
  shapes::Soup soup;
  soup.positions = {{9, 9, 9}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0f, 0, 0}, {1, 1, 0}};
  soup.indices = {1, 1, 2, 4, 2, 3, 2, 5, 3};
  const TriangleMesh mesh = weld_valid(soup);
  EXPECT_EQ(mesh.positions, (std::vector<vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<UVec3>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(mesh.source_triangles, (std::vector<uint32_t>{1, 2}));
  EXPECT_EQ(mesh.skipped.degenerate, 1u);
}

TEST(Weld, SkipsWhatHasNoAreaOrNoPlace) {
  shapes::Soup soup;
  soup.positions = {{0, 0, 0},        {0.1f, 0.2f, 0.3f}, {0.3f, 0.6f, 0.9f}, {NAN, 0, 0},
                    {INFINITY, 1, 0}, {1e30f, 0, 0},      {0, 1e30f, 0},      {1e-3f, 1, 0}};
  soup.indices = {0, 1, 2, 0, 1, 3, 4, 1, 0, 0, 5, 6, 0, 1, 1, 0, 1, 7};
  const TriangleMesh mesh = weld_valid(soup);
  EXPECT_EQ(mesh.skipped.degenerate, 2u);  // on a line up to rounding, and two corners the same
  EXPECT_EQ(mesh.skipped.not_finite, 3u);  // NaN, infinity, and an area beyond the numbers
  EXPECT_EQ(mesh.source_triangles, (std::vector<uint32_t>{5}));
}

TEST(Weld, KeepsOneOfEqualTriangles) {
  shapes::Soup soup;
  // The same square thrice: split vertices, turned corners, and once seen from the other side.
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.indices = {0, 1, 2, 0, 2, 3, 5, 6, 4, 7, 4, 6, 2, 1, 0, 3, 2, 0};
  const TriangleMesh mesh = weld_valid(soup);
  EXPECT_EQ(mesh.source_triangles, (std::vector<uint32_t>{0, 1, 4, 5}));  // the back is no copy
  EXPECT_EQ(mesh.skipped.duplicate, 2u);
  ASSERT_EQ(mesh.duplicates.size(), 2u);
  for (const DuplicateTriangle& d : mesh.duplicates)
    for (uint32_t k = 0; k < 3; ++k)
      EXPECT_EQ(soup.positions[soup.indices[3 * d.source + k]],
                mesh.positions[mesh.triangles[d.twin][int(k + d.turn) % 3]]);
}

TEST(Weld, KeepsVerySmallAndVeryThinTriangles) {
  for (const float size : {1e-12f, 1e-4f, 1e6f}) {
    shapes::Soup soup;
    soup.positions = {{0, 0, 0}, {size, 0, 0}, {0, 1e-5f * size, 0}};
    soup.indices = {0, 1, 2};
    EXPECT_EQ(weld_valid(soup).triangles.size(), 1u) << size;
  }
}

TEST(Weld, NothingIsFine) {
  EXPECT_TRUE(weld_valid({}).triangles.empty());
}

TEST(Weld, TheSameForAnyNumberOfThreads) {
  shapes::Soup soup = shapes::wavy_grid(300);
  const shapes::Soup again = soup;
  for (const uint32_t i : again.indices) soup.indices.push_back(i + uint32_t(again.positions.size()));
  soup.positions.insert(soup.positions.end(), again.positions.begin(), again.positions.end());
  TriangleMesh meshes[2];
  for (size_t threads = 1; threads <= 2; ++threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    meshes[threads - 1] = weld_valid(soup);
  }
  EXPECT_EQ(meshes[0].positions.size(), again.positions.size());
  EXPECT_EQ(meshes[0].positions, meshes[1].positions);
  EXPECT_EQ(meshes[0].triangles, meshes[1].triangles);
  EXPECT_EQ(meshes[0].source_triangles, meshes[1].source_triangles);
}

RC_GTEST_PROP(Weld, CornersAreThoseOfTheSource, (uint32_t seed)) {
  const auto triangles = *rc::gen::inRange<uint32_t>(0, 400), vertices = *rc::gen::inRange<uint32_t>(3, 100);
  const shapes::Soup soup = shapes::random_soup(seed, triangles, vertices);
  const TriangleMesh mesh = weld_valid(soup);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      RC_ASSERT(mesh.positions[mesh.triangles[t][k]] ==
                soup.positions[soup.indices[3 * mesh.source_triangles[t] + size_t(k)]]);
}

}  // namespace
}  // namespace goldthread
