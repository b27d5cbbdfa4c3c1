#include <cmath>

#include "base/check.h"
#include "cluster/face_cluster_tree.h"
#include "cluster/volume_cluster_tree.h"
#include "mesh/validate.h"

namespace goldthread {
namespace {

constexpr uint32_t kCheckedOneByOne =
    512;  ///< bounds of larger nodes are checked on some of their triangles only

struct Measured {
  dvec3 summed_normal{0}, moment{0};
  double area = 0;
};

dvec3 double_area(const TriangleMesh& mesh, uint32_t t) {
  const UVec3& v = mesh.triangles[t];
  const dvec3 a(mesh.positions[v.x]), b(mesh.positions[v.y]), c(mesh.positions[v.z]);
  return 0.5 * cross(b - a, c - a);
}

/// The range [first, first + count) and, for a node, that it is where depth-first order puts it.
uint32_t child_count(const FaceClusterTree& tree, ClusterRef child, uint32_t node, uint32_t first) {
  if (is_triangle(child)) {
    GOLDTHREAD_CHECK_EQ(triangle_of(child), first);
    return 1;
  }
  GOLDTHREAD_CHECK_EQ(child, node);
  GOLDTHREAD_CHECK_LT(size_t(child), tree.nodes.size());
  GOLDTHREAD_CHECK_EQ(tree.nodes[child].first, first);
  GOLDTHREAD_CHECK_LE(2u, tree.nodes[child].count);
  return tree.nodes[child].count;
}

void check_order(const FaceClusterTree& tree) {
  uint32_t first = 0, node = 0;
  for (const ClusterRef root : tree.roots) {
    const uint32_t count = child_count(tree, root, node, first);
    first += count;
    node += count - 1;
  }
  GOLDTHREAD_CHECK_EQ(size_t(first), tree.mesh.triangles.size());
  GOLDTHREAD_CHECK_EQ(size_t(node), tree.nodes.size());
  for (uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const FaceCluster& c = tree.nodes[i];
    const uint32_t front = child_count(tree, c.child[0], i + 1, c.first);
    const uint32_t back = child_count(tree, c.child[1], i + front, c.first + front);
    GOLDTHREAD_CHECK_EQ(front + back, c.count);
  }
}

void check_sums(const FaceClusterTree& tree) {
  const size_t triangles = tree.mesh.triangles.size();
  std::vector<Measured> upto(triangles + 1);  // prefix sums: a node's sum is a difference
  for (uint32_t t = 0; t < triangles; ++t) {
    const UVec3& v = tree.mesh.triangles[t];
    const dvec3 s = double_area(tree.mesh, t);
    const dvec3 middle = (dvec3(tree.mesh.positions[v.x]) + dvec3(tree.mesh.positions[v.y]) +
                          dvec3(tree.mesh.positions[v.z])) /
                         3.0;
    upto[t + 1] = {upto[t].summed_normal + s, upto[t].moment + glm::length(s) * middle,
                   upto[t].area + glm::length(s)};
  }
  for (const FaceCluster& c : tree.nodes) {
    const Measured &from = upto[c.first], &to = upto[c.first + c.count];
    // Single precision adds up over chains of nodes; the first term is that of the difference of sums here.
    const double slack = to.area * 1e-11 + (c.count <= 4096 ? 1e-4 : 1e-2) * double(c.area);
    GOLDTHREAD_CHECK_LE(std::abs(double(c.area) - (to.area - from.area)), slack);
    GOLDTHREAD_CHECK_LE(glm::length(dvec3(c.summed_normal) - (to.summed_normal - from.summed_normal)), slack);
    GOLDTHREAD_CHECK_LE(double(length(c.centre)) * 0, 0.0);  // finite
    GOLDTHREAD_CHECK_LE(0.0f, c.radius);
  }
}

void check_bounds_of(const FaceClusterTree& tree, const FaceCluster& c, uint32_t t) {
  const dvec3 centre(c.centre), s(c.summed_normal), normal = double_area(tree.mesh, t);
  for (int k = 0; k < 3; ++k)
    GOLDTHREAD_CHECK_LE(glm::length(dvec3(tree.mesh.positions[tree.mesh.triangles[t][k]]) - centre),
                        double(c.radius));
  if (c.cone_cosine > -1) {
    const double cosine = dot(s, normal) / (glm::length(s) * glm::length(normal));
    GOLDTHREAD_CHECK_LE(double(c.cone_cosine), cosine + 2e-6);
  }
}

}  // namespace

void validate(const FaceClusterTree& tree) {
  validate(tree.mesh);
  check_order(tree);
  check_sums(tree);
  for (const FaceCluster& c : tree.nodes) {
    const uint32_t step = c.count / kCheckedOneByOne + 1;
    for (uint32_t t = c.first; t < c.first + c.count; t += step) check_bounds_of(tree, c, t);
  }
}

void validate(const VolumeClusterTree& tree, std::span<const Box> items) {
  GOLDTHREAD_CHECK_EQ(tree.nodes.size(), items.size() < 2 ? 0 : items.size() - 1);
  std::vector<bool> seen(items.size(), false);
  for (uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const VolumeCluster& node = tree.nodes[i];
    Box box;
    bool node_before = false;
    for (const VolumeRef child : node.child) {
      if (child & kItemBit) {
        const uint32_t item = child & ~kItemBit;
        GOLDTHREAD_CHECK_LT(size_t(item), items.size());
        GOLDTHREAD_CHECK_EQ(bool(seen[item]), false);
        seen[item] = true;
        box.add(items[item]);
        continue;
      }
      GOLDTHREAD_CHECK_LT(i, child);
      GOLDTHREAD_CHECK_LT(size_t(child), tree.nodes.size());
      if (!node_before && child == node.child[0]) GOLDTHREAD_CHECK_EQ(child, i + 1);
      node_before = true;
      box.add(tree.nodes[child].box);
    }
    for (int axis = 0; axis < 3; ++axis) {
      GOLDTHREAD_CHECK_EQ(box.low[axis], node.box.low[axis]);
      GOLDTHREAD_CHECK_EQ(box.high[axis], node.box.high[axis]);
    }
  }
  for (const bool s : seen) GOLDTHREAD_CHECK_EQ(s || items.size() < 2, true);
}

}  // namespace goldthread
