// Charts: pieces of a mesh that lie flat in a plane (thesis 5.2), along its face clusters.
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "base/progress.h"
#include "cluster/face_cluster_tree.h"
#include "math/vec.h"

namespace goldthread {

/// A connected piece of a mesh and its image in the plane, in which no two triangles overlap and each is
/// wound as in the mesh: its area there is positive.
struct Chart {
  std::vector<uint32_t> triangles;  ///< of the tree's mesh, ascending
  std::vector<UVec3> faces;         ///< corners of triangles[i] as indices into `coordinates`
  std::vector<vec2> coordinates;    ///< the mesh's units; the chart's area is that of its triangles
  /// By area of triangles: root mean square of the singular values of the map from the surface to the plane
  /// where it stretches most, and of its inverse (Sander 2001, L2 stretch of both). 1 is an isometry.
  float stretch = 1;
};

struct ChartOptions {
  /// A chart that is stretched more, or pressed more, is divided into its clusters' children.
  float most_stretch = 2;
  /// So is one that leaves more of its box free, in the mesh's units of area: large frames and stars keep
  /// others from their places, and pages are filled better with their parts.
  float most_waste = std::numeric_limits<float>::infinity();
};

/// What making charts came to, over all charts of all calls that it was passed to.
struct ChartStats {
  uint64_t charts = 0, tried = 0;
  uint64_t flipped = 0, overlapping = 0, stretched = 0, not_discs = 0,
           sprawling = 0;               ///< why those tried were divided
  double area = 0, sum_of_stretch = 0;  ///< of charts, the latter weighed by area
  float most_stretch = 0;
};

/// Charts that together hold each triangle of the tree's mesh once, by their first triangle. A cluster
/// becomes a chart if it is a disc, perhaps with holes, its image turns no triangle over, its boundary
/// neither crosses nor touches itself, and its stretch is within the limit; else its children are tried.
/// Single triangles are always charts. The image is its projection where that is nearly as good as any, else
/// its least squares conformal map (Levy et al. 2002). Coordinates are whole multiples, below 2^24, of a
/// power of two of each chart's own, and flips and crossings are decided on them without rounding. The same
/// for any number of threads.
std::vector<Chart> make_charts(const FaceClusterTree& tree, const ChartOptions& options,
                               const CancelToken& cancel, ChartStats& stats);

}  // namespace goldthread
