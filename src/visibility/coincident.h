// Triangles that lie in one place.
#pragma once
#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "base/progress.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// Who gets a place that several triangles cover.
struct PlaceClaims {
  /// Whether this triangle has a say at all.
  std::function<bool(uint32_t triangle)> contends;
  /// Whether the first gets what both cover. Nothing beats itself, and what beats a winner beats the loser,
  /// too.
  std::function<bool(uint32_t first, uint32_t second)> beats;
};

/// Pairs (covered, owner) of triangles that overlap in one plane, to within the caster's epsilon, whichever
/// way they face; in order, each once. An owner is one that nothing beats where it was found, so that any
/// number of copies in one place give pairs in proportion to their own number. Found by points: the centre of
/// one has to lie on another, and of these some more are looked at; an overlap that is small beside both
/// triangles may be missed. The caster must be of these triangles. When cancelled, what was found so far.
std::vector<std::pair<uint32_t, uint32_t>> find_coincident(std::span<const vec3> positions,
                                                           std::span<const UVec3> triangles,
                                                           const RayCaster& caster, const PlaceClaims& claims,
                                                           const CancelToken& cancel);

}  // namespace goldthread
