// The order in which a mesh's triangles are merged: regions first, in parallel, then what they leave of each
// component.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "cluster/dual_merger.h"
#include "cluster/face_cluster_tree.h"

namespace goldthread {

/// Triangles have slots: all of a component together, and within it all of a region. Merges are named
///   slot | kTriangleBit       a triangle,
///   region.begin + i          merge i of a region (it has fewer merges than triangles),
///   slots + i                 merge i of a component's final pass.
struct MergeForest {
  struct Region {
    uint32_t begin, end;  ///< slots
    uint32_t merges = 0;
  };
  struct Component {
    uint32_t begin, end;                ///< slots
    uint32_t first_region, region_end;  ///< numbers of regions
    std::vector<Merge> final_merges;    ///< children before parents; empty when one region is all there is
  };

  std::vector<uint32_t> triangle_at;  ///< slot to triangle
  std::vector<Region> regions;
  std::vector<Component> components;
  std::vector<Merge> merges;    ///< by slot; children before parents
  uint64_t costs_computed = 0;  ///< for tests: the work that was done

  uint32_t slots() const { return uint32_t(triangle_at.size()); }
};

/// Cuts components of more than options.region_triangles into boxes by the median of their triangles'
/// centres, so that regions are compact and depend on nothing but the mesh, and collapses all.
MergeForest merge_triangles(const TriangleMesh& mesh, const FaceClusterOptions& options);

}  // namespace goldthread
