// The scene as light sees it: placed primitives, their clusters, and one-sided surfaces.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/progress.h"
#include "cluster/face_cluster_tree.h"
#include "math/box.h"
#include "scene/scene.h"

namespace goldthread {

/// A primitive of an instance, placed in the world. Its clusters are those of the mesh, shared by all
/// instances; only an instance that is scaled unevenly has a tree of its own, since no length or area
/// survives that.
struct Part {
  uint32_t instance = 0, primitive = 0, material = 0;
  uint32_t tree = 0;  ///< SurfaceSet::trees
  mat4 to_world{1};   ///< tree space to world: a similarity, perhaps mirrored
  mat3 area_map{1};   ///< carries the tree's area vectors to world ones of the front side
  float scale = 1;    ///< of lengths
  float winding = 1;  ///< -1 when mirrored: then the front of a triangle is where its corners run clockwise
  std::vector<vec3> positions;               ///< world, per vertex of the tree's mesh
  uint32_t first_triangle = 0;               ///< the number of its triangle 0 among all of the world's
  vec3 reflectance{0};                       ///< times coverage, clamped below 1
  vec3 exitance{0};                          ///< lm/m^2, times coverage
  float coverage = 1;                        ///< share of light that stops there (alpha, glass, overlaps)
  vec3 stopped{1};                           ///< the same by channel
  vec3 transmittance{0};                     ///< share of light that leaves diffusely on the other side
  std::vector<vec3> triangle_reflectance;    ///< area averages per tree triangle; empty when uniform
  std::vector<vec3> triangle_exitance;       ///< the same, empty when uniform
  std::vector<float> triangle_coverage;      ///< the same, empty when uniform
  std::vector<vec3> triangle_stopped;        ///< the same, empty when uniform and where there is no glass
  std::vector<vec3> triangle_transmittance;  ///< the same, empty when uniform and where none gets through
  /// The world's triangles that own places of this part's (settle_overlaps); triangle t's are covering
  /// [covering_first[t], covering_first[t + 1]). Both empty when there are none.
  std::vector<uint32_t> covering_first, covering;
};

/// One side of a connected component of a part: the unit that sends and receives light. Two-sided materials
/// give two.
struct Surface {
  uint32_t part = 0;
  ClusterRef root = 0;
  bool back = false;
};

struct SurfaceSet {
  const Scene* scene = nullptr;  ///< borrowed
  std::vector<FaceClusterTree> trees;
  std::vector<Part> parts;
  std::vector<Surface> surfaces;
  uint32_t triangles = 0;          ///< of all parts
  double area = 0;                 ///< of all triangles, one side, m^2
  uint64_t face_clusters = 0;      ///< inner nodes of all trees
  SkippedTriangles skipped;        ///< over all instances
  uint32_t clamped_materials = 0;  ///< whose reflectance was cut to kMaxReflectance
  bool has_glass = false;          ///< some part lets light straight on in what is not a hole
  bool has_translucent = false;    ///< some part lets light through to leave diffusely on the other side
  float same_place = 0;            ///< metres within which triangles of one plane lie in one place
  uint64_t overlapping = 0;        ///< pairs of triangles in one place, of which one owns it

  const FaceClusterTree& tree(const Part& part) const { return trees[part.tree]; }
};

/// The triangles of the part's tree that a surface consists of: [first, first + count).
struct TriangleRange {
  uint32_t first = 0, count = 0;
};
TriangleRange triangles_of(const SurfaceSet& set, const Surface& surface);
/// The box of their world vertices.
Box box_of(const SurfaceSet& set, const Surface& surface);

/// Welds, clusters and places every lit primitive of `scene`, which must outlive the result.
SurfaceSet build_surfaces(const Scene& scene, const CancelToken& cancel);

/// The world's triangles for the ray caster, numbered by Part::first_triangle, and which of them let rays
/// through (alpha mask and blend, glass; primitives of unlit materials block as all others).
struct WorldTriangles {
  std::vector<vec3> positions;
  std::vector<UVec3> triangles;
  std::vector<uint8_t> see_through;  ///< as RayCaster takes it; empty when all are opaque
};
WorldTriangles world_triangles(const SurfaceSet& set);

/// The part that the world's triangle belongs to.
const Part& part_of_triangle(const SurfaceSet& set, uint32_t triangle);

}  // namespace goldthread
