// What a point sees of a scene, and how much of its view each triangle fills: the item buffers of classical
// radiosity, with rays in the place of a rasteriser.
#pragma once
#include <cstdint>
#include <vector>

#include "visibility/direction_grid.h"
#include "visibility/ray_caster.h"

namespace goldthread {

struct ScanOptions {
  static constexpr uint32_t kMaxSamplesAcross = 16;

  /// 1: one ray through the middle of each cell, as an item buffer has it. k > 1: k x k rays, each jittered
  /// in its own part of the cell, against aliasing. At most kMaxSamplesAcross.
  uint32_t samples_across = 1;
  /// Radians by which the grid is turned about the normal. Receivers with the same turn share their aliasing,
  /// which shows as bands; with different turns it becomes noise.
  float turn = 0;
  uint32_t seed = 0;  ///< of the jitter; the same seed gives the same rays
};

/// A form factor from a receiver, and how far off it may be.
///
/// With one ray a cell, `error` bounds what the cells on the outline may hide: a quarter of the delta form
/// factors of all cells on both sides of it (a cell is on it when a neighbour met another triangle). A
/// straight outline passes between the middles of two neighbours, so that each pair of them is wrong by half
/// a cell at most. Outlines that run along the rows come near that; others, where errors differ in sign, are
/// far below. It falls as 1/resolution. Where several outlines cross one cell it is an estimate.
///
/// With k x k rays a cell, it is two standard errors, from the spread p (1 - p) of the rays in each cell as
/// if they were independent. They are stratified, so that of plain outlines it is an overestimate.
///
/// Neither knows of what no ray met: a triangle narrower than the distance of the rays may have no entry.
struct SeenShare {
  uint32_t triangle = Hit::kMiss;
  double front = 0;  ///< what met the side from which the triangle's corners run counter-clockwise
  double back = 0;   ///< what met the other. It hides what lies behind; whether it shines, the caller knows
  double error = 0;  ///< of front + back
};

/// A row of the form factor matrix: the whole hemisphere, given away. The fronts and backs of all triangles,
/// the environment and what the grid misses sum to one.
struct HemisphereScan {
  std::vector<SeenShare> seen;   ///< of each triangle that was met, by rising index
  double environment = 0;        ///< share of the rays that met nothing
  double environment_error = 0;  ///< as SeenShare::error
  double missing = 0;            ///< DirectionGrid::missing: where the grid does not look
  uint64_t rays = 0;
};

/// Point-to-triangle form factors, with occlusion, from a receiver at `position` of unit `normal` to all that
/// it sees (Cohen and Greenberg 1985; Cohen et al. 1988). Rays begin epsilon() off the receiver along its
/// normal. A receiver nearer than about that to another surface's plane, as at the foot of a wall or in a
/// corner, counts as before its front: the wall fills half the view, and its back stops nothing. Of rays that
/// graze it a few are lost to rounding, less than 1/50 of the view.
///
/// What is partly transparent stops its share of the rays, which ones a hash of the ray decides (see
/// RayCaster::closest); the grain counts as outline, and the error grows.
///
/// Serial, so that callers may scan many receivers at once; the same arguments give the same bytes.
HemisphereScan scan_hemisphere(const RayCaster& caster, const DirectionGrid& grid, const vec3& position,
                               const vec3& normal, const ScanOptions& options = {});

}  // namespace goldthread
