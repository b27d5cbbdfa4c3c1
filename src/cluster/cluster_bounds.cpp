#include "cluster/cluster_bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/parallel.h"

namespace goldthread {
namespace {

constexpr uint32_t kMeasured = 32;   ///< clusters up to this many triangles are measured exactly
constexpr uint32_t kSubtree = 4096;  ///< triangles of a subtree that is done as one task
constexpr uint32_t kOpenings = 64;   ///< least number of descendants that may be opened for a bound
constexpr float kRadiusTolerance = 1.01f, kAngleTolerance = 0.01f;
constexpr float kRounding = 1e-6f;  ///< added to bounds for the rounding of single precision
constexpr float kNoFacing = 1e-5f;  ///< |S| / A below which S has no direction

struct Bound {
  float value;
  ClusterRef cluster;
  bool operator<(const Bound& o) const { return value < o.value; }
};

using BoundHeap = std::vector<Bound>;

/// How many descendants may be opened for a node's bound. The smaller child's share adds up to n log n over
/// any tree, chains included, as it does when merging small sets into large ones.
uint32_t openings_for(const FaceClusterTree& tree, const FaceCluster& cluster) {
  uint32_t smaller = cluster.count;
  for (const ClusterRef child : cluster.child)
    smaller = std::min(smaller, is_triangle(child) ? 1 : tree.nodes[child].count);
  return kOpenings + smaller / 8;
}

/// The greatest over a cluster's triangles of something bounded for clusters: best first through the tree.
/// `bound_of` may overestimate for a node and must be exact for a triangle. Returns a value that is not below
/// the truth; it is above by no more than `close(found, open)` accepts, unless the openings run out.
template <typename BoundOf, typename Close>
float greatest(const FaceClusterTree& tree, const FaceCluster& cluster, BoundHeap& heap,
               const BoundOf& bound_of, const Close& close) {
  heap.clear();
  float found = 0;
  const auto add = [&](ClusterRef ref) {
    const float value = bound_of(ref);
    if (is_triangle(ref)) {
      found = std::max(found, value);
    } else {
      heap.push_back({value, ref});
      std::push_heap(heap.begin(), heap.end());
    }
  };
  add(cluster.child[0]);
  add(cluster.child[1]);
  for (uint32_t left = openings_for(tree, cluster); left > 0 && !heap.empty(); --left) {
    if (close(found, heap[0].value)) break;
    const FaceCluster& worst = tree.nodes[heap[0].cluster];
    std::pop_heap(heap.begin(), heap.end());
    heap.pop_back();
    add(worst.child[0]);
    add(worst.child[1]);
  }
  return heap.empty() ? found : std::max(found, heap[0].value);
}

class Bounds {
 public:
  explicit Bounds(FaceClusterTree& tree) : tree_(tree), normals_(tree.mesh.triangles.size()) {
    parallel_for(
        normals_.size(), [&](size_t t) { normals_[t] = normalized(area_of(uint32_t(t))); }, 8192);
  }

  void fill() {
    std::vector<uint32_t> subtrees, above;  // depth first: a subtree is a range of nodes
    for (uint32_t i = 0; i < tree_.nodes.size();) {
      const bool small = tree_.nodes[i].count <= kSubtree;
      (small ? subtrees : above).push_back(i);
      i += small ? tree_.nodes[i].count - 1 : 1;
    }
    parallel_for(subtrees.size(), [&](size_t s) {
      const uint32_t root = subtrees[s];
      BoundHeap heap;
      for (uint32_t i = root + tree_.nodes[root].count - 1; i-- > root;) {
        fill_sums(tree_.nodes[i]);
        fill_extents(tree_.nodes[i], heap);
      }
    });
    BoundHeap heap;
    for (size_t i = above.size(); i-- > 0;) {
      fill_sums(tree_.nodes[above[i]]);
      fill_extents(tree_.nodes[above[i]], heap);
    }
  }

 private:
  vec3 position(uint32_t triangle, int k) const {
    return tree_.mesh.positions[tree_.mesh.triangles[triangle][k]];
  }
  vec3 area_of(uint32_t t) const { return area_vector(position(t, 0), position(t, 1), position(t, 2)); }

  /// Scaled first: areas of tiny triangles are too small to be squared.
  static vec3 normalized(const vec3& area) {
    const vec3 magnitude = glm::abs(area);
    const vec3 scaled = area / std::max({magnitude.x, magnitude.y, magnitude.z});
    return scaled / length(scaled);
  }

  struct Sums {
    vec3 summed_normal;
    float area;
    vec3 centre;
  };
  Sums sums_of(ClusterRef ref) const {
    if (!is_triangle(ref)) {
      const FaceCluster& c = tree_.nodes[ref];
      return {c.summed_normal, c.area, c.centre};
    }
    const uint32_t t = triangle_of(ref);
    const vec3 area = area_of(t);
    return {area, dot(area, normals_[t]), (position(t, 0) + position(t, 1) + position(t, 2)) / 3.0f};
  }

  void fill_sums(FaceCluster& cluster) const {
    const Sums a = sums_of(cluster.child[0]), b = sums_of(cluster.child[1]);
    cluster.summed_normal = a.summed_normal + b.summed_normal;
    cluster.area = a.area + b.area;
    cluster.centre = a.centre + b.area / cluster.area * (b.centre - a.centre);
  }

  void fill_extents(FaceCluster& cluster, BoundHeap& heap) const {
    const bool measure = cluster.count <= kMeasured;
    cluster.radius = (measure ? measured_radius(cluster) : bounded_radius(cluster, heap)) * (1 + kRounding);
    const float facing = length(cluster.summed_normal);
    cluster.cone_cosine = -1;
    if (!(facing > kNoFacing * cluster.area)) return;
    const vec3 axis = cluster.summed_normal / facing;
    const float cosine = measure ? measured_cosine(cluster, axis) : bounded_cosine(cluster, axis, heap);
    cluster.cone_cosine = std::max(-1.0f, cosine - kRounding);
  }

  float farthest_corner(uint32_t t, const vec3& centre) const {
    float squared = 0;
    for (int k = 0; k < 3; ++k) {
      const vec3 d = position(t, k) - centre;
      squared = std::max(squared, dot(d, d));
    }
    return squared;
  }

  float measured_radius(const FaceCluster& cluster) const {
    float squared = 0;
    for (uint32_t t = cluster.first; t < cluster.first + cluster.count; ++t)
      squared = std::max(squared, farthest_corner(t, cluster.centre));
    return std::sqrt(squared);
  }

  float bounded_radius(const FaceCluster& cluster, BoundHeap& heap) const {
    const auto bound_of = [&](ClusterRef ref) {
      if (is_triangle(ref)) return std::sqrt(farthest_corner(triangle_of(ref), cluster.centre));
      const FaceCluster& c = tree_.nodes[ref];
      return length(c.centre - cluster.centre) + c.radius;
    };
    return greatest(tree_, cluster, heap, bound_of,
                    [](float found, float open) { return open <= kRadiusTolerance * found; });
  }

  float measured_cosine(const FaceCluster& cluster, const vec3& axis) const {
    float cosine = 1;
    for (uint32_t t = cluster.first; t < cluster.first + cluster.count; ++t)
      cosine = std::min(cosine, dot(normals_[t], axis));
    return cosine;
  }

  float bounded_cosine(const FaceCluster& cluster, const vec3& axis, BoundHeap& heap) const {
    // Not the arc cosine, which cannot tell small angles.
    const auto angle_to = [&](const vec3& v) { return std::atan2(length(cross(axis, v)), dot(axis, v)); };
    const auto bound_of = [&](ClusterRef ref) {
      if (is_triangle(ref)) return angle_to(normals_[triangle_of(ref)]);
      const FaceCluster& c = tree_.nodes[ref];
      return c.cone_cosine <= -1 ? kPi : std::min(kPi, angle_to(c.summed_normal) + std::acos(c.cone_cosine));
    };
    const float angle = greatest(tree_, cluster, heap, bound_of,
                                 [](float found, float open) { return open <= found + kAngleTolerance; });
    return std::cos(angle);
  }

  FaceClusterTree& tree_;
  std::vector<vec3> normals_;
};

}  // namespace

void fill_bounds(FaceClusterTree& tree) {
  Bounds(tree).fill();
}

}  // namespace goldthread
