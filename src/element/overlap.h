// Surfaces that lie in one place: real files hold a window frame in two materials, a carpet in the very plane
// of its floor. Each copy would take the light that only one can get.
#pragma once
#include <span>
#include <utility>

#include "element/surface_set.h"

namespace goldthread {

/// Gives every place one owner. `pairs` are triangles of the world that overlap in one plane, to within
/// `tolerance` metres; of two that face the same way (two-sided ones face both), what emits more owns the
/// common area, else what is two-sided, else the lower number. A lamp of one side in a surface of two takes
/// nothing from it, since it is not there on the other: both keep their light. There the other's coverage,
/// reflectance and exitance are nought: it still receives, so as to look lit, but no light lands on it or
/// leaves it twice. Materials with alpha, which share the light as they are, and unlit ones take no part.
void settle_overlaps(SurfaceSet& set, std::span<const std::pair<uint32_t, uint32_t>> pairs, float tolerance);

/// Whether another triangle owns the place `p` of the part's triangle.
bool is_covered(const SurfaceSet& set, const Part& part, uint32_t triangle, const vec3& p);

}  // namespace goldthread
