#include "reconstruct/average.h"

namespace goldthread {

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

}  // namespace goldthread
