#include "reconstruct/triangulate.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <map>

#include "element/small_elements.h"

namespace goldthread {
namespace {

using test::Random;

struct Quality {
  float area = 0, least = 1e30f;
  bool all_used = true, watertight = true, one_way = true;
};

Quality triangulate(const std::vector<vec3>& loop, const vec3& normal) {
  std::vector<UVec3> triangles;
  triangulate_face(loop, triangles);
  EXPECT_EQ(triangles.size(), loop.size() - 2);
  Quality q;
  std::vector<int> used(loop.size(), 0);
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const UVec3& t : triangles) {
    const vec3 area = area_vector(loop[t.x], loop[t.y], loop[t.z]);
    q.area += dot(area, normal);
    q.least = std::min(q.least, length(area));
    q.one_way &= dot(area, normal) >= 0;
    for (int k = 0; k < 3; ++k) {
      ++used[t[k]];
      ++edges[{t[k], t[(k + 1) % 3]}];
    }
  }
  for (const int u : used) q.all_used &= u > 0;
  const auto n = uint32_t(loop.size());
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    const bool border = edge.second == (edge.first + 1) % n;
    q.watertight &= count == 1 && (border ? back == edges.end() : back != edges.end());
  }
  return q;
}

/// Points on a circle or on the sides of a random convex polygon, with collinear runs on its sides.
std::vector<vec3> convex_loop(Random& random, float& area) {
  std::vector<float> angles;
  const uint32_t corners = 3 + random.below(5);
  for (uint32_t i = 0; i < corners; ++i)
    angles.push_back(2 * kPi * (float(i) + random.in(0.1f, 0.9f)) / float(corners));
  std::vector<vec3> loop;
  const float squeeze = random.in(0.2f, 1);
  const auto at = [&](float a) { return vec3(std::cos(a), squeeze * std::sin(a), 0); };
  area = 0;
  for (uint32_t i = 0; i < corners; ++i) {
    const vec3 a = at(angles[i]), b = at(angles[(i + 1) % corners]);
    loop.push_back(a);
    area += 0.5f * (a.x * b.y - a.y * b.x);
    const uint32_t between = random.below(4);
    for (uint32_t k = 1; k <= between; ++k) loop.push_back(a + (float(k) / float(between + 1)) * (b - a));
  }
  std::rotate(loop.begin(), loop.begin() + random.below(uint32_t(loop.size())), loop.end());
  return loop;
}

TEST(TriangulateFace, TriangleAndQuad) {
  const Quality one = triangulate({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {0, 0, 1});
  EXPECT_FLOAT_EQ(one.area, 0.5f);
  const Quality two = triangulate({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {0, 0, 1});
  EXPECT_FLOAT_EQ(two.area, 1);
  EXPECT_FLOAT_EQ(two.least, 0.5f);
}

TEST(TriangulateFace, AppendsToWhatIsThere) {
  std::vector<UVec3> triangles{{7, 8, 9}};
  const std::vector<vec3> loop{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  triangulate_face(loop, triangles);
  ASSERT_EQ(triangles.size(), 3u);
  EXPECT_EQ(triangles[0], UVec3(7, 8, 9));
}

TEST(TriangulateFace, TVerticesOnEverySide) {
  const Quality q = triangulate(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}, {0, 2, 0}, {0, 1, 0}}, {0, 0, 1});
  EXPECT_TRUE(q.all_used);
  EXPECT_TRUE(q.watertight);
  EXPECT_FLOAT_EQ(q.area, 4);
  EXPECT_GE(q.least, 0.499f);
}

TEST(TriangulateFace, ATriangleWithAllItsTVerticesOnOneSide) {
  const Quality q =
      triangulate({{0, 0, 0}, {0.1f, 0, 0}, {0.2f, 0, 0}, {0.7f, 0, 0}, {1, 0, 0}, {0.2f, 1, 0}}, {0, 0, 1});
  EXPECT_TRUE(q.all_used && q.watertight && q.one_way);
  EXPECT_NEAR(q.area, 0.5f, 1e-6f);
  EXPECT_GT(q.least, 0.01f);
}

RC_GTEST_PROP(TriangulateFace, ConvexLoopsWithCollinearCorners, (uint32_t seed)) {
  Random random(seed);
  float area = 0;
  std::vector<vec3> loop = convex_loop(random, area);
  vec3 normal(0, 0, 1);
  if (seed % 2 == 0) {
    const mat3 by(test::turn(random.in(0, 6), random.direction()));
    for (vec3& p : loop) p = 100.0f * (by * p);
    normal = by * normal;
    area *= 1e4f;
  }
  const Quality q = triangulate(loop, normal);
  RC_ASSERT(q.all_used);
  RC_ASSERT(q.watertight);
  RC_ASSERT(q.one_way);
  RC_ASSERT(std::abs(q.area - area) < 1e-4f * area);
  RC_ASSERT(q.least > 1e-6f * area);
}

}  // namespace
}  // namespace goldthread
