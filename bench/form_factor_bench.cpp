// All form factors of a hall with obstacles, beside what View3D is known for.
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>

#include "solve/matrix/matrix_builder.h"

namespace goldthread {
namespace {

void add_grid(PatchModel& model, const dvec3& corner, const dvec3& across, const dvec3& up, int n) {
  const dvec3 u = across / double(n), v = up / double(n);
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < n; ++k) {
      const dvec3 p = corner + double(i) * u + double(k) * v;
      model.patches.push_back({p, p + u, p + u + v, p + v});
    }
}

/// A hall of 10 x 8 x 3 m, seen from inside, with five blocks on its floor.
PatchModel hall(int n, int blocks_n) {
  PatchModel model;
  const dvec3 o(0), x(10, 0, 0), y(0, 8, 0), z(0, 0, 3);
  add_grid(model, o, x, y, n);
  add_grid(model, z, y, x, n);
  add_grid(model, o, y, z, n);
  add_grid(model, x, z, y, n);
  add_grid(model, o, z, x, n);
  add_grid(model, y, x, z, n);
  for (const dvec2& at : {dvec2(2, 2), dvec2(6, 2), dvec2(4, 5), dvec2(8, 6), dvec2(1, 6)}) {
    const dvec3 a(at.x, at.y, 0.001), u(1, 0, 0), v(0, 1, 0), w(0, 0, 1.2);
    add_grid(model, a + w, u, v, blocks_n);
    add_grid(model, a + u, v, w, blocks_n);
    add_grid(model, a, w, v, blocks_n);
    add_grid(model, a + v, w, u, blocks_n);
    add_grid(model, a, u, w, blocks_n);
  }
  return model;
}

int run() {
  // View3D, as published: 22,000 facets take hours; three are taken.
  constexpr double kView3dPairsPerSecond = 22000.0 * 21999 / 2 / (3 * 3600);
  const PatchModel model = hall(26, 6);
  const auto n = static_cast<double>(model.patches.size());
  const auto start = std::chrono::steady_clock::now();
  const Result<FormFactorMatrix> matrix = build_form_factor_matrix(model, {}, CancelToken());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!matrix) {
    fmt::print("{}\n", matrix.error().line());
    return EXIT_FAILURE;
  }
  double off = 0;
  const std::vector<double> sums = matrix->row_sums();
  for (size_t i = 0; i < sums.size(); ++i)
    off += std::abs(sums[i] + static_cast<double>(matrix->environment[i] + matrix->back[i]) - 1) / n;
  const double rate = n * (n - 1) / 2 / seconds;
  fmt::print("form factors of {} patches with obstacles: {:.1f} s, {:.2f} M pairs/s, {:.0f} MB\n",
             model.patches.size(), seconds, 1e-6 * rate, 1e-6 * static_cast<double>(matrix->memory_bytes()));
  fmt::print("  {:.0f} times View3D's rate (22,000 facets in three hours)\n", rate / kView3dPairsPerSecond);
  fmt::print("  rows and their surroundings are off one by {:.2e} on average\n", off);
  return off < 0.01 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace goldthread

int main() {
  return goldthread::run();
}
