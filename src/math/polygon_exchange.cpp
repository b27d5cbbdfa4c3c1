#include "math/polygon_exchange.h"

#include <algorithm>
#include <limits>

namespace goldthread {
namespace {

constexpr double kPrecise = std::numeric_limits<double>::epsilon();
constexpr double kPiExact = 3.14159265358979323846;

struct Edge {
  dvec3 start, direction;  // unit
  double length = 0;
};

std::vector<Edge> edges_of(std::span<const dvec3> polygon) {
  std::vector<Edge> edges;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const dvec3 along = polygon[(i + 1) % polygon.size()] - polygon[i];
    const double length = glm::length(along);
    if (length > 0) edges.push_back({polygon[i], along / length, length});
  }
  return edges;
}

// Antiderivative in u of ln sqrt(u² + h²).
double log_distance(double u, double h) {
  const double squared = u * u + h * h;
  if (squared <= 0) return 0;
  return 0.5 * u * std::log(squared) - u + (h > 0 ? h * std::atan(u / h) : 0.0);
}

// Integral of ln |p - q| over all q on the edge.
double log_distance_to_edge(const dvec3& p, const Edge& edge) {
  const dvec3 to_p = p - edge.start;
  const double foot = glm::dot(to_p, edge.direction);
  const double h = glm::length(to_p - foot * edge.direction);
  return log_distance(edge.length - foot, h) - log_distance(-foot, h);
}

// The part of `polygon` that can see anything of `other`.
Polygon facing_part(std::span<const dvec3> polygon, std::span<const dvec3> other) {
  return clip(polygon, plane_of(other), 1e-12 * (radius(polygon) + radius(other)));
}

}  // namespace

double point_form_factor(const dvec3& x, const dvec3& n, std::span<const dvec3> polygon) {
  const dvec3 facing = area_vector(polygon);
  if (polygon.size() < 3 || glm::dot(facing, x - polygon[0]) <= 0) return 0;
  const Polygon seen = clip(polygon, {n, -glm::dot(n, x)});
  double sum = 0;
  for (size_t i = 0; i < seen.size(); ++i) {
    const dvec3 a = seen[i] - x, b = seen[(i + 1) % seen.size()] - x;
    const dvec3 normal = glm::cross(a, b);
    const double sine = glm::length(normal);
    if (sine > 0) sum += glm::dot(n, normal) * (std::atan2(sine, glm::dot(a, b)) / sine);
  }
  // From the front, corners run clockwise as directions.
  return std::clamp(-sum / (2 * kPiExact), 0.0, 1.0);
}

Estimate polygon_exchange(std::span<const dvec3> first, std::span<const dvec3> second) {
  const Polygon from = facing_part(first, second), to = facing_part(second, first);
  if (from.size() < 3 || to.size() < 3) return {};
  const std::vector<Edge> outer = edges_of(from), inner = edges_of(to);
  // In units of their distance logarithms are small: the constant that goes is nothing on a closed contour.
  const double unit =
      std::max(glm::distance(mean_corner(from), mean_corner(to)), std::min(radius(from), radius(to)));
  Estimate sum;
  double terms = 0;
  for (const Edge& b : inner) {
    for (const Edge& a : outer) {
      const double cosine = glm::dot(a.direction, b.direction);
      if (std::abs(cosine) < kPrecise) continue;
      const auto along = [&](double s) {
        return log_distance_to_edge(a.start + s * a.direction, b) - b.length * std::log(unit);
      };
      const Estimate part = integrate(along, 0, a.length, 4 * kPrecise * a.length * b.length);
      sum += {cosine * part.value, std::abs(cosine) * part.error};
      terms += std::abs(cosine * part.value);
    }
  }
  const double scale = 1 / (2 * kPiExact);
  return {std::max(0.0, scale * sum.value), scale * (sum.error + 32 * kPrecise * terms)};
}

}  // namespace goldthread
