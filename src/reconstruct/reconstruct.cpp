#include "reconstruct/reconstruct.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "base/rng.h"
#include "reconstruct/final_gather.h"
#include "reconstruct/interpolate.h"
#include "reconstruct/light_points.h"
#include "reconstruct/outliers.h"

namespace goldthread {
namespace {

// Means of the adjoining leaves' irradiance, each turned to the point's own normal, by area.
std::vector<vec3> average_side(const HierarchicalSolver& solver, const PartPoints& points,
                               const std::vector<ElementId>& leaves, bool back) {
  std::vector<vec3> sum(points.points.size(), vec3(0));
  std::vector<float> weight(points.points.size(), 0);
  for (uint32_t f = 0; f + 1 < points.corner_first.size(); ++f) {
    if (leaves[f] == kNoElement) continue;
    const Element& leaf = solver.pool()[leaves[f]];
    const mat3& vector = solver.state().vector[leaves[f]];
    for (uint32_t c = points.corner_first[f]; c < points.corner_first[f + 1]; ++c) {
      const uint32_t p = points.corners[c];
      const vec3 n = back ? -points.points[p].normal : points.points[p].normal;
      // A flat leaf knows how its light varies with place, a curved one how it does with the normal.
      const vec3 turned = leaf.flat ? glm::max(solver.state().irradiance[leaves[f]] +
                                                   (points.points[p].position - leaf.centre) * vector,
                                               vec3(0))
                                    : glm::max(n * vector, vec3(0)) + solver.state().ambient[leaves[f]];
      sum[p] += turned;
      weight[p] += 1;
    }
  }
  for (size_t p = 0; p < sum.size(); ++p)
    if (weight[p] > 0) sum[p] /= weight[p];
  return sum;
}

// Points on an edge are drawn a little into their face: at the edge itself, a wall that stands on a floor is
// neither before nor behind it.
vec3 drawn_in(const LightPoint& point, const PartPoints& points, float epsilon) {
  const vec3 way = points.face_centres[point.face] - point.position;
  const float distance = length(way);
  const float step = std::min(0.5f * distance, std::max(0.03f * distance, 16 * epsilon));
  return point.position + way * (distance > 0 ? step / distance : 0.0f);
}

// A vertex normal that leans from its face looks partly below it, where nothing comes from: (1 - cos) / 2 of
// its hemisphere. What it would get of an even surrounding is restored, as far as it does see less than all
// there is. And no point sees more than all there is, whatever the rounding of its form factors.
float horizon_gain(float cosine, float seen) {
  const float all = 1 / std::max(seen, 1e-3f);
  return all < 1 ? all : std::min(all, 2 / (1 + std::clamp(cosine, 0.0f, 1.0f)));
}

// A point that sees less than this share of what lies before it is inside or behind something.
constexpr float kBuried = 0.08f;

// Gives points that lie buried (a ceiling's behind the lamp that hangs on it) the light of their open
// neighbours. Nobody sees the points themselves, but the faces that reach out from under cover would darken
// towards them.
void fill_buried(const PartPoints& points, std::vector<uint8_t> buried, std::vector<vec3>& light) {
  for (int ring = 0; ring < 2; ++ring) {
    std::vector<vec3> sum(light.size(), vec3(0));
    std::vector<float> weight(light.size(), 0);
    for (uint32_t f = 0; f + 1 < points.corner_first.size(); ++f) {
      for (uint32_t a = points.corner_first[f]; a < points.corner_first[f + 1]; ++a) {
        const uint32_t p = points.corners[a];
        if (buried[p] == 0) continue;
        for (uint32_t b = points.corner_first[f]; b < points.corner_first[f + 1]; ++b) {
          const uint32_t q = points.corners[b];
          if (buried[q] != 0) continue;
          const float w = 1 / (length(points.points[p].position - points.points[q].position) + 1e-20f);
          sum[p] += w * light[q];
          weight[p] += w;
        }
      }
    }
    for (size_t p = 0; p < light.size(); ++p) {
      if (weight[p] <= 0) continue;
      light[p] = sum[p] / weight[p];
      buried[p] = 0;
    }
  }
}

std::vector<vec3> gather_side(const HierarchicalSolver& solver, std::span<const vec3> shown,
                              const PartPoints& points, const std::vector<ElementId>& leaves, bool back,
                              const ReconstructOptions& options, const CancelToken& cancel,
                              ReconstructStats& stats) {
  std::vector<vec3> light = average_side(solver, points, leaves, back);
  const GatherOptions gather{options.light_rays, options.ray_share};
  std::atomic<uint64_t> rays{0}, nanoseconds{0};
  const KeyPoints keys(solver, points, leaves, back);
  std::vector<uint8_t> buried(points.points.size(), 0);
  parallel_for(
      keys.keys().size(),
      [&](size_t k) {
        const uint32_t i = keys.keys()[k];
        if (cancel.cancelled()) return;
        const LightPoint& point = points.points[i];
        const ElementId leaf = leaves[point.face];
        if (leaf == kNoElement) return;
        const vec3 n = back ? -point.normal : point.normal;
        RayCount count;
        const Gathered gathered =
            gather_at(solver, shown, leaf, drawn_in(point, points, solver.visibility().epsilon), n, gather,
                      hash(i, 77), count);
        light[i] = gathered.irradiance *
                   horizon_gain(dot(point.normal, points.face_normals[point.face]), gathered.seen);
        buried[i] = gathered.openness < kBuried ? 1 : 0;
        rays.fetch_add(count.rays, std::memory_order_relaxed);
        nanoseconds.fetch_add(count.nanoseconds, std::memory_order_relaxed);
      },
      32);
  stats.rays += {rays.load(), nanoseconds.load()};
  stats.points += keys.keys().size();
  if (!cancel.cancelled()) keys.interpolate(light);
  fill_buried(points, std::move(buried), light);
  return light;
}

std::vector<vec3> to_vertices(const std::vector<vec3>& light, const std::vector<uint32_t>& point_of_vertex) {
  std::vector<vec3> out(point_of_vertex.size(), vec3(0));
  for (size_t v = 0; v < out.size(); ++v)
    if (point_of_vertex[v] != kNoPoint) out[v] = light[point_of_vertex[v]];
  return out;
}

}  // namespace

Lighting reconstruct(const HierarchicalSolver& solver, const ReconstructOptions& options,
                     const CancelToken& cancel, ReconstructStats& stats) {
  const ElementPool& pool = solver.pool();
  const SurfaceSet& set = pool.surfaces();
  Lighting lighting;
  const std::vector<vec3> shown = options.method == Reconstruction::kGather
                                      ? settle_outliers(solver, options, cancel, stats)
                                      : std::vector<vec3>();
  for (uint32_t part = 0; part < set.parts.size(); ++part) {
    const Material& material = set.scene->materials[set.parts[part].material];
    if (material.unlit || set.tree(set.parts[part]).mesh.triangles.empty()) continue;
    const PartPoints points = collect_light_points(pool, part);
    std::vector<uint32_t> point_of_vertex;
    LitPrimitive lit = build_output_mesh(pool, part, points, point_of_vertex);
    for (int side = 0; side < (material.double_sided ? 2 : 1); ++side) {
      const std::vector<ElementId> leaves = pool.leaf_elements(part, side == 1);
      const std::vector<vec3> light =
          options.method == Reconstruction::kAverage
              ? average_side(solver, points, leaves, side == 1)
              : gather_side(solver, shown, points, leaves, side == 1, options, cancel, stats);
      (side == 0 ? lit.irradiance : lit.irradiance_back) = to_vertices(light, point_of_vertex);
    }
    lighting.primitives.push_back(std::move(lit));
  }
  return lighting;
}

}  // namespace goldthread
