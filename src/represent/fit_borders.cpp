#include "represent/fit_borders.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>

namespace goldthread {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// How much a texel's change counts beside a sample's error: little where it is free, enough to settle what
/// samples leave open; more where it is known well.
constexpr double kFree = 0.003, kKnown = 1.5;
/// What is left after so many steps is far below a step of eight bits.
constexpr int kMostSteps = 200;
constexpr double kTolerance = 1e-7;

/// The four texels that a bilinear filter mixes at a place.
struct Taps {
  std::array<size_t, 4> texel{};
  std::array<double, 4> weight{};
};

Taps taps_at(const FloatImage& page, const vec2& at) {
  const dvec2 size(page.width, page.height);
  const dvec2 p = glm::clamp(dvec2(at) - 0.5, dvec2(0), size - 1.0);
  const auto x = static_cast<size_t>(p.x), y = static_cast<size_t>(p.y);
  const size_t right = std::min<size_t>(x + 1, page.width - 1);
  const size_t below = std::min<size_t>(y + 1, page.height - 1);
  const double u = p.x - static_cast<double>(x), v = p.y - static_cast<double>(y);
  return {{y * page.width + x, y * page.width + right, below * page.width + x, below * page.width + right},
          {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v}};
}

}  // namespace

void fit_borders(FloatImage& page, std::span<const float> trust, std::span<const BorderSample> samples,
                 std::vector<uint8_t>& used) {
  constexpr int kUnused = -1;
  std::vector<int> unknown(page.pixels.size(), kUnused);
  std::vector<size_t> texels;
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t s = 0; s < samples.size(); ++s) {
    const Taps taps = taps_at(page, samples[s].at);
    for (size_t k = 0; k < 4; ++k) {
      if (!(taps.weight[k] > 0)) continue;
      int& number = unknown[taps.texel[k]];
      if (number == kUnused) {
        number = static_cast<int>(texels.size());
        texels.push_back(taps.texel[k]);
      }
      entries.emplace_back(static_cast<int>(s), number, taps.weight[k]);
    }
  }
  if (texels.empty()) return;
  const auto rows = static_cast<int>(samples.size()), columns = static_cast<int>(texels.size());
  std::vector<double> stiffness;
  for (const size_t texel : texels) {
    const auto known = static_cast<double>(trust[texel]);
    stiffness.push_back(std::max(kFree, kKnown * known));
  }
  for (int i = 0; i < columns; ++i) entries.emplace_back(rows + i, i, stiffness[static_cast<size_t>(i)]);
  Matrix matrix(rows + columns, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::LeastSquaresConjugateGradient<Matrix> solver(matrix);
  solver.setMaxIterations(kMostSteps);
  solver.setTolerance(kTolerance);
  for (int c = 0; c < 3; ++c) {
    Eigen::VectorXd right(rows + columns), guess(columns);
    for (int s = 0; s < rows; ++s) right[s] = static_cast<double>(samples[static_cast<size_t>(s)].light[c]);
    for (int i = 0; i < columns; ++i) {
      guess[i] = static_cast<double>(page.pixels[texels[static_cast<size_t>(i)]][c]);
      right[rows + i] = stiffness[static_cast<size_t>(i)] * guess[i];
    }
    const Eigen::VectorXd fitted = solver.solveWithGuess(right, guess);
    for (int i = 0; i < columns; ++i)
      page.pixels[texels[static_cast<size_t>(i)]][c] = static_cast<float>(std::max(0.0, fitted[i]));
  }
  for (const size_t texel : texels) used[texel] = 1;
}

}  // namespace goldthread
