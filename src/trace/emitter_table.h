// Which triangles shine, and a point on one of them drawn in proportion to their power.
#pragma once
#include <cstdint>
#include <vector>

#include "trace/traced_scene.h"

namespace goldthread {

/// The emitting triangles of a scene with their share of its light. Where a texture leaves a triangle dark at
/// all places that were looked at it is not in the table; what it emits is then found by paths alone.
class EmitterTable {
 public:
  explicit EmitterTable(const TracedScene& scene);

  bool empty() const { return triangles_.empty(); }

  /// A point drawn with `density` per m2 of area.
  struct Point {
    uint32_t triangle = 0;
    vec2 weights{0};
    float density = 0;
  };
  /// Maps the unit square onto the emitters: even points stay even. The table must not be empty.
  Point sample(double u, double v) const;

  /// Points per m2 that `sample` puts on a triangle: its share of all power over its area; 0 for those that
  /// are not in the table. Of two triangles over the very same corners, of which a ray can meet only one,
  /// both answer for the one that is in the table.
  float density(uint32_t triangle) const { return density_[triangle]; }

 private:
  std::vector<uint32_t> triangles_;
  std::vector<double> up_to_;    ///< running sum of the triangles' shares, ends in 1
  std::vector<uint32_t> guide_;  ///< first triangle whose up_to_ exceeds i / guide_.size()
  std::vector<float> density_;   ///< per triangle of the scene
};

}  // namespace goldthread
