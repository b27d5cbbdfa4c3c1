#include "cluster/face_cluster_tree.h"

#include "cluster/cluster_bounds.h"
#include "cluster/merge_forest.h"
#include "cluster/tree_layout.h"

namespace goldthread {

FaceClusterTree build_face_clusters(TriangleMesh mesh, const FaceClusterOptions& options) {
  MergeForest forest = merge_triangles(mesh, options);
  FaceClusterTree tree = lay_out(std::move(mesh), std::move(forest));
  fill_bounds(tree);
  tree.outlines = FlatOutlines(tree);
  return tree;
}

}  // namespace goldthread
