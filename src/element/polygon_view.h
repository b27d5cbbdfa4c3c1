// Places on one convex polygon: by area, or by what they send to a point.
#pragma once
#include <array>
#include <optional>
#include <span>

#include "math/form_factor.h"
#include "math/spherical_triangle.h"

namespace goldthread {

/// Corners of a convex polygon, counter-clockwise from the side that it sends to.
struct ElementPolygon {
  std::array<vec3, kMaxPolygon> corners;
  size_t count = 0;
  std::span<const vec3> span() const { return {corners.data(), count}; }
  /// Unit; up where there is no area.
  vec3 normal() const;
};

/// The one of a cluster's triangles on which the point lies.
constexpr uint32_t kSomeTriangle = 0xffffffffu;

/// A point on an element's surface: a triangle's, or that of an outline (FlatOutlines) that stands for many.
struct SurfacePoint {
  vec3 position{0};
  vec3 normal{0};         ///< unit, on the element's side
  uint32_t triangle = 0;  ///< of the part's tree, for points on clusters and triangles; or kSomeTriangle
};

/// A polygon of which many places are drawn: what they have in common is worked out once.
class PolygonSampler {
 public:
  /// `triangle` is what the points are given.
  PolygonSampler(const ElementPolygon& polygon, const vec3& normal, uint32_t triangle);

  /// The place that belongs to (u, v) in the unit square, evenly by area, a hair's breadth from the edges.
  SurfacePoint sample(float u, float v) const;

  const ElementPolygon& polygon() const { return polygon_; }
  const vec3& normal() const { return normal_; }
  uint32_t triangle() const { return triangle_; }
  float area() const { return 0.5f * twice_area_; }

 private:
  ElementPolygon polygon_;
  vec3 normal_;
  uint32_t triangle_;
  std::array<float, kMaxPolygon> twice_areas_;  // of the fan's triangles, by their second corner
  float twice_area_ = 0;
};

/// The same for places drawn by what they send to a point x: of a large polygon nearby, where it is near.
class PolygonView {
 public:
  PolygonView(const PolygonSampler& places, const vec3& x);

  /// `n` is the unit normal at x. `weight` is the place's form-factor density over the density it was drawn
  /// with (its mean over samples is the form factor times pi, occlusion apart); 0 where x is below or behind.
  SurfacePoint sample(const vec3& n, float u, float v, float& weight) const;

 private:
  const PolygonSampler places_;
  const vec3 x_;
  float before_;  // metres from the plane to x, on the side it sends to
  std::optional<SphericalPolygon> directions_;
  vec3 middle_{0};  // of the corners
};

}  // namespace goldthread
