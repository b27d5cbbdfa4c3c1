#include "solve/matrix/shape_surface.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "math/polygon_exchange.h"
#include "math/quadrature.h"

namespace goldthread {
namespace {

constexpr double kPiExact = std::numbers::pi;

ShapeSurface surface(const DiscShape& disc) {
  const PlaneFrame frame = plane_frame(disc.normal);
  return [disc, frame](double u, double v) {
    const double a = 2 * kPiExact * v;
    const dvec3 out = std::cos(a) * frame.x + std::sin(a) * frame.y;
    return SurfacePlace{disc.centre + u * disc.radius * out, disc.normal,
                        2 * kPiExact * u * disc.radius * disc.radius};
  };
}

ShapeSurface surface(const SphereShape& sphere) {
  return [sphere](double u, double v) {
    const double z = 2 * u - 1, r = std::sqrt(std::max(0.0, 1 - z * z)), a = 2 * kPiExact * v;
    const dvec3 out(r * std::cos(a), r * std::sin(a), z);
    return SurfacePlace{sphere.centre + sphere.radius * out, sphere.inside ? -out : out,
                        4 * kPiExact * sphere.radius * sphere.radius};
  };
}

ShapeSurface surface(const CylinderShape& cylinder) {
  const PlaneFrame frame = plane_frame(cylinder.axis);
  return [cylinder, frame](double u, double v) {
    const double a = 2 * kPiExact * v;
    const dvec3 out = std::cos(a) * frame.x + std::sin(a) * frame.y;
    return SurfacePlace{cylinder.base + cylinder.radius * out + u * cylinder.height * cylinder.axis,
                        cylinder.inside ? -out : out, 2 * kPiExact * cylinder.radius * cylinder.height};
  };
}

ShapeSurface surface(const CapShape& cap) {
  const PlaneFrame frame = plane_frame(cap.axis);
  return [cap, frame](double u, double v) {
    const double rise = 1 - std::cos(cap.half_angle), z = 1 - u * rise,
                 r = std::sqrt(std::max(0.0, 1 - z * z));
    const double a = 2 * kPiExact * v;
    const dvec3 out = r * (std::cos(a) * frame.x + std::sin(a) * frame.y) + z * cap.axis;
    return SurfacePlace{cap.centre + cap.radius * out, -out, 2 * kPiExact * cap.radius * cap.radius * rise};
  };
}

ShapeSurface surface(const PointShape& point) {
  return [point](double, double) { return SurfacePlace{point.position, point.normal, 1}; };
}

ShapeSurface surface(const Polygon& polygon) {
  std::vector<std::array<dvec3, 3>> triangles;
  std::vector<double> up_to;
  double whole = 0;
  for (const UVec3& t : triangulate(polygon)) {
    triangles.push_back({polygon[t.x], polygon[t.y], polygon[t.z]});
    up_to.push_back(whole += triangle_area(triangles.back()));
  }
  return [triangles, up_to, whole, normal = plane_of(polygon).normal](double u, double v) {
    size_t t = 0;
    while (t + 1 < up_to.size() && u * whole > up_to[t]) ++t;
    const double before = t > 0 ? up_to[t - 1] : 0, width = up_to[t] - before;
    const double within = std::sqrt(std::clamp(width > 0 ? (u * whole - before) / width : 0.5, 0.0, 1.0));
    const auto& [a, b, c] = triangles[t];
    return SurfacePlace{(1 - within) * a + within * ((1 - v) * b + v * c), normal, whole};
  };
}

struct AreaOf {
  double operator()(const PointShape&) const { return 0; }
  double operator()(const Polygon& p) const { return area(p); }
  double operator()(const DiscShape& d) const { return kPiExact * d.radius * d.radius; }
  double operator()(const SphereShape& s) const { return 4 * kPiExact * s.radius * s.radius; }
  double operator()(const CylinderShape& c) const { return 2 * kPiExact * c.radius * c.height; }
  double operator()(const CapShape& c) const {
    return 2 * kPiExact * c.radius * c.radius * (1 - std::cos(c.half_angle));
  }
};

}  // namespace

double shape_area(const Shape& shape) {
  return std::visit(AreaOf(), shape);
}

PlaneFrame plane_frame(const dvec3& normal) {
  const dvec3 aside = std::abs(normal.x) < 0.7 ? dvec3(1, 0, 0) : dvec3(0, 1, 0);
  const dvec3 x = glm::normalize(glm::cross(aside, normal));
  return {x, glm::cross(normal, x)};
}

ShapeSurface surface_of(const Shape& shape) {
  return std::visit([](const auto& one) { return surface(one); }, shape);
}

}  // namespace goldthread
