#include "solve/hierarchical/point_transfer.h"

#include <algorithm>

namespace goldthread {
namespace {

// Largest error of a form factor that one piece of a source may bring in.
constexpr float kTolerance = 6e-4f;
// The same for a piece that the receiver's horizon cuts: what is above it brings more than its centre says,
// and such errors add up. Of lamps, which outshine all else a thousandfold, next to nothing may be lost.
constexpr float kHorizonTolerance = 2e-4f, kLampTolerance = 2e-5f;

// Whether a piece of form factor about `factor`, whose points lie within `radius` of a centre
// `distance_squared` away, may be treated as a point: the error of that falls as the square of size over
// distance.
bool small_enough(float factor, float radius, float distance_squared) {
  const float ratio = radius * radius / std::max(distance_squared, 1e-30f);
  return ratio < 0.25f && factor * ratio < kTolerance;
}

vec3 dipole(const vec3& to_source, float distance_squared, const vec3& summed_normal) {
  const float power = -dot(to_source, summed_normal);
  if (power <= 0) return vec3(0);
  return to_source * (power / (kPi * distance_squared * distance_squared));
}

// The dipole of a flat piece with its second-order term. Moving over the piece's plane, K = (n.d)(s.d)/d^4
// has mean
//   K (1 + rho^2/d^2 (1 - 3 cos^2 + (n.s)(s.d)/(n.d)))
// where rho^2 is twice the sum of the piece's two variances (rho is the radius, for a disc), s its unit
// normal turned to the receiver and cos that of s and d: half the variance times the in-plane Laplacian of K.
// On the axis of a disc that is the start of the exact rho^2/(rho^2 + d^2); without it near pieces bring too
// much.
vec3 flat_dipole(const vec3& d, float squared, const vec3& summed_normal, const vec3& n, float rho_squared) {
  const float at_receiver = dot(d, n), power = -dot(d, summed_normal);
  if (at_receiver <= 0 || power <= 0) return vec3(0);
  const float area = length(summed_normal);
  const float at_source = power / area;
  const float cosine_squared = at_source * at_source / squared;
  const float bend = 1 - 3 * cosine_squared - dot(n, summed_normal) / area * at_source / at_receiver;
  const float factor = std::clamp(1 + rho_squared / squared * bend, 0.5f, 1.5f);
  return d * (factor * power / (kPi * squared * squared));
}

// Whether x is before the plane through `corner`, by more than rounding can make of a point on it: seen
// edge-on, a polygon has no sides, and one that x lies on would seem to fill the sky.
bool in_front(const vec3& x, const vec3& corner, const vec3& area_vector) {
  const vec3 most = glm::max(glm::abs(x), glm::abs(corner));
  const float rounding = 5e-7f * std::max(most.x, std::max(most.y, most.z));
  return dot(x - corner, area_vector) > rounding * length(area_vector);
}

// A far piece that turns both faces and backs to x: a bolt, a chair's leg. Half of the sum of |n.d| and of
// -n.d over its triangles is the projected area that faces x; the second is S's, the first is S's own besides
// what would be half the area, were the normals that cancel in S spread evenly. Taking S alone, a closed
// object would send nothing.
vec3 rounded_dipole(const vec3& d, float squared, const vec3& summed_normal, float area) {
  const float distance = std::sqrt(squared);
  const float net = -dot(d, summed_normal) / distance;
  const float cancelled = std::max(0.0f, area - length(summed_normal));
  const float facing = 0.5f * (std::abs(net) + 0.5f * cancelled + net);
  return d * (facing / (kPi * squared * distance));
}

struct PlacedTree {
  const Part& part;
  const FaceClusterTree& tree;
  mat3 area_map;  // to the element's side
  float winding;
};

vec3 triangle_transfer(const PlacedTree& placed, uint32_t triangle, const vec3& x, const vec3& n) {
  const UVec3& corner = placed.tree.mesh.triangles[triangle];
  const vec3 &a = placed.part.positions[corner.x], &b = placed.part.positions[corner.y],
             &c = placed.part.positions[corner.z];
  const vec3 normal = placed.winding * area_vector(a, b, c);
  const vec3 centre = (a + b + c) / 3.0f;
  const vec3 d = centre - x;
  if (!in_front(x, a, normal)) return vec3(0);
  const float squared = dot(d, d);
  const float radius_squared =
      std::max({dot(a - centre, a - centre), dot(b - centre, b - centre), dot(c - centre, c - centre)});
  const float factor = -dot(d, normal) / (kPi * squared * std::sqrt(squared) + 1e-30f);
  const float height = dot(d, n);
  if (height * height > radius_squared && small_enough(factor, std::sqrt(radius_squared), squared)) {
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    return flat_dipole(d, squared, normal, n, (dot(ab, ab) + dot(bc, bc) + dot(ca, ca)) / 18);
  }
  const std::array<vec3, 3> corners{a, placed.winding > 0 ? b : c, placed.winding > 0 ? c : b};
  return polygon_form_factor(x, n, corners);
}

// Descends a face cluster tree from `root`, adding up pieces that are small for their distance.
vec3 tree_transfer(const PlacedTree& placed, ClusterRef root, const vec3& x, const vec3& n,
                   float horizon_tolerance) {
  vec3 sum(0);
  constexpr size_t kStack = 256;
  std::array<ClusterRef, kStack> stack;
  size_t depth = 0;
  stack[depth++] = root;
  const float area_scale = placed.part.scale * placed.part.scale;
  while (depth > 0) {
    const ClusterRef ref = stack[--depth];
    if (is_triangle(ref)) {
      sum += triangle_transfer(placed, triangle_of(ref), x, n);
      continue;
    }
    const FaceCluster& node = placed.tree.nodes[ref];
    const vec3 d = vec3(placed.part.to_world * vec4(node.centre, 1)) - x;
    const float radius = node.radius * placed.part.scale;
    if (dot(d, n) < -radius) continue;  // wholly below the horizon
    const float squared = dot(d, d);
    const float area = node.area * area_scale;
    const vec3 summed = placed.area_map * node.summed_normal;
    const float distance = std::sqrt(squared);
    // The angle between S and the way to x, against the cone of normals widened by the cluster's own extent.
    const float facing = -dot(d, summed) / (distance * length(summed) + 1e-30f);
    const float cone_sine = std::sqrt(std::max(0.0f, 1 - node.cone_cosine * node.cone_cosine));
    const float extent = std::min(1.0f, radius / std::max(distance, 1e-30f));
    const float slack = node.cone_cosine > 0 ? std::min(1.0f, cone_sine + extent) : 1.0f;
    if (squared > radius * radius && facing < -slack && node.cone_cosine > 0)
      continue;  // all seen from behind
    // At most: the cosines at both ends, as far as the cluster's extent leaves them open, over the squared
    // distance.
    const float at_receiver = std::min(1.0f, (std::abs(dot(d, n)) + radius) / (distance + 1e-30f));
    const float at_source = std::min(1.0f, std::max(0.0f, facing) + slack);
    const float factor = area * at_receiver * at_source / (kPi * squared + 1e-30f);
    const bool turned_here = facing > slack;  // every triangle faces x
    const bool small = turned_here ? small_enough(factor, radius, squared)
                                   : factor < kTolerance && squared > 4 * radius * radius;
    const bool near_horizon = std::abs(dot(d, n)) < radius && factor > horizon_tolerance;
    if ((small && !near_horizon) || depth + 2 > kStack) {
      if (node.cone_cosine > 0.995f) {
        sum += flat_dipole(d, squared, summed, n, area / kPi);
      } else if (turned_here) {
        if (dot(d, n) > 0) sum += dipole(d, squared, summed);
      } else if (dot(d, n) > 0) {
        sum += rounded_dipole(d, squared, summed, area);
      }
      continue;
    }
    stack[depth++] = node.child[1];
    stack[depth++] = node.child[0];
  }
  return sum;
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

vec3 point_light_transfer(const Light& light, const vec3& x, const vec3& n) {
  const vec3 d = light.position - x;
  const float squared = dot(d, d);
  const float distance = std::sqrt(squared);
  if (dot(d, n) <= 0 || squared <= 0) return vec3(0);
  const float factor = light_distribution(light, -d / distance) * light_range_factor(light, distance);
  return d * (factor / (squared * distance));
}

}  // namespace

float light_distribution(const Light& light, const vec3& d) {
  if (light.kind != LightKind::kSpot) return 1;
  const float inner = std::cos(light.inner_cone), outer = std::cos(light.outer_cone);
  const float t = std::clamp((dot(d, light.direction) - outer) / std::max(inner - outer, 1e-3f), 0.0f, 1.0f);
  return t * t;
}

float light_range_factor(const Light& light, float distance) {
  if (light.range <= 0) return 1;
  const float r = distance / light.range;
  return std::clamp(1 - r * r * r * r, 0.0f, 1.0f);
}

namespace {

vec3 transfer_of_kind(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n) {
  const Element& e = pool[source];
  switch (e.kind) {
    case ElementKind::kVolume:
      return volume_transfer(pool, source, x, n);
    case ElementKind::kCluster:
    case ElementKind::kTriangle: {
      const Part& part = pool.surfaces().parts[e.part];
      const PlacedTree placed{part, pool.surfaces().tree(part),
                              e.back ? -1.0f * part.area_map : part.area_map,
                              e.back ? -part.winding : part.winding};
      if (e.kind == ElementKind::kTriangle) return triangle_transfer(placed, e.shape, x, n);
      return tree_transfer(placed, e.shape, x, n, e.exitance != vec3(0) ? kLampTolerance : kHorizonTolerance);
    }
    case ElementKind::kPatch: {
      const vec3 d = e.centre - x;
      if (!in_front(x, e.centre, e.summed_normal)) return vec3(0);
      const float squared = dot(d, d);
      const float factor = -dot(d, e.summed_normal) / (kPi * squared * std::sqrt(squared) + 1e-30f);
      if (std::abs(dot(d, n)) > e.radius && small_enough(factor, e.radius, squared))
        return flat_dipole(d, squared, e.summed_normal, n, e.area / kPi);
      return polygon_form_factor(x, n, pool.polygon(source).span());
    }
    case ElementKind::kSky:
      return sky_form_factor(n, pool.sky_corners(source));
    case ElementKind::kPoint:
      return point_light_transfer(pool.light(source), x, n);
    case ElementKind::kSun: {
      const vec3 to_light = -pool.light(source).direction;
      return dot(to_light, n) > 0 ? to_light : vec3(0);
    }
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

}  // namespace goldthread
