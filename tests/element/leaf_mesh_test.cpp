#include "element/leaf_mesh.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "element/small_elements.h"
#include "mesh/dual_graph.h"

namespace goldthread {
namespace {

using test::Random;

struct Mesh {
  TriangleMesh triangles;
  Part part;
  LeafMesh leaves;

  static Part place(const TriangleMesh& mesh) {
    Part part;
    part.positions = mesh.positions;
    return part;
  }
  explicit Mesh(const shapes::Soup& soup)
      : triangles(soup.weld()), part(place(triangles)), leaves(part, triangles) {}
};

vec3 loop_area(const LeafMesh& mesh, uint32_t face) {
  std::vector<uint32_t> loop;
  mesh.loop(face, loop);
  vec3 sum(0);
  for (size_t i = 1; i + 1 < loop.size(); ++i)
    sum += area_vector(mesh.positions()[loop[0]], mesh.positions()[loop[i]], mesh.positions()[loop[i + 1]]);
  return sum;
}

/// The pieces of every triangle add up to it, on the same side.
void expect_areas_kept(const Mesh& mesh) {
  std::vector<vec3> sum(mesh.triangles.triangles.size(), vec3(0));
  for (uint32_t f = 0; f < mesh.leaves.face_count(); ++f)
    sum[mesh.leaves.triangle_of_face(f)] += loop_area(mesh.leaves, f);
  for (size_t t = 0; t < sum.size(); ++t) {
    const UVec3& c = mesh.triangles.triangles[t];
    const std::vector<vec3>& p = mesh.triangles.positions;
    const vec3 whole = area_vector(p[c.x], p[c.y], p[c.z]);
    const float longest =
        std::max({length(p[c.y] - p[c.x]), length(p[c.z] - p[c.y]), length(p[c.x] - p[c.z])});
    ASSERT_LE(length(sum[t] - whole), 1e-5f * longest * longest) << t;
  }
}

uint32_t random_edge(const LeafMesh& mesh, uint32_t face, Random& random) {
  uint32_t edge = mesh.first_edge(face);
  for (uint32_t steps = random.below(12); steps > 0; --steps) edge = mesh.next(edge);
  return edge;
}

void cut_at_random(Mesh& mesh, Random& random, int cuts) {
  for (int i = 0; i < cuts; ++i) {
    const uint32_t face = random.below(mesh.leaves.face_count());
    const uint32_t edge = random_edge(mesh.leaves, face, random);
    if (random.below(2) == 0) {
      const vec3 a = mesh.leaves.positions()[mesh.leaves.origin(edge)];
      const vec3 b = mesh.leaves.positions()[mesh.leaves.origin(mesh.leaves.next(edge))];
      mesh.leaves.split_edge(edge, a + random.in(0.1f, 0.9f) * (b - a));
    } else {
      const uint32_t to = random_edge(mesh.leaves, face, random);
      if (to == edge || mesh.leaves.next(edge) == to || mesh.leaves.next(to) == edge) continue;
      mesh.leaves.split_face(edge, to);
    }
  }
}

shapes::Soup finite_soup(uint32_t seed) {
  Random random(seed);
  shapes::Soup soup;
  for (int i = 0; i < 9; ++i) soup.positions.push_back(random.point());
  for (int t = 0; t < 24; ++t) {
    const uint32_t a = random.below(9), b = random.below(9), c = random.below(9);
    if (a != b && b != c && c != a) soup.triangle(a, b, c);
  }
  return soup;
}

TEST(LeafMesh, StartsAsTheTriangles) {
  const Mesh mesh(shapes::cube(3));
  validate(mesh.leaves);
  ASSERT_EQ(mesh.leaves.face_count(), mesh.triangles.triangles.size());
  const std::vector<uint32_t> twins = find_twins(mesh.triangles);
  for (uint32_t e = 0; e < 3 * mesh.leaves.face_count(); ++e) {
    EXPECT_EQ(mesh.leaves.twin(e), twins[e]);
    EXPECT_EQ(mesh.leaves.face(e), e / 3);
  }
}

TEST(LeafMesh, ACutEdgeIsSeenByBothNeighbours) {
  shapes::Soup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  soup.quad(0, 1, 2, 3);
  for (const bool flipped : {false, true}) {
    if (flipped) std::swap(soup.indices[4], soup.indices[5]);
    Mesh mesh(soup);
    uint32_t shared = 0;
    while (mesh.leaves.twin(shared) == kNoEdge) ++shared;
    const uint32_t vertex = mesh.leaves.split_edge(shared, {0.5f, 0.5f, 0});
    validate(mesh.leaves);
    std::vector<uint32_t> loop;
    for (uint32_t f = 0; f < 2; ++f) {
      mesh.leaves.loop(f, loop);
      ASSERT_EQ(loop.size(), 4u);
      EXPECT_EQ(std::count(loop.begin(), loop.end(), vertex), 1);
    }
    // Both halves are still edges of two faces, so that a later cut of either is seen too.
    EXPECT_NE(mesh.leaves.twin(shared), kNoEdge);
    EXPECT_NE(mesh.leaves.twin(mesh.leaves.next(shared)), kNoEdge);
    expect_areas_kept(mesh);
  }
}

TEST(LeafMesh, SplitFaceKeepsTheNumberOnTheFirstSide) {
  Mesh mesh(test::polygon({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  const uint32_t first = mesh.leaves.first_edge(0);
  mesh.leaves.split_edge(first, {0.5f, 0, 0});
  const uint32_t from = mesh.leaves.next(first), to = mesh.leaves.next(mesh.leaves.next(from));
  const uint32_t made = mesh.leaves.split_face(from, to);
  validate(mesh.leaves);
  EXPECT_EQ(made, 1u);
  EXPECT_EQ(mesh.leaves.face(from), 0u);
  EXPECT_EQ(mesh.leaves.face(to), 1u);
  EXPECT_EQ(mesh.leaves.triangle_of_face(1), 0u);
  EXPECT_NEAR(loop_area(mesh.leaves, 0).z, 0.25f, 1e-6f);
  EXPECT_NEAR(loop_area(mesh.leaves, 1).z, 0.25f, 1e-6f);
}

RC_GTEST_PROP(LeafMesh, AnyCutsKeepItSound, (uint32_t seed)) {
  Random random(seed);
  // Triangles over few points: edges of three and more faces, flipped neighbours, doubles.
  Mesh soup(finite_soup(seed));
  if (soup.leaves.face_count() == 0) return;
  cut_at_random(soup, random, 200);
  validate(soup.leaves);
  expect_areas_kept(soup);
  Mesh band(shapes::moebius(12));
  cut_at_random(band, random, 200);
  validate(band.leaves);
  expect_areas_kept(band);
}

TEST(LeafMesh, MemoryIsCounted) {
  Mesh mesh(shapes::cube(8));
  const uint64_t before = mesh.leaves.memory_bytes();
  EXPECT_GE(before, 3 * 4 * sizeof(uint32_t) * mesh.leaves.face_count());
  Random random(3);
  cut_at_random(mesh, random, 5000);
  EXPECT_GT(mesh.leaves.memory_bytes(), before);
}

}  // namespace
}  // namespace goldthread
