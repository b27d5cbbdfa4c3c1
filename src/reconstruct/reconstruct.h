// From a solution on elements to light at vertices.
#pragma once
#include <functional>
#include <optional>

#include "base/progress.h"
#include "scene/lighting.h"
#include "solve/hierarchical/solver.h"

namespace goldthread {

struct ShownLight;

struct ReconstructOptions {
  uint32_t light_rays = 128;  ///< shadow rays for a link that brings all of a vertex's light; less pro rata
  float ray_share =
      0.01f;  ///< links that bring less than this share use the visibility that they were sampled with
  /// Root mean square of what lies between vertices, over mean light: by area as far as it counts (Regard),
  /// more in the dark and less on textures (weight_of_darkness, weight_of_masking).
  double error = 0.06;
  double growth = 3;  ///< no more is cut once so many times the work of the solver's own leaves has been done
  std::function<bool()> full;  ///< asked before every round of cuts: true when there is no room for more
};

struct ReconstructStats {
  RayCount rays;
  uint64_t points = 0;
  uint64_t places = 0;    ///< between them that were looked at, to see what is wrong there
  uint64_t outliers = 0;  ///< leaves whose own light was gathered first
  double error = 0;       ///< what `ReconstructOptions::error` bounds, as it is in the end
  /// Root mean square by area of the error of the light between the points, over its mean, as gathering at
  /// other places finds it. Noise and interpolation are in it, and sources read more finely than the points
  /// read them; not what the solution itself is wrong by. None when cancelled.
  std::optional<double> estimate;
};

/// Light on every primitive that receives it. Every link on the way to the root is evaluated again at the
/// vertices (thesis 4.5.5, final gather), and leaves are cut where light bends between them: the solver gains
/// elements. When cancelled, what is not yet gathered is averaged. `shown`, if given, becomes what the
/// elements show now, for gathering at more places.
Lighting reconstruct(HierarchicalSolver& solver, const ReconstructOptions& options, const CancelToken& cancel,
                     ReconstructStats& stats, ShownLight* shown = nullptr);

/// The same from the leaf elements' irradiance vectors alone: fast, for snapshots.
Lighting average_lighting(const HierarchicalSolver& solver);

}  // namespace goldthread
