// Rules of quadrature: exact for what they should be exact for, honest about the rest.
#include "math/quadrature.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

TEST(GaussKronrod, IsExactForPolynomialsOfDegreeTwentyTwo) {
  for (int degree = 0; degree <= 22; ++degree) {
    const Estimate sum = gauss_kronrod([&](double x) { return std::pow(x, degree); }, 0, 2);
    const double exact = std::pow(2.0, degree + 1) / (degree + 1);
    EXPECT_NEAR(sum.value / exact, 1, 1e-14) << degree;
    if (degree <= 13) {  // Gauss's own degree
      EXPECT_LT(sum.error, 1e-13 * exact);
    }
  }
  const Estimate beyond = gauss_kronrod([](double x) { return std::pow(x, 30); }, 0, 2);
  EXPECT_GT(std::abs(beyond.value * 31 / std::pow(2.0, 31) - 1), 1e-14);
}

TEST(Integrate, MeetsItsToleranceAtSingularEndsAndKinks) {
  const Estimate logarithm = integrate([](double x) { return std::log(x); }, 0, 1, 1e-12);
  EXPECT_NEAR(logarithm.value, -1, 1e-12);
  EXPECT_GE(logarithm.error, std::abs(logarithm.value + 1));
  const Estimate kink = integrate([](double x) { return std::abs(x - 0.3); }, 0, 1, 1e-12);
  EXPECT_NEAR(kink.value, (0.09 + 0.49) / 2, 1e-12);
}

TEST(Integrate, WhatIsNotSureStaysInTheError) {
  const auto steep = [](double x) { return std::log(x); };
  const Estimate rough = integrate(steep, 0, 1, 1e-15, 3);
  EXPECT_GT(rough.error, 1e-6);
  EXPECT_GE(rough.error, std::abs(rough.value + 1));
}

TEST(TriangleMean, IsExactForPolynomialsOfDegreeFive) {
  const std::array<dvec3, 3> unit{dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0)};
  const auto factorial = [](int n) { return std::tgamma(n + 1.0); };
  for (int i = 0; i <= 5; ++i)
    for (int k = 0; i + k <= 5; ++k) {
      const double mean =
          triangle_mean([&](const dvec3& p) { return std::pow(p.x, i) * std::pow(p.y, k); }, unit);
      EXPECT_NEAR(mean, 2 * factorial(i) * factorial(k) / factorial(i + k + 2), 1e-15) << i << " " << k;
    }
}

TEST(IntegrateTriangles, MeetsWhatIsAskedAtAKink) {
  const std::array<dvec3, 3> unit{dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0)};
  // A plane's positive part: a small triangle of height t at a corner.
  for (const double t : {0.5, 0.13, 0.031}) {
    const auto f = [&](const dvec3& p) { return std::max(0.0, t - p.x - p.y); };
    const Estimate sum = integrate_triangles(f, std::span(&unit, 1), {1e-6, 0, 1000000});
    const double exact = t * t * t / 6;
    EXPECT_LE(std::abs(sum.value - exact), sum.error) << t;
    EXPECT_LE(sum.error, 1.001e-6 * exact);
  }
}

TEST(IntegrateTriangles, StopsAtItsLimitAndSaysSo) {
  const std::array<dvec3, 3> unit{dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(0, 1, 0)};
  size_t calls = 0;
  const auto jump = [&](const dvec3& p) {
    ++calls;
    return p.x > 0.3 ? 1.0 : 0.0;
  };
  const Estimate sum = integrate_triangles(jump, std::span(&unit, 1), {1e-12, 0, 2000});
  EXPECT_LT(calls, 2200u);
  EXPECT_GT(sum.error, 1e-4);
  EXPECT_NEAR(sum.value, 0.245, sum.error);
}

}  // namespace
}  // namespace goldthread
