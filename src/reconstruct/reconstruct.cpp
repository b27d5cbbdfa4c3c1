#include "reconstruct/reconstruct.h"

#include <algorithm>

#include "reconstruct/adaptive_gather.h"
#include "reconstruct/average.h"
#include "reconstruct/light_points.h"

namespace goldthread {
namespace {

std::vector<vec3> to_vertices(const std::vector<vec3>& light, const std::vector<uint32_t>& point_of_vertex) {
  std::vector<vec3> out(point_of_vertex.size(), vec3(0));
  for (size_t v = 0; v < out.size(); ++v)
    if (point_of_vertex[v] != kNoPoint) out[v] = light[point_of_vertex[v]];
  return out;
}

// The error is measured at a tenth as many places as there are light points, within these limits.
constexpr uint64_t kLeastChecks = 500, kMostChecks = 4000;

}  // namespace

Lighting reconstruct(HierarchicalSolver& solver, const ReconstructOptions& options, const CancelToken& cancel,
                     ReconstructStats& stats, ShownLight* shown) {
  const ElementPool& pool = solver.pool();
  const SurfaceSet& set = pool.surfaces();
  AdaptiveGather gather(solver, options, cancel, stats);
  gather.run();
  gather.measure_error(static_cast<uint32_t>(std::clamp(stats.points / 10, kLeastChecks, kMostChecks)));
  if (shown != nullptr) *shown = gather.shown_light();
  Lighting lighting;
  for (uint32_t part = 0; part < set.parts.size(); ++part) {
    if (!gather.is_lit(part)) continue;
    std::vector<uint32_t> point_of_vertex;
    LitPrimitive lit = build_output_mesh(pool, part, gather.points(part), point_of_vertex);
    lit.irradiance = to_vertices(gather.light(part, false), point_of_vertex);
    if (gather.is_two_sided(part))
      lit.irradiance_back = to_vertices(gather.light(part, true), point_of_vertex);
    lighting.primitives.push_back(std::move(lit));
  }
  return lighting;
}

Lighting average_lighting(const HierarchicalSolver& solver) {
  const ElementPool& pool = solver.pool();
  const SurfaceSet& set = pool.surfaces();
  Lighting lighting;
  for (uint32_t part = 0; part < set.parts.size(); ++part) {
    const Material& material = set.scene->materials[set.parts[part].material];
    if (material.unlit || set.tree(set.parts[part]).mesh.triangles.empty()) continue;
    const PartPoints points = collect_light_points(pool, part);
    std::vector<uint32_t> point_of_vertex;
    LitPrimitive lit = build_output_mesh(pool, part, points, point_of_vertex);
    for (int side = 0; side < (material.lit_behind() ? 2 : 1); ++side) {
      const std::vector<ElementId> leaves = pool.leaf_elements(part, side == 1);
      (side == 0 ? lit.irradiance : lit.irradiance_back) =
          to_vertices(average_side(solver, points, leaves, side == 1), point_of_vertex);
    }
    lighting.primitives.push_back(std::move(lit));
  }
  return lighting;
}

}  // namespace goldthread
