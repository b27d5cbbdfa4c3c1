#include "math/polygon_exchange.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace goldthread {
namespace {

constexpr double kPrecise = std::numeric_limits<double>::epsilon();
constexpr double kTouching = 1e-3;  // nearer, in lengths of an edge, another makes its integrand bend
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

// Integral of ln(|to_p - q| / unit) over all q on the edge, `to_p` from its start. It is exact to rounding of
// the edge's length: far from a short edge the two ends' antiderivatives, u ln r - u + h atan(u / h), are
// large and nearly the same, and what they differ by is written out.
double log_distance_to_edge(const dvec3& to_p, const Edge& edge, double unit) {
  const double foot = glm::dot(to_p, edge.direction);
  const double h = glm::length(to_p - foot * edge.direction), hh = h * h;
  const double low = -foot, high = edge.length - foot;                                    // u at the ends
  const double near = low * low + hh, far = high * high + hh, scale = 1 / (unit * unit);  // r²
  const double angle = h * std::atan2(h * edge.length, hh + low * high);
  if (std::min(near, far) <= edge.length * edge.length) {
    const auto term = [&](double u, double squared) {
      return squared > 0 ? 0.5 * u * std::log(squared * scale) : 0.0;
    };
    return term(high, far) - term(low, near) + angle - edge.length;
  }
  const double middle = 0.5 * (low + high);
  return 0.25 * edge.length * std::log(near * scale * far * scale) +
         0.5 * middle * std::log1p(2 * edge.length * middle / near) + angle - edge.length;
}

// The double integral of ln(distance / unit) over both edges: over `b` in closed form, over `a` by
// quadrature.
Estimate edge_pair_integral(const Edge& a, const Edge& b, double cosine, double unit) {
  const dvec3 between = a.start - b.start;
  const auto along = [&](double s) { return log_distance_to_edge(between + s * a.direction, b, unit); };
  // Where `a` meets an end of `b`, or its inside, there is a kink. Inside an interval both rules may err by
  // the same by chance; at its end they do not.
  std::array<double, 5> cuts{0, a.length, a.length, a.length, a.length};
  size_t count = 1;
  const auto cut_near = [&](double on_b) {
    const dvec3 to = on_b * b.direction - between;
    const double s = glm::dot(to, a.direction);
    if (s > 0 && s < a.length && glm::distance(to, s * a.direction) < kTouching * a.length) cuts[count++] = s;
  };
  cut_near(0);
  cut_near(b.length);
  const double nearest =
      glm::dot(between, b.direction - cosine * a.direction) / std::max(kPrecise, 1 - cosine * cosine);
  if (nearest > 0 && nearest < b.length) cut_near(nearest);
  std::sort(cuts.begin(), cuts.end());
  Estimate sum;
  for (size_t k = 0; k < count; ++k)
    sum += integrate(along, cuts[k], cuts[k + 1], 4 * kPrecise * a.length * b.length);
  return sum;
}

Polygon relative_to(const dvec3& origin, std::span<const dvec3> polygon) {
  Polygon out(polygon.begin(), polygon.end());
  for (dvec3& p : out) p -= origin;
  return out;
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
  // Coordinates that are large beside the polygons would cost digits.
  const dvec3 origin = mean_corner(first);
  const Polygon near = relative_to(origin, first), other = relative_to(origin, second);
  const Polygon from = facing_part(near, other), to = facing_part(other, near);
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
      const Estimate part = edge_pair_integral(a, b, cosine, unit);
      sum += {cosine * part.value, std::abs(cosine) * part.error};
      // The parts may cancel within themselves as well: their sizes are those of the edges.
      terms += std::abs(cosine) * (std::abs(part.value) + 0.125 * a.length * b.length);
    }
  }
  const double scale = 1 / (2 * kPiExact);
  return {std::max(0.0, scale * sum.value), scale * (sum.error + 32 * kPrecise * terms)};
}

}  // namespace goldthread
