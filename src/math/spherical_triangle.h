// Directions spread evenly over the solid angle of a triangle or convex polygon.
#pragma once
#include <span>

#include "math/vec.h"

namespace goldthread {

/// Solid angle (steradians) of the triangle with unit corner directions a, b, c (van Oosterom and Strackee
/// 1983).
float solid_angle(const vec3& a, const vec3& b, const vec3& c);

/// The unit direction that maps (u, v) in the unit square to the spherical triangle with even density (Arvo
/// 1995).
vec3 sample_spherical_triangle(const vec3& a, const vec3& b, const vec3& c, float u, float v);

/// The same for a convex polygon of corners seen from the origin, of at most kMaxPolygon; zero when it has no
/// solid angle.
vec3 sample_spherical_polygon(std::span<const vec3> corners, float u, float v);

}  // namespace goldthread
