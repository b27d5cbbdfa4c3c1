// Directions spread evenly over the solid angle of a triangle or convex polygon.
#pragma once
#include <array>
#include <span>

#include "math/form_factor.h"
#include "math/vec.h"

namespace goldthread {

/// Solid angle (steradians) of the triangle with unit corner directions a, b, c (van Oosterom and Strackee
/// 1983).
float solid_angle(const vec3& a, const vec3& b, const vec3& c);

/// The unit direction that maps (u, v) in the unit square to the spherical triangle with even density (Arvo
/// 1995). `angle` is the triangle's solid_angle.
vec3 sample_spherical_triangle(const vec3& a, const vec3& b, const vec3& c, float angle, float u, float v);

/// A convex polygon as it is seen from a point, from which many directions are drawn.
class SphericalPolygon {
 public:
  /// Corners seen from the origin, at most kMaxPolygon + 1, at any distance.
  explicit SphericalPolygon(std::span<const vec3> corners);

  float solid_angle() const { return total_; }  ///< steradians
  /// The unit direction that belongs to (u, v); zero when there is no solid angle.
  vec3 sample(float u, float v) const;

 private:
  std::array<vec3, kMaxPolygon + 1> unit_;
  std::array<float, kMaxPolygon + 1> angles_;  // of the fan's triangles, by their second corner
  size_t count_;
  float total_ = 0;
};

}  // namespace goldthread
