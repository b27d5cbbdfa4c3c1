#include "reconstruct/outliers.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "base/parallel.h"
#include "base/rng.h"
#include "reconstruct/final_gather.h"

namespace goldthread {
namespace {

// Net over summed area from which a cluster counts as nearly flat.
constexpr float kNearlyFlat = 0.8f;
// Cosine to the cluster's net normal below which a leaf is an outlier, and its largest share of the area.
constexpr float kTurned = 0.5f;
constexpr float kSmall = 0.25f;
constexpr uint32_t kPoints = 4;

bool is_outlier(const ElementPool& pool, ElementId id) {
  const Element& leaf = pool[id];
  if (leaf.first_child != kNoElement || !is_surface(leaf.kind) || !leaf.flat) return false;
  const float leaf_net = length(leaf.summed_normal);
  for (ElementId a = leaf.parent; a != kNoElement && pool[a].kind == ElementKind::kCluster;
       a = pool[a].parent) {
    const Element& cluster = pool[a];
    const float net = length(cluster.summed_normal);
    if (net > kNearlyFlat * cluster.area && leaf.area < kSmall * cluster.area &&
        dot(leaf.summed_normal, cluster.summed_normal) < kTurned * leaf_net * net)
      return true;
  }
  return false;
}

}  // namespace

ShownLight settle_outliers(const HierarchicalSolver& solver, const ReconstructOptions& options,
                           const CancelToken& cancel, ReconstructStats& stats) {
  const ElementPool& pool = solver.pool();
  const ShownLight solved(solver.state());
  ShownLight light = solved;
  std::vector<uint8_t> found(pool.size());
  parallel_for(
      found.size(),
      [&](size_t id) {
        if (!cancel.cancelled()) found[id] = is_outlier(pool, static_cast<ElementId>(id)) ? 1 : 0;
      },
      4096);
  std::vector<ElementId> outliers;
  for (ElementId id = 0; id < pool.size(); ++id) {
    if (found[id] == 0) continue;
    const ElementId first = pool[pool[id].parent].first_child, beside = id == first ? first + 1 : first;
    outliers.push_back(id);
    if (pool[beside].first_child == kNoElement && pool[beside].flat) outliers.push_back(beside);
  }
  std::sort(outliers.begin(), outliers.end());
  outliers.erase(std::unique(outliers.begin(), outliers.end()), outliers.end());
  const GatherOptions gather{options.light_rays, options.ray_share};
  std::atomic<uint64_t> rays{0}, nanoseconds{0};
  parallel_for(
      outliers.size(),
      [&](size_t i) {
        if (cancel.cancelled()) return;
        const ElementId id = outliers[i];
        std::array<SurfacePoint, kPoints> at;
        pool.quadrature(id, at);
        RayCount count;
        vec3 sum(0);
        // All by what the solver knows: an outlier next to another sees it as it was.
        for (uint32_t k = 0; k < kPoints; ++k)
          sum += gather_at(solver, solved, id, at[k].position, at[k].normal, gather, hash(id, 78 + k), count)
                     .irradiance;
        light.shown[id] =
            leaving_light(pool, id, sum / static_cast<float>(kPoints), solver.state().irradiance);
        light.low[id] = light.high[id] = largest(light.shown[id]);
        rays.fetch_add(count.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(count.nanoseconds, std::memory_order_relaxed);
      },
      32);
  stats.rays += {rays.load(), nanoseconds.load()};
  stats.outliers = outliers.size();
  return light;
}

}  // namespace goldthread
