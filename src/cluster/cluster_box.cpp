#include "cluster/cluster_box.h"

#include <vector>

#include "mesh/min_rectangle.h"

namespace goldthread {
namespace {

/// Clusters thinner than this share of their length are flat: their principal axes are at the mercy of where
/// corners happen to lie.
constexpr float kFlat = 0.05f;
constexpr float kNoFacing =
    0.5f;  ///< |S| / A below which a flat cluster is a two-sided sheet, S no guide to its plane

struct Corners {
  std::vector<vec3> points;
  vec3 summed_normal{0};
  float area = 0;
};

Corners corners_of(const FaceClusterTree& tree, ClusterRef ref) {
  const bool single = is_triangle(ref);
  const uint32_t first = single ? triangle_of(ref) : tree.nodes[ref].first;
  const uint32_t count = single ? 1 : tree.nodes[ref].count;
  Corners corners;
  corners.points.reserve(3 * size_t(count));
  for (uint32_t t = first; t < first + count; ++t)
    for (int k = 0; k < 3; ++k) corners.points.push_back(tree.mesh.positions[tree.mesh.triangles[t][k]]);
  if (single) {
    corners.summed_normal = area_vector(corners.points[0], corners.points[1], corners.points[2]);
    corners.area = length(corners.summed_normal);
  } else {
    corners.summed_normal = tree.nodes[ref].summed_normal;
    corners.area = tree.nodes[ref].area;
  }
  return corners;
}

/// Axes with `normal` third and the sides of the smallest rectangle in its plane.
mat3 flat_axes(const vec3& normal, const std::vector<vec3>& points) {
  const mat3 frame = frame_about(normal);
  std::vector<vec2> projected;
  projected.reserve(points.size());
  for (const vec3& p : points)
    projected.push_back({dot(p - points[0], frame[0]), dot(p - points[0], frame[1])});
  const vec2 u = min_rectangle(projected).u;
  const vec3 along = u.x * frame[0] + u.y * frame[1];
  return mat3(along, cross(normal, along), normal);
}

}  // namespace

OrientedBox fit_box(const FaceClusterTree& tree, ClusterRef cluster) {
  const Corners corners = corners_of(tree, cluster);
  const PrincipalAxes principal = principal_axes(corners.points);
  if (principal.deviation[2] < kFlat * principal.deviation[0]) {
    const float facing = length(corners.summed_normal);
    const vec3 normal =
        facing > kNoFacing * corners.area ? normalize(corners.summed_normal / facing) : principal.axes[2];
    return box_along(flat_axes(normal, corners.points), corners.points);
  }
  const OrientedBox box = box_along(principal.axes, corners.points);
  const OrientedBox upright = box_along(mat3(1), corners.points);
  return upright.surface_area() < box.surface_area() ? upright : box;
}

}  // namespace goldthread
