#include "trace/scrambled_sobol.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

namespace goldthread {
namespace {

TEST(ScrambledSobol, EveryElementaryIntervalHoldsOnePoint) {
  for (uint32_t seed = 0; seed < 20; ++seed)
    for (uint32_t m = 0; m <= 10; ++m)
      for (uint32_t across = 0; across <= m; ++across) {
        std::set<std::pair<uint64_t, uint64_t>> cells;
        for (uint32_t i = 0; i < 1u << m; ++i) {
          const SobolPoint p = sobol_point(i, hash(seed));
          cells.insert({uint64_t{p.u} >> (32 - across), uint64_t{p.v} >> (32 - (m - across))});
        }
        ASSERT_EQ(cells.size(), size_t{1} << m) << "seed " << seed << " 2^" << across << " columns";
      }
}

TEST(ScrambledSobol, PascalProductIsPascalsTriangle) {
  std::vector<std::vector<uint32_t>> odd(32, std::vector<uint32_t>(32, 0));
  for (size_t j = 0; j < 32; ++j)
    for (size_t i = 0; i <= j; ++i) odd[j][i] = i == 0 || i == j ? 1 : odd[j - 1][i - 1] ^ odd[j - 1][i];
  for (uint32_t j = 0; j < 32; ++j)
    for (uint32_t i = 0; i < 32; ++i) EXPECT_EQ(pascal_product(1u << j) >> i & 1, odd[j][i]) << j << " " << i;
}

// What makes means of batches unbiased: over scramblings each single point is spread evenly, and two
// scramblings have nothing to do with each other.
TEST(ScrambledSobol, EachPointIsEvenOverSeeds) {
  constexpr uint32_t kSeeds = 4096, kCells = 16;
  for (const uint32_t index : {0u, 1u, 5u, 1000u}) {
    std::vector<double> cells(kCells * kCells, 0);
    double correlation = 0, last = 0;
    for (uint32_t seed = 0; seed < kSeeds; ++seed) {
      const SobolPoint p = path_point({index, hash(seed, 77)}, 4);
      cells[(p.u >> 28) * kCells + (p.v >> 28)] += 1;
      correlation += (unit_double(p.u) - 0.5) * last;
      last = unit_double(p.u) - 0.5;
    }
    double chi_square = 0;
    const double expected = double(kSeeds) / (kCells * kCells);
    for (const double cell : cells) chi_square += (cell - expected) * (cell - expected) / expected;
    // 255 degrees of freedom: mean 255, deviation 22.6.
    EXPECT_NEAR(chi_square, 255, 4 * 22.6) << index;
    EXPECT_NEAR(correlation * 12 / kSeeds, 0, 4 / std::sqrt(double(kSeeds))) << index;
  }
}

TEST(ScrambledSobol, DeepDimensionsAreEvenToo) {
  double sum = 0, product = 0;
  constexpr uint32_t kCount = 65536;
  for (uint32_t i = 0; i < kCount; ++i) {
    const SobolPoint p = path_point({i, 12345}, 30);
    sum += unit_double(p.u);
    product += (unit_double(p.u) - 0.5) * (unit_double(p.v) - 0.5);
  }
  EXPECT_NEAR(sum / kCount, 0.5, 4 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_NEAR(product / kCount, 0, 4.0 / 12 / std::sqrt(double(kCount)));
}

TEST(ScrambledSobol, ManyAtOnceAreTheSame) {
  std::vector<PathSeed> paths;
  for (uint32_t i = 0; i < 37; ++i) paths.push_back({hash(i, 1), hash(i, 2)});
  std::vector<SobolPoint> points(paths.size());
  for (uint32_t pair = 1; pair <= kSobolPairs + 2; ++pair) {
    path_points(paths, pair, points);
    for (size_t i = 0; i < paths.size(); ++i) {
      EXPECT_EQ(points[i].u, path_point(paths[i], pair).u);
      EXPECT_EQ(points[i].v, path_point(paths[i], pair).v);
    }
  }
}

}  // namespace
}  // namespace goldthread
