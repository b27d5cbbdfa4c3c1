#include "solve/hierarchical/point_transfer.h"

#include <algorithm>
#include <limits>

#include "math/far_form_factor.h"
#include "solve/hierarchical/area_lamp.h"

namespace goldthread {
namespace {

// Whether a piece of form factor about `factor`, whose points lie within `radius` of a centre
// `distance_squared` away, may be treated as a point: the error of that falls as the square of size over
// distance.
bool small_enough(float factor, float radius, float distance_squared) {
  const float ratio = radius * radius / std::max(distance_squared, 1e-30f);
  return ratio < 0.25f && factor * ratio < kPieceTolerance;
}

// Whether x is before the plane through `corner`, by more than rounding can make of a point on it: seen
// edge-on, a polygon has no sides, and one that x lies on would seem to fill the sky.
bool in_front(const vec3& x, const vec3& corner, const vec3& area_vector) {
  const vec3 most = glm::max(glm::abs(x), glm::abs(corner));
  const float rounding = 5e-7f * std::max(most.x, std::max(most.y, most.z));
  return dot(x - corner, area_vector) > rounding * length(area_vector);
}

struct PlacedTree {
  const Part& part;
  const FaceClusterTree& tree;
  mat3 area_map;  // to the element's side
  float winding;
};

// A flat piece that is taken for far: `rho_squared` is what flat_dipole_form_factor wants.
struct FarPolygon {
  vec3 d;  // to its centroid
  float squared = 0;
  vec3 summed_normal;
  float rho_squared = 0;
};

// A face cluster that is taken for far.
struct FarCluster {
  vec3 d;
  float squared = 0;
  vec3 summed_normal;
  float area = 0, radius = 0;
  bool nearly_flat = false;
  ConeView<float> view;
};

vec3 polygon_dipole(const FarPolygon& p, const vec3& n) {
  return flat_dipole_form_factor(p.d, p.squared, p.summed_normal, n, p.rho_squared);
}

vec3 cluster_dipole(const FarCluster& c, const vec3& n) {
  if (c.nearly_flat) return flat_dipole_form_factor(c.d, c.squared, c.summed_normal, n, c.area / kPi);
  if (dot(c.d, n) <= 0) return vec3(0);
  return c.view.all_in_front ? dipole_form_factor(c.d, c.squared, c.summed_normal)
                             : rounded_dipole_form_factor(c.d, c.squared, c.summed_normal, c.area);
}

double polygon_error_bound(const FarPolygon& p, std::span<const vec3> corners, const vec3& x, const vec3& n) {
  std::array<DoubleTriangle, kMaxPolygon> triangles;
  size_t count = 0;
  for (size_t i = 1; i + 1 < corners.size(); ++i)
    triangles[count++] = {dvec3(corners[0]), dvec3(corners[i]), dvec3(corners[i + 1])};
  FarPiece piece = far_piece_of(x, {triangles.data(), count});
  piece.flat = true;  // but for rounding
  return dot(p.d, n) > 0 ? flat_dipole_error_bound(piece, n, p.rho_squared) : 0;
}

// What view_of_cone bounds a form factor by.
double largest_form_factor(const ConeView<float>& view, double radius, double squared) {
  const double left = 1 - radius / std::sqrt(squared);
  return left > 0 ? static_cast<double>(view.factor) / (left * left)
                  : std::numeric_limits<double>::infinity();
}

double cluster_error_bound(const FarCluster& c, const vec3& n) {
  // What is there and what is taken for it both lie between nought and this.
  const double taken = std::max(0.0f, dot(n, cluster_dipole(c, n)));
  const double by_size = std::max(taken, largest_form_factor(c.view, c.radius, c.squared));
  FarPiece piece;
  piece.to_centroid = c.d;
  piece.summed_normal = c.summed_normal;
  piece.area = c.area;
  piece.radius = c.radius;
  piece.second_moment = piece.radius * piece.radius;
  if (!c.view.all_in_front)
    return c.nearly_flat ? by_size : std::min(by_size, rounded_dipole_error_bound(piece, n));
  const bool is_cut = dot(c.d, n) < c.radius;
  const double bound = is_cut ? cut_dipole_error_bound(piece, n) : dipole_error_bound(piece);
  if (!c.nearly_flat) return std::min(by_size, bound);
  const double dipole = std::max(0.0f, dot(n, dipole_form_factor(c.d, c.squared, c.summed_normal)));
  return std::min(by_size, bound + std::abs(taken - dipole));
}

// What pieces bring together, and how far that may be off: what a descent adds up. `shape` gives the corners
// of a far polygon.
struct FactorSum {
  vec3 m{0};
  void add_near(const vec3& x, const vec3& n, std::span<const vec3> corners) {
    m += polygon_form_factor(x, n, corners);
  }
  template <typename Shape>
  void add_far(const FarPolygon& p, const Shape&, const vec3&, const vec3& n) {
    m += polygon_dipole(p, n);
  }
  void add_far(const FarCluster& c, const vec3& n) { m += cluster_dipole(c, n); }
};
struct ErrorSum {
  double bound = 0;
  void add_near(const vec3&, const vec3&, std::span<const vec3>) {}
  template <typename Shape>
  void add_far(const FarPolygon& p, const Shape& shape, const vec3& x, const vec3& n) {
    bound += polygon_error_bound(p, shape().span(), x, n);
  }
  void add_far(const FarCluster& c, const vec3& n) { bound += cluster_error_bound(c, n); }
};

template <typename Sum>
void add_triangle(const PlacedTree& placed, uint32_t triangle, const vec3& x, const vec3& n, Sum& sum) {
  const UVec3& corner = placed.tree.mesh.triangles[triangle];
  const vec3 &a = placed.part.positions[corner.x], &b = placed.part.positions[corner.y],
             &c = placed.part.positions[corner.z];
  const vec3 normal = placed.winding * area_vector(a, b, c);
  const vec3 centre = (a + b + c) / 3.0f;
  const vec3 d = centre - x;
  if (!in_front(x, a, normal)) return;
  const float squared = dot(d, d);
  const float radius_squared =
      std::max({dot(a - centre, a - centre), dot(b - centre, b - centre), dot(c - centre, c - centre)});
  const float factor = -dot(d, normal) / (kPi * squared * std::sqrt(squared) + 1e-30f);
  const float height = dot(d, n);
  const std::array<vec3, 3> corners{a, placed.winding > 0 ? b : c, placed.winding > 0 ? c : b};
  if (height * height > radius_squared && small_enough(factor, std::sqrt(radius_squared), squared)) {
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    const float edges = dot(ab, ab) + dot(bc, bc) + dot(ca, ca);
    const auto shape = [&] { return ElementPolygon{{corners[0], corners[1], corners[2]}, 3}; };
    sum.add_far(FarPolygon{d, squared, normal, edges / 18}, shape, x, n);
  } else {
    sum.add_near(x, n, corners);
  }
}

// Descends the tree of a face cluster, adding up pieces that are small for their distance.
template <typename Sum>
void add_tree(const ElementPool& pool, ElementId source, const PlacedTree& placed, const vec3& x,
              const vec3& n, float horizon_tolerance, Sum& sum) {
  constexpr size_t kStack = 256;
  std::array<ClusterRef, kStack> stack;
  size_t depth = 0;
  stack[depth++] = pool[source].shape;
  const float area_scale = placed.part.scale * placed.part.scale;
  while (depth > 0) {
    const ClusterRef ref = stack[--depth];
    if (is_triangle(ref)) {
      add_triangle(placed, triangle_of(ref), x, n, sum);
      continue;
    }
    const FaceCluster& node = placed.tree.nodes[ref];
    const vec3 d = vec3(placed.part.to_world * vec4(node.centre, 1)) - x;
    const float radius = node.radius * placed.part.scale;
    if (dot(d, n) < -radius) continue;  // wholly below the horizon
    const float squared = dot(d, d);
    const float area = node.area * area_scale;
    const vec3 summed = placed.area_map * node.summed_normal;
    const ConeView<float> view = view_of_cone(d, squared, n, summed, area, radius, node.cone_cosine);
    if (view.all_behind) continue;
    const bool small = view.all_in_front ? small_enough(view.factor, radius, squared)
                                         : view.factor < kPieceTolerance && squared > 4 * radius * radius;
    const bool near_horizon = std::abs(dot(d, n)) < radius && view.factor > horizon_tolerance;
    if ((small && !near_horizon) || depth + 2 > kStack) {
      sum.add_far(FarCluster{d, squared, summed, area, radius, node.cone_cosine > 0.995f, view}, n);
      continue;
    }
    // Exact at once, however many triangles it is made of.
    if (!placed.tree.outlines.of(ref).empty()) {
      const ElementPolygon outline = pool.outline(source, ref);
      if (in_front(x, outline.corners[0], summed)) sum.add_near(x, n, outline.span());
      continue;
    }
    stack[depth++] = node.child[1];
    stack[depth++] = node.child[0];
  }
}

// A volume cluster: its stored samples stand for equal shares of its area.
vec3 volume_transfer(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n) {
  const float area = pool[source].area / static_cast<float>(kStoredSamples);
  vec3 sum(0);
  for (uint32_t i = 0; i < kStoredSamples; ++i) {
    const SurfacePoint& y = pool.stored_sample(source, i);
    const vec3 d = y.position - x;
    const float cosine = -dot(d, y.normal);
    if (cosine <= 0 || dot(d, n) <= 0) continue;
    const float squared = dot(d, d);
    // The disc of the sample's share bounds what a sample that happens to lie close may bring.
    sum += d * (cosine * area / (squared * (kPi * squared + area)));
  }
  return sum;
}

// A vector whose product with n is `irradiance`: along the way to the light where n faces it.
vec3 towards_disc(const LightDisc& disc, const vec3& n, float irradiance) {
  const float cosine = dot(disc.axis, n);
  return cosine > disc.sine ? disc.axis * (irradiance / cosine) : n * irradiance;
}

vec3 point_light_transfer(const Light& light, const vec3& x, const vec3& n) {
  if (light.has_area()) return area_lamp_transfer(light, x, n);
  const vec3 d = light.position - x;
  const float squared = dot(d, d);
  const float distance = std::sqrt(squared);
  if (squared <= 0) return vec3(0);
  const LightDisc disc = light_disc(light, x);
  if (disc.sine <= 0 && dot(d, n) <= 0) return vec3(0);
  const float factor = light_distribution(light, -d / distance) * light_range_factor(light, distance);
  if (disc.sine > 0) return towards_disc(disc, n, disc_cosine(disc, n) * factor / squared);
  return d * (factor / (squared * distance));
}

vec3 sun_transfer(const Light& light, const vec3& x, const vec3& n) {
  const LightDisc disc = light_disc(light, x);
  if (disc.sine > 0) return towards_disc(disc, n, disc_cosine(disc, n));
  return dot(disc.axis, n) > 0 ? disc.axis : vec3(0);
}

}  // namespace

LightDisc light_disc(const Light& light, const vec3& x) {
  if (light.kind == LightKind::kDirectional)
    return {-light.direction, 0, std::sin(light.angular_diameter / 2)};
  const vec3 d = light.position - x;
  const float distance = length(d);
  return {normalize_or(d, vec3(0, 1, 0)), distance, light.radius < distance ? light.radius / distance : 0.0f};
}

float disc_cosine(const LightDisc& disc, const vec3& n) {
  const float cosine = std::clamp(dot(disc.axis, n), -1.0f, 1.0f);
  if (cosine >= disc.sine) return cosine;
  if (cosine <= -disc.sine) return 0;
  // Here sigma is the disc's angular radius, theta the angle between axis and normal.
  const double sine_squared = static_cast<double>(disc.sine * disc.sine);
  const double cos_theta = static_cast<double>(cosine), sin_theta = std::sqrt(1 - cos_theta * cos_theta);
  const double x = std::sqrt(1 / sine_squared - 1);
  const double y = std::clamp(-x * cos_theta / sin_theta, -1.0, 1.0), root = sin_theta * std::sqrt(1 - y * y);
  const double factor = (cos_theta * std::acos(y) - x * root) * sine_squared + std::atan2(root, x);
  return static_cast<float>(std::max(0.0, factor) / (sine_squared * static_cast<double>(kPi)));
}

float light_distribution(const Light& light, const vec3& d) {
  if (light.profile) {
    const vec3 up = cross(light.across, light.direction);
    return light.profile->intensity({dot(d, light.across), dot(d, up), -dot(d, light.direction)});
  }
  if (light.kind != LightKind::kSpot) return 1;
  const float inner = std::cos(light.inner_cone), outer = std::cos(light.outer_cone);
  const float t = std::clamp((dot(d, light.direction) - outer) / std::max(inner - outer, 1e-3f), 0.0f, 1.0f);
  return t * t;
}

float lamp_solid_angle(const Light& light) {
  if (light.profile) return static_cast<float>(light.profile->luminous_flux());
  if (light.has_area()) return kPi;  // by the cosine
  return light.kind == LightKind::kPoint ? 4 * kPi : 2 * kPi * (1 - std::cos(light.outer_cone));
}

float light_range_factor(const Light& light, float distance) {
  if (light.range <= 0) return 1;
  const float r = distance / light.range;
  return std::clamp(1 - r * r * r * r, 0.0f, 1.0f);
}

namespace {

// Adds up a face cluster, a triangle or a patch.
template <typename Sum>
void add_surface(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n, Sum& sum) {
  const Element& e = pool[source];
  if (e.kind == ElementKind::kPatch) {
    const vec3 d = e.centre - x;
    if (!in_front(x, e.centre, e.summed_normal)) return;
    const float squared = dot(d, d);
    const float factor = -dot(d, e.summed_normal) / (kPi * squared * std::sqrt(squared) + 1e-30f);
    const auto shape = [&] { return pool.polygon(source); };
    if (std::abs(dot(d, n)) > e.radius && small_enough(factor, e.radius, squared)) {
      sum.add_far(FarPolygon{d, squared, e.summed_normal, e.area / kPi}, shape, x, n);
    } else {
      sum.add_near(x, n, shape().span());
    }
    return;
  }
  const Part& part = pool.surfaces().parts[e.part];
  const PlacedTree placed{part, pool.surfaces().tree(part), e.back ? -1.0f * part.area_map : part.area_map,
                          e.back ? -part.winding : part.winding};
  if (e.kind == ElementKind::kTriangle) return add_triangle(placed, e.shape, x, n, sum);
  add_tree(pool, source, placed, x, n, e.exitance != vec3(0) ? kLampTolerance : kHorizonTolerance, sum);
}

// A cell that the horizon does not cut brings exactly what its light is, however uneven; of what is cut, the
// mean.
vec3 sky_transfer(const SkyCell& cell, const vec3& n) {
  bool whole = true;
  for (const vec3& c : cell.corners)
    whole = whole && dot(c, n) > -1e-4f;  // rounded normals cut next to nothing
  return whole && cell.unevenness > 0 ? cell.transfer : sky_form_factor(n, cell.corners);
}

vec3 transfer_of_kind(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n) {
  switch (pool[source].kind) {
    case ElementKind::kVolume:
      return volume_transfer(pool, source, x, n);
    case ElementKind::kCluster:
    case ElementKind::kTriangle:
    case ElementKind::kPatch: {
      FactorSum sum;
      add_surface(pool, source, x, n, sum);
      return sum.m;
    }
    case ElementKind::kSky:
      return sky_transfer(pool.sky_cell(source), n);
    case ElementKind::kPoint:
      return point_light_transfer(pool.light(source), x, n);
    case ElementKind::kSun:
      return sun_transfer(pool.light(source), x, n);
  }
  return vec3(0);
}

}  // namespace

vec3 point_transfer(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n) {
  const vec3 m = transfer_of_kind(pool, source, x, n);
  const float factor = dot(m, n);
  if (!(factor > 0)) return vec3(0);  // not a number, too: a sliver without a normal
  // No plane fills more than the whole hemisphere, whatever the rounding of what touches x. What has layers,
  // one behind the other, may well: that is for visibility to sort out.
  return pool[source].flat && factor > 1 ? m / factor : m;
}

double point_transfer_error_bound(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n) {
  const Element& e = pool[source];
  if (!is_surface(e.kind)) return 0;
  if (e.kind == ElementKind::kVolume) {
    const Box& box = pool.box(source);
    const OrientedBox placed{box.centre(), mat3(1), 0.5f * box.size()};
    const FormFactorBounds bounds = box_form_factor_bounds(x, n, placed, e.area, dvec3(0, 0, 1), -1);
    const double taken = std::max(0.0f, dot(n, point_transfer(pool, source, x, n)));
    return std::max(bounds.high - taken, taken - bounds.low);
  }
  ErrorSum sum;
  add_surface(pool, source, x, n, sum);
  return sum.bound;
}

}  // namespace goldthread
