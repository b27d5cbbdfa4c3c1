#include "visibility/direction_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "math/form_factor.h"

namespace goldthread {
namespace {

constexpr double kPiDouble = 3.14159265358979323846;

double sum(std::span<const double> values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

std::vector<DirectionGrid> all_grids(uint32_t resolution) {
  return {DirectionGrid::hemicube(resolution), DirectionGrid::cubic_tetrahedron(resolution),
          DirectionGrid::single_plane(resolution, 1), DirectionGrid::single_plane(resolution, 14)};
}

TEST(DirectionGrid, SumsToOneAtEveryResolution) {
  // All of the low ones, where whatever is odd shows; then every seventh, odd and even by turns, for time.
  std::vector<uint32_t> resolutions;
  for (uint32_t n = 1; n <= 512; n += n < 127 ? 1 : 7) resolutions.push_back(n);
  resolutions.push_back(511);
  std::vector<std::array<double, 3>> sums(resolutions.size());
  parallel_for(resolutions.size(), [&](size_t i) {
    const uint32_t n = resolutions[i];
    const DirectionGrid plane = DirectionGrid::single_plane(n, 0.1 + 0.05 * n);
    sums[i] = {sum(DirectionGrid::hemicube(n).delta_form_factors()),
               sum(DirectionGrid::cubic_tetrahedron(n).delta_form_factors()),
               sum(plane.delta_form_factors()) + plane.missing()};
  });
  EXPECT_EQ(resolutions[resolutions.size() - 2], 512u);
  for (size_t i = 0; i < resolutions.size(); ++i)
    for (const double total : sums[i]) EXPECT_NEAR(total, 1, 1e-12) << resolutions[i];
}

TEST(DirectionGrid, HasAsManyCellsAsItSays) {
  for (uint32_t n = 1; n < 10; ++n) {
    EXPECT_EQ(DirectionGrid::hemicube(n).size(), n * n + 4 * n * ((n + 1) / 2));
    EXPECT_EQ(DirectionGrid::cubic_tetrahedron(n).size(), 3 * n * (n + 1) / 2);
    EXPECT_EQ(DirectionGrid::single_plane(n, 2).size(), n * n);
  }
}

TEST(DirectionGrid, MissingShareOfASinglePlane) {
  // Four of Howell's B-3 with a = b = h.
  const double s = std::sqrt(0.5);
  EXPECT_NEAR(DirectionGrid::single_plane(7, 1).missing(), 1 - 4 / kPiDouble * s * std::atan(s), 1e-15);
  // Far out, what lies beyond a distance R of the foot is 1/(1 + R^2) of the view: over the directions of a
  // square R = w / cos, so that the mean of cos^2 counts: (1/2 + 1/pi) / w^2.
  for (const double w : {1e3, 1e6, 1e9})
    EXPECT_NEAR(DirectionGrid::single_plane(1, w).missing() * w * w, 0.5 + 1 / kPiDouble, 2 / (w * w) + 1e-12)
        << w;
  EXPECT_EQ(DirectionGrid::hemicube(3).missing(), 0);
  EXPECT_EQ(DirectionGrid::cubic_tetrahedron(3).missing(), 0);
}

TEST(DirectionGrid, CellsAreTheirPolygons) {
  for (const uint32_t n : {1u, 2u, 3u, 8u, 15u, 40u})
    for (const DirectionGrid& grid : all_grids(n))
      for (uint32_t cell = 0; cell < grid.size(); ++cell) {
        std::array<dvec3, 4> corners;
        const size_t count = grid.corners(cell, corners);
        std::vector<vec3> polygon;
        double reach = 0;  // rounding of a corner moves an edge by so much, beside the distance to it
        for (size_t i = 0; i < count; ++i) {
          polygon.emplace_back(corners[i]);
          reach = std::max(reach, length(corners[i] - corners[(i + 1) % count]) / length(corners[i]));
        }
        const float one_way = polygon_form_factor(vec3(0), vec3(0, 0, 1), polygon).z;
        std::reverse(polygon.begin(), polygon.end());
        const float other_way = polygon_form_factor(vec3(0), vec3(0, 0, 1), polygon).z;
        EXPECT_NEAR(grid.delta_form_factors()[cell], double(std::max(one_way, other_way)), 3e-7 * reach)
            << n << " " << cell;
        EXPECT_GT(grid.delta_form_factors()[cell], 0);
      }
}

/// The integral of `integrand(a, b)` over [a0, a0 + side] x [b0, b0 + height] by the midpoint rule; only over
/// a + b > `from`, where a square that the line halves counts half.
template <typename Integrand>
double integral(double a0, double b0, double side, double height, double from, const Integrand& integrand) {
  constexpr int kParts = 64;
  double total = 0;
  for (int i = 0; i < kParts; ++i)
    for (int j = 0; j < kParts; ++j) {
      const double a = a0 + (i + 0.5) * side / kParts, b = b0 + (j + 0.5) * height / kParts;
      const double beyond = a + b - from;
      total += (std::abs(beyond) < 1e-9 ? 0.5 : beyond > 0 ? 1.0 : 0.0) * integrand(a, b);
    }
  return total * side * height / (kParts * kParts);
}

TEST(DirectionGrid, HemicubeIntegratesThePapersDeltaFormFactors) {
  constexpr uint32_t kResolution = 5;
  constexpr double kSide = 2.0 / kResolution, kEverything = -10;
  const DirectionGrid grid = DirectionGrid::hemicube(kResolution);
  const auto top = [](double x, double y) { return 1 / (kPiDouble * std::pow(x * x + y * y + 1, 2)); };
  const auto side = [](double y, double z) { return z / (kPiDouble * std::pow(y * y + z * z + 1, 2)); };
  for (uint32_t i = 0; i < kResolution; ++i) {
    const double a = -1 + i * kSide;
    for (uint32_t j = 0; j < kResolution; ++j)
      EXPECT_NEAR(grid.delta_form_factors()[grid.faces()[0].cell(i, j)],
                  integral(a, -1 + j * kSide, kSide, kSide, kEverything, top), 1e-5 * kSide * kSide);
    for (size_t s = 1; s <= 4; ++s)
      for (uint32_t j = 0; j < 3; ++j) {
        const double low = std::max(0.0, 1 - (j + 1) * kSide), height = 1 - j * kSide - low;
        EXPECT_NEAR(grid.delta_form_factors()[grid.faces()[s].cell(i, j)],
                    integral(a, low, kSide, height, kEverything, side), 1e-5 * kSide * kSide);
      }
  }
}

TEST(DirectionGrid, CubicTetrahedronIntegratesItsDeltaFormFactors) {
  constexpr uint32_t kResolution = 6;
  constexpr double kSide = 3.0 / kResolution;
  const DirectionGrid grid = DirectionGrid::cubic_tetrahedron(kResolution);
  const auto integrand = [](double y, double z) {
    return (1 + y + z) / (std::sqrt(3.0) * kPiDouble * std::pow(1 + y * y + z * z, 2));
  };
  for (const GridFace& face : grid.faces())
    for (uint32_t j = 0; j < kResolution; ++j)
      for (uint32_t i = 0; i < face.columns_in(j); ++i)
        EXPECT_NEAR(grid.delta_form_factors()[face.cell(i, j)],
                    integral(1 - (i + 1) * kSide, 1 - (j + 1) * kSide, kSide, kSide, -1, integrand),
                    1e-4 * kSide * kSide);
}

TEST(DirectionGrid, DirectionsAndPointsLieInTheirCells) {
  for (const uint32_t n : {1u, 2u, 5u, 6u})
    for (const DirectionGrid& grid : all_grids(n))
      for (uint32_t cell = 0; cell < grid.size(); ++cell) {
        std::array<dvec3, 4> corners;
        const size_t count = grid.corners(cell, corners);
        const dvec3 facing = cross(corners[1] - corners[0], corners[2] - corners[0]);
        const double sign = dot(facing, corners[0]) > 0 ? 1 : -1;
        std::vector<dvec3> inside{dvec3(grid.directions()[cell])};
        for (const double u : {0.01, 0.5, 0.99})
          for (const double v : {0.02, 0.5, 0.98}) inside.push_back(grid.point(cell, u, v));
        for (const dvec3& p : inside)
          for (size_t i = 0; i < count; ++i)
            EXPECT_GT(sign * dot(p, cross(corners[i], corners[(i + 1) % count])), -1e-6) << n << " " << cell;
        EXPECT_NEAR(length(grid.directions()[cell]), 1, 1e-6f);
        EXPECT_GT(grid.directions()[cell].z, 0);
      }
}

/// Neighbours share two corners, and only the horizon, or the rim of a plane, has none beyond it.
TEST(DirectionGrid, NeighboursShareASide) {
  const auto on_rim = [](const dvec3& a, const dvec3& b, bool plane) {
    const dvec3 middle = 0.5 * (a + b);
    if (!plane) return std::abs(middle.z) < 1e-9;
    return std::max(std::abs(middle.x), std::abs(middle.y)) > 14 - 1e-9;
  };
  for (const uint32_t n : {1u, 2u, 3u, 6u})
    for (const DirectionGrid& grid : {DirectionGrid::hemicube(n), DirectionGrid::cubic_tetrahedron(n),
                                      DirectionGrid::single_plane(n, 14)})
      for (uint32_t cell = 0; cell < grid.size(); ++cell) {
        std::array<dvec3, 4> own, other;
        const size_t count = grid.corners(cell, own);
        for (size_t i = 0; i < count; ++i) {
          const dvec3 a = own[i], b = own[(i + 1) % count];
          int beyond = 0;
          for (const uint32_t neighbour : grid.neighbours(cell)) {
            if (neighbour == DirectionGrid::kNone) continue;
            const size_t others = grid.corners(neighbour, other);
            const auto has = [&](const dvec3& p) {
              return std::any_of(other.begin(), other.begin() + static_cast<ptrdiff_t>(others),
                                 [&](const dvec3& q) { return length(p - q) < 1e-9; });
            };
            beyond += has(a) && has(b) ? 1 : 0;
          }
          EXPECT_EQ(beyond, on_rim(a, b, grid.missing() > 0) ? 0 : 1) << n << " " << cell << " " << i;
        }
      }
}

}  // namespace
}  // namespace goldthread
