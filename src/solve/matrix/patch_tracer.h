// What rays say of patches: how much of a pair's exchange is seen, and what fills the view of each patch.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "solve/matrix/matrix_builder.h"
#include "visibility/hemicube.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// A patch as rays need it: single precision, metres.
struct TracedPatch {
  std::vector<vec3> corners;
  std::vector<std::array<vec3, 3>> triangles;  ///< for sampling; not empty
  std::vector<float> area_up_to;               ///< m², running sum over the triangles
  std::vector<vec3> points;                    ///< of the quadrature
  std::vector<float> weights;                  ///< m², of the points; they sum to the area
  vec3 normal{0}, centre{0};
  float area = 0, radius = 0;

  /// The polygon, planar and simple. Strang's 3-point rule, exact to degree 2, on each of the 4^cuts parts of
  /// each of its triangles.
  TracedPatch(const Polygon& polygon, int cuts);

  /// The point of (u, v), both 0..1: uniform over the patch where these are over the square.
  vec3 sample(float u, float v) const;
};

/// An entry of the matrix, and how it was found.
struct MatrixEntry {
  uint32_t column;
  FormFactorMethod method;
  float error;      ///< of the exchange, m²; see FormFactorMatrix::error
  double exchange;  ///< A_i F_ij, m²
};
using MatrixRow = std::vector<MatrixEntry>;  ///< columns ascending

/// Shares, 0..1, of what leaves a patch.
struct Surroundings {
  float environment = 0;  ///< meets nothing
  float back = 0;         ///< meets the back of something, or what only blocks
};

/// What a patch exchanges with all others, and what is left.
struct ScannedRow {
  MatrixRow row;  ///< columns on both sides of the diagonal
  Surroundings surroundings;
  uint64_t rays = 0;
};

/// Casts the rays of a model's patches. Keeps references to model and options, which must outlive it. The
/// same arguments give the same bytes; thread safe once built. Patches are told by their number in the model.
class PatchTracer {
 public:
  PatchTracer(const PatchModel& model, const MatrixOptions& options);

  /// What patches i and j exchange, as an entry of column j: the unobstructed exchange times the share that
  /// `MatrixOptions::rays` rays see of it. Nothing where they exchange nothing. The number of rays is added
  /// to `rays`.
  std::optional<MatrixEntry> exchange(uint32_t i, uint32_t j, uint64_t& rays) const;

  /// The whole row of patch i at once, by item buffers at the points of its quadrature: the mean of what each
  /// sees, by area.
  ScannedRow scan_row(uint32_t i, const DirectionGrid& grid) const;

  /// Surroundings of patch i by `MatrixOptions::environment_rays` cosine-distributed rays.
  Surroundings look_around(uint32_t i) const;

 private:
  // Sums over a patch's points, weighted by area.
  struct ViewOfPatch {
    std::map<uint32_t, std::pair<double, double>> shares;  // a patch: form factor, and its error
    double missed = 0, behind = 0;
  };
  struct SeenFraction {
    double value, deviation;  // standard deviation
  };

  void add_view(const HemisphereScan& scan, double weight, ViewOfPatch& view) const;
  SeenFraction seen(const TracedPatch& from, const TracedPatch& to, bool near, uint32_t seed,
                    uint64_t& rays) const;
  void find_twins();
  bool has_twin(uint32_t triangle) const;

  const PatchModel& model_;
  const MatrixOptions& options_;
  RayCaster caster_;
  std::vector<TracedPatch> patches_;
  std::vector<uint32_t> patch_of_triangle_;  // kNoPatch: of what only blocks
  std::vector<uint32_t> twins_;              // kNoPatch: of none
};

}  // namespace goldthread
