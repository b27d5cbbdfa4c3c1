#include "solve/matrix/shape_rays.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/rng.h"
#include "math/polygon_exchange.h"
#include "solve/matrix/shape_surface.h"
#include "visibility/ray_caster.h"

namespace goldthread {
namespace {

constexpr double kPiExact = std::numbers::pi, kMiss = std::numeric_limits<double>::infinity();
constexpr size_t kSequences = 16;
constexpr uint64_t kFirstRays = 1024;  // of each sequence

struct Ball {
  dvec3 centre{0};
  double radius = 0;
};

struct BallOf {
  Ball operator()(const PointShape& p) const { return {p.position, 0}; }
  Ball operator()(const Polygon& p) const { return {mean_corner(p), radius(p)}; }
  Ball operator()(const DiscShape& d) const { return {d.centre, d.radius}; }
  Ball operator()(const SphereShape& s) const { return {s.centre, s.radius}; }
  Ball operator()(const CylinderShape& c) const {
    return {c.base + 0.5 * c.height * c.axis, std::hypot(c.radius, 0.5 * c.height)};
  }
  Ball operator()(const CapShape& c) const { return {c.centre, c.radius}; }
};

/// The two distances at which a line meets a sphere or an endless cylinder: roots of a t² + 2 b t + c.
struct Roots {
  double near = kMiss, far = kMiss;
  Roots(double a, double b, double c) {
    const double squared = b * b - a * c;
    if (!(a > 0) || !(squared > 0)) return;
    // Without the cancellation of -b and the root (Press et al., Numerical Recipes, 5.6).
    const double q = -(b + std::copysign(std::sqrt(squared), b));
    near = std::min(q / a, c / q);
    far = std::max(q / a, c / q);
  }
};

/// How far along the unit `way` from x the sending side of a shape is first met; kMiss where it is not.
struct DistanceTo {
  const dvec3 &x, &way;

  double plane(const dvec3& through, const dvec3& normal) const {
    const double down = -glm::dot(way, normal);
    return down > 0 ? glm::dot(x - through, normal) / down : kMiss;
  }
  Roots sphere(const dvec3& centre, double radius) const {
    const dvec3 d = x - centre;
    return {1, glm::dot(d, way), glm::dot(d, d) - radius * radius};
  }
  double operator()(const PointShape&) const { return kMiss; }
  double operator()(const Polygon& polygon) const {
    const dvec3 normal = plane_of(polygon).normal;
    const double t = plane(polygon[0], normal);
    if (!(t > 0) || t == kMiss) return kMiss;
    // Turns of the outline about the place, which also tell it where a polygon is not convex.
    const dvec3 p = x + t * way;
    double turn = 0;
    for (size_t k = 0; k < polygon.size(); ++k) {
      const dvec3 a = polygon[k] - p, b = polygon[(k + 1) % polygon.size()] - p;
      turn += std::atan2(glm::dot(normal, glm::cross(a, b)), glm::dot(a, b));
    }
    return turn > kPiExact ? t : kMiss;
  }
  double operator()(const DiscShape& disc) const {
    const double t = plane(disc.centre, disc.normal);
    return t > 0 && t != kMiss && glm::length(x + t * way - disc.centre) <= disc.radius ? t : kMiss;
  }
  double operator()(const SphereShape& s) const {
    const Roots roots = sphere(s.centre, s.radius);
    const double t = s.inside ? roots.far : roots.near;
    return t > 0 ? t : kMiss;
  }
  double operator()(const CylinderShape& c) const {
    const dvec3 d = x - c.base, across = way - glm::dot(way, c.axis) * c.axis,
                aside = d - glm::dot(d, c.axis) * c.axis;
    const Roots roots(glm::dot(across, across), glm::dot(aside, across),
                      glm::dot(aside, aside) - c.radius * c.radius);
    const double t = c.inside ? roots.far : roots.near;
    if (!(t > 0) || t == kMiss) return kMiss;
    const double height = glm::dot(d + t * way, c.axis);
    return height >= 0 && height <= c.height ? t : kMiss;
  }
  double operator()(const CapShape& cap) const {
    const Roots roots = sphere(cap.centre, cap.radius);
    const auto on_cap = [&](double t) {
      return glm::dot(x + t * way - cap.centre, cap.axis) >= cap.radius * std::cos(cap.half_angle);
    };
    if (!(roots.far > 0) || roots.far == kMiss || !on_cap(roots.far)) return kMiss;
    // From outside the cap's own back may be first.
    return roots.near > 1e-9 * cap.radius && on_cap(roots.near) ? kMiss : roots.far;
  }
};

/// Where rays start, what they are for and what is in their way.
class Rays {
 public:
  Rays(const Shape& from, const Shape& to, std::span<const Polygon> occluders)
      : target_(to), start_(surface_of(from)), ball_(std::visit(BallOf(), to)), caster_(build(occluders)) {
    const Ball around = std::visit(BallOf(), from);
    const auto reach = [](const Ball& b) { return glm::length(b.centre) + b.radius; };
    margin_ = std::max(static_cast<double>(caster_.epsilon()), 1e-6 * std::max(reach(around), reach(ball_)));
  }

  struct Sums {
    double open = 0, seen = 0;
    uint64_t met = 0, got_through = 0;  // rays
  };

  /// Points first to last of a sequence.
  void cast(uint64_t first, uint64_t last, uint32_t seed, Sums& sums) const {
    // Roberts' R4: powers of the reciprocal of the root of x^5 = x + 1, shifted (Cranley and Patterson).
    constexpr double kRoot = 1.1673039782614186843;
    std::array<double, 4> step{}, shift{};
    double power = 1;
    for (uint32_t k = 0; k < 4; ++k) {
      step[k] = power /= kRoot;
      shift[k] = (hash(seed, 2 * k) + hash(seed, 2 * k + 1) * 0x1p-32) * 0x1p-32;
    }
    for (uint64_t i = first; i < last; ++i) {
      std::array<double, 4> p{};
      for (size_t k = 0; k < 4; ++k) {
        const double at = shift[k] + static_cast<double>(i + 1) * step[k];
        p[k] = at - std::floor(at);
      }
      cast_one(p, sums);
    }
  }

 private:
  static RayCaster build(std::span<const Polygon> occluders) {
    std::vector<vec3> positions;
    std::vector<UVec3> triangles;
    for (const Polygon& polygon : occluders) {
      const auto offset = static_cast<uint32_t>(positions.size());
      for (const dvec3& p : polygon) positions.emplace_back(p);
      for (const UVec3& t : triangulate(polygon)) triangles.push_back(t + offset);
    }
    return {positions, triangles};
  }

  void cast_one(const std::array<double, 4>& p, Sums& sums) const {
    const SurfacePlace place = start_(p[0], p[1]);
    const dvec3 towards = ball_.centre - place.position;
    const double distance = glm::length(towards), turn = 2 * kPiExact * p[3];
    const auto direction = [&](const dvec3& axis, double rise) {
      const PlaneFrame frame = plane_frame(axis);
      const double aside = std::sqrt(std::max(0.0, 1 - rise * rise));
      return aside * (std::cos(turn) * frame.x + std::sin(turn) * frame.y) + rise * axis;
    };
    dvec3 way;
    double weight = place.area;
    if (distance > 1.0001 * ball_.radius) {  // evenly within the cone of the target's ball
      const double sine = ball_.radius / distance, cosine = std::sqrt(1 - sine * sine);
      const double spread = sine * sine / (1 + cosine);  // 1 - cosine
      way = direction(towards / distance, 1 - p[2] * spread);
      weight *= 2 * spread * std::max(0.0, glm::dot(way, place.normal));
    } else {
      way = direction(place.normal, std::sqrt(1 - p[2]));
    }
    if (!(weight > 0)) return;
    const double length = std::visit(DistanceTo{place.position, way}, target_);
    if (length == kMiss) return;
    sums.open += weight;
    ++sums.met;
    Ray ray{vec3(place.position), vec3(way), static_cast<float>(margin_),
            static_cast<float>(length - margin_)};
    if (ray.far > ray.near && caster_.transmittance(ray) <= 0) return;
    sums.seen += weight;
    ++sums.got_through;
  }

  const Shape& target_;
  ShapeSurface start_;
  Ball ball_;
  RayCaster caster_;
  double margin_ = 0;  // metres at both ends of a ray in which nothing blocks
};

/// A cap hides part of itself from what lies outside it, which is told where it is met; and of two shapes the
/// smaller one sends, for more of its rays meet the other.
bool starts_at_second(const Shape& from, const Shape& to) {
  if (std::holds_alternative<PointShape>(from)) return false;
  const bool first_cap = std::holds_alternative<CapShape>(from),
             second_cap = std::holds_alternative<CapShape>(to);
  return first_cap != second_cap ? first_cap : shape_area(to) < shape_area(from);
}

struct Share {
  double mean = 0, standard_error = 0, doubt = 0;
};

Share share_of(std::span<const Rays::Sums> sums) {
  Share share;
  uint64_t met = 0, got_through = 0;
  std::array<double, kSequences> shares{};
  for (size_t b = 0; b < kSequences; ++b) {
    shares[b] = sums[b].open > 0 ? sums[b].seen / sums[b].open : 0;
    share.mean += shares[b] / kSequences;
    met += sums[b].met;
    got_through += sums[b].got_through;
  }
  double squares = 0;
  for (const double one : shares) squares += (one - share.mean) * (one - share.mean);
  share.standard_error = std::sqrt(squares / (kSequences * (kSequences - 1)));
  // Of N rays that all say the same, another might be three in N (Hanley and Lippman-Hand 1983).
  const bool unanimous = got_through == 0 || got_through == met;
  share.doubt = unanimous ? 3 / static_cast<double>(std::max<uint64_t>(met, 3)) : 2 * share.standard_error;
  return share;
}

}  // namespace

FormFactor seen_by_rays(const FormFactor& open, const Shape& from, const Shape& to,
                        std::span<const Polygon> occluders, const ShapeRayLimits& limits) {
  const bool turned = starts_at_second(from, to);
  const Rays rays(turned ? to : from, turned ? from : to, occluders);
  std::array<Rays::Sums, kSequences> sums{};
  // What is hidden from all rays is held against all that there might be.
  const double open_error = open.error_bound / open.value;
  const auto wanted = [&](const Share& s) {
    return s.mean > 0 ? (limits.relative - open_error) * s.mean : limits.relative;
  };
  Share share;
  uint64_t done = 0;
  do {
    const uint64_t next = std::max(kFirstRays, 2 * done);
    parallel_for(kSequences, [&](size_t b) {
      rays.cast(done, next, hash(limits.seed, static_cast<uint32_t>(b)), sums[b]);
    });
    done = next;
    share = share_of(sums);
  } while (share.doubt > wanted(share) && 2 * done * kSequences <= limits.most_rays);
  FormFactor seen;
  seen.value = open.value * share.mean;
  seen.standard_error = open.value * share.standard_error;
  seen.error_bound = open.value * share.doubt + open.error_bound * share.mean;
  seen.method = FormFactorMethod::kRays;
  return seen;
}

}  // namespace goldthread
