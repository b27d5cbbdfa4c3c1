#include "element/overlap.h"

#include <algorithm>

#include "base/parallel.h"
#include "element/paint.h"
#include "math/colour.h"
#include "scene/place_claim.h"

namespace goldthread {
namespace {

struct PlacedTriangle {
  const Part& part;
  uint32_t triangle;  // of the part's tree

  const vec3& corner(const SurfaceSet& set, int k) const {
    return part.positions[set.tree(part).mesh.triangles[triangle][k]];
  }
  float exitance() const {
    return luminance(part.triangle_exitance.empty() ? part.exitance : part.triangle_exitance[triangle]);
  }
  vec3 area(const SurfaceSet& set) const {
    return part.winding * area_vector(corner(set, 0), corner(set, 1), corner(set, 2));
  }
};

PlacedTriangle placed(const SurfaceSet& set, uint32_t world_triangle) {
  const Part& part = part_of_triangle(set, world_triangle);
  return {part, world_triangle - part.first_triangle};
}

const Material& material_of(const SurfaceSet& set, const Part& part) {
  return set.scene->materials[part.material];
}

PlaceClaim claim_of(const SurfaceSet& set, uint32_t triangle) {
  const PlacedTriangle t = placed(set, triangle);
  const auto part = static_cast<uint32_t>(&t.part - set.parts.data());
  return {place_order(part, set.tree(t.part).mesh.source_triangles[t.triangle]), t.exitance(),
          material_of(set, t.part).lit_behind(), t.area(set)};
}

}  // namespace

bool contends_for_place(const SurfaceSet& set, uint32_t triangle) {
  const Material& material = material_of(set, part_of_triangle(set, triangle));
  return !material.unlit && !material.is_see_through();
}

bool owns_place(const SurfaceSet& set, uint32_t owner, uint32_t other) {
  return owns_place(claim_of(set, owner), claim_of(set, other));
}

void settle_overlaps(SurfaceSet& set, std::span<const std::pair<uint32_t, uint32_t>> covered,
                     float tolerance) {
  set.same_place = tolerance;
  std::vector<uint32_t> parts;
  for (size_t i = 0; i < covered.size();) {
    const auto number = static_cast<uint32_t>(&part_of_triangle(set, covered[i].first) - set.parts.data());
    Part& part = set.parts[number];
    const auto count = static_cast<uint32_t>(set.tree(part).mesh.triangles.size());
    part.covering_first.assign(count + 1, 0);
    part.covering.clear();
    for (uint32_t t = 0; t < count; ++t) {
      for (; i < covered.size() && covered[i].first == part.first_triangle + t; ++i)
        part.covering.push_back(covered[i].second);
      part.covering_first[t + 1] = static_cast<uint32_t>(part.covering.size());
    }
    parts.push_back(number);
  }
  parallel_for(parts.size(), [&](size_t i) { paint_part(set, set.parts[parts[i]]); });
  set.overlapping = covered.size();
}

bool is_covered(const SurfaceSet& set, const Part& part, uint32_t triangle, const vec3& p) {
  if (part.covering.empty()) return false;
  for (uint32_t i = part.covering_first[triangle]; i < part.covering_first[triangle + 1]; ++i) {
    const PlacedTriangle owner = placed(set, part.covering[i]);
    if (lies_on_triangle(p, owner.corner(set, 0), owner.corner(set, 1), owner.corner(set, 2), set.same_place))
      return true;
  }
  return false;
}

}  // namespace goldthread
