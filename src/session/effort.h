// How hard a bake tries, for the error that is tolerated.
#pragma once
#include <optional>
#include <string>

#include "goldthread/bake.h"
#include "reconstruct/reconstruct.h"
#include "solve/hierarchical/solver.h"

namespace goldthread {

struct Effort {
  SolveOptions solve;
  ReconstructOptions reconstruct;
};

/// Root mean square error, over the mean of the light, that a preset aims at: 0.15, 0.06, 0.03, 0.015.
double tolerated_error(Quality quality);

/// Options for a tolerated error, kLeastError to kMostError: those of the presets, geometric in between and
/// beyond.
Effort effort_for(double error);

/// Nothing when the estimate (none where none was made) keeps what was asked for; else a sentence.
std::string missed_error(double asked, std::optional<double> estimate);

constexpr double kLeastError = 0.003, kMostError = 0.5;

}  // namespace goldthread
