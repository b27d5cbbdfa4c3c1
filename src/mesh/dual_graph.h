// Which triangles are neighbours across an edge (thesis 4.2.2: the dual graph).
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace goldthread {

constexpr uint32_t kNoTwin = 0xffffffffu;

/// For half-edge 3 * t + k (from corner k to corner k + 1 of triangle t): the half-edge on the other side, or
/// kNoTwin. Edges of more than two triangles are paired front to back in triangle order, same winding
/// direction last, so that every half-edge has at most one twin and twin(twin(h)) == h. Pairs of equal
/// direction (a flipped neighbour) are made only when no opposite partner is left.
std::vector<uint32_t> find_twins(const TriangleMesh& mesh);

}  // namespace goldthread
