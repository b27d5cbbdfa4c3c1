// Surfaces that lie in one place: real files hold a window frame in two materials, a carpet in the very plane
// of its floor. Each copy would take the light that only one can get.
#pragma once
#include <span>
#include <utility>

#include "element/surface_set.h"

namespace goldthread {

/// Whether this triangle of the world competes for its place: not where its material has alpha or is
/// glass, since such share the light as they are, and not where it is unlit.
bool contends_for_place(const SurfaceSet& set, uint32_t triangle);

/// Whether the first of two contenders that overlap gets their common area (scene/place_claim.h).
bool owns_place(const SurfaceSet& set, uint32_t owner, uint32_t other);

/// Gives every place one owner. `covered` are pairs (which, by which) of the world's triangles, in order,
/// that overlap in one plane to within `tolerance` metres. Where a triangle is covered, its coverage,
/// reflectance and exitance are nought: it still receives, so as to look lit, but no light lands on it or
/// leaves it twice.
void settle_overlaps(SurfaceSet& set, std::span<const std::pair<uint32_t, uint32_t>> covered,
                     float tolerance);

/// Whether another triangle owns the place `p` of the part's triangle.
bool is_covered(const SurfaceSet& set, const Part& part, uint32_t triangle, const vec3& p);

}  // namespace goldthread
