// Triangles that lie in one place.
#pragma once
#include <span>
#include <utility>
#include <vector>

#include "visibility/ray_caster.h"

namespace goldthread {

/// Pairs (first < second) of triangles that overlap in one plane, to within the caster's epsilon, whichever
/// way they face; in order, each once. Found by points: the centre of one has to lie on another, and of these
/// some more are looked at; an overlap that is small beside both triangles may be missed. The caster must be
/// of these triangles.
std::vector<std::pair<uint32_t, uint32_t>> find_coincident(std::span<const vec3> positions,
                                                           std::span<const UVec3> triangles,
                                                           const RayCaster& caster);

}  // namespace goldthread
