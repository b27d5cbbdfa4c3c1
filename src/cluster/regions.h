// Which triangles are clustered together.
#pragma once
#include "cluster/merge_forest.h"
#include "mesh/components.h"

namespace goldthread {

/// Fills slots, regions and components of an otherwise empty forest.
void make_regions(const TriangleMesh& mesh, const Components& components, uint32_t region_triangles,
                  MergeForest& forest);

}  // namespace goldthread
