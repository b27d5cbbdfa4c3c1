// From a solution on elements to light at vertices.
#pragma once
#include "base/progress.h"
#include "scene/lighting.h"
#include "solve/hierarchical/solver.h"

namespace goldthread {

enum class Reconstruction {
  kAverage,  ///< leaf elements' irradiance vectors, turned to the vertex normal and averaged: fast, for
             ///< snapshots
  kGather,   ///< every link on the way to the root is evaluated again at the vertex (thesis 4.5.5, final
             ///< gather)
};

struct ReconstructOptions {
  Reconstruction method = Reconstruction::kGather;
  uint32_t light_rays =
      128;  ///< kGather: shadow rays for a link that brings all of a vertex's light; less pro rata
  float ray_share =
      0.01f;  ///< links that bring less than this share use the visibility that they were sampled with
};

struct ReconstructStats {
  RayCount rays;
  uint64_t points = 0;
  uint64_t outliers = 0;  ///< leaves whose own light was gathered first
};

/// Light on every primitive that receives it. When cancelled, what is not yet gathered is averaged.
Lighting reconstruct(const HierarchicalSolver& solver, const ReconstructOptions& options,
                     const CancelToken& cancel, ReconstructStats& stats);

}  // namespace goldthread
