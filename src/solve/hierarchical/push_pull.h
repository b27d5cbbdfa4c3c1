// One sweep of light over all links, down the hierarchy and up again (thesis 3.2.3, 4.2.3).
#pragma once
#include "solve/hierarchical/link_pool.h"
#include "solve/hierarchical/radiosity_state.h"
#include "solve/hierarchical/regard.h"

namespace goldthread {

/// How much a sweep has changed of the light that leaves reflect, by regard.
struct SweepChange {
  double power = 0;     ///< as a share of all power that lands
  double relative = 0;  ///< of each leaf's own light, a mean by area: a dark room beside a bright one counts
};

/// Gathers every link (equation 4.20), pushes irradiance vectors to the leaves (4.16), turns them into
/// radiosity (4.21) and pulls averages up (4.17). Vectors are kept apart by octant of direction on the way
/// down, so that two lamps on opposite sides of a cluster do not cancel. Leaves whose sampled form factors
/// add up to more than `most_seen` are scaled down to that.
SweepChange gather_push_pull(const ElementPool& pool, const LinkPool& links, RadiosityState& state,
                             float most_seen = 1.25f, const Regard& regard = {});

/// Irradiance times area (with coverage) over the leaves, lm.
vec3 landing_power(const ElementPool& pool, const RadiosityState& state);

}  // namespace goldthread
