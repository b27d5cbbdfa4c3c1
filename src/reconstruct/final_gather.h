// Irradiance at a single point from the links of the solution.
#pragma once
#include "solve/hierarchical/solver.h"

namespace goldthread {

struct GatherOptions {
  uint32_t light_rays = 32;
  float ray_share = 0.01f;
};

struct Gathered {
  vec3 irradiance{0};  ///< lux
  float openness = 1;  ///< of what lies before the point, the share that it sees
  float seen = 1;      ///< sum of the visible form factors
};

/// Irradiance at `x` with unit normal `n`, which belongs to leaf element `leaf`: the links into it and all
/// elements above it, each evaluated exactly at x (equation 4.12 with the transfer of 4.19 taken anew), but
/// for those that bring next to nothing, which serve as they are. Rays are cast for links that bring a share
/// of the light worth them; for the rest the links' own sampled visibility serves.
/// `shown` is the elements' radiosity: RadiosityState::shown or a better one.
Gathered gather_at(const HierarchicalSolver& solver, std::span<const vec3> shown, ElementId leaf,
                   const vec3& x, const vec3& n, const GatherOptions& options, uint32_t seed, RayCount& rays);

}  // namespace goldthread
