#include "cluster/cluster_box.h"

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace goldthread {
namespace {

const glm::quat kTurn = glm::angleAxis(0.7f, normalize(vec3(1, 2, 3)));

FaceClusterTree build(shapes::Soup soup, const vec3& scale, const glm::quat& turn, const vec3& shift) {
  for (vec3& p : soup.positions) p = turn * (scale * p) + shift;
  return build_face_clusters(soup.weld());
}

void expect_inside(const FaceClusterTree& tree, ClusterRef ref, const OrientedBox& box) {
  EXPECT_NEAR(glm::determinant(box.axes), 1, 1e-5f);
  const uint32_t first = is_triangle(ref) ? triangle_of(ref) : tree.nodes[ref].first;
  const uint32_t count = is_triangle(ref) ? 1 : tree.nodes[ref].count;
  const float slack = 1e-5f * length(box.half) + 1e-6f * length(box.centre);
  for (uint32_t t = first; t < first + count; ++t)
    for (int k = 0; k < 3; ++k) {
      const vec3 p = (tree.mesh.positions[tree.mesh.triangles[t][k]] - box.centre) * box.axes;
      for (int axis = 0; axis < 3; ++axis) EXPECT_LE(std::abs(p[axis]), box.half[axis] + slack);
    }
}

TEST(ClusterBox, ATurnedPanelIsFoundExactly) {
  const FaceClusterTree tree = build(shapes::flat_grid(9), vec3(4, 1, 1), kTurn, vec3(10, 20, 30));
  const OrientedBox box = fit_box(tree, tree.roots[0]);
  expect_inside(tree, tree.roots[0], box);
  EXPECT_NEAR(length(box.half - vec3(2, 0.5f, 0)), 0, 1e-4f);
  EXPECT_NEAR(std::abs(dot(box.axes[2], kTurn * vec3(0, 0, 1))), 1, 1e-5f);
  EXPECT_NEAR(length(box.centre - (kTurn * vec3(2, 0.5f, 0) + vec3(10, 20, 30))), 0, 1e-4f);
}

TEST(ClusterBox, EveryClusterOfEveryShapeIsInside) {
  for (const shapes::Soup& soup :
       {shapes::wavy_grid(20), shapes::cube(4), shapes::sphere(12), shapes::moebius(20)}) {
    const FaceClusterTree tree = build(soup, vec3(3), kTurn, vec3(100, 0, 0));
    for (ClusterRef i = 0; i < tree.nodes.size(); ++i) expect_inside(tree, i, fit_box(tree, i));
    for (ClusterRef t = 0; t < tree.mesh.triangles.size(); ++t)
      expect_inside(tree, t | kTriangleBit, fit_box(tree, t | kTriangleBit));
  }
}

TEST(ClusterBox, AnUprightCubeAndALongBlock) {
  const FaceClusterTree cube = build(shapes::cube(3), vec3(1), glm::quat(1, 0, 0, 0), vec3(0));
  EXPECT_NEAR(fit_box(cube, cube.roots[0]).surface_area(), 6, 1e-4f);
  const FaceClusterTree block = build(shapes::cube(3), vec3(5, 2, 1), kTurn, vec3(0));
  const OrientedBox box = fit_box(block, block.roots[0]);
  EXPECT_NEAR(length(box.half - vec3(2.5f, 1, 0.5f)), 0, 0.06f);
}

TEST(ClusterBox, ATwoSidedSheetIsFlatToo) {
  shapes::Soup sheet = shapes::flat_grid(4);
  const std::vector<uint32_t> front = sheet.indices;
  for (size_t i = 0; i < front.size(); i += 3) sheet.triangle(front[i], front[i + 2], front[i + 1]);
  const FaceClusterTree tree = build(sheet, vec3(2, 1, 1), kTurn, vec3(0));
  const OrientedBox box = fit_box(tree, tree.roots[0]);
  EXPECT_NEAR(length(box.half - vec3(1, 0.5f, 0)), 0, 1e-4f);
}

}  // namespace
}  // namespace goldthread
