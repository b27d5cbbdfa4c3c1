#include "solve/matrix/shape_form_factor.h"

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include "math/polygon_exchange.h"
#include "solve/matrix/shape_rays.h"

namespace goldthread {
namespace {

constexpr double kPiExact = std::numbers::pi;

// A closed curve made of pieces, each with its parameter in [0, 1], that runs as a polygon's outline does:
// counter-clockwise as seen from where it sends to.
struct CurvePiece {
  dvec3 centre{0}, across{0}, up{0};  // an arc: centre + cos a * across + sin a * up
  double start = 0, turn = 0;         // angles; turn 0: the straight line from centre to centre + across

  dvec3 at(double t) const {
    if (turn == 0) return centre + t * across;
    const double a = start + t * turn;
    return centre + std::cos(a) * across + std::sin(a) * up;
  }
  dvec3 slope(double t) const {
    if (turn == 0) return across;
    const double a = start + t * turn;
    return turn * (-std::sin(a) * across + std::cos(a) * up);
  }
};

// The parameters in (0, 1) at which a piece crosses the plane n through x, ascending.
std::vector<double> crossings(const CurvePiece& piece, const dvec3& x, const dvec3& n) {
  std::vector<double> found;
  const auto keep = [&](double t) {
    if (t > 1e-15 && t < 1 - 1e-15) found.push_back(t);
  };
  const double base = glm::dot(piece.centre - x, n);
  if (piece.turn == 0) {
    const double slope = glm::dot(piece.across, n);
    if (slope != 0) keep(-base / slope);
    return found;
  }
  const double c = glm::dot(piece.across, n), s = glm::dot(piece.up, n), size = std::hypot(c, s);
  if (size <= std::abs(base)) return found;
  const double middle = std::atan2(s, c), half = std::acos(-base / size);
  for (const double sign : {-1.0, 1.0})
    for (int round = -2; round <= 2; ++round)
      keep((middle + sign * half + 2 * kPiExact * round - piece.start) / piece.turn);
  std::sort(found.begin(), found.end());
  return found;
}

double great_circle_term(const dvec3& a, const dvec3& b, const dvec3& n) {
  const dvec3 normal = glm::cross(a, b);
  const double sine = glm::length(normal);
  return sine > 0 ? glm::dot(n, normal) * (std::atan2(sine, glm::dot(a, b)) / sine) : 0;
}

// Lambert's contour integral along curves: what is above the horizon of n at x, closed along the horizon.
Estimate curve_form_factor(const dvec3& x, const dvec3& n, std::span<const CurvePiece> curve) {
  Estimate sum;
  std::optional<dvec3> left, first;  // where the curve went below, and where it first came up
  const auto above = [&](const CurvePiece& piece, double from, double to) {
    const auto along = [&](double t) {
      const dvec3 r = piece.at(t) - x;
      return glm::dot(n, glm::cross(r, piece.slope(t))) / glm::dot(r, r);
    };
    sum += integrate(along, from, to, 1e-14);
  };
  for (const CurvePiece& piece : curve) {
    std::vector<double> ends = crossings(piece, x, n);
    ends.insert(ends.begin(), 0.0);
    ends.push_back(1.0);
    for (size_t k = 0; k + 1 < ends.size(); ++k) {
      if (glm::dot(piece.at(0.5 * (ends[k] + ends[k + 1])) - x, n) <= 0) continue;
      const dvec3 start = piece.at(ends[k]) - x, end = piece.at(ends[k + 1]) - x;
      if (!first) first = start;
      if (left) sum.value += great_circle_term(*left, start, n);
      above(piece, ends[k], ends[k + 1]);
      left = end;
    }
  }
  if (!first) return {};
  sum.value += great_circle_term(*left, *first, n);
  return {std::clamp(-sum.value / (2 * kPiExact), 0.0, 1.0), sum.error / (2 * kPiExact) + 1e-15};
}

Estimate to_disc(const dvec3& x, const dvec3& n, const DiscShape& disc) {
  if (glm::dot(x - disc.centre, disc.normal) <= 0) return {};
  const PlaneFrame frame = plane_frame(disc.normal);
  const CurvePiece circle{disc.centre, disc.radius * frame.x, disc.radius * frame.y, 0, 2 * kPiExact};
  return curve_form_factor(x, n, {&circle, 1});
}

// A sphere from without, cut by the horizon or not (Howell's catalogue B-38, B-39).
Estimate to_sphere(const dvec3& x, const dvec3& n, const SphereShape& sphere) {
  const dvec3 to_centre = sphere.centre - x;
  const double h = glm::length(to_centre) / sphere.radius;
  const double cosine = glm::dot(n, to_centre) / glm::length(to_centre);
  if (h * cosine <= -1) return {};
  const double whole = cosine / (h * h);
  if (h * cosine >= 1) return {whole, 1e-15};
  const double root = std::sqrt(std::max(0.0, h * h - 1)),
               sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  const double cut = std::sqrt(std::max(0.0, 1 - h * h * cosine * cosine));
  const double value =
      0.5 - std::asin(std::clamp(root / (h * sine), -1.0, 1.0)) / kPiExact +
      (cosine * std::acos(std::clamp(-root * cosine / sine, -1.0, 1.0)) - root * cut) / (kPiExact * h * h);
  return {std::clamp(value, 0.0, 1.0), 1e-14};
}

// The part of the outside of a cylinder's wall that x can see: between the lines along which it is touched.
Estimate to_cylinder(const dvec3& x, const dvec3& n, const CylinderShape& cylinder) {
  const dvec3 from_base = x - cylinder.base;
  const dvec3 outwards = from_base - glm::dot(from_base, cylinder.axis) * cylinder.axis;
  const double distance = glm::length(outwards);
  if (distance <= cylinder.radius) return {};
  const dvec3 a = outwards / distance, b = glm::cross(cylinder.axis, a);
  const double half = std::acos(cylinder.radius / distance);
  const dvec3 rise = cylinder.height * cylinder.axis;
  const auto rim = [&](double angle) {
    return cylinder.base + cylinder.radius * (std::cos(angle) * a + std::sin(angle) * b);
  };
  // Seen from outside: right along the bottom, up, left along the top, down.
  const std::array<CurvePiece, 4> outline{
      CurvePiece{cylinder.base, cylinder.radius * a, cylinder.radius * b, -half, 2 * half},
      CurvePiece{rim(half), rise, dvec3(0), 0, 0},
      CurvePiece{cylinder.base + rise, cylinder.radius * a, cylinder.radius * b, half, -2 * half},
      CurvePiece{rim(-half) + rise, -rise, dvec3(0), 0, 0}};
  return curve_form_factor(x, n, outline);
}

// A cap from within the sphere: as much as its rim spans, if x lies before the rim's plane.
Estimate to_cap(const dvec3& x, const dvec3& n, const CapShape& cap) {
  const dvec3 rim_centre = cap.centre + cap.radius * std::cos(cap.half_angle) * cap.axis;
  return to_disc(x, n, {rim_centre, -cap.axis, cap.radius * std::sin(cap.half_angle)});
}

using PointFactor = std::function<Estimate(const dvec3& x, const dvec3& n)>;

Error unknown(const std::string& message) {
  return {ErrorCode::kBadInput, message, {}, {}, "give polygons instead"};
}

// The form factor of `to` at points; the error says why there is none.
Result<PointFactor> point_factor(const Shape& to, std::span<const Polygon> occluders) {
  if (const auto* polygon = std::get_if<Polygon>(&to))
    return PointFactor([polygon, occluders](const dvec3& x, const dvec3& n) {
      const FormFactor f = point_to_polygon(x, n, *polygon, occluders);
      return Estimate{f.value, f.error_bound};
    });
  if (const auto* disc = std::get_if<DiscShape>(&to))
    return PointFactor([disc](const dvec3& x, const dvec3& n) { return to_disc(x, n, *disc); });
  if (const auto* cap = std::get_if<CapShape>(&to))
    return PointFactor([cap](const dvec3& x, const dvec3& n) { return to_cap(x, n, *cap); });
  if (const auto* sphere = std::get_if<SphereShape>(&to)) {
    // From within, all that a point sees.
    if (sphere->inside) return PointFactor([](const dvec3&, const dvec3&) { return Estimate{1, 0}; });
    return PointFactor([sphere](const dvec3& x, const dvec3& n) { return to_sphere(x, n, *sphere); });
  }
  if (const auto* cylinder = std::get_if<CylinderShape>(&to); cylinder && !cylinder->inside)
    return PointFactor([cylinder](const dvec3& x, const dvec3& n) { return to_cylinder(x, n, *cylinder); });
  return unknown("the inside of a cylinder is known as a source only");
}

Estimate integrate_surface(const ShapeSurface& surface, const PointFactor& factor, double tolerance) {
  double inner_error = 0;
  const auto row = [&](double u) {
    const Estimate sum = integrate(
        [&](double v) {
          const SurfacePlace place = surface(u, v);
          return place.area * factor(place.position, place.normal).value;
        },
        0, 1, 0.3 * tolerance, 12);
    inner_error = std::max(inner_error, sum.error);
    return sum.value;
  };
  Estimate sum = integrate(row, 0, 1, tolerance, 12);
  sum.error += inner_error;
  return sum;
}

bool is_convex_body(const Shape& shape) {
  const auto* sphere = std::get_if<SphereShape>(&shape);
  const auto* cylinder = std::get_if<CylinderShape>(&shape);
  return (sphere && !sphere->inside) || (cylinder && !cylinder->inside);
}

bool is_flat(const Shape& shape) {
  return std::holds_alternative<PointShape>(shape) || std::holds_alternative<Polygon>(shape);
}

bool is_cylinder_inside(const Shape& shape) {
  const auto* cylinder = std::get_if<CylinderShape>(&shape);
  return cylinder && cylinder->inside;
}

Estimate integrate_polygon(const Polygon& polygon, const PointFactor& factor, const CubatureLimits& limits) {
  std::vector<std::array<dvec3, 3>> triangles;
  for (const UVec3& t : triangulate(polygon)) triangles.push_back({polygon[t.x], polygon[t.y], polygon[t.z]});
  const dvec3 n = plane_of(polygon).normal;
  return integrate_triangles([&](const dvec3& x) { return factor(x, n).value; }, triangles, limits);
}

// The mean over `from` of what its points send to `to`. A convex body hides of its surroundings what lies
// below its points' horizons, and nothing else.
Result<FormFactor> mean_over(const Shape& from, const Shape& to, const CubatureLimits& limits) {
  const Result<PointFactor> factor = point_factor(to, {});
  if (!factor) return factor.error();
  const double whole = shape_area(from);
  if (const auto* polygon = std::get_if<Polygon>(&from)) {
    const Estimate exchange = integrate_polygon(*polygon, *factor, limits);
    return FormFactor{std::clamp(exchange.value / whole, 0.0, 1.0), exchange.error / whole,
                      FormFactorMethod::kShape};
  }
  const Estimate exchange = integrate_surface(surface_of(from), *factor, 1e-3 * limits.relative * whole);
  return FormFactor{std::clamp(exchange.value / whole, 0.0, 1.0), exchange.error / whole + 1e-14,
                    FormFactorMethod::kShape};
}

}  // namespace

Result<FormFactor> shape_form_factor(const Shape& from, const Shape& to, std::span<const Polygon> occluders,
                                     const CubatureLimits& limits, const ShapeRayLimits& ray_limits) {
  if (std::holds_alternative<PointShape>(to)) return unknown("nothing can be sent to a point");
  if (!occluders.empty() && !(is_flat(from) && is_flat(to))) {
    // Most of the tolerance is for the rays.
    CubatureLimits open_limits = limits;
    open_limits.relative = std::min(limits.relative, 0.1 * ray_limits.relative);
    const Result<FormFactor> open = shape_form_factor(from, to, {}, open_limits);
    return open && open->value > 0 ? seen_by_rays(*open, from, to, occluders, ray_limits) : open;
  }
  if (const auto* point = std::get_if<PointShape>(&from)) {
    const Result<PointFactor> factor = point_factor(to, occluders);
    if (!factor) return factor.error();
    const Estimate f = (*factor)(point->position, point->normal);
    return FormFactor{f.value, f.error + 1e-15,
                      f.value > 0 ? FormFactorMethod::kPoint : FormFactorMethod::kFacesAway};
  }
  const auto *first = std::get_if<Polygon>(&from), *second = std::get_if<Polygon>(&to);
  if (first && second) return polygon_form_factor(*first, *second, occluders, limits);
  if (is_cylinder_inside(from) && is_cylinder_inside(to)) {
    const auto &tube = std::get<CylinderShape>(from), &other = std::get<CylinderShape>(to);
    if (tube.base != other.base || tube.axis != other.axis || tube.radius != other.radius ||
        tube.height != other.height)
      return unknown("the insides of two cylinders");
    // An empty tube: what does not leave by its ends (the discs' F, Howell C-41, by reciprocity).
    const double x = tube.height / (2 * tube.radius);
    return FormFactor{1 + x - std::sqrt(1 + x * x), 1e-15 * (1 + x), FormFactorMethod::kShape};
  }
  // The other way round, by A1 F12 = A2 F21, where that has no horizons in it or is the only one known.
  if (is_cylinder_inside(to) || (is_convex_body(from) && !is_convex_body(to))) {
    Result<FormFactor> back = mean_over(to, from, limits);
    if (!back) return back;
    const double scale = shape_area(to) / shape_area(from);
    return FormFactor{std::clamp(back->value * scale, 0.0, 1.0), back->error_bound * scale, back->method};
  }
  return mean_over(from, to, limits);
}

}  // namespace goldthread
