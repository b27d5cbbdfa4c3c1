#include "math/far_form_factor.h"

#include <array>
#include <limits>

#include "math/polygon_exchange.h"

namespace goldthread {
namespace {

constexpr double kPiExact = std::numbers::pi;
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Of the Taylor series of K along any direction, all from order k on, over (|delta|/D)^k: the first of the
// header's two remainders.
double rest(int k, double ratio) {
  const double left = 1 - ratio;
  return (k + 1 - k * ratio) / (left * left);
}

// The second: of a plane, over the cosine at the source too.
double plane_rest(int k, double ratio) {
  const double left = 1 - ratio;
  return (0.5 * (k + 1) * (k + 2) - k * (k + 2) * ratio + 0.5 * k * (k + 1) * ratio * ratio) /
         (left * left * left);
}

// A piece by ratios: what all bounds are made of, without the common A/(pi D^2).
struct View {
  double scale = 0;   // A/(pi D^2)
  double ratio = 0;   // R
  double moment = 0;  // E|delta|^2/D^2
  double cosine = 0;  // t.e of a flat piece
  bool flat = false;
  bool symmetric = false;
  double deviation = 0;  // s/D^2

  double rest_of(int k) const {
    return flat ? std::min(rest(k, ratio), cosine * plane_rest(k, ratio)) : rest(k, ratio);
  }
  // Beyond the second order, with E|delta|^k <= r^(k - 2) E|delta|^2.
  double third() const { return (symmetric ? rest_of(4) * ratio * ratio : rest_of(3) * ratio) * moment; }
  double across() const { return std::max(0.0, 1 - cosine * cosine); }
  double isotropic() const { return 4 * cosine * std::sqrt(3 * across() * across() - 3 * across() + 1); }
  double anisotropic() const { return 4 * cosine * std::sqrt(across() * (1 + 3 * across())); }
};

View view_of(const FarPiece& piece) {
  View view;
  const double squared = glm::dot(piece.to_centroid, piece.to_centroid), distance = std::sqrt(squared);
  view.scale = piece.area / (kPiExact * squared);
  view.ratio = piece.radius / distance;
  view.moment = piece.second_moment / squared;
  view.flat = piece.flat;
  view.symmetric = piece.symmetric;
  view.cosine = std::clamp(
      -glm::dot(piece.to_centroid, piece.summed_normal) / (distance * glm::length(piece.summed_normal)), 0.0,
      1.0);
  view.deviation = piece.deviation / squared;
  return view;
}

bool is_within(const FarPiece& piece) {
  return !(glm::dot(piece.to_centroid, piece.to_centroid) > piece.radius * piece.radius);
}

// What the extent of a piece does to K where either factor may change its sign within it.
double extent_error(const FarPiece& piece, const View& view, const dvec3& n) {
  const double deviation = std::sqrt(view.moment);
  const double toward = std::max(0.0, glm::dot(n, glm::normalize(piece.to_centroid)));
  const double left = 1 - view.ratio, cubed = left * left * left;
  double slope = (1 - cubed) / (cubed * view.ratio);
  if (view.flat) slope = std::min(slope, view.cosine * (1 - cubed * left) / (cubed * left * view.ratio));
  const double by_factors =
      (view.flat ? 0.5 * view.cosine : 1) * deviation + slope * (toward * deviation + view.moment);
  return view.scale * std::min(view.rest_of(1) * deviation, by_factors);
}

double angle_between(const dvec3& a, const dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

// Cosines of the least and the largest angle that leave both within their range.
double largest_cosine(double angle) {
  return std::cos(std::max(0.0, angle));
}
double least_cosine(double angle) {
  return std::cos(std::min(kPiExact, angle));
}

// x in a box's own frame, in which it reaches from -half to half.
struct BoxFrame {
  dvec3 half, x;
  std::array<dvec3, 3> axes;

  BoxFrame(const dvec3& place, const OrientedBox& box) : half(box.half) {
    for (int i = 0; i < 3; ++i) axes[static_cast<size_t>(i)] = dvec3(box.axes[i]);
    x = local(place - dvec3(box.centre));
  }
  dvec3 local(const dvec3& v) const {
    return {glm::dot(v, axes[0]), glm::dot(v, axes[1]), glm::dot(v, axes[2])};
  }
  dvec3 corner(int i) const {
    return half * dvec3((i & 1) != 0 ? 1 : -1, (i & 2) != 0 ? 1 : -1, (i & 4) != 0 ? 1 : -1);
  }
  bool holds_x() const { return glm::all(glm::lessThanEqual(glm::abs(x), half)); }
};

}  // namespace

double largest_deviation(double area, double second_moment) {
  const double half = 0.5 * second_moment, disc = area / (4 * kPiExact);
  return std::sqrt(std::max(0.0, half * half - disc * disc));
}

FarPiece far_piece_of(const dvec3& x, std::span<const DoubleTriangle> triangles) {
  FarPiece piece;
  dvec3 first_moment(0);  // about x
  for (const auto& [a, b, c] : triangles) {
    const dvec3 normal = 0.5 * glm::cross(b - a, c - a);
    const double area = glm::length(normal);
    piece.summed_normal += normal;
    piece.area += area;
    first_moment += area * ((a + b + c) / 3.0 - x);
  }
  piece.to_centroid = first_moment / piece.area;
  glm::dmat3 covariance(0);
  for (const auto& triangle : triangles) {
    const auto& [a, b, c] = triangle;
    const double share = 0.5 * glm::length(glm::cross(b - a, c - a)) / piece.area;
    const dvec3 away = (a + b + c) / 3.0 - x - piece.to_centroid;
    covariance += share * glm::outerProduct(away, away);
    for (const dvec3& edge : {b - a, c - b, a - c}) covariance += share / 36 * glm::outerProduct(edge, edge);
    for (const dvec3& corner : triangle)
      piece.radius = std::max(piece.radius, glm::length(corner - x - piece.to_centroid));
  }
  piece.second_moment = covariance[0][0] + covariance[1][1] + covariance[2][2];
  // Unit normals whose mean is this close to one are within 1e-6 of each other.
  const double summed = glm::length(piece.summed_normal);
  piece.flat = summed > (1 - 1e-12) * piece.area;
  if (!(summed > 0)) return piece;
  const dvec3 normal = piece.summed_normal / summed;
  for (const auto& triangle : triangles)
    for (const dvec3& corner : triangle)
      piece.flat =
          piece.flat && std::abs(glm::dot(normal, corner - x - piece.to_centroid)) <= 1e-9 * piece.radius;
  // What is left without the part that is the same in all directions of the plane: +s and -s.
  const glm::dmat3 uneven =
      covariance - 0.5 * piece.second_moment * (glm::dmat3(1) - glm::outerProduct(normal, normal));
  double squares = 0;
  for (int i = 0; i < 3; ++i) squares += glm::dot(uneven[i], uneven[i]);
  piece.deviation = std::sqrt(0.5 * squares);
  return piece;
}

FarPiece far_piece_of_disc(const dvec3& x, const dvec3& centre, const dvec3& unit_normal, double radius) {
  FarPiece piece;
  piece.to_centroid = centre - x;
  piece.area = kPiExact * radius * radius;
  piece.summed_normal = piece.area * unit_normal;
  piece.radius = radius;
  piece.second_moment = 0.5 * radius * radius;
  piece.flat = piece.symmetric = true;
  return piece;
}

double dipole_error_bound(const FarPiece& piece) {
  if (is_within(piece)) return kInfinite;
  const View view = view_of(piece);
  if (view.flat) {
    const double by_terms = 0.5 * view.moment * view.isotropic() + view.deviation * view.anisotropic();
    return view.scale * std::min(by_terms + view.third(), view.rest_of(2) * view.moment);
  }
  const double mean_normal = glm::length(piece.summed_normal) / piece.area;
  const double spread = std::sqrt(std::max(0.0, 1 - mean_normal * mean_normal));
  return view.scale * (2 * std::sqrt(view.moment) * spread + view.rest_of(2) * view.moment);
}

double flat_dipole_error_bound(const FarPiece& piece, const dvec3& n, double rho_squared) {
  if (is_within(piece)) return kInfinite;
  const View view = view_of(piece);
  const double squared = glm::dot(piece.to_centroid, piece.to_centroid);
  const double missing = std::abs(0.5 * piece.second_moment - 0.25 * rho_squared) / squared;
  const double bound =
      view.scale * (missing * view.isotropic() + view.deviation * view.anisotropic() + view.third());
  // As flat_dipole_form_factor has it.
  const double toward = glm::dot(n, piece.to_centroid) / std::sqrt(squared);
  const double normals = glm::dot(n, piece.summed_normal) / piece.area;
  const double bend = 1 - 3 * view.cosine * view.cosine - normals * view.cosine / toward;
  const bool kept = std::abs(rho_squared / squared * bend) <= 0.5;
  return kept ? bound : std::max(bound, dipole_error_bound(piece));
}

double rounded_dipole_error_bound(const FarPiece& piece, const dvec3& n) {
  if (is_within(piece)) return kInfinite;
  const double height = glm::dot(piece.to_centroid, n);
  if (height <= -piece.radius) return 0;
  const View view = view_of(piece);
  const double squared = glm::dot(piece.to_centroid, piece.to_centroid);
  const double summed = glm::length(piece.summed_normal);
  const double net = std::abs(glm::dot(piece.to_centroid, piece.summed_normal)) / std::sqrt(squared);
  const double cancelled = std::max(0.0, piece.area - summed);
  const double most = std::sqrt(std::max(net * net, piece.area * piece.area - summed * summed + net * net));
  const double spread = 0.5 * std::max(0.5 * cancelled, most - net - 0.5 * cancelled);
  View extent = view;
  extent.flat = false;  // not all of it need turn its front to the receiver
  return extent_error(piece, extent, n) +
         std::max(0.0, height) * spread / (kPiExact * squared * std::sqrt(squared));
}

double cut_dipole_error_bound(const FarPiece& piece, const dvec3& n) {
  if (is_within(piece)) return kInfinite;
  return extent_error(piece, view_of(piece), n);
}

FormFactorBounds box_form_factor_bounds(const dvec3& x, const dvec3& n, const OrientedBox& box, double area,
                                        const dvec3& axis, double cone_cosine) {
  const BoxFrame frame(x, box);
  if (frame.holds_x()) return {0, kInfinite};
  const dvec3 nearest = glm::clamp(frame.x, -frame.half, frame.half) - frame.x;
  dvec3 farthest(0);
  // Seen from x all of the box is within `opening` of its centre: corners span the cone of its directions,
  // and a round cone of less than a right angle is convex.
  double opening = 0;
  for (int i = 0; i < 8; ++i) {
    const dvec3 to_corner = frame.corner(i) - frame.x;
    opening = std::max(opening, angle_between(to_corner, -frame.x));
    if (glm::dot(to_corner, to_corner) > glm::dot(farthest, farthest)) farthest = to_corner;
  }
  if (opening >= 0.5 * kPiExact) opening = kPiExact;
  const double cone = std::acos(std::clamp(cone_cosine, -1.0, 1.0));
  const double at_receiver = angle_between(frame.local(n), -frame.x);
  const double at_source = angle_between(frame.local(axis), frame.x);
  FormFactorBounds bounds;
  bounds.high = area * std::max(0.0, largest_cosine(at_receiver - opening)) *
                std::max(0.0, largest_cosine(at_source - opening - cone)) /
                (kPiExact * glm::dot(nearest, nearest));
  bounds.low = area * std::max(0.0, least_cosine(at_receiver + opening)) *
               std::max(0.0, least_cosine(at_source + opening + cone)) /
               (kPiExact * glm::dot(farthest, farthest));
  return bounds;
}

double box_form_factor(const dvec3& x, const dvec3& n, const OrientedBox& box) {
  const BoxFrame frame(x, box);
  if (frame.holds_x()) return 1;
  const dvec3 normal = frame.local(n);
  double sum = 0;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(frame.x[axis]) <= frame.half[axis]) continue;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    dvec3 across(0), up(0), centre(0);
    centre[axis] = std::copysign(frame.half[axis], frame.x[axis]);
    across[u] = std::copysign(frame.half[u], frame.x[axis]);  // counter-clockwise from outside
    up[v] = frame.half[v];
    const std::array<dvec3, 4> face{centre - across - up, centre + across - up, centre + across + up,
                                    centre - across + up};
    sum += point_form_factor(frame.x, normal, face);
  }
  return std::min(1.0, sum);
}

}  // namespace goldthread
