// Planar polygons in double precision: what exact form factors are made of.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// Corners of a planar polygon, counter-clockwise as seen from the side that it sends to.
using Polygon = std::vector<dvec3>;

/// All x with dot(normal, x) + offset >= 0 lie in front.
struct Plane {
  dvec3 normal{0};
  double offset = 0;

  double height(const dvec3& x) const { return glm::dot(normal, x) + offset; }
};

/// Half the sum of the corners' cross products: length = area, direction = the side that it sends to.
dvec3 area_vector(std::span<const dvec3> polygon);
double area(std::span<const dvec3> polygon);
/// The plane of a polygon that has an area; unit normal.
Plane plane_of(std::span<const dvec3> polygon);
/// Largest distance of a corner from the mean of all.
double radius(std::span<const dvec3> polygon);
dvec3 mean_corner(std::span<const dvec3> polygon);

bool is_convex(std::span<const dvec3> polygon);

/// What is wrong with a polygon: fewer than three corners, coordinates that are not finite, no area, corners
/// further than `tolerance` of its size from its plane, edges that cross. Nothing when it is fit for use.
std::optional<std::string> polygon_problem(std::span<const dvec3> polygon, double tolerance = 1e-5);

/// Two polygons (numbers, ascending) that face the same way and have the same corners, to within a millionth
/// of their size: one of them is there twice. The first such pair, if there is any.
std::optional<std::pair<uint32_t, uint32_t>> find_twice(std::span<const Polygon> polygons);

/// The part in front of the plane, empty when there is none. Corners within `tolerance` metres of the plane
/// count as on it, so that polygons that share an edge leave no slivers. A polygon that is not convex keeps
/// edges that run along the plane there and back, which contour integrals do not mind.
Polygon clip(std::span<const dvec3> polygon, const Plane& plane, double tolerance = 0);

/// Triangles (corner numbers) that make up a simple polygon, by cutting off ears.
std::vector<UVec3> triangulate(std::span<const dvec3> polygon);
/// The same as convex polygons: itself if it is one, else its triangles.
std::vector<Polygon> convex_parts(std::span<const dvec3> polygon);

}  // namespace goldthread
