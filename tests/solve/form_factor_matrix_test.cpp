// Matrices of form factors: exact values, conservation, both methods against each other.
#include "solve/matrix/form_factor_matrix.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "math/shared_cases.h"
#include "solve/matrix/fold_surfaces.h"
#include "solve/matrix/matrix_builder.h"

namespace goldthread {
namespace {

Polygon rectangle(const dvec3& corner, const dvec3& across, const dvec3& up) {
  return {corner, corner + across, corner + across + up, corner + up};
}

/// The unit cube's faces, seen from inside, each cut into n x n.
PatchModel room(int n) {
  PatchModel model;
  const dvec3 o(0), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  const std::array<std::array<dvec3, 3>, 6> faces{
      {{o, x, y}, {z, y, x}, {o, y, z}, {x, z, y}, {o, z, x}, {y, x, z}}};
  for (const auto& [corner, across, up] : faces)
    for (int i = 0; i < n; ++i)
      for (int k = 0; k < n; ++k)
        model.patches.push_back(rectangle(corner + double(i) / n * across + double(k) / n * up,
                                          across / double(n), up / double(n)));
  return model;
}

FormFactorMatrix built(const PatchModel& model, const MatrixOptions& options) {
  Result<FormFactorMatrix> matrix = build_form_factor_matrix(model, options, CancelToken());
  if (!matrix) throw std::runtime_error(matrix.error().line());
  return *std::move(matrix);
}

double form_factor(const FormFactorMatrix& matrix, uint32_t from, uint32_t to) {
  const auto [row, column] = std::minmax(from, to);
  for (uint64_t k = matrix.first[row]; k < matrix.first[row + 1]; ++k)
    if (matrix.column[k] == column)
      return (row == from ? matrix.exchange[k] : matrix.reverse_exchange(k)) / matrix.areas[from];
  return 0;
}

TEST(FormFactorMatrix, ACubesRowsSumToOneExactly) {
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const FormFactorMatrix matrix = built(room(2), options);
  for (const double sum : matrix.row_sums()) EXPECT_NEAR(sum, 1, 1e-10);
  for (const float share : matrix.environment) EXPECT_EQ(share, 0);
  for (const float share : matrix.back) EXPECT_EQ(share, 0);
}

TEST(FormFactorMatrix, RaysAgreeWithTheExactMatrixWithinWhatTheySay) {
  PatchModel model = room(2);
  model.occluders = {rectangle({0.3, 0.2, 0.4}, {0.5, 0, 0.1}, {0, 0.4, 0}),
                     rectangle({0.6, 0.7, 0.1}, {0, 0, 0.7}, {0.2, 0.1, 0})};
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const FormFactorMatrix exact = built(model, options);
  options.method = MatrixMethod::kRays;
  options.rays = 64;
  const FormFactorMatrix rays = built(model, options);
  size_t pairs = 0, off = 0;
  for (uint32_t i = 0; i < rays.size(); ++i)
    for (uint64_t k = rays.first[i]; k < rays.first[i + 1]; ++k, ++pairs) {
      const double truth = form_factor(exact, i, rays.column[k]) * exact.areas[i];
      if (std::abs(rays.exchange[k] - truth) > static_cast<double>(rays.error[k])) ++off;
    }
  EXPECT_GT(pairs, 200u);
  EXPECT_LT(off, pairs / 20);  // two standard errors
  const std::vector<double> sums = rays.row_sums(), bounds = rays.row_error_bounds();
  for (uint32_t i = 0; i < rays.size(); ++i) {
    // What the occluders take is by their backs and fronts: both count as something else than patches.
    EXPECT_NEAR(sums[i], exact.row_sums()[i], 1.5 * bounds[i]);
  }
}

// Most of what a long wall and its floor exchange goes past their common edge, where few of the points spread
// evenly over both are, and a low sill there hides a part of it.
TEST(FormFactorMatrix, RaysFindWhatIsHiddenWherePatchesTouch) {
  PatchModel model;
  model.patches = {rectangle({0, 0, 0}, {100, 0, 0}, {0, 40, 0}),
                   rectangle({0, 0, 0}, {0, 0, 3}, {100, 0, 0})};
  model.occluders = {rectangle({20, 0.2, 0}, {60, 0, 0}, {0, 0, 0.3})};
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const double exact = form_factor(built(model, options), 1, 0);
  options.method = MatrixMethod::kRays;
  options.rays = 64;
  double sum = 0, squares = 0;
  constexpr int kSeeds = 50;
  for (int seed = 0; seed < kSeeds; ++seed) {
    options.seed = uint32_t(seed);
    const double off = form_factor(built(model, options), 1, 0) / exact - 1;
    sum += off;
    squares += off * off;
  }
  // A ratio of two sums leans to one side by what one ray tells, 1/64.
  EXPECT_NEAR(sum / kSeeds, 0, 1.0 / 64);
  EXPECT_LT(std::sqrt(squares / kSeeds), 0.06);
}

TEST(FormFactorMatrix, RowsAndTheirSurroundingsSumToOne) {
  PatchModel model = room(4);
  model.patches.erase(model.patches.begin() + 5, model.patches.begin() + 16);  // a hole
  // Sheets that only block, one each way round: they take what meets them from either side.
  const Polygon sheet = rectangle({0.3, 0.2, 0.4}, {0.5, 0, 0.1}, {0, 0.4, 0});
  model.occluders = {sheet, rectangle({0.6, 0.7, 0.1}, {0, 0, 0.7}, {0.2, 0.1, 0})};
  MatrixOptions options;
  options.method = MatrixMethod::kRays;
  const FormFactorMatrix matrix = built(model, options);
  const std::vector<double> sums = matrix.row_sums(), bounds = matrix.row_error_bounds();
  double escaped = 0;
  for (size_t i = 0; i < matrix.size(); ++i) {
    const double all = sums[i] + static_cast<double>(matrix.environment[i] + matrix.back[i]);
    EXPECT_NEAR(all, 1, 1.5 * bounds[i] + static_cast<double>(matrix.share_error));
    escaped += static_cast<double>(matrix.environment[i]);
  }
  EXPECT_GT(escaped, 1);
}

TEST(FormFactorMatrix, TheSameForAnyNumberOfThreadsAndTwice) {
  MatrixOptions options;
  options.method = MatrixMethod::kRays;
  const FormFactorMatrix two = built(room(3), options);
  const FormFactorMatrix one = [&] {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, 1);
    return built(room(3), options);
  }();
  EXPECT_EQ(one.exchange, two.exchange);
  EXPECT_EQ(one.column, two.column);
  options.seed = 1;
  PatchModel model = room(3);
  model.occluders = {rectangle({0.3, 0.2, 0.4}, {0.5, 0, 0.1}, {0, 0.4, 0})};
  const FormFactorMatrix other = built(model, options);
  EXPECT_NE(one.exchange, other.exchange);
}

TEST(FormFactorMatrix, StopsAtTheMemoryLimitAndWhenCancelled) {
  MatrixOptions options;
  options.method = MatrixMethod::kRays;
  options.max_memory = 10000;
  const Result<FormFactorMatrix> full = build_form_factor_matrix(room(5), options, CancelToken());
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kLimit);
  CancelToken stop;
  stop.cancel();
  options.max_memory = 0;
  const Result<FormFactorMatrix> stopped = build_form_factor_matrix(room(5), options, stop);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
}

TEST(FormFactorMatrix, HemicubesAgreeWithTheExactMatrixWithinWhatTheySay) {
  PatchModel model = room(2);
  model.occluders = {rectangle({0.3, 0.2, 0.4}, {0.5, 0, 0.1}, {0, 0.4, 0})};
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const FormFactorMatrix exact = built(model, options);
  for (const MatrixMethod method : {MatrixMethod::kHemicube, MatrixMethod::kCubicTetrahedron}) {
    options.method = method;
    FormFactorMatrix matrix = built(model, options);
    ASSERT_EQ(matrix.reverse.size(), matrix.exchange.size());
    const std::vector<double> sums = matrix.row_sums();
    double squares = 0;
    for (uint32_t i = 0; i < matrix.size(); ++i) {
      // A hemisphere is all given away, the six points' as well.
      EXPECT_NEAR(sums[i] + static_cast<double>(matrix.environment[i] + matrix.back[i]), 1, 1e-6);
      for (uint32_t j = 0; j < matrix.size(); ++j) {
        const double off = form_factor(matrix, i, j) - form_factor(exact, i, j);
        squares += off * off / static_cast<double>(matrix.size() * matrix.size());
      }
    }
    EXPECT_LT(std::sqrt(squares), 0.004);  // of a mean of 1/24: six points stand for a patch
    EXPECT_GT(matrix.reciprocity_error(), 1e-6);
    enforce_reciprocity(matrix);
    EXPECT_EQ(matrix.reciprocity_error(), 0);
    for (uint32_t i = 0; i < matrix.size(); ++i)
      for (uint32_t j = 0; j < i; ++j)
        EXPECT_NEAR(form_factor(matrix, i, j) * matrix.areas[i], form_factor(matrix, j, i) * matrix.areas[j],
                    1e-15);
  }
}

TEST(FormFactorMatrix, APlateOfTwoFacesInOnePlaceHidesNeitherFromTheOther) {
  PatchModel model = room(1);
  const Polygon plate = rectangle({0.25, 0.25, 0.75}, {0.5, 0, 0}, {0, 0.5, 0});
  model.patches.push_back(plate);
  model.patches.emplace_back(plate.rbegin(), plate.rend());
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const FormFactorMatrix exact = built(model, options);
  for (const MatrixMethod method : {MatrixMethod::kRays, MatrixMethod::kHemicube}) {
    options.method = method;
    options.rays = 64;
    const FormFactorMatrix matrix = built(model, options);
    for (const float share : matrix.back) EXPECT_EQ(share, 0);
    for (uint32_t i = 0; i < matrix.size(); ++i)
      for (uint32_t j = 0; j < matrix.size(); ++j)
        EXPECT_NEAR(form_factor(matrix, i, j), form_factor(exact, i, j), 0.04) << i << " " << j;
  }
}

TEST(FormFactorMatrix, ASinglePlaneMissesTheHorizon) {
  MatrixOptions options;
  options.method = MatrixMethod::kSinglePlane;
  const FormFactorMatrix matrix = built(room(1), options);
  // In a closed room all that is missing is what the plane does not cover: of half width w at height 1.
  const double w = options.plane_half_width, s = std::sqrt(1 + w * w);
  const double covered = 4 / 3.14159265358979323846 * (w / s) * std::atan(w / s);
  for (size_t i = 0; i < matrix.size(); ++i) EXPECT_NEAR(matrix.environment[i], 1 - covered, 1e-5);
}

TEST(FormFactorMatrix, ProgressGrowsToOne) {
  double last = 0;
  MatrixOptions options;
  options.method = MatrixMethod::kRays;
  ASSERT_TRUE(build_form_factor_matrix(room(2), options, CancelToken(), [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  }));
  EXPECT_NEAR(last, 1, 1e-9);
}

TEST(Closure, RowsSumToOneAndStaySymmetric) {
  MatrixOptions options;
  options.method = MatrixMethod::kRays;
  FormFactorMatrix matrix = built(room(3), options);
  double before = 0;
  for (const double sum : matrix.row_sums()) before = std::max(before, std::abs(sum - 1));
  EXPECT_GT(before, 1e-6);
  const Result<double> change = enforce_closure(matrix);
  ASSERT_TRUE(change);
  EXPECT_LT(*change, 0.1);
  for (const double sum : matrix.row_sums()) EXPECT_NEAR(sum, 1, 1e-11);
  for (const double exchange : matrix.exchange) EXPECT_GT(exchange, 0);
}

TEST(FoldSurfaces, AWindowIsTakenOutOfItsWall) {
  // The whole floor as base, a quarter of it as subsurface: as if the floor had been cut.
  PatchModel model = room(1), cut = room(1);
  const Polygon window = rectangle({0.25, 0.25, 0}, {0.5, 0, 0}, {0, 0.5, 0});
  model.patches.push_back(window);
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const FormFactorMatrix whole = built(model, options);
  SurfaceRoles roles;
  roles.base.assign(7, SurfaceRoles::kNone);
  roles.combined.assign(7, SurfaceRoles::kNone);
  roles.base[6] = 0;
  std::vector<uint32_t> kept;
  const FormFactorMatrix folded = fold_surfaces(whole, roles, kept);
  EXPECT_EQ(kept.size(), 7u);
  EXPECT_NEAR(folded.areas[0], 0.75, 1e-12);
  for (const double sum : folded.row_sums()) EXPECT_NEAR(sum, 1, 1e-10);
  EXPECT_NEAR(form_factor(folded, 1, 0) + form_factor(folded, 1, 6), form_factor(whole, 1, 0), 1e-12);
}

TEST(FoldSurfaces, PartsThatAreCombinedAreOne) {
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const FormFactorMatrix parts = built(room(2), options), whole = built(room(1), options);
  SurfaceRoles roles;
  roles.base.assign(24, SurfaceRoles::kNone);
  for (uint32_t p = 0; p < 24; ++p) roles.combined.push_back(p % 4 == 0 ? SurfaceRoles::kNone : p / 4 * 4);
  std::vector<uint32_t> kept;
  const FormFactorMatrix folded = fold_surfaces(parts, roles, kept);
  ASSERT_EQ(folded.size(), 6u);
  for (uint32_t i = 0; i < 6; ++i)
    for (uint32_t j = 0; j < 6; ++j) {
      if (i == j) continue;
      EXPECT_NEAR(form_factor(folded, i, j), form_factor(whole, i, j), 1e-10);
    }
}

TEST(FoldSurfaces, WhatACombinedSurfaceSendsToItselfIsItsOwn) {
  // Floor and ceiling as one.
  MatrixOptions options;
  options.method = MatrixMethod::kExact;
  const FormFactorMatrix faces = built(room(1), options);
  SurfaceRoles roles;
  roles.base.assign(6, SurfaceRoles::kNone);
  roles.combined.assign(6, SurfaceRoles::kNone);
  roles.combined[1] = 0;
  std::vector<uint32_t> kept;
  const FormFactorMatrix folded = fold_surfaces(faces, roles, kept);
  ASSERT_EQ(folded.size(), 5u);
  for (const double sum : folded.row_sums()) EXPECT_NEAR(sum, 1, 1e-10);
  EXPECT_NEAR(form_factor(folded, 0, 0), form_factor(faces, 0, 1), 1e-12);
}

TEST(Closure, RowsFoundOneByOneAreScaledOneByOne) {
  MatrixOptions options;
  options.method = MatrixMethod::kHemicube;
  options.resolution = 8;
  PatchModel model = room(2);
  model.patches.pop_back();
  FormFactorMatrix matrix = built(model, options);
  matrix.exchange[3] *= 1.5;  // as if a row had gone wrong
  ASSERT_TRUE(enforce_closure(matrix));
  const std::vector<double> sums = matrix.row_sums();
  for (size_t i = 0; i < matrix.size(); ++i)
    EXPECT_NEAR(sums[i] + static_cast<double>(matrix.environment[i] + matrix.back[i]), 1, 1e-6);
}

TEST(FormFactorMatrix, SharedRooms) {
  const test::Json cases = test::shared_cases("view_factor_matrices.json");
  if (cases.is_null()) GTEST_SKIP() << test::kNoSharedCases;
  EXPECT_EQ(cases.size(), 9u);
  for (const auto& item : cases) {
    PatchModel model;
    for (const auto& surface : item["surfaces"]) model.patches.push_back(test::corners_of<dvec3>(surface));
    MatrixOptions options;
    options.method = MatrixMethod::kExact;
    const FormFactorMatrix matrix = built(model, options);
    double worst = 0;
    for (uint32_t i = 0; i < matrix.size(); ++i)
      for (uint32_t j = 0; j < matrix.size(); ++j) {
        if (i == j) continue;
        const double exact = item["F"][i][j];
        EXPECT_NEAR(form_factor(matrix, i, j), exact, 1e-4 * exact + 1e-9) << item["id"] << i << " " << j;
        worst = std::max(worst, std::abs(form_factor(matrix, i, j) - exact));
      }
    RecordProperty(item["id"].get<std::string>(), std::to_string(worst));
    std::vector<double> sums = matrix.row_sums();
    for (const double sum : sums) EXPECT_NEAR(sum, 1, 1e-4) << item["id"];
  }
}

}  // namespace
}  // namespace goldthread
