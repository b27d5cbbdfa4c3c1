#include "element/polygon_view.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "base/rng.h"

namespace goldthread {
namespace {

ElementPolygon polygon_of(const std::vector<vec3>& corners) {
  ElementPolygon polygon;
  polygon.count = corners.size();
  std::copy(corners.begin(), corners.end(), polygon.corners.begin());
  return polygon;
}

// A rectangle and a pentagon in the plane y = 0, which send upwards.
std::vector<ElementPolygon> polygons() {
  return {polygon_of({{-1, 0, -2}, {-1, 0, 2}, {3, 0, 2}, {3, 0, -2}}),
          polygon_of({{0, 0, -1}, {-1, 0, 0}, {-0.5f, 0, 1}, {0.6f, 0, 1.1f}, {1, 0, 0}})};
}

TEST(PolygonView, WeightsAddUpToTheFormFactor) {
  // Near, where places are drawn by solid angle, and far, where by area; the receiver's horizon cuts neither.
  for (const ElementPolygon& polygon : polygons()) {
    for (const vec3 x : {vec3(0.2f, 0.1f, 0.1f), vec3(0.5f, 1, -0.3f), vec3(1, 30, 2)}) {
      const vec3 n = normalize(vec3(0, -1, 0));
      const PolygonView view(PolygonSampler(polygon, {0, 1, 0}, 7), x);
      constexpr uint32_t kCount = 1 << 16;
      double sum = 0;
      for (uint32_t i = 0; i < kCount; ++i) {
        const UnitSquarePoint uv = r2_point(i, 5);
        float weight = 0;
        const SurfacePoint y = view.sample(n, uv.u, uv.v, weight);
        sum += static_cast<double>(weight);
        ASSERT_NEAR(y.position.y, 0, 2e-6f * x.y);
        ASSERT_EQ(y.triangle, 7u);
      }
      const auto exact = static_cast<double>(dot(n, polygon_form_factor(x, n, polygon.span())));
      EXPECT_NEAR(sum / (kCount * static_cast<double>(kPi)), exact, 2e-3 * exact) << x.y;
    }
  }
}

TEST(PolygonView, PlacesAreDrawnByWhatTheySend) {
  // Of all that is sent a half-plane's share of the places brings its share: against the part's form factor.
  const ElementPolygon whole = polygons()[0],
                       part = polygon_of({{-1, 0, -2}, {-1, 0, 2}, {0.4f, 0, 2}, {0.4f, 0, -2}});
  const vec3 x(0.2f, 0.3f, 0.1f), n = normalize(vec3(0.1f, -1, 0.05f));
  const PolygonView view(PolygonSampler(whole, {0, 1, 0}, 0), x);
  constexpr uint32_t kCount = 1 << 16;
  double sum = 0;
  for (uint32_t i = 0; i < kCount; ++i) {
    const UnitSquarePoint uv = r2_point(i, 9);
    float weight = 0;
    const SurfacePoint y = view.sample(n, uv.u, uv.v, weight);
    if (y.position.x < 0.4f) sum += static_cast<double>(weight);
  }
  const auto exact = static_cast<double>(dot(n, polygon_form_factor(x, n, part.span())));
  EXPECT_NEAR(sum / (kCount * static_cast<double>(kPi)), exact, 2e-3 * exact);
}

TEST(PolygonView, NothingComesFromBehind) {
  const PolygonView view(PolygonSampler(polygons()[0], {0, 1, 0}, 0), {0, -0.5f, 0});
  float weight = 1;
  view.sample({0, 1, 0}, 0.3f, 0.6f, weight);
  EXPECT_EQ(weight, 0);
}

TEST(PolygonSampler, PlacesAreEvenByArea) {
  for (const ElementPolygon& polygon : polygons()) {
    const PolygonSampler places(polygon, polygon.normal(), 0);
    EXPECT_NEAR(places.normal().y, 1, 1e-6);
    constexpr uint32_t kCount = 1 << 14;
    // The mean over the places is the centroid, of the fan's triangles by area.
    vec3 mean(0), centroid(0);
    float area = 0;
    for (size_t i = 1; i + 1 < polygon.count; ++i) {
      const vec3 &a = polygon.corners[0], &b = polygon.corners[i], &c = polygon.corners[i + 1];
      const float part = 0.5f * length(cross(b - a, c - a));
      centroid += part * (a + b + c) / 3.0f;
      area += part;
    }
    for (uint32_t i = 0; i < kCount; ++i) {
      const UnitSquarePoint uv = r2_point(i, 3);
      mean += places.sample(uv.u, uv.v).position / static_cast<float>(kCount);
    }
    EXPECT_NEAR(places.area(), area, 1e-5f);
    EXPECT_LT(length(mean - centroid / area), 2e-3f);
  }
}

TEST(SphericalPolygon, TheEndsOfTheSquareAreItsEdges) {
  // No rounding takes a direction out of a triangle, however thin.
  for (const float thin : {1.0f, 1e-2f, 1e-3f}) {
    const std::vector<vec3> corners{{1, 0, 1}, {0, thin, 1}, {-1, 0, 1}};
    const SphericalPolygon seen(corners);
    for (const float u : {0.0f, 0.5f, 0.99999994f})
      for (const float v : {0.0f, 0.5f, 0.99999994f}) {
        const vec3 d = seen.sample(u, v);
        EXPECT_NEAR(length(d), 1, 1e-5);
        EXPECT_GT(d.y, -1e-6f) << thin << " " << u << " " << v;
        EXPECT_LT(std::abs(d.x) / d.z, 1 + 1e-5f) << thin << " " << u << " " << v;
      }
  }
}

}  // namespace
}  // namespace goldthread
