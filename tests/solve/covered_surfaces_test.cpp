// Masks and null surfaces against the same surfaces cut by hand.
#include <gtest/gtest.h>

#include <numeric>

#include "solve/matrix/fold_surfaces.h"
#include "solve/matrix/matrix_builder.h"

namespace goldthread {
namespace {

constexpr uint32_t kNone = SurfaceRoles::kNone;

/// An upright rectangle over x and y in the plane z, facing up or down.
Polygon level(double x, double y, double width, double depth, double z, bool up) {
  const Polygon p = {{x, y, z}, {x + width, y, z}, {x + width, y + depth, z}, {x, y + depth, z}};
  return up ? p : Polygon(p.rbegin(), p.rend());
}

/// The unit cube's faces from inside: floor, ceiling, four walls.
PatchModel room() {
  PatchModel model;
  model.patches = {level(0, 0, 1, 1, 0, true), level(0, 0, 1, 1, 1, false)};
  const std::array<dvec3, 4> ring = {dvec3(0, 0, 0), dvec3(1, 0, 0), dvec3(1, 1, 0), dvec3(0, 1, 0)};
  for (size_t k = 0; k < 4; ++k) {
    const dvec3 &a = ring[k], &b = ring[(k + 1) % 4], up(0, 0, 1);
    model.patches.push_back({b, a, a + up, b + up});
  }
  return model;
}

FormFactorMatrix folded(const PatchModel& model, const SurfaceRoles& roles, MatrixMethod method) {
  MatrixOptions options;
  options.method = method;
  options.rays = 64;
  const Result<FormFactorMatrix> matrix = build_form_factor_matrix(model, options, CancelToken());
  if (!matrix) throw std::runtime_error(matrix.error().line());
  std::vector<uint32_t> kept;
  return fold_surfaces(*matrix, roles, kept);
}

SurfaceRoles roles_of(size_t count) {
  return {std::vector<uint32_t>(count, kNone), std::vector<uint32_t>(count, kNone),
          std::vector<Cover>(count, Cover::kNothing)};
}

/// The room with something of 0.4 x 0.5 on its floor, the last patch.
FormFactorMatrix covered(Cover cover, MatrixMethod method) {
  PatchModel model = room();
  model.patches.push_back(level(0.2, 0.3, 0.4, 0.5, 0, true));
  SurfaceRoles roles = roles_of(7);
  roles.base[6] = 0;
  roles.cover[6] = cover;
  return folded(model, roles, method);
}

/// The same floor as four rectangles about a hole, combined into one.
FormFactorMatrix cut() {
  PatchModel model = room();
  model.patches[0] = level(0, 0, 0.2, 1, 0, true);
  model.patches.push_back(level(0.6, 0, 0.4, 1, 0, true));
  model.patches.push_back(level(0.2, 0, 0.4, 0.3, 0, true));
  model.patches.push_back(level(0.2, 0.8, 0.4, 0.2, 0, true));
  SurfaceRoles roles = roles_of(9);
  for (size_t p = 6; p < 9; ++p) roles.combined[p] = 0;
  return folded(model, roles, MatrixMethod::kExact);
}

double exchange_of(const FormFactorMatrix& matrix, uint32_t from, uint32_t to) {
  const auto [row, column] = std::minmax(from, to);
  for (uint64_t k = matrix.first[row]; k < matrix.first[row + 1]; ++k)
    if (matrix.column[k] == column) return row == from ? matrix.exchange[k] : matrix.reverse_exchange(k);
  return 0;
}

void expect_closed(const FormFactorMatrix& matrix, double tolerance) {
  const std::vector<double> sums = matrix.row_sums();
  for (size_t i = 0; i < sums.size(); ++i)
    EXPECT_NEAR(sums[i] + double(matrix.environment[i]) + double(matrix.back[i]), 1, tolerance) << i;
}

TEST(CoveredSurfaces, ANullSurfaceIsAHole) {
  const FormFactorMatrix null = covered(Cover::kNull, MatrixMethod::kExact), hole = cut();
  ASSERT_EQ(null.size(), 6u);
  for (uint32_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(null.areas[i], hole.areas[i], 1e-12);
    for (uint32_t j = 0; j < 6; ++j) EXPECT_NEAR(exchange_of(null, i, j), exchange_of(hole, i, j), 1e-9);
  }
  EXPECT_NEAR(null.areas[0], 0.8, 1e-12);
  EXPECT_NEAR(double(null.back[0]), 0, 1e-6);
  EXPECT_GT(double(null.back[1]), 0.02);  // where the hole is the ceiling's light is gone
  expect_closed(null, 1e-6);
}

TEST(CoveredSurfaces, AMaskSeesItsBaseAndNothingElse) {
  const FormFactorMatrix mask = covered(Cover::kMask, MatrixMethod::kExact), hole = cut();
  ASSERT_EQ(mask.size(), 7u);
  EXPECT_NEAR(mask.areas[0], 1, 1e-12);  // the floor is still there
  EXPECT_NEAR(mask.areas[6], 0.2, 1e-12);
  EXPECT_NEAR(exchange_of(mask, 6, 0), 0.2, 1e-12);
  EXPECT_NEAR(exchange_of(mask, 0, 6), 0.2, 1e-12);
  for (uint32_t j = 1; j < 6; ++j) {
    EXPECT_EQ(exchange_of(mask, 6, j), 0);
    EXPECT_NEAR(exchange_of(mask, 0, j), exchange_of(hole, 0, j), 1e-9);
    EXPECT_NEAR(exchange_of(mask, j, 0), exchange_of(hole, j, 0), 1e-9);
  }
  expect_closed(mask, 1e-6);
}

TEST(CoveredSurfaces, AMaskOverAllLeavesNothingToSee) {
  PatchModel model = room();
  model.patches.push_back(model.patches[0]);
  SurfaceRoles roles = roles_of(7);
  roles.base[6] = 0;
  roles.cover[6] = Cover::kMask;
  const FormFactorMatrix mask = folded(model, roles, MatrixMethod::kExact);
  for (uint32_t j = 1; j < 6; ++j) EXPECT_NEAR(exchange_of(mask, 0, j), 0, 1e-12);
  EXPECT_NEAR(exchange_of(mask, 0, 6), 1, 1e-12);
}

// Two masks that would see each other: what both cover is taken away once.
TEST(CoveredSurfaces, MasksOnBothSides) {
  PatchModel model = room();
  model.patches.push_back(level(0.2, 0.3, 0.4, 0.5, 0, true));
  model.patches.push_back(level(0, 0, 0.5, 1, 1, false));
  SurfaceRoles roles = roles_of(8);
  roles.base[6] = 0;
  roles.base[7] = 1;
  roles.cover[6] = Cover::kNull;
  roles.cover[7] = Cover::kMask;
  const FormFactorMatrix both = folded(model, roles, MatrixMethod::kExact);
  expect_closed(both, 1e-6);
  PatchModel half = room();
  half.patches[1] = level(0.5, 0, 0.5, 1, 1, false);
  half.patches.push_back(model.patches[6]);
  SurfaceRoles of_half = roles_of(7);
  of_half.base[6] = 0;
  of_half.cover[6] = Cover::kNull;
  EXPECT_NEAR(exchange_of(both, 0, 1), exchange_of(folded(half, of_half, MatrixMethod::kExact), 0, 1), 1e-9);
}

// An obstruction hides nothing of what lies on it, as View3D has it; what lies behind it, it does.
TEST(CoveredSurfaces, WhatLiesOnAnObstructionIsSeen) {
  PatchModel model;
  model.patches = {level(0.2, 0.2, 0.4, 0.4, 0.5, true), level(0, 0, 1, 1, 1, false),
                   level(0, 0, 1, 1, 0, true)};
  const PatchModel open = model;
  model.occluders = {level(0, 0, 1, 1, 0.5, true)};
  for (const MatrixMethod method : {MatrixMethod::kExact, MatrixMethod::kRays}) {
    const FormFactorMatrix without = folded(open, roles_of(3), method),
                           with = folded(model, roles_of(3), method);
    EXPECT_GT(exchange_of(with, 0, 1), 0.05);
    EXPECT_NEAR(exchange_of(with, 0, 1), exchange_of(without, 0, 1), 1e-12);
    EXPECT_LT(exchange_of(with, 2, 1), 0.5 * exchange_of(without, 2, 1));
  }
}

// 64 rays a pair say exchanges to a few hundredths of themselves; what the mask takes is a fifth.
TEST(CoveredSurfaces, RaysAgree) {
  const FormFactorMatrix exact = covered(Cover::kMask, MatrixMethod::kExact),
                         rays = covered(Cover::kMask, MatrixMethod::kRays);
  for (uint32_t i = 0; i < 7; ++i)
    for (uint32_t j = 0; j < 7; ++j) EXPECT_NEAR(exchange_of(rays, i, j), exchange_of(exact, i, j), 8e-3);
}

}  // namespace
}  // namespace goldthread
