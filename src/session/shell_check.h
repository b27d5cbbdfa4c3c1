// Shells of a whole mesh, all its primitives together: a shell may be of several materials.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/orient.h"
#include "scene/scene.h"

namespace goldthread {

/// A mesh's primitives welded into one, with the way back.
struct JoinedMesh {
  TriangleMesh mesh;                     ///< source_triangles count through all primitives
  std::vector<uint32_t> first_triangle;  ///< of each primitive, in source_triangles
  std::vector<uint32_t> twins;
};
JoinedMesh join_primitives(const Mesh& mesh);

/// Tells rooms, which face inwards on purpose, from shells that are inside out.
class ShellCheck {
 public:
  explicit ShellCheck(const Scene& scene);

  /// Per shell of a mesh: 1 when it faces inwards and, as an instance places it, holds a camera or most of
  /// the rest of the scene.
  std::vector<uint8_t> find_rooms(uint32_t mesh, const Winding& winding) const;

 private:
  bool is_room(const Box& box, uint32_t mesh) const;

  const Scene& scene_;
  std::vector<Box> instance_boxes_;
  std::vector<uint64_t> instance_triangles_;
  uint64_t triangles_ = 0;
};

}  // namespace goldthread
