// How light varies within leaves, from their corners.
#pragma once
#include <span>

#include "reconstruct/final_gather.h"
#include "reconstruct/light_points.h"

namespace goldthread {

/// Sets `shown` and `rise` of the flat leaves of one side of a part to the plane, by least squares, through
/// the radiosity at their corners. `leaves` by face and `light` (lux) by point of `points`. What a leaf of
/// many directions shows stays as it is. What comes through from a leaf's other side is `state`'s.
void fit_leaves(const ElementPool& pool, const PartPoints& points, std::span<const ElementId> leaves,
                std::span<const vec3> light, const RadiosityState& state, ShownLight& shown);

/// Sets `low` and `high` of all surfaces to what their leaves range over. What elements above leaves show
/// stays: it is weighted by how open their leaves lie.
void range_over_leaves(const ElementPool& pool, ShownLight& shown);

}  // namespace goldthread
