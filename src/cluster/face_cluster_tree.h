// Face cluster hierarchies (thesis 4.2): a multiresolution view of a mesh for light, built without touching
// it.
#pragma once
#include <cstdint>
#include <vector>

#include "cluster/flat_outlines.h"
#include "mesh/triangle_mesh.h"

namespace goldthread {

/// A reference to a cluster: an inner node of the tree, or a single triangle when the high bit is set.
using ClusterRef = uint32_t;
constexpr ClusterRef kTriangleBit = 0x80000000u;
constexpr bool is_triangle(ClusterRef ref) {
  return (ref & kTriangleBit) != 0;
}
constexpr uint32_t triangle_of(ClusterRef ref) {
  return ref & ~kTriangleBit;
}

/// An inner node: a connected set of at least two triangles, which is a contiguous range of the mesh's
/// triangles. 56 bytes; there is one less than there are triangles in a component.
struct FaceCluster {
  uint32_t first = 0, count = 0;  ///< triangle range in FaceClusterTree::mesh
  ClusterRef child[2] = {0, 0};   ///< child 0 covers the front of the range
  vec3 summed_normal{0};          ///< S, the sum of area vectors (equation 4.9)
  float area = 0;                 ///< sum of triangle areas
  vec3 centre{0};                 ///< area-weighted centroid
  float radius = 0;               ///< all vertices lie within this distance of the centre
  float cone_cosine = -1;  ///< every triangle normal is within acos(this) of S's direction; -1 when S is ~0
};

/// The hierarchies of all connected components of one mesh. Shape only: shared by all instances, untouched by
/// paint.
struct FaceClusterTree {
  TriangleMesh mesh;               ///< triangles reordered so that each cluster is a range
  std::vector<FaceCluster> nodes;  ///< depth first: child 0 of node i, when a node, is i + 1
  std::vector<ClusterRef> roots;   ///< one a connected component, in order of their triangle ranges
  FlatOutlines outlines;           ///< of those nodes that are convex polygons
};

struct FaceClusterOptions {
  /// k of equation 4.8: larger trades planarity for balance. Has no unit: see merge_cost(). Taken as 1e-6 at
  /// least.
  float balance = 0.001f;
  /// Components above this are first clustered in regions of at most this size, in parallel.
  uint32_t region_triangles = 4096;
  /// A region is clustered down to 1/this of its triangles before the final pass over its component.
  uint32_t region_reduction = 32;
};

/// Clusters each connected component of `mesh` (adjacency by welded position) bottom up by the quadric cost
/// (equations 4.1-4.9) with a heap. Consumes the mesh. The result is the same for any number of threads.
FaceClusterTree build_face_clusters(TriangleMesh mesh, const FaceClusterOptions& options = {});

/// Aborts if ranges, sums, cones, radii or depth-first order are broken. For tests.
void validate(const FaceClusterTree& tree);

}  // namespace goldthread
