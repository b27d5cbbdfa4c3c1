// The geometry that hierarchies are built on: welded positions and sound triangles.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// Triangles that were left out of a TriangleMesh, by reason.
struct SkippedTriangles {
  uint64_t not_finite = 0;  ///< a corner is NaN or infinite
  uint64_t degenerate = 0;  ///< no area: corners coincide or lie on a line
  uint64_t duplicate = 0;   ///< the same corners, in the same sense, as one that is kept
};

/// A triangle that was left out since another is the same.
struct DuplicateTriangle {
  uint32_t source = 0;  ///< its number in the source primitive
  uint32_t twin = 0;    ///< TriangleMesh::triangles
  uint32_t turn = 0;    ///< its corner k is corner (k + turn) % 3 of the twin
};

/// Positions merged where equal (glTF splits vertices at every normal and UV seam; light must not see that),
/// and the triangles over them. Mesh space.
struct TriangleMesh {
  std::vector<vec3> positions;
  std::vector<UVec3> triangles;  ///< corners as indices into positions, in the source's order and winding
  std::vector<uint32_t> source_triangles;  ///< per triangle: its number in the source primitive
  std::vector<DuplicateTriangle> duplicates;
  SkippedTriangles skipped;
};

/// Welds bit-equal positions (-0 equals 0) and drops triangles without area and
/// all but the first of equal ones. `indices` must be in range.
/// Corner k of a kept triangle is corner k of its source triangle.
TriangleMesh weld(std::span<const vec3> positions, std::span<const uint32_t> indices);

/// The normal of a triangle times its area. Worked out in double: the cross product of two long sides of a
/// thin triangle loses its leading digits, and CAD is full of those.
inline vec3 area_vector(const vec3& a, const vec3& b, const vec3& c) {
  const dvec3 from(a);
  return vec3(0.5 * cross(dvec3(b) - from, dvec3(c) - from));
}

/// Whether `p` lies on triangle a b c, to within `tolerance` of its plane. Points on its edges do.
inline bool lies_on_triangle(const vec3& p, const vec3& a, const vec3& b, const vec3& c, float tolerance) {
  const dvec3 u = dvec3(b) - dvec3(a), v = dvec3(c) - dvec3(a), w = dvec3(p) - dvec3(a);
  const dvec3 n = cross(u, v);
  const double squared = dot(n, n), height = dot(w, n);
  const double reach = static_cast<double>(tolerance) * static_cast<double>(tolerance) * squared;
  if (!(squared > 0) || !(height * height <= reach)) return false;
  const double s = dot(cross(w, v), n), t = dot(cross(u, w), n), slack = 1e-6 * squared;
  return s >= -slack && t >= -slack && s + t <= squared + slack;
}

}  // namespace goldthread
