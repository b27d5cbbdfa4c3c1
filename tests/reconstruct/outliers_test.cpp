// Leaves that the solver knows poorly, in a room where every radiosity is known.
#include "reconstruct/outliers.h"

#include <gtest/gtest.h>

#include "solve/solved_scene.h"

namespace goldthread {
namespace {

TEST(Outliers, AreTakenAnewAndRightly) {
  // The furnace: E = 1, rho = 0.5, so that all radiosities are 2. Dense enough for clusters to catch single
  // triangles round its edges.
  SolveOptions options;
  options.last_error = 3e-5;
  options.least_area = 3e-5;
  test::Solved solved(test::procedural("furnace", 200000), options);
  solved.solve();
  ReconstructStats stats;
  const std::vector<vec3> shown =
      settle_outliers(*solved.solver, ReconstructOptions(), CancelToken(), stats).shown;
  ASSERT_EQ(shown.size(), solved.state().shown.size());
  float worst_before = 0, worst_after = 0;
  uint64_t changed = 0;
  for (size_t i = 0; i < shown.size(); ++i) {
    if (shown[i] == solved.state().shown[i]) continue;
    ++changed;
    worst_before = std::max(worst_before, std::abs(solved.state().shown[i].x - 2));
    worst_after = std::max(worst_after, std::abs(shown[i].x - 2));
  }
  EXPECT_GT(changed, 0u);
  EXPECT_LE(changed, stats.outliers);
  EXPECT_LT(changed, shown.size() / 20);
  EXPECT_GT(worst_before, 0.02f);  // or the scene no longer tells anything
  EXPECT_LT(worst_after, 0.02f);
}

TEST(Outliers, NoneOnABox) {
  test::Solved solved(test::procedural("cornell-box"), test::quick());
  solved.solve();
  ReconstructStats stats;
  EXPECT_EQ(settle_outliers(*solved.solver, ReconstructOptions(), CancelToken(), stats).shown,
            solved.state().shown);
  EXPECT_EQ(stats.outliers, 0u);
}

}  // namespace
}  // namespace goldthread
