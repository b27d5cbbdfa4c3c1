// A scene, its hierarchy and its solver in one piece, and questions that tests ask of the solution.
#pragma once
#include <memory>
#include <utility>
#include <vector>

#include "element/overlap.h"
#include "element/small_elements.h"
#include "solve/hierarchical/solver.h"
#include "visibility/coincident.h"

namespace goldthread::test {

struct Solved {
  std::unique_ptr<Scene> scene;
  std::unique_ptr<SurfaceSet> set;
  std::unique_ptr<RayCaster> caster;
  std::unique_ptr<HierarchicalSolver> solver;

  /// `passing(triangle, weights, set)` says how much light see-through triangles let through.
  template <typename Passing>
  Solved(Scene s, const SolveOptions& options, Passing passing)
      : scene(std::make_unique<Scene>(std::move(s))) {
    set = std::make_unique<SurfaceSet>(build_surfaces(*scene, CancelToken()));
    const WorldTriangles world = world_triangles(*set);
    caster = std::make_unique<RayCaster>(
        world.positions, world.triangles, world.see_through,
        [surfaces = set.get(), passing](uint32_t t, vec2 w, const Ray&) { return passing(t, w, *surfaces); });
    const PlaceClaims claims{[this](uint32_t t) { return contends_for_place(*set, t); },
                             [this](uint32_t a, uint32_t b) { return owns_place(*set, a, b); }};
    settle_overlaps(*set, find_coincident(world.positions, world.triangles, *caster, claims, CancelToken()),
                    caster->epsilon());
    solver = std::make_unique<HierarchicalSolver>(*set, *caster, options);
  }
  explicit Solved(Scene s, const SolveOptions& options = {})
      : Solved(std::move(s), options, [](uint32_t, vec2, const SurfaceSet&) { return 0.0f; }) {}

  Solved& solve() {
    const CancelToken never;
    while (solver->step(never)) {
    }
    return *this;
  }

  const ElementPool& pool() const { return solver->pool(); }
  const RadiosityState& state() const { return solver->state(); }

  /// The deepest elements that are on surfaces.
  std::vector<ElementId> leaves() const {
    std::vector<ElementId> out, stack{pool().root()};
    while (!stack.empty()) {
      const ElementId id = stack.back();
      stack.pop_back();
      const ElementId child = pool()[id].first_child;
      if (child == kNoElement) {
        out.push_back(id);
      } else {
        stack.insert(stack.end(), {child + 1, child});
      }
    }
    return out;
  }
};

/// Area-weighted mean of value(id) over leaves, with the least and the most.
struct Summary {
  double mean = 0, least = 1e300, most = -1e300, area = 0;
};
template <typename Value>
Summary summarise(const Solved& solved, const Value& value) {
  Summary s;
  for (const ElementId id : solved.leaves()) {
    const auto v = double(value(id));
    const auto a = double(solved.pool()[id].area);
    s.mean += v * a;
    s.area += a;
    s.least = std::min(s.least, v);
    s.most = std::max(s.most, v);
  }
  s.mean /= s.area;
  return s;
}

/// Effort for tests that need a right answer but not a fine one.
inline SolveOptions quick() {
  SolveOptions options;
  options.last_error = 1e-4;
  options.least_area = 2e-4;
  return options;
}

}  // namespace goldthread::test
