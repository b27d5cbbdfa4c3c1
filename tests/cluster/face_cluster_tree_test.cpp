#include "cluster/face_cluster_tree.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>
#include <tbb/global_control.h>

#include <cstring>

#include "cluster/merge_forest.h"
#include "mesh/shapes.h"

namespace goldthread {
namespace {

FaceClusterTree build(const shapes::Soup& soup, const FaceClusterOptions& options = {}) {
  FaceClusterTree tree = build_face_clusters(soup.weld(), options);
  validate(tree);
  return tree;
}

uint32_t depth_of(const FaceClusterTree& tree) {
  std::vector<uint32_t> depth(tree.nodes.size(), 1);
  uint32_t deepest = 0;
  for (uint32_t i = 0; i < tree.nodes.size(); ++i) {
    for (const ClusterRef child : tree.nodes[i].child)
      if (!is_triangle(child)) depth[child] = depth[i] + 1;
    deepest = std::max(deepest, depth[i]);
  }
  return deepest;
}

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}
bool same(const FaceClusterTree& a, const FaceClusterTree& b) {
  return same_bytes(a.nodes, b.nodes) && same_bytes(a.roots, b.roots) &&
         same_bytes(a.mesh.source_triangles, b.mesh.source_triangles);
}

TEST(FaceClusterTree, NothingAndOneTriangle) {
  EXPECT_TRUE(build({}).roots.empty());
  shapes::Soup one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.indices = {0, 1, 2};
  const FaceClusterTree tree = build(one);
  ASSERT_EQ(tree.roots.size(), 1u);
  EXPECT_EQ(tree.roots[0], 0u | kTriangleBit);
  EXPECT_TRUE(tree.nodes.empty());
}

TEST(FaceClusterTree, CubeFallsIntoItsSixFaces) {
  for (const uint32_t n : {1u, 4u, 16u}) {
    const FaceClusterTree tree = build(shapes::cube(n));
    ASSERT_EQ(tree.roots.size(), 1u);
    int faces = 0;
    for (const FaceCluster& c : tree.nodes)
      faces += c.count == 2 * n * n && c.cone_cosine > 0.999f && std::abs(c.area - 1) < 1e-4f;
    EXPECT_EQ(faces, 6) << n;
    const FaceCluster& root = tree.nodes[tree.roots[0]];
    EXPECT_NEAR(length(root.summed_normal), 0, 1e-5f);
    EXPECT_NEAR(root.area, 6, 1e-4f);
    EXPECT_NEAR(length(root.centre - vec3(0.5f)), 0, 1e-5f);
    EXPECT_NEAR(root.radius, std::sqrt(0.75f), 0.05f);
    EXPECT_EQ(root.cone_cosine, -1);
  }
}

TEST(FaceClusterTree, BoundsAreNotMuchAboveTheTruth) {
  const FaceClusterTree tree = build(shapes::wavy_grid(80), {.region_triangles = 2000});
  for (const FaceCluster& c : tree.nodes) {
    float radius = 0, cosine = 1;
    for (uint32_t t = c.first; t < c.first + c.count; ++t) {
      const UVec3& v = tree.mesh.triangles[t];
      const vec3 corner[3] = {tree.mesh.positions[v.x], tree.mesh.positions[v.y], tree.mesh.positions[v.z]};
      for (const vec3& p : corner) radius = std::max(radius, length(p - c.centre));
      cosine = std::min(
          cosine, dot(normalize(area_vector(corner[0], corner[1], corner[2])), normalize(c.summed_normal)));
    }
    EXPECT_LE(c.radius, 1.02f * radius);
    EXPECT_LE(std::acos(std::max(-1.0f, c.cone_cosine)), std::acos(cosine) + 0.03f);
  }
}

TEST(FaceClusterTree, PartsThatDoNotTouchGetTheirOwnRoots) {
  shapes::Soup two = shapes::cube(2);
  const uint32_t n = uint32_t(two.positions.size());
  const shapes::Soup other = shapes::cube(2);
  for (const vec3& p : other.positions) two.positions.push_back(p + vec3(3, 0, 0));
  for (const uint32_t i : other.indices) two.indices.push_back(i + n);
  const FaceClusterTree tree = build(two);
  ASSERT_EQ(tree.roots.size(), 2u);
  EXPECT_EQ(tree.nodes[tree.roots[0]].count, 48u);
  EXPECT_EQ(tree.nodes[tree.roots[1]].first, 48u);
}

TEST(FaceClusterTree, ScaleByAPowerOfTwoChangesNothing) {
  const shapes::Soup soup = shapes::sphere(24);
  const FaceClusterTree tree = build(soup);
  for (const float scale : {0x1p-20f, 0x1p+20f}) {
    shapes::Soup scaled = soup;
    for (vec3& p : scaled.positions) p *= scale;
    EXPECT_TRUE(same_bytes(build(scaled).mesh.source_triangles, tree.mesh.source_triangles));
  }
}

TEST(FaceClusterTree, SumsOfChildrenAreThoseOfParents) {
  const FaceClusterTree tree = build(shapes::wavy_grid(40));
  for (const FaceCluster& c : tree.nodes) {
    vec3 sum(0);
    for (const ClusterRef child : c.child) {
      const UVec3& v = tree.mesh.triangles[triangle_of(child) % tree.mesh.triangles.size()];
      sum += is_triangle(child)
                 ? area_vector(tree.mesh.positions[v.x], tree.mesh.positions[v.y], tree.mesh.positions[v.z])
                 : tree.nodes[child].summed_normal;
    }
    EXPECT_EQ(sum, c.summed_normal);
  }
}

TEST(FaceClusterTree, TheSameForAnyNumberOfThreads) {
  for (const shapes::Soup& soup :
       {shapes::wavy_grid(120), shapes::random_soup(5, 4000, 500), shapes::sphere(80)}) {
    const FaceClusterOptions options{.region_triangles = 1000};
    FaceClusterTree trees[2];
    for (size_t threads = 1; threads <= 2; ++threads) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
      trees[threads - 1] = build(soup, options);
    }
    EXPECT_TRUE(same(trees[0], trees[1]));
  }
}

/// Work is counted in costs computed, not in seconds: greedy collapse needs a few a triangle whatever the
/// shape.
void expect_linear_work(const shapes::Soup& soup, const FaceClusterOptions& options, uint32_t deepest) {
  const TriangleMesh mesh = soup.weld();
  EXPECT_LE(merge_triangles(mesh, options).costs_computed, 16 * mesh.triangles.size());
  EXPECT_LE(depth_of(build(soup, options)), deepest);
}

constexpr uint32_t kOneRegion = 1u << 30;

TEST(FaceClusterTree, LongStripsAndFans) {
  expect_linear_work(shapes::strip(1000000), {}, 40);
  expect_linear_work(shapes::fan(300000), {}, 40);
}

TEST(FaceClusterTree, FlatGridsStayBalancedWithoutBalance) {
  expect_linear_work(shapes::flat_grid(400), {}, 40);
  expect_linear_work(shapes::flat_grid(300), {.balance = 0, .region_triangles = kOneRegion}, 40);
}

TEST(FaceClusterTree, APlateOfManyNeighboursIsNotQuadratic) {
  // The plate swallows its spikes one by one: the tree is deep, the work is not.
  const shapes::Soup plate = shapes::spiked_plate(200);
  expect_linear_work(plate, {}, 3000);
  expect_linear_work(plate, {.balance = 0, .region_triangles = kOneRegion}, 30000);
}

RC_GTEST_PROP(FaceClusterTree, AnySoupGivesAValidTree, ()) {
  const auto seed = *rc::gen::arbitrary<uint32_t>();
  const auto triangles = *rc::gen::inRange<uint32_t>(0, 600), vertices = *rc::gen::inRange<uint32_t>(3, 120);
  const auto region = *rc::gen::inRange<uint32_t>(1, 300), reduction = *rc::gen::inRange<uint32_t>(1, 40);
  build(shapes::random_soup(seed, triangles, vertices),
        {.balance = 0.001f, .region_triangles = region, .region_reduction = reduction});
}

}  // namespace
}  // namespace goldthread
