// Which triangles shine, and a point on one of them drawn in proportion to their power.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "trace/lanes.h"
#include "trace/scrambled_sobol.h"
#include "trace/traced_scene.h"

namespace goldthread {

/// A triangle that shines, with all that sampling needs in one place.
struct Emitter {
  vec3 corner{0}, across{0}, up{0};  ///< corner 0, and from it to corners 1 and 2, world
  vec3 normal{0};                    ///< unit, to the front
  vec3 nits{0};                      ///< where it is `even`
  double from = 0, up_to = 0;  ///< running sums of shares of power, without this one's and with it; to 1
  double per_share = 0;        ///< 1 / (up_to - from)
  float density = 0;           ///< points per m2: its share of all power over its area
  uint32_t triangle = 0;
  bool double_sided = false;
  bool covered = false;  ///< whether another triangle owns some of its place
  bool even = true;      ///< one luminance all over, opaque and not covered
};

/// Points that were drawn, one a path.
struct EmitterPoints {
  Vec3Lanes points, normals;  ///< world; unit, to the front
  FloatLanes density;         ///< points per m2
  FloatLanes two_sided;       ///< 1, or 0
  std::array<const Emitter*, kLanes> emitters;
  std::array<vec2, kLanes> weights;  ///< barycentric, of corners 1 and 2
};

/// The emitting triangles of a scene with their share of its light. Where a texture leaves a triangle dark at
/// all places that were looked at it is not in the table; what it emits is then found by paths alone.
class EmitterTable {
 public:
  explicit EmitterTable(const TracedScene& scene);

  bool empty() const { return emitters_.empty(); }

  /// A point drawn by power, evenly within each triangle: maps the unit square onto the emitters, so that
  /// even points stay even. The table must not be empty, and `points` are at most kLanes.
  void sample(std::span<const SobolPoint> points, EmitterPoints& drawn) const;
  /// Luminance times coverage at a point; 0 where another surface lies in the same place and owns it.
  vec3 nits(const Emitter& emitter, vec2 weights) const;

  /// Points per m2 that `sample` puts on a triangle of the scene; 0 for those that are not in the table. Of
  /// triangles over the very same corners, of which a ray can meet only one, all answer for their owner,
  /// which is in the table.
  float density(uint32_t triangle) const { return density_[triangle]; }

 private:
  const Emitter& at(double share) const;

  const TracedScene& scene_;
  std::vector<Emitter> emitters_;
  std::vector<uint32_t> guide_;  ///< first emitter whose up_to exceeds i / guide_.size() (Chen and Asau 1974)
  std::vector<float> density_;   ///< per triangle of the scene
};

}  // namespace goldthread
