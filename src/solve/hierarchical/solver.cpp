#include "solve/hierarchical/solver.h"

#include <algorithm>

#include "base/rng.h"
#include "solve/hierarchical/point_transfer.h"
#include "solve/hierarchical/push_pull.h"

namespace goldthread {
namespace {

// Feet that no link asked about are cut down to this share of the least area.
constexpr float kLeastAtHiddenFoot = 0.125f;

// No step is finer than the one before by more than this.
constexpr double kMostFiner = 256;
// Where less than this share of what shines into the scene lands, it is dark. So small, since on a plain of
// kilometres next to all that shines into its box lands where it hardly counts (Regard).
constexpr double kDark = 1e-12;

}  // namespace

HierarchicalSolver::HierarchicalSolver(const SurfaceSet& surfaces, const RayCaster& caster,
                                       const SolveOptions& options)
    : options_(options),
      pool_(surfaces),
      regard_(surfaces),

      bound_(options.first_error) {
  visibility_.caster = &caster;
  Box box;
  for (const Part& part : surfaces.parts)
    for (const vec3& p : part.positions)
      if (is_finite(p)) box.add(p);
  visibility_.extent = box.diagonal();
  visibility_.epsilon = caster.epsilon();
  // Spread over all bits: seeds are small numbers, and so are some of what they are mixed with.
  visibility_.seed = options.seed == 0 ? 0 : hash(options.seed, 1);
  visibility_.shafts = options.shafts;
  visibility_.adaptive = options.adaptive_sampling;
  visibility_.discontinuities = options.discontinuities;
  if (options.shafts || options.discontinuities) caster.prepare_shafts();
  feet_.grow_to(pool_, visibility_);
  state_.grow_to(pool_);
  make_first_links();
}

void HierarchicalSolver::make_first_links() {
  const ElementId root = pool_.root();
  if (root == kNoElement) return;
  std::vector<Link>& all = links_.all();
  Link self;
  self.receiver = self.source = root;
  all.push_back(self);
  for (const ElementId light : pool_.lights())
    all.push_back(make_link(pool_, visibility_, root, light, 8, 2, stats_.rays));
  links_.sort(pool_.size());
}

double HierarchicalSolver::first_power() const {
  return static_cast<double>(largest(emitted_power(pool_)));
}

bool HierarchicalSolver::step(const CancelToken& cancel) {
  if (pool_.root() == kNoElement || stats_.converged) return false;
  const double landing = static_cast<double>(largest(regarded_power(pool_, state_, regard_)));
  RefineOptions refine_options;
  const double wanted =
      bound_ * (stats_.iterations == 0 ? first_power() : std::max(landing, kDark * first_power()));
  refine_options.power_error = power_error_ = next_power_error(wanted, power_error_);
  refine_options.regard = regard_;
  refine_options.least_area = static_cast<float>(options_.least_area * regarded_area(pool_, regard_));
  refine_options.most_links = options_.most_links;
  const RefineCounters counters =
      refine(pool_, visibility_, links_, feet_, state_, refine_options, cancel, stats_.rays, between_waves);
  stats_.limited |= counters.limited;
  if (pool_.surfaces().has_translucent) cut_sides_alike();
  const bool reached = power_error_ <= wanted;
  const bool last = (reached && bound_ <= options_.last_error * 1.0001) || counters.limited;
  if (last) cut_at_feet(kLeastAtHiddenFoot * refine_options.least_area);
  if (last) measure_all(pool_, visibility_, links_, state_, refine_options, cancel, stats_.rays);
  // The first steps only have to find where the light goes; the last has to settle.
  sweep(last ? 400 : 3, last ? options_.settled : 30 * options_.settled, cancel);
  if (cancel.cancelled()) return false;
  stats_.epsilon = bound_;
  stats_.converged = last;
  if (reached) bound_ = std::max(options_.last_error, bound_ * options_.error_ratio);
  return !last;
}

// Light differs on the two sides of a foot even where links need not know it.
void HierarchicalSolver::cut_at_feet(float least_area) {
  for (std::vector<ElementId> leaves;; leaves.clear()) {
    for (ElementId id = 0; id < pool_.size(); ++id)
      if (pool_[id].first_child == kNoElement && !pool_[id].indivisible && pool_[id].area > 2 * least_area &&
          feet_.of(id).present())
        leaves.push_back(id);
    if (leaves.empty()) return;
    cut_leaves(leaves);
  }
}

// What shines through a sheet is as uneven as the light behind it, which its own light knows nothing of: a
// leaf is cut where its twin is.
void HierarchicalSolver::cut_sides_alike() {
  for (std::vector<ElementId> coarse;; coarse.clear()) {
    for (ElementId id = 0; id < pool_.size(); ++id)
      if (pool_[id].first_child == kNoElement && !pool_[id].indivisible &&
          largest(pool_.transmittance(id)) > 0) {
        const ElementId twin = pool_.twin(id);
        if (twin != kNoElement && pool_[twin].first_child != kNoElement) coarse.push_back(id);
      }
    if (coarse.empty()) return;
    cut_leaves(coarse);
  }
}

void HierarchicalSolver::cut_leaves(std::span<const ElementId> leaves) {
  const LampLinks lamps(pool_, state_, links_.all());
  pool_.expand(leaves, find_discontinuities(pool_, visibility_, leaves, feet_, lamps, stats_.rays));
  feet_.grow_to(pool_, visibility_);
  state_.grow_to(pool_);
}

void HierarchicalSolver::sweep(uint32_t most, double settled, const CancelToken& cancel) {
  // Single leaves may overstate what they see, up and down about evenly. Where bright walls face each other
  // across a gap and all do, light would grow for ever; then no leaf is let see more than there is.
  float most_seen = 1.25f;
  double before = std::numeric_limits<double>::max();
  for (uint32_t i = 0; i < most; ++i) {
    const SweepChange change = gather_push_pull(pool_, links_, state_, most_seen, regard_);
    ++stats_.iterations;
    if (i > 10 && change.power >= before) most_seen = 1;
    before = change.power;
    if ((change.power < settled && change.relative < 10 * settled) || cancel.cancelled()) break;
  }
  double squares = 0;
  for (const Link& link : links_.all()) {
    const double error = estimate_error(pool_, state_, link).total();
    squares += error * error;
  }
  const double landing = static_cast<double>(largest(regarded_power(pool_, state_, regard_)));
  stats_.error_estimate = landing > 0 ? std::sqrt(squares) / landing : 0;
}

double HierarchicalSolver::share_done() const {
  if (stats_.converged) return 1;
  // Work grows about as the inverse of the bound's root.
  const double first = std::sqrt(options_.first_error), last = std::sqrt(options_.last_error);
  const double now =
      std::sqrt(std::max(stats_.epsilon > 0 ? stats_.epsilon : options_.first_error, options_.last_error));
  return std::clamp((1 / now - 1 / first) / std::max(1e-12, 1 / last - 1 / first), 0.0, 1.0);
}

uint64_t HierarchicalSolver::memory_bytes() const {
  return pool_.memory_bytes() + links_.memory_bytes() +
         state_.radiosity.capacity() * (4 * sizeof(vec3) + 3 * sizeof(float) + sizeof(mat3));
}

double next_power_error(double wanted, double before) {
  return std::max(wanted, before / kMostFiner);
}

vec3 emitted_power(const ElementPool& pool) {
  vec3 power(0);
  if (pool.root() == kNoElement) return power;
  const Element& root = pool[pool.root()];
  power += root.area * root.exitance;
  Box box;
  for (const Part& part : pool.surfaces().parts)
    for (const vec3& p : part.positions)
      if (is_finite(p)) box.add(p);
  const vec3 size = box.size();
  for (const ElementId id : pool.lights()) {
    const Element& e = pool[id];
    if (e.kind == ElementKind::kSky) {
      // The cell's share of what crosses the box inward, were the box a ball.
      power += e.exitance * box.surface_area() * (pool.sky_cell(id).solid_angle / (4 * kPi));
    } else if (e.kind == ElementKind::kSun) {
      const vec3 d = glm::abs(pool.light(id).direction);
      power += e.exitance * (d.x * size.y * size.z + d.y * size.z * size.x + d.z * size.x * size.y);
    } else {
      power += e.exitance * lamp_solid_angle(pool.light(id));
    }
  }
  return power;
}

}  // namespace goldthread
