// How much of an element's radiosity arrives at a point, were nothing between.
#pragma once
#include "element/element_pool.h"

namespace goldthread {

/// Vector form factor m of `source` at `x`, without occlusion: dot(n, m) times the source's radiosity is the
/// irradiance on a receiver of unit normal `n`. Equation 4.19 where the source is far; near, face clusters
/// are descended until each piece is small for its distance, and triangles and patches are exact (Lambert's
/// contour formula), so that shared edges and closed sources need no special care. Zero below the receiver's
/// horizon and behind the source. For lights the "radiosity" is what Element::exitance says: candela, lux, or
/// the sky's lm/m^2.
vec3 point_transfer(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n);

/// Share of a point or spot light's intensity that goes in unit direction `d` (KHR_lights_punctual's cone
/// falloff).
float light_distribution(const Light& light, const vec3& d);
/// Share that is left at `distance` metres of a light with a range (KHR_lights_punctual), besides the inverse
/// square.
float light_range_factor(const Light& light, float distance);

}  // namespace goldthread
