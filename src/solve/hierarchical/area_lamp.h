// Rectangle and disc lamps as points see them.
#pragma once
#include <optional>

#include "element/element_pool.h"

namespace goldthread {

/// Corners that stand for a disc that the horizon cuts, and for where rays go: those of a regular polygon of
/// the disc's area.
constexpr size_t kDiscCorners = 22;

/// Ways, in metres, from `x` to the corners of an area lamp, counter-clockwise from the side it shines to.
ElementPolygon area_lamp_corners(const Light& light, const vec3& x);

/// What 1 cd of an area lamp brings to `x`, were nothing between: m with dot(n, m) the irradiance over the
/// intensity, in 1/m^2, on a receiver of unit normal `n`. With luminance intensity / area and the polygon's
/// form factor F (Lambert 1760, clipped at the receiver's horizon) that is pi F / area. A disc above the
/// horizon is exact (J. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, B-12 and B-13);
/// of one that is cut, kDiscCorners corners are right to 1% of what all of it would bring. A lamp that is far
/// for its size is a point that shines by the cosine. Zero behind the lamp and in its plane.
vec3 area_lamp_transfer(const Light& light, const vec3& x, const vec3& n);

/// What of an area lamp is above the horizon of `x`: places of it to send rays to.
class AreaLampView {
 public:
  /// `n` is the receiver's unit normal.
  AreaLampView(const Light& light, const vec3& x, const vec3& n);

  bool empty() const { return corners_.count < 3; }
  /// The way from `x` to the place that belongs to (u, v) in the unit square, in metres; by solid angle where
  /// the lamp is near, by area where it is far. `weight` becomes what that place brings relative to the
  /// others.
  vec3 way(float u, float v, float& weight) const;

 private:
  vec3 by_area(float u, float v) const;

  vec3 n_, direction_;
  float height_;  // metres, of x before the lamp's plane
  ElementPolygon corners_;
  std::optional<SphericalPolygon> directions_;  // where it is near
};

}  // namespace goldthread
