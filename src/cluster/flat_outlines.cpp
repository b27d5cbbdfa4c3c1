#include "cluster/flat_outlines.h"

#include <algorithm>
#include <array>

#include "cluster/face_cluster_tree.h"
#include "mesh/convex_hull.h"

namespace goldthread {
namespace {

// How much of its area a plane may lose in its summed normal, by rounding.
constexpr float kTurned = 1e-6f;
// How far corners may lie from the plane: as a share of the radius, and of the largest coordinate, whose
// rounding it is. Well within what rays leave surfaces by (RayCaster::epsilon), or places on the polygon
// would lie behind the triangles.
constexpr float kThick = 2e-6f, kRounding = 2.5e-7f;
// A corner is none if the outline loses no more than this share of its area without it.
constexpr float kStraight = 1e-6f;
// By how much of its area the polygon may differ from the triangles.
constexpr float kFilled = 1e-5f;
// Hulls of more corners are not carried on to the clusters above: what is so ragged rarely becomes convex.
constexpr size_t kMostCarried = 48;

struct Frame {
  vec3 origin, u, v, n;

  Frame(const vec3& at, const vec3& normal) : origin(at), n(normal) {
    u = normalize(std::abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0) : vec3(0, n.z, -n.y));
    v = cross(n, u);
  }
  vec2 flat(const vec3& p) const { return {dot(p - origin, u), dot(p - origin, v)}; }
};

// Drops corners without which the outline loses no more than `tolerance` of its area.
std::vector<vec2> without_straight(const std::vector<vec2>& hull, float tolerance) {
  std::vector<vec2> kept;
  for (size_t i = 0; i < hull.size(); ++i) {
    const vec2 before = kept.empty() ? hull.back() : kept.back();
    const vec2 a = hull[i] - before, b = hull[(i + 1) % hull.size()] - before;
    if (std::abs(a.x * b.y - a.y * b.x) > 2 * tolerance) kept.push_back(hull[i]);
  }
  return kept;
}

float area_of(std::span<const vec2> polygon) {
  float twice = 0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    const vec2 a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5f * twice;
}

}  // namespace

FlatOutlines::FlatOutlines(const FaceClusterTree& tree) : outline_(tree.nodes.size(), kNone), first_{0} {
  // Hulls of flat clusters, which wait for the cluster above; children come after their parents.
  std::vector<std::vector<vec3>> hulls(tree.nodes.size());
  std::vector<vec3> points;
  std::vector<vec2> flat;
  for (size_t i = tree.nodes.size(); i-- > 0;) {
    const FaceCluster& node = tree.nodes[i];
    points.clear();
    bool is_flat = length(node.summed_normal) >= (1 - kTurned) * node.area && node.area > 0;
    for (const ClusterRef child : node.child) {
      if (is_triangle(child)) {
        const UVec3& c = tree.mesh.triangles[triangle_of(child)];
        for (const uint32_t corner : {c.x, c.y, c.z}) points.push_back(tree.mesh.positions[corner]);
      } else {
        is_flat &= !hulls[child].empty();
        points.insert(points.end(), hulls[child].begin(), hulls[child].end());
        hulls[child] = {};
      }
    }
    if (!is_flat) continue;
    const Frame frame(node.centre, normalize(node.summed_normal));
    flat.clear();
    float thickness = 0, magnitude = 0;
    for (const vec3& p : points) {
      flat.push_back(frame.flat(p));
      thickness = std::max(thickness, std::abs(dot(p - frame.origin, frame.n)));
      magnitude = std::max({magnitude, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    if (thickness > std::max(kThick * node.radius, kRounding * magnitude)) continue;
    const std::vector<vec2> hull = without_straight(convex_hull(flat), kStraight * node.area);
    if (hull.size() < 3 || hull.size() > kMostCarried) continue;
    // The vertices themselves: to place them anew at every level would add up roundings.
    for (const vec2& p : hull)
      hulls[i].push_back(points[static_cast<size_t>(std::find(flat.begin(), flat.end(), p) - flat.begin())]);
    if (hull.size() > kMostCorners || std::abs(area_of(hull) - node.area) > kFilled * node.area) continue;
    outline_[i] = static_cast<uint32_t>(first_.size() - 1);
    corners_.insert(corners_.end(), hulls[i].begin(), hulls[i].end());
    first_.push_back(static_cast<uint32_t>(corners_.size()));
  }
  corners_.shrink_to_fit();
}

}  // namespace goldthread
