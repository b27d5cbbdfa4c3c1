#include "math/form_factor.h"

#include <algorithm>

namespace goldthread {
namespace {

// Sum of Theta * Gamma / 2 pi over the edges of a polygon of directions, clockwise or not deciding the sign.
// Double precision: the edge terms of a small, far polygon cancel almost wholly.
vec3 contour_sum(std::span<const vec3> directions) {
  dvec3 sum(0);
  dvec3 previous = directions.back();
  double previous_length = glm::length(previous);
  for (const vec3& direction : directions) {
    const dvec3 current = direction;
    const double current_length = glm::length(current);
    const dvec3 normal = glm::cross(previous, current);
    const double sine = glm::length(normal);
    const double cosine = glm::dot(previous, current);
    // A corner at x itself, or an edge through it, adds a plane through x that lies in the polygon's own:
    // nothing.
    if (sine > 1e-14 * (previous_length * current_length + 1e-300))
      sum += normal * (std::atan2(sine, cosine) / sine);
    previous = current;
    previous_length = current_length;
  }
  return vec3(sum * (0.5 / 3.14159265358979323846));
}

}  // namespace

// Sutherland-Hodgman, one plane.
size_t clip_to_horizon(const vec3& n, std::span<const vec3> in, std::array<vec3, kMaxPolygon + 1>& out) {
  size_t count = 0;
  vec3 previous = in.back();
  float previous_height = dot(n, previous);
  for (const vec3& current : in) {
    const float height = dot(n, current);
    if ((height < 0) != (previous_height < 0)) {
      const float t = previous_height / (previous_height - height);
      out[count++] = previous + t * (current - previous);
    }
    if (height >= 0) out[count++] = current;
    previous = current;
    previous_height = height;
  }
  return count;
}

vec3 polygon_form_factor(const vec3& x, const vec3& n, std::span<const vec3> corners) {
  std::array<vec3, kMaxPolygon> directions;
  const size_t count = corners.size();
  bool below = false, above = false;
  for (size_t i = 0; i < count; ++i) {
    directions[i] = corners[i] - x;
    (dot(n, directions[i]) < 0 ? below : above) = true;
  }
  if (!above) return vec3(0);
  // From the front, corners that run counter-clockwise run clockwise as directions from x: the contour sum
  // points away.
  if (!below) {
    const vec3 m = -contour_sum({directions.data(), count});
    return dot(m, n) > 0 ? m : vec3(0);
  }
  std::array<vec3, kMaxPolygon + 1> clipped;
  const size_t kept = clip_to_horizon(n, {directions.data(), count}, clipped);
  if (kept < 3) return vec3(0);
  const vec3 m = -contour_sum({clipped.data(), kept});
  return dot(m, n) > 0 ? m : vec3(0);
}

vec3 sky_form_factor(const vec3& n, std::span<const vec3> directions) {
  std::array<vec3, kMaxPolygon + 1> clipped;
  const size_t kept = clip_to_horizon(n, directions, clipped);
  if (kept < 3) return vec3(0);
  const vec3 m = -contour_sum({clipped.data(), kept});
  return dot(m, n) > 0 ? m : vec3(0);
}

}  // namespace goldthread
