// Which clusters are convex polygons, and of which corners.
#include "cluster/flat_outlines.h"

#include <gtest/gtest.h>

#include <glm/gtc/quaternion.hpp>

#include "cluster/face_cluster_tree.h"
#include "mesh/shapes.h"

namespace goldthread {
namespace {

FaceClusterTree build(const shapes::Soup& soup) {
  return build_face_clusters(soup.weld());
}

std::span<const vec3> outline_of_root(const FaceClusterTree& tree) {
  return tree.outlines.of(tree.roots.at(0));
}

float area_about(std::span<const vec3> corners, const vec3& normal) {
  vec3 sum(0);
  for (size_t i = 1; i + 1 < corners.size(); ++i) sum += area_vector(corners[0], corners[i], corners[i + 1]);
  return dot(sum, normalize(normal));
}

/// Every outline fills its cluster: the same area about the same normal, and no triangle sticks out.
void expect_filled(const FaceClusterTree& tree) {
  for (uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const std::span<const vec3> outline = tree.outlines.of(i);
    if (outline.empty()) continue;
    const FaceCluster& node = tree.nodes[i];
    ASSERT_NEAR(area_about(outline, node.summed_normal), node.area, 2e-4f * node.area);
    const vec3 n = normalize(node.summed_normal);
    for (uint32_t t = node.first; t < node.first + node.count; ++t)
      for (int k = 0; k < 3; ++k) {
        const vec3& p = tree.mesh.positions[tree.mesh.triangles[t][k]];
        for (size_t c = 0; c < outline.size(); ++c) {
          const vec3 along = normalize(outline[(c + 1) % outline.size()] - outline[c]);
          ASSERT_GT(dot(cross(n, along), p - outline[c]), -1e-3f * node.radius);
        }
      }
  }
}

TEST(FlatOutlines, ARectangleHasFourCornersHoweverItIsCut) {
  for (const uint32_t n : {1u, 2u, 7u, 40u}) {
    shapes::Soup soup = shapes::flat_grid(n);
    const mat3 turn = glm::mat3_cast(glm::angleAxis(1.1f, normalize(vec3(1, 2, 3))));
    for (vec3& p : soup.positions) p = turn * (vec3(3, 1, 1) * p) + vec3(20, -7, 4);
    const FaceClusterTree tree = build(soup);
    const std::span<const vec3> outline = outline_of_root(tree);
    ASSERT_EQ(outline.size(), 4u) << n;
    EXPECT_NEAR(area_about(outline, turn * vec3(0, 0, 1)), 3, 3e-4) << n;
    for (const vec3 corner : {vec3(0, 0, 0), vec3(3, 0, 0), vec3(3, 1, 0), vec3(0, 1, 0)}) {
      const vec3 there = turn * corner + vec3(20, -7, 4);
      const auto near = [&](const vec3& p) { return length(p - there) < 1e-4f; };
      EXPECT_EQ(std::count_if(outline.begin(), outline.end(), near), 1) << n;
    }
    expect_filled(tree);
  }
}

TEST(FlatOutlines, OfACubeItsSixFaces) {
  const FaceClusterTree tree = build(shapes::cube(8));
  EXPECT_TRUE(outline_of_root(tree).empty());
  int faces = 0;
  for (uint32_t i = 0; i < tree.nodes.size(); ++i)
    faces += !tree.outlines.of(i).empty() && tree.nodes[i].count == 128;
  EXPECT_EQ(faces, 6);
  expect_filled(tree);
}

TEST(FlatOutlines, NoneOfWhatIsNotConvex) {
  // An L, and a frame round a hole.
  for (const bool hole : {false, true}) {
    const shapes::Soup whole = shapes::flat_grid(6);
    shapes::Soup soup;
    soup.positions = whole.positions;
    for (size_t t = 0; t < whole.indices.size(); t += 3) {
      vec3 middle(0);
      for (size_t k = 0; k < 3; ++k) middle += whole.positions[whole.indices[t + k]] / 3.0f;
      const bool out = hole ? std::abs(middle.x - 0.5f) < 1.0f / 6 && std::abs(middle.y - 0.5f) < 1.0f / 6
                            : middle.x > 0.5f && middle.y > 0.5f;
      if (!out) soup.triangle(whole.indices[t], whole.indices[t + 1], whole.indices[t + 2]);
    }
    const FaceClusterTree tree = build(soup);
    ASSERT_EQ(tree.roots.size(), 1u);
    EXPECT_TRUE(outline_of_root(tree).empty());
    expect_filled(tree);
  }
}

TEST(FlatOutlines, NoneOfWhatIsBentOrFolded) {
  EXPECT_TRUE(outline_of_root(build(shapes::wavy_grid(8))).empty());
  // Bent by a hundredth of its width along the middle.
  const auto ridge = [](float x, float) { return 0.01f * std::min(x, 1 - x); };
  const FaceClusterTree bent = build(shapes::grid(8, ridge));
  EXPECT_TRUE(outline_of_root(bent).empty());
  expect_filled(bent);
  // A square and its mirror image folded onto it: one area, nothing in sum.
  shapes::Soup fold;
  fold.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, 1e-7f}, {1, 1, 1e-7f}};
  fold.quad(0, 1, 2, 3);
  fold.quad(0, 3, 5, 4);
  EXPECT_TRUE(outline_of_root(build(fold)).empty());
}

TEST(FlatOutlines, NoneOfWhatIsThickerThanRaysKeepOff) {
  for (const float uneven : {1e-7f, 1e-4f}) {
    const auto rough = [&](float x, float y) {
      return uneven * static_cast<float>((int(8 * x + 0.5f) + int(8 * y + 0.5f)) % 2);
    };
    EXPECT_EQ(outline_of_root(build(shapes::grid(8, rough))).size(), uneven < 1e-6f ? 4u : 0u);
  }
}

TEST(FlatOutlines, NoneOfMoreCornersThanAreKept) {
  for (const uint32_t corners : {8u, 9u, 60u}) {
    shapes::Soup soup;
    for (uint32_t i = 0; i < corners; ++i) {
      const float a = 2 * kPi * static_cast<float>(i) / static_cast<float>(corners);
      soup.positions.emplace_back(std::cos(a), std::sin(a), 0);
    }
    for (uint32_t i = 1; i + 1 < corners; ++i) soup.triangle(0, i, i + 1);
    for (const float narrow : {1.0f, 0.1f}) {
      for (vec3& p : soup.positions) p.y *= narrow;
      const FaceClusterTree tree = build(soup);
      EXPECT_EQ(outline_of_root(tree).size(), corners == 8 ? 8u : 0u);
      expect_filled(tree);
    }
  }
}

TEST(FlatOutlines, SliversAndPointsDoNotHarm) {
  shapes::Soup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0.5f, 1e-6f, 0}, {0.5f, 1, 0}, {0.5f, 1, 0}};
  soup.triangle(0, 1, 2);
  soup.triangle(0, 2, 3);
  soup.triangle(2, 1, 4);
  const FaceClusterTree tree = build(soup);
  expect_filled(tree);
}

}  // namespace
}  // namespace goldthread
