// A cluster cut out of its mesh: what is joined to what when only its own triangles count.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace goldthread {

/// A range of a mesh's triangles as an oriented manifold with corners of its own. A corner is a fan:
/// triangles round one vertex that follow each other across shared edges. Where fans merely touch in a
/// vertex, or where neighbours are wound against each other, the surface is cut.
struct Piece {
  uint32_t first = 0;              ///< of its triangles in the mesh
  std::vector<UVec3> faces;        ///< corners of triangle first + i
  std::vector<dvec3> positions;    ///< per corner, from the first one's
  std::vector<uint32_t> boundary;  ///< corners in the triangles' sense, loop after loop
  std::vector<uint32_t> loops;     ///< where each loop begins in `boundary`, then its size
  bool connected = false;

  size_t loop_count() const { return loops.size() - 1; }
  std::span<const uint32_t> loop(size_t i) const {
    return std::span(boundary).subspan(loops[i], loops[i + 1] - loops[i]);
  }
  /// Connected, and a disc once its holes are filled: no handles, at least one boundary.
  bool is_disc_with_holes() const;
};

/// find_twins() without neighbours of equal direction: one has to be mirrored to lie beside the other.
std::vector<uint32_t> find_opposite_twins(const TriangleMesh& mesh);

/// `twins` is what find_opposite_twins() gave for the mesh.
Piece cut_piece(const TriangleMesh& mesh, std::span<const uint32_t> twins, uint32_t first, uint32_t count);

}  // namespace goldthread
