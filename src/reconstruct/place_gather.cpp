#include "reconstruct/place_gather.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "base/rng.h"

namespace goldthread {
namespace {

constexpr uint32_t kNoTriangle = 0xffffffffu;
constexpr uint32_t kPlaceRays = 16384;
constexpr float kPlaceShare = 1e-4f;

}  // namespace

PlaceFinder::PlaceFinder(const ElementPool& pool) : pool_(pool) {
  const SurfaceSet& set = pool.surfaces();
  parts_.resize(set.parts.size());
  for (uint32_t p = 0; p < set.parts.size(); ++p) {
    parts_[p].part = p;
    const TriangleMesh& mesh = set.tree(set.parts[p]).mesh;
    std::vector<uint32_t>& of = parts_[p].tree_triangle;
    const auto put = [&](uint32_t source, uint32_t tree) {
      if (source >= of.size()) of.resize(source + 1, kNoTriangle);
      of[source] = tree;
    };
    for (uint32_t t = 0; t < mesh.source_triangles.size(); ++t) put(mesh.source_triangles[t], t);
    for (const DuplicateTriangle& d : mesh.duplicates) put(d.source, d.twin);
  }
  for (size_t s = 0; s < set.surfaces.size(); ++s) {
    const Surface& surface = set.surfaces[s];
    const uint32_t first = is_triangle(surface.root)
                               ? triangle_of(surface.root)
                               : set.tree(set.parts[surface.part]).nodes[surface.root].first;
    parts_[surface.part].roots[surface.back ? 1 : 0].emplace_back(first, pool.surface_roots()[s]);
  }
  for (PartPlaces& part : parts_)
    for (auto& roots : part.roots) std::sort(roots.begin(), roots.end());
  std::sort(parts_.begin(), parts_.end(), [&](const PartPlaces& a, const PartPlaces& b) {
    const Part &p = set.parts[a.part], &q = set.parts[b.part];
    return std::pair(p.instance, p.primitive) < std::pair(q.instance, q.primitive);
  });
}

const PlaceFinder::PartPlaces* PlaceFinder::find(uint32_t instance, uint32_t primitive) const {
  const SurfaceSet& set = pool_.surfaces();
  const auto at = std::lower_bound(parts_.begin(), parts_.end(), std::pair(instance, primitive),
                                   [&](const PartPlaces& a, const std::pair<uint32_t, uint32_t>& wanted) {
                                     const Part& p = set.parts[a.part];
                                     return std::pair(p.instance, p.primitive) < wanted;
                                   });
  if (at == parts_.end()) return nullptr;
  const Part& found = set.parts[at->part];
  return found.instance == instance && found.primitive == primitive ? &*at : nullptr;
}

std::optional<ElementId> PlaceFinder::leaf(const SurfacePlace& place) const {
  const PartPlaces* part = find(place.instance, place.primitive);
  if (part == nullptr || place.triangle >= part->tree_triangle.size()) return std::nullopt;
  const uint32_t triangle = part->tree_triangle[place.triangle];
  const auto& roots = part->roots[place.back ? 1 : 0];
  if (triangle == kNoTriangle || roots.empty() || triangle < roots.front().first) return std::nullopt;
  const auto root = std::upper_bound(roots.begin(), roots.end(), std::pair(triangle, kNoElement)) - 1;
  const vec3& normal = place.surface == vec3(0) ? place.normal : place.surface;
  return pool_.deepest(root->second, {place.position, normal, triangle});
}

std::vector<std::optional<vec3>> gather_places(const HierarchicalSolver& solver, const ShownLight& shown,
                                               std::span<const SurfacePlace> places,
                                               const ReconstructOptions& options, const CancelToken& cancel,
                                               ReconstructStats& stats) {
  const PlaceFinder finder(solver.pool());
  // Places are few, and somebody asks for just these.
  const GatherOptions gather{std::max(options.light_rays, kPlaceRays),
                             std::min(options.ray_share, kPlaceShare), false};
  std::vector<std::optional<vec3>> light(places.size());
  std::atomic<uint64_t> rays{0}, nanoseconds{0};
  parallel_for(
      places.size(),
      [&](size_t i) {
        const std::optional<ElementId> leaf = finder.leaf(places[i]);
        if (!leaf) return;
        light[i] = solver.state().irradiance[*leaf];
        if (cancel.cancelled()) return;
        RayCount count;
        const SurfacePlace& place = places[i];
        GatherOptions how = gather;
        how.bent = place.surface != vec3(0);
        // Rays start an epsilon along the normal: that shall take them off the surface, however it is bent.
        const vec3 x = how.bent
                           ? place.position + solver.visibility().epsilon * (place.surface - place.normal)
                           : place.position;
        const Gathered gathered =
            gather_at(solver, shown, *leaf, x, place.normal, how, hash(static_cast<uint32_t>(i), 79), count);
        light[i] = gathered.irradiance * horizon_gain(1, gathered.seen);
        rays.fetch_add(count.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(count.nanoseconds, std::memory_order_relaxed);
      },
      32);
  stats.rays += {rays.load(), nanoseconds.load()};
  return light;
}

}  // namespace goldthread
