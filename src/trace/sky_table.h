// Directions drawn from where the sky is bright.
#pragma once
#include <vector>

#include "scene/sky_grid.h"

namespace goldthread {

/// A direction to the sky, with the density of its drawing.
struct SkyDirection {
  vec3 direction{0, 1, 0};  ///< unit
  float density = 0;        ///< 1/sr
};

/// Draws pieces of a SkyGrid by their share of luminance times solid angle, and directions evenly within each
/// (Pharr, Jakob and Humphreys, Physically Based Rendering, 2016, section 14.2.4). Density is 0 where a piece
/// is dark: what light there is in it other strategies have to find.
class SkyTable {
 public:
  explicit SkyTable(const Sky& sky);

  bool empty() const { return !(total_ > 0); }
  /// Maps the unit square onto the sky, so that even points stay even. The table must not be empty.
  SkyDirection sample(double u, double v) const;
  /// Density, 1/sr, with which `sample` takes the unit direction.
  float density(const vec3& direction) const;

 private:
  size_t row_start(size_t row) const { return row * (grid_.width + size_t{1}); }

  SkyGrid grid_;
  std::vector<double> rows_;     ///< running sums of rows' power, height + 1, ends in 1
  std::vector<double> columns_;  ///< of each row running sums over its pieces, width + 1, each ends in 1
  double total_ = 0;             ///< luminance integrated over the sphere, lx
};

}  // namespace goldthread
