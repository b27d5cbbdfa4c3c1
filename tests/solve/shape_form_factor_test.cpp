// Form factors of discs, spheres and cylinders against the catalogue's closed forms.
#include "solve/matrix/shape_form_factor.h"

#include <gtest/gtest.h>

#include <numbers>

namespace goldthread {
namespace {

double factor(const Shape& from, const Shape& to) {
  const Result<FormFactor> f = shape_form_factor(from, to, {});
  if (!f) throw std::runtime_error(f.error().line());
  EXPECT_GE(f->value, 0);
  EXPECT_LE(f->value, 1);
  return f->value;
}

TEST(ShapeFormFactor, CoaxialDiscs) {
  // Howell C-41.
  for (const double r2 : {0.4, 1.0, 3.0})
    for (const double h : {0.2, 1.0, 8.0}) {
      const double a = 1 / h, b = r2 / h, x = 1 + (1 + b * b) / (a * a);
      const double exact = 0.5 * (x - std::sqrt(x * x - 4 * b * b / (a * a)));
      const DiscShape below{{0, 0, 0}, {0, 0, 1}, 1}, above{{0, 0, h}, {0, 0, -1}, r2};
      EXPECT_NEAR(factor(below, above), exact, 1e-8) << r2 << " " << h;
      EXPECT_NEAR(factor(above, below) * r2 * r2, exact, 1e-8 * r2 * r2);
    }
}

TEST(ShapeFormFactor, ADiscBelowTheHorizonIsNotThereAndHalfOfOneIsHalf) {
  const PointShape point{{0, 0, 0}, {0, 0, 1}};
  EXPECT_EQ(factor(point, DiscShape{{3, 0, -2}, {-1, 0, 0}, 1}), 0);
  // A ring of view about the horizon: a disc whose centre lies on it, and the same one turned upside down.
  const double half = factor(point, DiscShape{{3, 0, 0}, {-1, 0, 0}, 1});
  const double up = factor({PointShape{{0, 0, 0}, {1, 0, 0}}}, DiscShape{{3, 0, 0}, {-1, 0, 0}, 1});
  EXPECT_NEAR(up, 0.1, 1e-12);  // r² / (r² + d²)
  EXPECT_GT(half, 0);
  EXPECT_LT(half, up / 2);
}

TEST(ShapeFormFactor, AManyCorneredPolygonIsADisc) {
  for (const dvec3 centre : {dvec3(2, 0.3, 0.1), dvec3(0.5, 0, 2), dvec3(1.2, -1, 0.4)}) {
    const dvec3 normal = glm::normalize(dvec3(-1, 0.2, -0.3));
    const dvec3 x = glm::normalize(glm::cross(normal, dvec3(0, 1, 0))), y = glm::cross(normal, x);
    Polygon polygon;
    constexpr int kCorners = 2000;
    for (int k = 0; k < kCorners; ++k) {
      const double a = 2 * std::numbers::pi * k / kCorners;
      polygon.push_back(centre + std::cos(a) * x + std::sin(a) * y);
    }
    const PointShape point{{0, 0, 0}, {0, 0, 1}};
    EXPECT_NEAR(factor(point, DiscShape{centre, normal, 1}), factor(point, polygon), 1e-5);
  }
}

TEST(ShapeFormFactor, ASphereAcrossTheHorizonIsTheLimitOfItsFacets) {
  // Discs that fill the sphere's outline: a sphere looks like the disc of its silhouette.
  for (const double height : {-0.6, 0.0, 0.4, 0.9, 1.5}) {
    const dvec3 centre(2, 0, height);
    const double d = glm::length(centre), spread = std::asin(1 / d);
    const dvec3 axis = centre / d;
    const DiscShape outline{d * std::cos(spread) * std::cos(spread) * axis, -axis,
                            d * std::cos(spread) * std::sin(spread)};
    const PointShape point{{0, 0, 0}, {0, 0, 1}};
    EXPECT_NEAR(factor(point, SphereShape{centre, 1}), factor(point, outline), 1e-11) << height;
  }
}

TEST(ShapeFormFactor, APlateAndASphere) {
  // What leaves the sphere and lands on a wide plate tends to half of it.
  const Polygon plate{{-200, -200, 0}, {200, -200, 0}, {200, 200, 0}, {-200, 200, 0}};
  EXPECT_NEAR(factor(SphereShape{{0, 0, 2}, 1}, plate), 0.5, 0.01);
}

TEST(ShapeFormFactor, TwoSpheresSendEachOtherTheSame) {
  const SphereShape small{{0, 0, 0}, 0.5}, large{{3, 0, 0}, 2};
  EXPECT_NEAR(factor(small, large) * shape_area(small) / shape_area(large), factor(large, small), 1e-7);
}

TEST(ShapeFormFactor, ATubeWithItsEndsIsClosed) {
  for (const double h : {0.3, 2.0, 9.0}) {
    const CylinderShape tube{{0, 0, 0}, {0, 0, 1}, 1, h, true};
    const DiscShape bottom{{0, 0, 0}, {0, 0, 1}, 1}, top{{0, 0, h}, {0, 0, -1}, 1};
    EXPECT_NEAR(factor(tube, tube) + factor(tube, bottom) + factor(tube, top), 1, 1e-7) << h;
    EXPECT_NEAR(factor(bottom, top) + factor(bottom, tube), 1, 1e-7) << h;
  }
}

TEST(ShapeFormFactor, ASphereWithOneInItIsClosed) {
  const SphereShape outer{{0, 0, 0}, 2, true}, inner{{0.3, -0.2, 0.5}, 0.7};
  EXPECT_NEAR(factor(inner, outer), 1, 1e-9);
  EXPECT_NEAR(factor(outer, inner), 0.7 * 0.7 / 4, 1e-9);
}

TEST(ShapeFormFactor, WhatIsNotKnownIsSaid) {
  const CylinderShape inside{{0, 0, 0}, {0, 0, 1}, 1, 2, true}, other{{0, 0, 0}, {0, 0, 1}, 3, 2, true};
  const Result<FormFactor> two = shape_form_factor(inside, other, {});
  ASSERT_FALSE(two);
  EXPECT_EQ(two.error().code, ErrorCode::kBadInput);
  EXPECT_FALSE(shape_form_factor(inside, PointShape{{0, 0, 0}, {0, 0, 1}}, {}));
}

}  // namespace
}  // namespace goldthread
