// The points that stand for a polygon: inside it, and right for functions of second degree.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "element/small_elements.h"

namespace goldthread {
namespace {

using test::Elements;
using test::Random;

struct Moments {
  double area = 0;
  dvec3 mean{0};
  glm::dmat3 second{0};  ///< mean of p p^T about the mean
};

/// Exact, by the edge-midpoint rule on the fan, which is right for quadratics.
Moments moments_of(const ElementPolygon& polygon) {
  Moments m;
  const auto add = [&](const auto& value) {
    for (size_t i = 1; i + 1 < polygon.count; ++i) {
      const dvec3 a(polygon.corners[0]), b(polygon.corners[i]), c(polygon.corners[i + 1]);
      value(length(cross(b - a, c - a)) / 2, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
    }
  };
  add([&](double area, const dvec3& p, const dvec3& q, const dvec3& r) {
    m.area += area;
    m.mean += area / 3 * (p + q + r);
  });
  m.mean /= m.area;
  add([&](double area, const dvec3& p, const dvec3& q, const dvec3& r) {
    for (const dvec3& at : {p, q, r})
      m.second += area / (3 * m.area) * glm::outerProduct(at - m.mean, at - m.mean);
  });
  return m;
}

double size_of(const glm::dmat3& m) {
  return std::sqrt(dot(m[0], m[0]) + dot(m[1], m[1]) + dot(m[2], m[2]));
}

bool inside(const ElementPolygon& polygon, const vec3& normal, const vec3& p, float slack) {
  for (size_t i = 0; i < polygon.count; ++i) {
    const vec3 &a = polygon.corners[i], &b = polygon.corners[(i + 1) % polygon.count];
    if (dot(cross(b - a, p - a), normal) < -slack * length(b - a)) return false;
  }
  return std::abs(dot(p - polygon.corners[0], normal)) <= slack;
}

void expect_exact(const ElementPool& pool, ElementId id, size_t points) {
  SCOPED_TRACE("element " + std::to_string(id) + " kind " + std::to_string(int(pool[id].kind)));
  std::array<SurfacePoint, 16> at;
  pool.quadrature(id, {at.data(), points});
  const ElementPolygon polygon = pool.polygon(id);
  const Moments exact = moments_of(polygon);
  const vec3 normal = normalize(pool[id].summed_normal);
  dvec3 mean(0);
  for (size_t i = 0; i < points; ++i) {
    mean += dvec3(at[i].position) / double(points);
    ASSERT_TRUE(inside(polygon, normal, at[i].position, 1e-5f * (pool[id].radius + length(pool[id].centre))));
    ASSERT_GT(dot(at[i].normal, normal), 0.9999f);
  }
  const double radius = double(pool[id].radius), place = double(length(pool[id].centre));
  ASSERT_LE(length(mean - exact.mean), 1e-5 * (radius + place));
  glm::dmat3 second(0);
  for (size_t i = 0; i < points; ++i) {
    const dvec3 d = dvec3(at[i].position) - mean;
    second += glm::outerProduct(d, d) / double(points);
  }
  // The points are drawn in by 0.5% so that none lies on an edge, hence 1% of the variance.
  ASSERT_LE(size_of(second - exact.second),
            0.0101 * size_of(exact.second) + 1e-5 * radius * (radius + place));
}

RC_GTEST_PROP(Quadrature, QuadraticsOnTrianglesAndPatches, (uint32_t seed)) {
  Random random(seed);
  Scene scene;
  shapes::Soup soup;
  for (int i = 0; i < 12; ++i) soup.positions.push_back(3.0f * random.point());
  soup.indices = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  test::add(scene, soup, test::add(scene, test::diffuse(0.5f)),
            seed % 2 == 0 ? test::scale({-1, 1, 1}) : mat4(1));
  Elements elements(std::move(scene));
  elements.expand_some(random, 7, 0.8f);
  for (ElementId id = 0; id < elements.pool->size(); ++id) {
    const ElementKind kind = (*elements.pool)[id].kind;
    if (kind != ElementKind::kTriangle && kind != ElementKind::kPatch) continue;
    for (const size_t points : {size_t{4}, size_t{8}, size_t{16}}) expect_exact(*elements.pool, id, points);
    RC_ASSERT(!::testing::Test::HasFatalFailure());
  }
}

TEST(Quadrature, LongThinTriangles) {
  Scene scene;
  shapes::Soup soup;
  soup.positions = {{0, 0, 0}, {10, 0, 0}, {10, 0.01f, 0}, {0, 1, 0}, {10, 1, 0}, {5, 1.02f, 0.01f}};
  soup.indices = {0, 1, 2, 3, 4, 5};
  test::add(scene, soup, test::add(scene, test::diffuse(0.5f)));
  Elements elements(std::move(scene));
  elements.expand(4);
  for (ElementId id = 1; id < elements.pool->size(); ++id) {
    if ((*elements.pool)[id].kind == ElementKind::kVolume) continue;
    expect_exact(*elements.pool, id, 4);
    expect_exact(*elements.pool, id, 8);
  }
}

TEST(Quadrature, ManyPointsAreDistinct) {
  Scene scene;
  test::add(scene, test::polygon({{0, 0, 0}, {2, 0, 0}, {0, 1, 0}}), test::add(scene, test::diffuse(0.5f)));
  const Elements elements(std::move(scene));
  std::array<SurfacePoint, 8> at;
  elements.pool->quadrature(elements.pool->root(), at);
  for (size_t i = 0; i < at.size(); ++i)
    for (size_t j = 0; j < i; ++j) EXPECT_GT(length(at[i].position - at[j].position), 0.01f) << i << " " << j;
}

/// Samples of one polygon fill it evenly: moments again, now of many points.
RC_GTEST_PROP(Quadrature, SamplesFillPolygonsEvenly, (uint32_t seed)) {
  Random random(seed);
  Scene scene;
  test::add(scene, test::polygon({random.point(), random.point(), random.point()}),
            test::add(scene, test::diffuse(0.5f)));
  Elements elements(std::move(scene));
  elements.expand(3);
  const ElementId id = ElementId(elements.pool->size() - 1);
  const ElementPolygon polygon = elements.pool->polygon(id);
  const Moments exact = moments_of(polygon);
  RC_PRE(exact.area > 1e-4);
  const vec3 normal = normalize((*elements.pool)[id].summed_normal);
  constexpr int kRoot = 400;  // the grid against the fan: at 200 its own error nears the bound
  dvec3 mean(0);
  glm::dmat3 second(0);
  for (int i = 0; i < kRoot; ++i)
    for (int j = 0; j < kRoot; ++j) {
      const SurfacePoint p =
          elements.pool->sample_at(id, (float(i) + 0.5f) / kRoot, (float(j) + 0.5f) / kRoot);
      RC_ASSERT(inside(polygon, normal, p.position, 1e-5f));
      mean += dvec3(p.position) / double(kRoot * kRoot);
      second += glm::outerProduct(dvec3(p.position) - exact.mean, dvec3(p.position) - exact.mean) /
                double(kRoot * kRoot);
    }
  const double radius = double((*elements.pool)[id].radius);
  RC_ASSERT(length(mean - exact.mean) < 0.01 * radius);
  RC_ASSERT(size_of(second - exact.second) < 0.01 * size_of(exact.second));
}

}  // namespace
}  // namespace goldthread
