// The hierarchical answer beside a dense linear system over the same rooms (B = E + diag(rho) F B).
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "element/paint.h"
#include "scene/shared_rooms.h"
#include "solve/solved_scene.h"

namespace goldthread {
namespace {

using test::Solved;

/// A closed box of 3 by 2 by 1, each wall n by n rectangles, wall i of its own reflectance and emission.
struct Box6 {
  std::array<float, 6> rho{0.1f, 0.3f, 0.5f, 0.6f, 0.7f, 0.8f}, exitance{0, 100, 0, 0, 20, 0};
  int cells = 1;

  std::array<std::array<vec3, 3>, 6> walls() const {
    const vec3 o(0), x(3, 0, 0), y(0, 2, 0), z(0, 0, 1);
    return {{{o, x, y}, {z, y, x}, {o, y, z}, {x, z, y}, {o, z, x}, {y, x, z}}};
  }
  Scene scene() const {
    Scene scene;
    for (size_t i = 0; i < 6; ++i) {
      const auto [corner, across, up] = walls()[i];
      test::add(scene, test::parallelogram(corner, across, up, 2),
                test::add(scene, test::diffuse(rho[i], exitance[i])));
    }
    return scene;
  }

  /// Constant radiosity on every cell; form factors by integrating Lambert's formula over the receiver
  /// (Gauss, 4 x 4). Solved by Gauss-Seidel. Returns the mean irradiance of each wall.
  std::array<double, 6> solve_matrix() const {
    struct Cell {
      vec3 corner, across, up;
      size_t wall;
    };
    std::vector<Cell> list;
    for (size_t w = 0; w < 6; ++w)
      for (int j = 0; j < cells; ++j)
        for (int i = 0; i < cells; ++i) {
          const auto [corner, across, up] = walls()[w];
          const float step = 1.0f / float(cells);
          list.push_back(
              {corner + float(i) * step * across + float(j) * step * up, step * across, step * up, w});
        }
    const auto n = Eigen::Index(list.size());
    Eigen::MatrixXd factor(n, n);
    const double node[4] = {0.0694318442, 0.3300094782, 0.6699905218, 0.9305681558};
    const double weight[4] = {0.1739274226, 0.3260725774, 0.3260725774, 0.1739274226};
    for (Eigen::Index r = 0; r < n; ++r)
      for (Eigen::Index s = 0; s < n; ++s) {
        const Cell &to = list[size_t(r)], &from = list[size_t(s)];
        const std::array<vec3, 4> corners{from.corner, from.corner + from.across,
                                          from.corner + from.across + from.up, from.corner + from.up};
        const vec3 normal = normalize(cross(to.across, to.up));
        double sum = 0;
        for (int i = 0; i < 4; ++i)
          for (int j = 0; j < 4; ++j) {
            const vec3 x = to.corner + float(node[i]) * to.across + float(node[j]) * to.up;
            if (to.wall != from.wall)
              sum += weight[i] * weight[j] * double(dot(normal, polygon_form_factor(x, normal, corners)));
          }
        factor(r, s) = sum;
      }
    // Rows of a closed room sum to one; what quadrature lacks at shared edges is spread over the row.
    for (Eigen::Index r = 0; r < n; ++r) {
      EXPECT_NEAR(factor.row(r).sum(), 1, 1e-3);
      factor.row(r) /= factor.row(r).sum();
    }
    Eigen::VectorXd b(n);
    for (Eigen::Index i = 0; i < n; ++i) b[i] = double(exitance[list[size_t(i)].wall]);
    for (int sweep = 0; sweep < 200; ++sweep)
      for (Eigen::Index i = 0; i < n; ++i) {
        const size_t w = list[size_t(i)].wall;
        b[i] = double(exitance[w]) + double(rho[w]) * factor.row(i).dot(b);
      }
    Eigen::MatrixXd system = Eigen::MatrixXd::Identity(n, n);
    Eigen::VectorXd emission(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      system.row(i) -= double(rho[list[size_t(i)].wall]) * factor.row(i);
      emission[i] = double(exitance[list[size_t(i)].wall]);
    }
    EXPECT_LT((b - system.partialPivLu().solve(emission)).norm(), 1e-9 * b.norm());
    const Eigen::VectorXd irradiance = factor * b;
    std::array<double, 6> mean{};
    for (Eigen::Index i = 0; i < n; ++i) mean[list[size_t(i)].wall] += irradiance[i] / (cells * cells);
    return mean;
  }
};

TEST(Matrix, ClosedBoxOfSixReflectances) {
  Box6 coarse{.cells = 4}, fine{.cells = 8};
  const std::array<double, 6> at_4 = coarse.solve_matrix(), at_8 = fine.solve_matrix();
  Solved solved(fine.scene());
  solved.solve();
  std::array<double, 6> sum{}, area{};
  for (const ElementId id : solved.leaves()) {
    const Element& e = solved.pool()[id];
    sum[e.part] += double(e.area * solved.state().irradiance[id].x);
    area[e.part] += double(e.area);
  }
  for (size_t w = 0; w < 6; ++w) {
    EXPECT_NEAR(at_4[w] / at_8[w], 1, 0.02) << w;  // the matrix has settled
    EXPECT_NEAR(sum[w] / area[w] / at_8[w], 1, 0.01) << w;
  }
}

/// Rooms of the shared collection with an exact or converged mean; none reflects more than kMaxReflectance.
class SharedCase : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedCase, MeansOfSurfaces) {
  const test::Json room = test::shared_room(GetParam());
  if (room.is_null()) GTEST_SKIP() << test::kNoSharedCases;
  const std::vector<std::string> names = test::surface_names(room);
  std::vector<dvec3> irradiance(names.size(), dvec3(0)), radiosity(names.size(), dvec3(0));
  std::vector<double> area(names.size(), 0);
  // What one choice of rays gives a small face by luck, three do not.
  for (const uint32_t seed : {0u, 1u, 2u}) {
    Scene scene;
    test::add_surfaces(scene, room);
    SolveOptions options;
    options.last_error = 5e-6;
    options.least_area = 1.2e-5;
    options.seed = seed;
    Solved solved(std::move(scene), options);
    solved.solve();
    for (const ElementId id : solved.leaves()) {
      const Element& e = solved.pool()[id];
      irradiance[e.part] += double(e.area) * dvec3(solved.state().irradiance[id]);
      radiosity[e.part] += double(e.area) * dvec3(solved.state().radiosity[id]);
      area[e.part] += double(e.area);
    }
  }
  constexpr double kOfMean = 0.002;
  double total = 0, landing = 0;
  size_t checked = 0;
  for (size_t i = 0; i < names.size(); ++i) {
    total += area[i];
    landing += irradiance[i].y;
  }
  for (const auto& expect : room["expect"]) {
    if (!expect.contains("surface")) continue;
    const size_t i =
        size_t(std::find(names.begin(), names.end(), expect["surface"].get<std::string>()) - names.begin());
    ASSERT_LT(i, names.size());
    const bool uniform = expect["quantity"] == "uniform_radiosity";
    if (!uniform && expect["quantity"] != "mean_irradiance") continue;
    ++checked;
    for (int k = 0; k < 3; ++k) {
      const double truth = expect["value"][size_t(k)],
                   got = (uniform ? radiosity : irradiance)[i][k] / area[i];
      // Within 1% of the value, and a fifth of that of the room's mean where hardly any light gets.
      EXPECT_NEAR(got, truth, 0.01 * truth + kOfMean * landing / total)
          << GetParam() << " " << names[i] << " channel " << k;
    }
  }
  EXPECT_GT(checked, 0u);
}

INSTANTIATE_TEST_SUITE_P(Rooms, SharedCase,
                         ::testing::Values("gi-p-furnace-cube", "gi-p-furnace-lroom", "gi-p-furnace-facet8",
                                           "gi-p-hetero-lroom", "gi-p-hetero-facet8", "gi-p-black-box",
                                           "gi-p-black-lroom", "gi-p-cube-ceiling", "gi-p-globillum-room",
                                           "gi-p-lroom-colour", "gi-p-cornell-rgb"),
                         test::CaseName());

}  // namespace
}  // namespace goldthread
