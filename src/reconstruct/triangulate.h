// Faces with corners on straight lines, cut into triangles so that no T-vertex is left (thesis 4.4.3).
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// Triangulates a convex planar polygon whose loop may hold collinear corners. Every corner is used; of the
/// possible triangulations the Delaunay one is sought by flipping diagonals. Appends loop positions, three a
/// triangle, wound as the loop. Triangles without area are made only when all corners are collinear.
void triangulate_face(std::span<const vec3> loop, std::vector<UVec3>& triangles);

}  // namespace goldthread
