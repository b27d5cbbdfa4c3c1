// The sky as spherical triangles, cut where it is uneven, each with the light of its own piece.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"
#include "scene/sky_grid.h"

namespace goldthread {

/// A spherical triangle of directions.
struct SkyCell {
  std::array<vec3, 3> corners;  ///< unit, counter-clockwise as seen from inside
  float solid_angle = 0;        ///< steradians
  vec3 nits{0};                 ///< mean luminance over its solid angle
  /// Mean over its solid angle of how far luminance is from `nits`, nits of the channel where that is most.
  /// Half of it times the cell's form factor is the most by which an irradiance can be off that takes the
  /// cell for even: all that is seen of it would have to be on one side of the mean.
  float unevenness = 0;
  /// Vector form factor of the whole cell, its luminance weighed: pi `nits` times its dot product with a
  /// normal is the irradiance of a receiver whose horizon does not cut the cell.
  vec3 transfer{0};
  uint32_t first = 0, count = 0;  ///< its samples of the sky; none where the sky is uniform
};

/// Cells of one sky, made on demand. A cell's light is a sum over the pieces of a SkyGrid whose middles lie
/// in it, the pieces cut up where few are left, so that two halves always send together what the whole did.
class SkyCells {
 public:
  /// The eight octants; none where the sky is dark. The sky must outlive the cells.
  explicit SkyCells(const Sky& sky);

  size_t size() const { return cells_.size(); }
  const SkyCell& operator[](uint32_t cell) const { return cells_[cell]; }

  /// Cells that together are the sky: the octants, cut on where else one cell's unevenness would be more than
  /// 5% of all light, to 64 at most. A sun in a picture gets a cell of about its own.
  std::vector<uint32_t> make_first();

  /// Luminance from a unit direction in a cell over the cell's mean, to the SkyGrid's resolution.
  float relative_luminance(uint32_t cell, const vec3& direction) const;

  /// Whether halves of the cell may be of different light.
  bool divisible(uint32_t cell) const;
  /// Cuts a cell across its longest edge; returns the first half, the second follows.
  uint32_t split(uint32_t cell);

  uint64_t memory_bytes() const {
    return cells_.capacity() * sizeof(SkyCell) + samples_.capacity() * sizeof(Sample);
  }

 private:
  struct Sample {
    SkyPiece piece;
    vec3 nits;
  };

  void add_octants();
  void take_samples();
  void refine_samples(SkyCell& cell, uint32_t fewest);
  void measure(SkyCell& cell) const;

  const Sky* sky_;
  SkyGrid grid_;  ///< empty where the sky is uniform
  std::vector<SkyCell> cells_;
  std::vector<Sample> samples_;
};

}  // namespace goldthread
