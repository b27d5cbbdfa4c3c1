// The mesh at the bottom of the hierarchy: a part's triangles and the patches they are cut into, as
// half-edges, so that a cut made in one face is seen by its neighbour (thesis 6.2.3).
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "element/surface_set.h"

namespace goldthread {

constexpr uint32_t kNoEdge = 0xffffffffu;

/// Whether light may differ on the two sides of an edge.
enum class Seam : uint8_t {
  kNone,   ///< it is the same
  kSharp,  ///< a wall stands there, or a shadow ends
  kGap,    ///< something hovers close above one side: under it light falls off within the gap's height or two
};

/// Half-edges 3t..3t+2 and face t are the part's triangle t until it is cut. Faces are convex; a loop may
/// hold corners on a straight line, where a neighbour was cut (T-vertices). World space. Own structure rather
/// than OpenMesh, which refuses the non-manifold edges of real models and costs twice the time to fill.
class LeafMesh {
 public:
  LeafMesh(const Part& part, const TriangleMesh& mesh);

  uint32_t face_count() const { return static_cast<uint32_t>(face_edge_.size()); }
  uint32_t triangle_of_face(uint32_t face) const { return face_triangle_[face]; }
  const std::vector<vec3>& positions() const { return positions_; }

  uint32_t first_edge(uint32_t face) const { return face_edge_[face]; }
  uint32_t next(uint32_t edge) const { return next_[edge]; }
  uint32_t origin(uint32_t edge) const { return origin_[edge]; }
  uint32_t twin(uint32_t edge) const { return twin_[edge]; }
  uint32_t face(uint32_t edge) const { return face_[edge]; }

  /// The face's corners in order, T-vertices included.
  void loop(uint32_t face, std::vector<uint32_t>& vertices) const;

  bool has_seams() const { return !seam_.empty(); }
  /// kNone for all edges but those of cuts within a triangle.
  Seam seam(uint32_t edge) const { return edge < seam_.size() ? seam_[edge] : Seam::kNone; }

  /// Puts a vertex at `position` on an edge, in both faces that share it. The new half-edge follows `edge`.
  uint32_t split_edge(uint32_t edge, const vec3& position);

  /// Cuts a face between the origins of two of its half-edges that are not neighbours. The part that starts
  /// at `from` keeps the face's number; the other's new number is returned. `seam` is what seam() will say
  /// of the cut.
  uint32_t split_face(uint32_t from, uint32_t to, Seam seam = Seam::kNone);

  uint64_t memory_bytes() const;

 private:
  uint32_t add_edge(uint32_t origin, uint32_t face);
  void mark_seam(uint32_t edge, Seam seam);

  std::vector<vec3> positions_;
  std::vector<uint32_t> origin_, next_, twin_, face_;
  std::vector<uint32_t> face_edge_, face_triangle_;
  std::vector<Seam> seam_;  // by half-edge, as far as there is a seam
};

/// Aborts if loops, twins or areas are broken. For tests.
void validate(const LeafMesh& mesh);

}  // namespace goldthread
