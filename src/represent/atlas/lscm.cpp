// Least squares conformal maps, in complex numbers. With W the sides of a triangle in its own plane, d twice
// its area and U its corners' images, the map fails to keep angles by |W0 U0 + W1 U1 + W2 U2|^2 / d (Levy et
// al. 2002, equation 3). conj(Wj) Wk has the sides' dot product for its real part and plus or minus d for its
// imaginary one, so that no local frames are needed. The normal equations are Hermitian with one unknown a
// corner: a quarter of the entries that they have in real numbers.
#include <Eigen/SparseCholesky>
#include <complex>

#include "represent/atlas/flatten.h"

namespace goldthread {
namespace {

using Complex = std::complex<double>;
using Matrix = Eigen::SparseMatrix<Complex>;
using Vector = Eigen::VectorXcd;

/// Thin triangles would outweigh all others, though their angles say little (Ray et al. 2003 leave them out):
/// none counts as lower than this share of its longest side.
constexpr double kThin = 1e-3;

/// Two corners on the boundary that are far apart: the one farthest from the middle and the one farthest from
/// that.
std::array<uint32_t, 2> choose_pins(const Piece& piece) {
  const auto farthest_from = [&](const dvec3& from) {
    uint32_t best = piece.boundary[0];
    double most = -1;
    for (const uint32_t corner : piece.boundary) {
      const dvec3 apart = piece.positions[corner] - from;
      if (dot(apart, apart) > most) most = dot(apart, apart), best = corner;
    }
    return best;
  };
  dvec3 middle(0);
  for (const uint32_t corner : piece.boundary) middle += piece.positions[corner];
  const uint32_t first = farthest_from(middle / double(piece.boundary.size()));
  return {first, farthest_from(piece.positions[first])};
}

/// The normal equations with the pinned corners' columns moved to the right. Unknowns are numbered as corners
/// are, without the pinned ones.
class Conformal {
 public:
  explicit Conformal(const Piece& piece) : piece_(piece), pins_(choose_pins(piece)) {
    const size_t corners = piece.positions.size();
    unknown_.resize(corners);
    int next = 0;
    for (uint32_t i = 0; i < corners; ++i) unknown_[i] = i == pins_[0] || i == pins_[1] ? -1 : next++;
    pinned_ = length(piece.positions[pins_[0]] - piece.positions[pins_[1]]);
    right_ = Vector::Zero(next);
    entries_.reserve(piece.faces.size() * 6);
    for (const UVec3& face : piece.faces) add(face);
  }

  std::optional<PlaneImage> solve() {
    Matrix matrix(right_.size(), right_.size());
    matrix.setFromTriplets(entries_.begin(), entries_.end());
    const Eigen::SimplicialLDLT<Matrix, Eigen::Lower> solver(matrix);
    if (solver.info() != Eigen::Success) return std::nullopt;
    const Vector solution = solver.solve(right_);
    PlaneImage image(unknown_.size(), dvec2(0));
    for (size_t i = 0; i < image.size(); ++i)
      if (unknown_[i] >= 0) image[i] = {solution[unknown_[i]].real(), solution[unknown_[i]].imag()};
    image[pins_[1]] = {pinned_, 0};
    return image;
  }

 private:
  void add(const UVec3& face) {
    const dvec3& a = piece_.positions[face.x];
    const dvec3& b = piece_.positions[face.y];
    const dvec3& c = piece_.positions[face.z];
    const dvec3 sides[3] = {c - b, a - c, b - a};
    const double doubled_area = length(cross(sides[0], sides[1]));
    const double longest =
        std::max({dot(sides[0], sides[0]), dot(sides[1], sides[1]), dot(sides[2], sides[2])});
    const double weight = 1 / std::max(doubled_area, kThin * longest);
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3;
      add_entry(face[j], face[j], weight * dot(sides[j], sides[j]));
      const Complex across(weight * dot(sides[j], sides[k]), weight * doubled_area);
      add_entry(face[j], face[k], across);
      add_entry(face[k], face[j], std::conj(across));
    }
  }

  /// conj(U[row]) * value * U[column]; only the lower half of the matrix is kept.
  void add_entry(uint32_t row, uint32_t column, Complex value) {
    const int r = unknown_[row], c = unknown_[column];
    if (r >= 0 && c >= 0 && r >= c) entries_.emplace_back(r, c, value);
    if (r >= 0 && column == pins_[1]) right_[r] -= value * pinned_;
  }

  const Piece& piece_;
  std::array<uint32_t, 2> pins_;  ///< at 0 and at pinned_
  double pinned_ = 0;
  std::vector<int> unknown_;
  std::vector<Eigen::Triplet<Complex>> entries_;
  Vector right_;
};

}  // namespace

std::optional<PlaneImage> map_conformally(const Piece& piece) {
  std::optional<PlaneImage> image = Conformal(piece).solve();
  if (!image) return std::nullopt;
  double surface = 0, plane = 0;
  for (const UVec3& f : piece.faces) {
    surface += length(
        cross(piece.positions[f.y] - piece.positions[f.x], piece.positions[f.z] - piece.positions[f.x]));
    const dvec2 p = (*image)[f.y] - (*image)[f.x], q = (*image)[f.z] - (*image)[f.x];
    plane += p.x * q.y - p.y * q.x;
  }
  const double scale = std::sqrt(surface / plane);
  if (!(scale > 0) || !std::isfinite(scale)) return std::nullopt;
  for (dvec2& p : *image) p *= scale;
  return image;
}

}  // namespace goldthread
