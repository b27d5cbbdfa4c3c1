// Where the light goes: an account that the solver's own links have no part in.
#pragma once
#include "solve/hierarchical/solver.h"

namespace goldthread {

/// Luminous flux, lm. What surfaces emit and reflect is counted from the solution; what escapes to the sky,
/// falls on unlit backs, or comes in from sky, sun and point lights is counted by rays. emitted = absorbed +
/// escaped + residual, where the residual is the solver's error.
struct PowerBalance {
  double emitted = 0, absorbed = 0, escaped = 0, residual = 0;
};

/// `rays`: how many of each kind; the counts' standard error falls with the root. Deterministic by `seed`.
PowerBalance measure_power(const HierarchicalSolver& solver, uint32_t rays, uint32_t seed);

}  // namespace goldthread
