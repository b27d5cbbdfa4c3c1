// What `info` says of the geometry of one mesh.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/scene.h"
#include "session/shell_check.h"

namespace goldthread {

/// Counts after welding all primitives of the mesh.
struct MeshFacts {
  uint64_t triangles = 0;           ///< as in the file
  uint64_t not_finite = 0;          ///< left out of all that follows
  uint64_t degenerate = 0;          ///< without area: the same
  uint64_t thin = 0;                ///< longest side over 20 times the height upon it
  uint64_t duplicate = 0;           ///< over the same three points as an earlier one
  uint64_t boundary_edges = 0;      ///< of one triangle
  uint64_t non_manifold_edges = 0;  ///< of more than two
  uint64_t shells = 0, closed_shells = 0;
  uint64_t inside_out_shells = 0;    ///< closed, one-sided, facing inwards, and no room
  uint64_t inconsistent_shells = 0;  ///< with triangles wound against the others, one-sided
  uint64_t wrong_triangles = 0;      ///< that --fix-normals would turn
};

MeshFacts measure_mesh(const Scene& scene, uint32_t mesh, const ShellCheck& check);

/// `more` times `copies` added to `sum`.
void add_facts(MeshFacts& sum, const MeshFacts& more, uint64_t copies);

}  // namespace goldthread
