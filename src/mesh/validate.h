// Checks that tests run after every construction. A broken promise aborts with both values.
#pragma once
#include <cstdint>
#include <span>

#include "mesh/triangle_mesh.h"

namespace goldthread {

/// Indices in range, all positions finite, distinct and used, every triangle with an area, one source number
/// each.
void validate(const TriangleMesh& mesh);

/// One twin at most, twin(twin(h)) == h, both halves over the same two vertices, no triangle its own
/// neighbour.
void validate_twins(const TriangleMesh& mesh, std::span<const uint32_t> twins);

}  // namespace goldthread
