#include "math/form_factor.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace goldthread {
namespace {

using Corners = std::vector<vec3>;
constexpr double kPiDouble = 3.14159265358979323846;

float factor(const vec3& x, const vec3& n, const Corners& corners) {
  return dot(n, polygon_form_factor(x, n, corners));
}

/// Differential element to a parallel rectangle a by b, h away, one corner of which lies on the element's
/// normal (Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-3).
double parallel_rectangle(double a, double b, double h) {
  const double A = a / h, B = b / h, p = std::sqrt(1 + A * A), q = std::sqrt(1 + B * B);
  return (A / p * std::atan(B / p) + B / q * std::atan(A / q)) / (2 * kPiDouble);
}

/// Differential element to a rectangle in a plane perpendicular to its own, `a` high above that and b wide, c
/// away; the element is opposite the end of the rectangle's foot (Howell, B-4).
double perpendicular_rectangle(double a, double b, double c) {
  const double d = std::sqrt(a * a + c * c);
  return (std::atan(b / c) - c / d * std::atan(b / d)) / (2 * kPiDouble);
}

struct Random {
  std::mt19937 engine;
  float in(float low, float high) {
    return low + (high - low) * static_cast<float>(engine() >> 8) * 0x1p-24f;
  }
  vec3 direction() {
    const float z = in(-1, 1), angle = in(0, 2 * kPi), r = std::sqrt(std::max(0.0f, 1 - z * z));
    return normalize(vec3(r * std::cos(angle), r * std::sin(angle), z));
  }
};

/// The six faces of a box, sending inwards.
std::vector<Corners> box_faces(const vec3& low, const vec3& high) {
  std::vector<Corners> faces;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool far : {false, true}) {
      vec3 a = low, b = low, c = low, d = low;
      a[axis] = b[axis] = c[axis] = d[axis] = far ? high[axis] : low[axis];
      b[u] = c[u] = high[u];
      c[v] = d[v] = high[v];
      faces.push_back(far ? Corners{a, d, c, b} : Corners{a, b, c, d});
    }
  }
  return faces;
}

/// The definition, by the midpoint rule: integral of cos * cos / (pi r^2) over a parallelogram.
double by_quadrature(const vec3& x, const vec3& n, const vec3& corner, const vec3& across, const vec3& up) {
  constexpr int kCells = 700;
  const dvec3 area = cross(dvec3(across), dvec3(up)) / double(kCells * kCells);
  double sum = 0;
  for (int j = 0; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) {
      const dvec3 d =
          dvec3(corner) + (i + 0.5) / kCells * dvec3(across) + (j + 0.5) / kCells * dvec3(up) - dvec3(x);
      const double here = dot(d, dvec3(n)), there = -dot(d, area), squared = dot(d, d);
      if (here > 0 && there > 0) sum += here * there / (kPiDouble * squared * squared);
    }
  return sum;
}

TEST(PolygonFormFactor, ParallelRectangle) {
  for (const double a : {0.01, 0.5, 1.0, 30.0})
    for (const double b : {0.2, 1.0, 7.0})
      for (const double h : {0.01, 1.0, 10.0}) {
        const float A = float(a), B = float(b), H = float(h);
        const Corners down{{0, 0, H}, {0, B, H}, {A, B, H}, {A, 0, H}};
        const double exact = parallel_rectangle(double(A), double(B), double(H));
        EXPECT_NEAR(factor({0, 0, 0}, {0, 0, 1}, down), exact, 1e-6 + 1e-5 * exact)
            << a << " " << b << " " << h;
      }
}

TEST(PolygonFormFactor, PerpendicularRectangle) {
  for (const double a : {0.01, 1.0, 20.0})
    for (const double b : {0.1, 1.0, 8.0})
      for (const double c : {1e-5, 0.01, 1.0, 5.0}) {
        const float A = float(a), B = float(b), C = float(c);
        const Corners wall{{C, 0, 0}, {C, 0, A}, {C, B, A}, {C, B, 0}};  // sends to -x
        const double exact = perpendicular_rectangle(double(A), double(B), double(C));
        EXPECT_NEAR(factor({0, 0, 0}, {0, 0, 1}, wall), exact, 1e-6 + 1e-5 * exact)
            << a << " " << b << " " << c;
      }
}

TEST(PolygonFormFactor, HorizonCutsTheWallInHalf) {
  // As the wall above, but reaching as far below the floor: the lower half must count for nothing.
  const Corners wall{{1, 0, -2}, {1, 0, 2}, {1, 3, 2}, {1, 3, -2}};
  EXPECT_NEAR(factor({0, 0, 0}, {0, 0, 1}, wall), perpendicular_rectangle(2, 3, 1), 1e-6);
}

TEST(PolygonFormFactor, TiltedElementAgainstTheDefinition) {
  Random random{std::mt19937(7)};
  const vec3 corner(-0.4f, -0.7f, 1), across(0, 1.9f, 0.3f), up(1.2f, 0.1f, 0.2f);
  const Corners corners{corner, corner + across, corner + across + up, corner + up};
  for (int i = 0; i < 20; ++i) {
    const vec3 n = random.direction();
    EXPECT_NEAR(factor(vec3(0), n, corners), by_quadrature(vec3(0), n, corner, across, up), 2e-5) << i;
  }
}

RC_GTEST_PROP(PolygonFormFactor, ClosedBoxSumsToOne, (uint32_t seed)) {
  Random random{std::mt19937(seed)};
  const vec3 low(random.in(-3, 0), random.in(-3, 0), random.in(-3, 0));
  const vec3 high = low + vec3(random.in(0.1f, 9), random.in(0.1f, 9), random.in(0.1f, 9));
  const vec3 share(random.in(0.001f, 0.999f), random.in(0.001f, 0.999f), random.in(0.001f, 0.999f));
  const vec3 x = low + share * (high - low), n = random.direction();
  vec3 sum(0);
  for (const Corners& face : box_faces(low, high)) {
    const vec3 m = polygon_form_factor(x, n, face);
    RC_ASSERT(dot(m, n) >= 0 && dot(m, n) <= 1.00001f);
    sum += m;
  }
  RC_ASSERT(std::abs(dot(sum, n) - 1) < 1e-5f);
  // Light from everywhere: its irradiance vector is the normal itself. Close to a face, the rounding of its
  // cut at the horizon turns the vector along that horizon.
  float nearest = INFINITY;
  for (int k = 0; k < 3; ++k) nearest = std::min({nearest, x[k] - low[k], high[k] - x[k]});
  RC_ASSERT(length(sum - n) < 1e-5f + 3e-6f * length(high - low) / nearest);
}

RC_GTEST_PROP(PolygonFormFactor, SidesOfACutAddUp, (uint32_t seed)) {
  Random random{std::mt19937(seed)};
  const vec3 a = 3.0f * random.direction(), b = 3.0f * random.direction(), c = 3.0f * random.direction();
  const vec3 middle = 0.5f * (b + c), n = random.direction();
  const float whole = factor(vec3(0), n, {a, b, c});
  RC_ASSERT(std::abs(factor(vec3(0), n, {a, b, middle}) + factor(vec3(0), n, {a, middle, c}) - whole) <
            1e-5f);
}

RC_GTEST_PROP(PolygonFormFactor, ScaleAndRotation, (uint32_t seed)) {
  Random random{std::mt19937(seed)};
  const vec3 x = random.direction(), n = random.direction();
  const Corners corners{2.0f * random.direction(), 2.0f * random.direction(), 2.0f * random.direction()};
  const vec3 m = polygon_form_factor(x, n, corners);
  for (const float scale : {0x1p-30f, 0x1p+30f}) {
    Corners scaled = corners;
    for (vec3& c : scaled) c *= scale;
    RC_ASSERT(polygon_form_factor(scale * x, n, scaled) == m);
  }
  const glm::quat turn = glm::angleAxis(random.in(0, 6), random.direction());
  Corners turned = corners;
  for (vec3& c : turned) c = turn * c;
  RC_ASSERT(length(polygon_form_factor(turn * x, turn * n, turned) - turn * m) < 1e-5f);
}

TEST(PolygonFormFactor, NothingFromBehind) {
  const Corners square{{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};  // sends to +z, away from the origin
  Random random{std::mt19937(1)};
  for (int i = 0; i < 200; ++i) {
    const vec3 n = random.direction();
    EXPECT_EQ(polygon_form_factor({0, 0, 0}, n, square), vec3(0)) << n.x << " " << n.y << " " << n.z;
  }
  EXPECT_GT(factor({0, 0, 2}, {0, 0, -1}, square), 0.5f);
}

TEST(PolygonFormFactor, OnItsPlane) {
  const Corners square{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  EXPECT_EQ(factor({3, 0, 0}, {0, 0, 1}, square), 0);  // beside it
  EXPECT_NEAR(factor({3, 0, 0}, {-1, 0, 0}, square), 0, 1e-6f);
  EXPECT_EQ(factor({0.2f, 0, 0}, {0, 0, 1}, square), 0);            // within it, facing the same way
  EXPECT_NEAR(factor({0.2f, 0, 0}, {0, 0, -1}, square), 1, 1e-6f);  // covered by it
}

TEST(PolygonFormFactor, SharedEdgeAndCorner) {
  const Corners wall{{0, -1, 0}, {0, -1, 1}, {0, 1, 1}, {0, 1, 0}};  // stands on x = 0, sends to -x
  // Towards the edge a wall of any height fills half of what the floor sees.
  for (const float c : {1e-3f, 1e-5f, 1e-7f})
    EXPECT_NEAR(factor({-c, 0, 0}, {0, 0, 1}, wall), 2 * perpendicular_rectangle(1, 1, double(c)), 1e-6) << c;
  for (const vec3& x : {vec3(0, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0)}) {
    const vec3 m = polygon_form_factor(x, {0, 0, 1}, wall);
    ASSERT_TRUE(is_finite(m));
    EXPECT_GE(m.z, 0);
    EXPECT_LE(m.z, 0.5f + 1e-5f);
  }
}

TEST(PolygonFormFactor, TinyAndFar) {
  for (const float size : {1e-3f, 1e-4f, 1e-5f, 1e-6f})
    for (const float distance : {1.0f, 16.0f, 1024.0f}) {
      const float s = size / 2;
      const Corners square{{-s, -s, distance}, {-s, s, distance}, {s, s, distance}, {s, -s, distance}};
      const double exact = double(size) * double(size) / (kPiDouble * double(distance) * double(distance));
      EXPECT_NEAR(factor(vec3(0), {0, 0, 1}, square) / exact, 1, 1e-3) << size << " " << distance;
    }
}

/// Octant `number`, counter-clockwise as seen from inside.
std::array<vec3, 3> octant(int number) {
  const vec3 a((number & 1) != 0 ? -1 : 1, 0, 0), b(0, (number & 2) != 0 ? -1 : 1, 0),
      c(0, 0, (number & 4) != 0 ? -1 : 1);
  if (dot(cross(a, b), c) > 0) return {a, c, b};
  return {a, b, c};
}

RC_GTEST_PROP(SkyFormFactor, OctantsSumToTheNormal, (uint32_t seed)) {
  Random random{std::mt19937(seed)};
  const vec3 n = random.direction();
  vec3 sum(0);
  for (int i = 0; i < 8; ++i) {
    const vec3 m = sky_form_factor(n, octant(i));
    RC_ASSERT(dot(m, n) >= 0);
    sum += m;
  }
  RC_ASSERT(length(sum - n) < 1e-5f);
}

TEST(SkyFormFactor, OctantsAlongTheAxes) {
  // Four octants lie above a floor, each a quarter of its light.
  for (int i = 0; i < 8; ++i)
    EXPECT_NEAR(sky_form_factor({0, 1, 0}, octant(i)).y, (i & 2) != 0 ? 0.0f : 0.25f, 1e-6f) << i;
}

}  // namespace
}  // namespace goldthread
