#include "cluster/tree_layout.h"

#include "base/parallel.h"

namespace goldthread {
namespace {

class Layout {
 public:
  Layout(MergeForest& forest, FaceClusterTree& tree) : forest_(forest), tree_(tree) {
    const size_t slots = forest.slots();
    tree.nodes.resize(slots - forest.components.size());
    tree.roots.resize(forest.components.size());
    slot_order_.resize(slots);
    node_of_merge_.resize(slots);
    parallel_for(forest.components.size(), [&](size_t c) { place_component(c); });
  }

  /// Which slot comes where in the final order.
  std::vector<uint32_t> take_slot_order() { return std::move(slot_order_); }

 private:
  const Merge& merge_named(const MergeForest::Component& component, ClusterRef name) const {
    return name < forest_.slots() ? forest_.merges[name] : component.final_merges[name - forest_.slots()];
  }

  uint32_t count_of(const MergeForest::Component& component, ClusterRef name) const {
    return is_triangle(name) ? 1 : merge_named(component, name).count;
  }

  /// Puts a cluster at `first` in the order of triangles and, when it is a merge, at node `node`.
  ClusterRef place(ClusterRef name, uint32_t node, uint32_t first, std::vector<uint32_t>& node_of_final) {
    if (is_triangle(name)) {
      slot_order_[first] = triangle_of(name);
      return first | kTriangleBit;
    }
    (name < forest_.slots() ? node_of_merge_[name] : node_of_final[name - forest_.slots()]) = node;
    tree_.nodes[node].first = first;
    return node;
  }

  void place_children(const MergeForest::Component& component, const Merge& merge, uint32_t node,
                      std::vector<uint32_t>& node_of_final) {
    FaceCluster& cluster = tree_.nodes[node];
    const uint32_t front = count_of(component, merge.child[0]);
    cluster.count = merge.count;
    cluster.child[0] = place(merge.child[0], node + 1, cluster.first, node_of_final);
    cluster.child[1] = place(merge.child[1], node + front, cluster.first + front, node_of_final);
  }

  void place_component(size_t c) {
    const MergeForest::Component& component = forest_.components[c];
    std::vector<uint32_t> node_of_final(component.final_merges.size());
    const MergeForest::Region& last = forest_.regions[component.region_end - 1];
    const ClusterRef root = component.end - component.begin == 1 ? component.begin | kTriangleBit
                            : component.final_merges.empty()
                                ? last.begin + last.merges - 1
                                : forest_.slots() + uint32_t(component.final_merges.size()) - 1;
    tree_.roots[c] = place(root, component.begin - uint32_t(c), component.begin, node_of_final);
    // Parents come after their children, so that going backwards every merge already has its place.
    for (size_t i = component.final_merges.size(); i-- > 0;)
      place_children(component, component.final_merges[i], node_of_final[i], node_of_final);
    parallel_for(component.region_end - component.first_region, [&](size_t r) {
      const MergeForest::Region& region = forest_.regions[component.first_region + r];
      for (uint32_t i = region.merges; i-- > 0;)
        place_children(component, forest_.merges[region.begin + i], node_of_merge_[region.begin + i],
                       node_of_final);
    });
  }

  const MergeForest& forest_;
  FaceClusterTree& tree_;
  std::vector<uint32_t> slot_order_;
  std::vector<uint32_t> node_of_merge_;
};

}  // namespace

FaceClusterTree lay_out(TriangleMesh mesh, MergeForest forest) {
  FaceClusterTree tree;
  std::vector<uint32_t> order = Layout(forest, tree).take_slot_order();
  parallel_for(
      order.size(), [&](size_t i) { order[i] = forest.triangle_at[order[i]]; }, 16384);
  forest = {};
  tree.mesh.positions = std::move(mesh.positions);
  tree.mesh.skipped = mesh.skipped;
  tree.mesh.triangles.resize(order.size());
  tree.mesh.source_triangles.resize(order.size());
  parallel_for(
      order.size(),
      [&](size_t i) {
        tree.mesh.triangles[i] = mesh.triangles[order[i]];
        tree.mesh.source_triangles[i] = mesh.source_triangles[order[i]];
      },
      16384);
  if (!mesh.duplicates.empty()) {
    std::vector<uint32_t> place(order.size());
    for (size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<uint32_t>(i);
    for (DuplicateTriangle& d : mesh.duplicates) d.twin = place[d.twin];
  }
  tree.mesh.duplicates = std::move(mesh.duplicates);
  return tree;
}

}  // namespace goldthread
