// Boxes in any orientation, and the principal axes of points.
#pragma once
#include <span>

#include "math/vec.h"

namespace goldthread {

struct OrientedBox {
  vec3 centre{0};
  mat3 axes{1};  ///< columns: unit, orthogonal, right-handed
  vec3 half{0};  ///< half extents along them

  float surface_area() const { return 8 * (half.x * half.y + half.y * half.z + half.z * half.x); }
};

/// Mean and eigenvectors of the covariance of points (thesis equations 4.5 and 4.6).
struct PrincipalAxes {
  vec3 mean{0};
  mat3 axes{1};       ///< columns by falling variance, right-handed
  vec3 deviation{0};  ///< root mean square distance from the mean along each
};

/// Points must be finite; without any the default is returned.
PrincipalAxes principal_axes(std::span<const vec3> points);

/// The smallest box along `axes` (orthonormal, right-handed) that holds all points.
OrientedBox box_along(const mat3& axes, std::span<const vec3> points);

/// A right-handed orthonormal frame with the unit vector `normal` as its third column.
mat3 frame_about(const vec3& normal);

}  // namespace goldthread
