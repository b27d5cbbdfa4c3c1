// Directions drawn about a normal, or all around.
#pragma once
#include <span>

#include "trace/lanes.h"
#include "trace/scrambled_sobol.h"

namespace goldthread {

/// A direction about `normal` with density cosine / pi.
vec3 cosine_direction(const vec3& normal, SobolPoint p);
/// The same of many normals, bit for bit; `points` are as many as directions are wanted.
void cosine_directions(const Vec3Lanes& normals, std::span<const SobolPoint> points, Vec3Lanes& directions);
/// A direction of even density 1 / 4 pi.
vec3 even_direction(SobolPoint p);

}  // namespace goldthread
