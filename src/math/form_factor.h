// How much of what a shape sends arrives at a point: closed forms.
#pragma once
#include <array>
#include <span>

#include "math/vec.h"

namespace goldthread {

/// Most corners a polygon may have here, and one more for horizon clipping.
constexpr size_t kMaxPolygon = 24;

/// Cuts a convex polygon of directions by the half space dot(n, v) >= 0; returns how many corners `out` has
/// then, fewer than 3 where nothing is left. At most kMaxPolygon corners.
size_t clip_to_horizon(const vec3& n, std::span<const vec3> in, std::array<vec3, kMaxPolygon + 1>& out);

/// The vector form factor of a planar polygon at `x`: m with dot(n, m) the point-to-polygon form factor for a
/// receiver of normal n, so that irradiance = dot(n, m) * radiosity (Lambert 1760; thesis equation 4.19 in
/// its exact limit):
///   m = 1/(2 pi) * sum over edges of Theta_i * Gamma_i,
/// Theta_i the angle an edge subtends and Gamma_i the unit normal of the plane through it and x.
/// The polygon sends to the side from which its corners run counter-clockwise; seen from behind it gives
/// zero. `n` (unit) cuts away what lies below the receiver's horizon. At most kMaxPolygon - 1 corners.
vec3 polygon_form_factor(const vec3& x, const vec3& n, std::span<const vec3> corners);

/// The same for a convex cone of directions from any point (a piece of sky): corners are unit directions,
/// counter-clockwise as seen from the receiver inside. A cell of the sky has no back.
vec3 sky_form_factor(const vec3& n, std::span<const vec3> directions);

}  // namespace goldthread
