// The oracle and the refiner: which links are too coarse, and what replaces them (thesis 4.5).
#pragma once
#include <functional>

#include "base/progress.h"
#include "solve/hierarchical/discontinuity.h"
#include "solve/hierarchical/link_pool.h"
#include "solve/hierarchical/radiosity_state.h"
#include "solve/hierarchical/regard.h"

namespace goldthread {

struct RefineOptions {
  double power_error = 0;   ///< lm: links whose estimated error of received power counts for more are refined
  Regard regard;            ///< how much receivers' area counts
  float least_area = 0;     ///< m^2: receivers are not cut below this
  uint64_t most_links = 0;  ///< stop refining beyond; 0 for no limit
};

struct RefineCounters {
  uint64_t links_refined = 0;
  bool limited = false;  ///< most_links was reached
};

/// Estimated error of the power that a link brings, lm, by what it comes from (BFA-weighted L1, thesis 4.5.3,
/// with terms for what sampling may have missed).
struct LinkError {
  double receiver = 0;  ///< transfer or visibility varies over the receiver
  double source = 0;    ///< radiosity varies over the source
  double total() const { return receiver + source; }
};
LinkError estimate_error(const ElementPool& pool, const RadiosityState& state, const Link& link);

/// Refines breadth first until no link exceeds the bound, none leads as a whole to what a foot parts (Feet),
/// and none from such a source to what lies in the plane of the foot's wall. New elements are made as they
/// are needed. Each wave of links is decided and sampled in parallel and laid out in a fixed order, so that
/// the result does not depend on the threads. Rays are added to `rays` wave by wave; `between_waves` may be
/// empty.
RefineCounters refine(ElementPool& pool, const Visibility& visibility, LinkPool& links, Feet& feet,
                      RadiosityState& state, const RefineOptions& options, const CancelToken& cancel,
                      RayCount& rays, const std::function<void()>& between_waves);

/// Measures all links anew, once no more will be refined, and looks at which places of uneven sources they
/// see (measure_link). Rays are added to `rays`.
void measure_all(const ElementPool& pool, const Visibility& visibility, LinkPool& links,
                 const RadiosityState& state, const RefineOptions& options, const CancelToken& cancel,
                 RayCount& rays);

}  // namespace goldthread
