// The hierarchical solver: refine, gather, push-pull, with a falling error bound (thesis 4.5.2).
#pragma once
#include <cstdint>
#include <functional>

#include "base/progress.h"
#include "element/element_pool.h"
#include "solve/hierarchical/discontinuity.h"
#include "solve/hierarchical/link_pool.h"
#include "solve/hierarchical/radiosity_state.h"
#include "solve/hierarchical/refine.h"
#include "visibility/ray_caster.h"

namespace goldthread {

struct SolveOptions {
  double first_error =
      1e-2;  ///< bound on a link's error in the first step, as a share of all light that lands
  double last_error = 1e-5;    ///< the same in the last step
  double error_ratio = 0.25;   ///< each step's bound over the one before
  double least_area = 2.5e-5;  ///< receivers are not cut below this share of the scene's area
  /// Iterate until a sweep changes reflected power by less than this share of landing light, and of each
  /// place's own by less than ten times that.
  double settled = 1e-4;
  uint64_t most_links = 0;  ///< 0: no limit
  uint32_t seed = 0;        ///< another choice of sample points and rays
  /// Visibility's accelerators.
  bool shafts = false, adaptive_sampling = true, discontinuities = false;
};

/// What a solve has cost and reached.
struct SolveStats {
  RayCount rays;
  uint32_t iterations = 0;    ///< gather and push-pull sweeps
  double epsilon = 0;         ///< the last finished step's bound, as a share of landing light
  double error_estimate = 0;  ///< root of summed squares of link errors over landing light
  bool converged = false;     ///< the last step was finished and settled
  bool limited = false;       ///< most_links stopped refinement
};

/// Solves one scene. Not thread safe: one thread calls `step`; others may read between calls only.
class HierarchicalSolver {
 public:
  /// Both are borrowed and must outlive the solver.
  HierarchicalSolver(const SurfaceSet& surfaces, const RayCaster& caster, const SolveOptions& options);

  /// One error bound: refine to it, then sweep. Returns false when there is nothing left to do. When
  /// cancelled midway, the links made so far are swept once, so that the state is always a solution.
  bool step(const CancelToken& cancel);

  /// Gives leaves (ascending ids) children for the sake of what is shown of them: no links lead to these, all
  /// above them are theirs. One that cannot be divided stays as it is.
  /// Cuts follow the light (find_discontinuities).
  void cut_leaves(std::span<const ElementId> leaves);

  /// 0..1 by bounds done.
  double share_done() const;

  const ElementPool& pool() const { return pool_; }
  const LinkPool& links() const { return links_; }
  const RadiosityState& state() const { return state_; }
  const Visibility& visibility() const { return visibility_; }
  const Regard& regard() const { return regard_; }
  const SolveStats& stats() const { return stats_; }
  uint64_t memory_bytes() const;

  /// Called on the stepping thread between waves of refinement, when elements and their light (not links) may
  /// be read.
  std::function<void()> between_waves;

 private:
  void make_first_links();
  double first_power() const;
  void cut_sides_alike();
  void cut_at_feet(float least_area);
  void sweep(uint32_t most, double settled, const CancelToken& cancel);

  const SolveOptions options_;
  ElementPool pool_;
  const Regard regard_;
  Visibility visibility_;
  LinkPool links_;
  Feet feet_;
  RadiosityState state_;
  SolveStats stats_;
  double bound_;
  double power_error_ = 0;  // of the last step, lm
};

/// The error that a link may have in the next step, in lm: `wanted`, a share of the light that was found to
/// land, but no less than a 256th of the step `before`. Coarse links may miss what comes through a small
/// opening; were nothing at all found, each link would be too wrong, and all would be opened down to the last
/// triangle.
double next_power_error(double wanted, double before);

/// Light given off by the scene's surfaces and lights, lm. Sun and sky count what enters the scene's box.
vec3 emitted_power(const ElementPool& pool);

}  // namespace goldthread
