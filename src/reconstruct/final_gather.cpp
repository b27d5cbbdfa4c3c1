#include "reconstruct/final_gather.h"

#include <algorithm>

#include "solve/hierarchical/point_transfer.h"

namespace goldthread {
namespace {

// Rays worth casting for a link that would bring `share` of a point's light if it were all visible.
uint32_t rays_for(float share, const Link& link, ElementKind source, const GatherOptions& options) {
  if (share < options.ray_share) return 0;
  if (source == ElementKind::kPoint || source == ElementKind::kSun) return 1;
  const bool mixed = link.visibility > 0 && link.visibility < 255;
  const float wanted = share * static_cast<float>(options.light_rays) * (mixed ? 2.0f : 0.5f);
  return static_cast<uint32_t>(std::clamp(std::ceil(wanted), mixed ? 2.0f : 1.0f, 64.0f));
}

// What a source could bring at most to a point, by its size and distance alone: a link may be weak on the
// whole and yet all that a point next to the source gets.
float most_at(const Element& source, const vec3& x) {
  if (!is_surface(source.kind)) return 0;
  const float apart = length(source.centre - x) - source.radius;
  return apart > 0 ? std::min(1.0f, source.area / (kPi * apart * apart)) : 1.0f;
}

}  // namespace

Gathered gather_at(const HierarchicalSolver& solver, std::span<const vec3> shown, ElementId leaf,
                   const vec3& x, const vec3& n, const GatherOptions& options, uint32_t seed,
                   RayCount& rays) {
  const ElementPool& pool = solver.pool();
  const RadiosityState& state = solver.state();
  // What the leaf has in all, against which single links are weighed; its own value may be nought in a
  // shadow.
  const float whole = largest(state.irradiance[leaf]) + 1e-20f;
  vec3 sum(0);
  float faced = 0, seen = 0;
  for (ElementId id = leaf; id != kNoElement; id = pool[id].parent) {
    for (const Link& link : solver.links().into(id)) {
      const vec3 b = seen_radiosity(link, solver.links().views(), shown);
      const float most = largest(b);
      if (most <= 0) continue;
      const ElementKind kind = pool[link.source].kind;
      const bool fills_sky = kind != ElementKind::kPoint && kind != ElementKind::kSun;  // has a solid angle
      const float little = 0.1f * options.ray_share * whole, weak = (link.mean + link.spread) * most;
      // What is weak because it is hidden stays so; what is weak on the whole may be strong at one spot.
      if (weak < little && (link.visibility == 0 || most_at(pool[link.source], x) * most < 10 * little)) {
        const Element& r = pool[id];
        const float modelled = r.flat ? link.ambient + dot(x - r.centre, link.transfer)
                                      : std::max(0.0f, dot(n, link.transfer)) + link.ambient;
        sum += std::max(0.0f, modelled) * b;
        faced += fills_sky ? link.unoccluded : 0;
        seen += fills_sky ? link.mean : 0;
        continue;
      }
      const vec3 m = point_transfer(pool, link.source, x, n);
      const float factor = dot(m, n);
      if (factor <= 0) continue;
      const uint32_t count = rays_for(factor * most / (whole + factor * most), link, kind, options);
      float visible = static_cast<float>(link.visibility) / 255.0f;
      if (count > 0)
        visible = solver.visibility().fraction(pool, link.source, x, n, count, seed, rays, visible);
      if (is_surface(kind)) visible = std::min(visible, 1 / factor);
      sum += visible * factor * b;
      if (!fills_sky) continue;
      faced += factor;
      seen += visible * factor;
    }
  }
  return {sum, faced > 0 ? seen / faced : 1.0f, seen};
}

}  // namespace goldthread
