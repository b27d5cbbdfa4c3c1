// All the room between two convex things, bounded by planes (Haines and Wallace 1994; thesis 3.4.1).
#pragma once
#include <array>
#include <span>

#include "math/box.h"

namespace goldthread {

/// Planes that contain every segment from one point set to another. What is wholly outside one of them is
/// between no two points.
class Shaft {
 public:
  /// `from` and `to` are corners, in order, of convex polygons, or `to` any points whose hull is meant. At
  /// most kMostPoints each. What lies within `epsilon` metres of the shaft's sides counts as outside: rays do
  /// not start or end on surfaces either.
  Shaft(std::span<const vec3> from, std::span<const vec3> to, float epsilon);

  static constexpr size_t kMostPoints = 24;

  /// A cap (thesis 3.4.1): only what reaches above the plane through `point` with unit normal `normal`
  /// counts.
  void add_cap(const vec3& point, const vec3& normal);

  bool excludes(const Box& box) const;
  /// Exact but for triangles that pass by a corner where no plane of the shaft or their own parts them from
  /// it.
  bool excludes(const vec3& a, const vec3& b, const vec3& c) const;

 private:
  struct Plane {
    vec3 normal{0};  // unit, outwards
    float distance = 0;
  };
  void add_sides(std::span<const vec3> edges, std::span<const vec3> others);
  void add(const vec3& normal, const vec3& through);
  bool contains_all(const vec3& normal, float distance) const;

  static constexpr size_t kMostPlanes = 32;
  std::array<Plane, kMostPlanes> planes_;
  size_t count_ = 0;
  std::array<vec3, 2 * kMostPoints> points_;
  size_t point_count_ = 0;
  Box box_;
  float epsilon_ = 0;
};

}  // namespace goldthread
