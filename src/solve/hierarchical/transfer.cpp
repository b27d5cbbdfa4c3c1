#include "solve/hierarchical/transfer.h"

#include <algorithm>
#include <bit>
#include <chrono>

#include "base/rng.h"

namespace goldthread {
namespace {

// Largest error of a form factor that one piece of a source may bring in.
constexpr float kTolerance = 6e-4f;

// Squared distance over squared radius below which a source is sampled by solid angle instead of by area.
constexpr float kNearSource = 6;

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
  if (small_enough(factor, std::sqrt(radius_squared), squared)) {
    const vec3 ab = b - a, bc = c - b, ca = a - c;
    return flat_dipole(d, squared, normal, n, (dot(ab, ab) + dot(bc, bc) + dot(ca, ca)) / 18);
  }
  const std::array<vec3, 3> corners{a, placed.winding > 0 ? b : c, placed.winding > 0 ? c : b};
  return polygon_form_factor(x, n, corners);
}

// Descends a face cluster tree from `root`, adding up pieces that are small for their distance.
vec3 tree_transfer(const PlacedTree& placed, ClusterRef root, const vec3& x, const vec3& n) {
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
    const bool near_horizon = std::abs(dot(d, n)) < radius && factor > kTolerance;
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

// Reaches from surface to surface without touching either.
Ray ray_between(const vec3& from, const vec3& from_normal, const vec3& to, const vec3& to_normal,
                float epsilon) {
  Ray ray;
  ray.origin = from + epsilon * from_normal;
  ray.direction = to + epsilon * to_normal - ray.origin;
  ray.near = 0;
  // Ends short of the target by what its surface may stand out beside it; at closer quarters nothing fits
  // between.
  const float distance = length(ray.direction);
  ray.far = distance > 4 * epsilon ? 1 - 2 * epsilon / distance : 0.0f;
  return ray;
}

uint32_t timed_packet(const RayCaster& caster, std::span<const Ray> rays, RayCount& count) {
  const auto start = std::chrono::steady_clock::now();
  const uint32_t blocked = caster.occluded_packet(rays);
  const auto time = std::chrono::steady_clock::now() - start;
  count.rays += rays.size();
  count.nanoseconds +=
      static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
  return blocked;
}

// Splits a link's light into a part that follows the normal and one that does not, by least squares over the
// samples, keeping the sampled mean; and measures what remains unexplained.
void fit_model(Link& link, std::span<const float> received, std::span<const vec3> normals) {
  const auto count = static_cast<float>(received.size());
  float predicted_mean = 0;
  for (const vec3& n : normals) predicted_mean += std::max(0.0f, dot(n, link.transfer)) / count;
  if (predicted_mean > 0) {
    const float scale = link.mean / predicted_mean;
    float covariance = 0, variance = 0;
    for (size_t i = 0; i < received.size(); ++i) {
      const float predicted = scale * std::max(0.0f, dot(normals[i], link.transfer)) - link.mean;
      covariance += predicted * (received[i] - link.mean);
      variance += predicted * predicted;
    }
    // One normal, or none to tell apart: all is vector.
    const float follows = variance > 1e-6f * link.mean * link.mean * count
                              ? std::clamp(covariance / variance, 0.0f, 1.0f)
                              : 1.0f;
    link.transfer *= follows * scale;
    link.ambient = (1 - follows) * link.mean;
  } else {
    link.transfer = vec3(0);
    link.ambient = link.mean;
  }
  for (size_t i = 0; i < received.size(); ++i)
    link.spread = std::max(
        link.spread, std::abs(received[i] - link.ambient - std::max(0.0f, dot(normals[i], link.transfer))));
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
      return tree_transfer(placed, e.shape, x, n);
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
  // Nothing fills more than the whole hemisphere, whatever the rounding of what touches x.
  return is_surface(pool[source].kind) && factor > 1 ? m / factor : m;
}

float Visibility::fraction(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n,
                           uint32_t rays, uint32_t seed, RayCount& count) const {
  const Element& e = pool[source];
  const vec3 origin = x + epsilon * n;
  if (e.kind == ElementKind::kPoint || e.kind == ElementKind::kSun) {
    Ray ray{origin, -pool.surfaces().scene->lights[e.shape].direction};
    if (e.kind == ElementKind::kPoint) {
      ray.direction = e.centre - origin;
      ray.far = 0.9999f;
    }
    return timed_packet(*caster, {&ray, 1}, count) != 0 ? 0.0f : 1.0f;
  }
  const vec3 way = e.centre - x;
  const bool near = is_surface(e.kind) && e.kind != ElementKind::kVolume &&
                    dot(way, way) < kNearSource * e.radius * e.radius;
  const bool turns = e.kind == ElementKind::kVolume || (e.kind == ElementKind::kCluster && !e.flat);
  const uint32_t turn = hash(seed, source);
  // A point of the source, and what it would bring: the more, the more it counts.
  const auto candidate = [&](uint32_t i, uint32_t of, Ray& ray) -> float {
    const UnitSquarePoint uv = r2_point(i, turn);
    if (e.kind == ElementKind::kSky) {
      ray = {origin, pool.sky_direction(source, uv.u, uv.v)};
      return std::max(0.0f, dot(ray.direction, n));
    }
    float weight = 0;
    SurfacePoint y;
    if (near) {
      y = pool.sample_towards(source, x, n, uv.u, uv.v, weight);
    } else {
      // Stored samples suffice for few rays, and spare the descent.
      const bool stored =
          of <= kStoredSamples && (e.kind == ElementKind::kVolume || e.kind == ElementKind::kCluster);
      const uint32_t offset = turn % std::max(1u, kStoredSamples / of);
      y = stored ? pool.stored_sample(source, (i * kStoredSamples) / of + offset)
                 : pool.sample_at(source, uv.u, uv.v);
      const vec3 d = y.position - x;
      const float here = dot(d, n), there = -dot(d, y.normal), squared = dot(d, d);
      // Bounded, so that one near sample does not decide alone.
      if (here > 0 && there > 0) weight = here * there / (squared * (squared + 0.05f * e.area));
    }
    if (weight > 0) ray = ray_between(x, n, y.position, y.normal, epsilon);
    return weight;
  };
  float seen = 0, all = 0;
  for (uint32_t first = 0; first < rays; first += 16) {
    const uint32_t batch = std::min(16u, rays - first);
    if (!turns) {
      std::array<Ray, 16> packet;
      std::array<float, 16> weight;
      size_t size = 0;
      for (uint32_t i = first; i < first + batch; ++i)
        if ((weight[size] = candidate(i, rays, packet[size])) > 0) ++size;
      if (size == 0) continue;
      const uint32_t blocked = timed_packet(*caster, {packet.data(), size}, count);
      for (size_t k = 0; k < size; ++k) {
        all += weight[k];
        if ((blocked >> k & 1) == 0) seen += weight[k];
      }
      continue;
    }
    // Of what turns many ways most points face elsewhere, and of two or three chosen blindly often all: more
    // are looked at, and rays go to them in proportion to what they would bring.
    constexpr uint32_t kLook = 16;
    std::array<Ray, kLook> found;
    std::array<float, kLook> up_to;
    uint32_t size = 0;
    float sum = 0;
    for (uint32_t i = 0; i < kLook; ++i) {
      const float weight = candidate(first + i, rays <= kLook ? kLook : rays, found[size]);
      if (weight > 0) up_to[size++] = sum += weight;
    }
    if (size == 0) continue;
    std::array<Ray, 16> packet;
    const float start = unit_float(hash(turn, first));
    for (uint32_t k = 0, at = 0; k < batch; ++k) {
      const float target = sum * (static_cast<float>(k) + start) / static_cast<float>(batch);
      while (at + 1 < size && up_to[at] < target) ++at;
      packet[k] = found[at];
    }
    const uint32_t blocked = timed_packet(*caster, {packet.data(), batch}, count);
    all += sum;
    seen += sum * static_cast<float>(batch - static_cast<uint32_t>(std::popcount(blocked & ((1u << batch) - 1)))) /
            static_cast<float>(batch);
  }
  if (all > 0) return seen / all;
  // No sample faces x although a little of the source does (a silhouette): a ray to just before it must do.
  if (e.kind == ElementKind::kSky) return 0;
  const vec3 to_centre = e.centre - origin;
  const float distance = length(to_centre);
  if (distance <= 1.01f * e.radius) return 1;
  Ray ray{origin, to_centre};
  ray.far = 1 - 1.01f * e.radius / distance;
  return timed_packet(*caster, {&ray, 1}, count) != 0 ? 0.0f : 1.0f;
}

void split_source(const ElementPool& pool, Link& link) {
  const ElementId child = pool[link.source].first_child;
  std::array<SurfacePoint, 4> at;
  pool.quadrature(link.receiver, at);
  float front = 0, back = 0;
  for (const SurfacePoint& x : at) {
    front += std::max(0.0f, dot(x.normal, point_transfer(pool, child, x.position, x.normal)));
    back += std::max(0.0f, dot(x.normal, point_transfer(pool, child + 1, x.position, x.normal)));
  }
  const float area = pool[child].area + pool[child + 1].area;
  link.front_share = front + back > 0 ? front / (front + back) : (area > 0 ? pool[child].area / area : 0.5f);
}

namespace {

// What one receiver point gets of a link's source.
struct PointSample {
  vec3 transfer{0};  // visibility included
  float received = 0;
  float unoccluded = 0;
  uint32_t rays = 0;
};

PointSample sample_point(const ElementPool& pool, const Visibility& visibility, ElementId source,
                         const SurfacePoint& x, uint32_t rays, uint32_t seed, RayCount& count) {
  PointSample out;
  out.transfer = point_transfer(pool, source, x.position, x.normal);
  out.unoccluded = dot(out.transfer, x.normal);
  if (out.unoccluded <= 0) return {};
  const uint64_t before = count.rays;
  const float v = visibility.fraction(pool, source, x.position, x.normal, rays, seed, count);
  out.rays = static_cast<uint32_t>(count.rays - before);
  out.transfer *= v;
  out.received = out.unoccluded * v;
  return out;
}

void finish(Link& link, float received, float unoccluded, uint32_t rays) {
  link.visibility = static_cast<uint8_t>(std::lround(unoccluded > 0 ? 255 * received / unoccluded : 255));
  link.rays = static_cast<uint8_t>(std::min(rays, 255u));
}

// A gradient may take the light from nothing at one end to twice the mean at the other, and no further:
// fitted to samples that happen to lie close together it could be anything.
void limit_gradient(Link& link, float radius) {
  const float rise = length(link.transfer) * radius;
  if (rise > link.ambient) link.transfer *= link.ambient / std::max(rise, 1e-30f);
}

// A triangle or patch: mean and gradient from the quadrature's inner ring, doubt from what these leave and
// from the centre, which alone tells a bend.
void link_polygon(const ElementPool& pool, const Visibility& visibility, Link& link, uint32_t points,
                  uint32_t rays_per_point, RayCount& count) {
  std::array<SurfacePoint, 9> at;
  pool.quadrature(link.receiver, {at.data(), points});
  at[points] = {pool[link.receiver].centre, at[0].normal};
  std::array<PointSample, 9> sample;
  uint32_t rays = 0;
  for (uint32_t i = 0; i <= points; ++i) {
    sample[i] =
        sample_point(pool, visibility, link.source, at[i], rays_per_point, link.receiver * 16 + i, count);
    rays += sample[i].rays;
    if (i == points) break;
    link.mean += sample[i].received / static_cast<float>(points);
    link.unoccluded += sample[i].unoccluded / static_cast<float>(points);
  }
  finish(link, link.mean, link.unoccluded, rays);
  // The ring's corners lie at -+ along two orthogonal axes.
  const vec3 a1 = 0.5f * (at[1].position - at[0].position), a2 = 0.5f * (at[2].position - at[0].position);
  const float g1 = (sample[1].received + sample[3].received - sample[0].received - sample[2].received) / 4;
  const float g2 = (sample[2].received + sample[3].received - sample[0].received - sample[1].received) / 4;
  link.ambient = link.mean;
  link.transfer = a1 * (g1 / std::max(dot(a1, a1), 1e-30f)) + a2 * (g2 / std::max(dot(a2, a2), 1e-30f));
  limit_gradient(link, pool[link.receiver].radius);
  for (uint32_t i = 0; i <= points; ++i) {
    const float said = link.mean + dot(at[i].position - pool[link.receiver].centre, link.transfer);
    link.spread = std::max(link.spread, std::abs(sample[i].received - said));
  }
  // A tenth of what is linear: no light is wholly so.
  link.spread += 0.1f * (std::abs(g1) + std::abs(g2));
}

// Mean and plane fitted by least squares over samples that lie where the triangles do.
void fit_plane(Link& link, const Element& receiver, std::span<const SurfacePoint> at,
               std::span<const float> received) {
  const auto count = static_cast<float>(at.size());
  const vec3 n = normalize_or(receiver.summed_normal, vec3(0, 1, 0));
  const vec3 u = normalize(std::abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0) : vec3(0, n.z, -n.y)), v = cross(n, u);
  vec2 middle(0);
  for (const SurfacePoint& p : at)
    middle += vec2(dot(p.position - receiver.centre, u), dot(p.position - receiver.centre, v)) / count;
  float xx = 0, xy = 0, yy = 0, xf = 0, yf = 0;
  for (size_t i = 0; i < at.size(); ++i) {
    const vec2 p =
        vec2(dot(at[i].position - receiver.centre, u), dot(at[i].position - receiver.centre, v)) - middle;
    const float f = received[i] - link.mean;
    xx += p.x * p.x;
    xy += p.x * p.y;
    yy += p.y * p.y;
    xf += p.x * f;
    yf += p.y * f;
  }
  const float determinant = xx * yy - xy * xy;
  vec2 g(0);
  if (determinant > 1e-4f * (xx + yy) * (xx + yy)) {
    g = vec2(yy * xf - xy * yf, xx * yf - xy * xf) / determinant;
  } else if (xx + yy > 0) {
    // Samples along a line tell nothing across it.
    const vec2 along = glm::normalize(xx >= yy ? vec2(xx, xy) : vec2(xy, yy));
    g = along * ((along.x * xf + along.y * yf) / (xx + yy));
  }
  link.ambient = std::max(0.0f, link.mean - dot(g, middle));
  link.transfer = g.x * u + g.y * v;
  limit_gradient(link, receiver.radius);
  for (size_t i = 0; i < at.size(); ++i) {
    const float said = link.ambient + dot(at[i].position - receiver.centre, link.transfer);
    link.spread = std::max(link.spread, std::abs(received[i] - said));
  }
  link.spread += 0.1f * std::sqrt((xx * g.x * g.x + 2 * xy * g.x * g.y + yy * g.y * g.y) / count);
  link.mean = link.ambient;  // the centre is the centroid
}

void link_cluster(const ElementPool& pool, const Visibility& visibility, Link& link, uint32_t points,
                  uint32_t rays_per_point, RayCount& count) {
  std::array<SurfacePoint, kStoredSamples> at;
  pool.quadrature(link.receiver, {at.data(), points});
  std::array<float, kStoredSamples> received{};
  std::array<vec3, kStoredSamples> normals;
  uint32_t rays = 0, facing = 0;
  for (uint32_t i = 0; i < points; ++i) {
    const PointSample sample =
        sample_point(pool, visibility, link.source, at[i], rays_per_point, link.receiver * 16 + i, count);
    normals[i] = at[i].normal;
    received[i] = sample.received;
    if (sample.unoccluded > 0) ++facing;
    rays += sample.rays;
    link.transfer += sample.transfer;
    link.mean += sample.received / static_cast<float>(points);
    link.unoccluded += sample.unoccluded / static_cast<float>(points);
  }
  // The vector is that at the points which face the source: the others' normals clip it when it is pushed to
  // them.
  if (facing > 0) link.transfer /= static_cast<float>(facing);
  finish(link, link.mean, link.unoccluded, rays);
  const Element& receiver = pool[link.receiver];
  if (receiver.flat) {
    fit_plane(link, receiver, {at.data(), points}, {received.data(), points});
  } else if (receiver.kind != ElementKind::kVolume) {
    fit_model(link, {received.data(), points}, {normals.data(), points});
  }
}

// Of the last measurement of links.
constexpr uint32_t kFreshPoints = 8, kFreshRays = 2;

// Gives a link another mean, keeping the shape of its light over the receiver if there was any to speak of.
void set_mean(Link& link, float mean) {
  if (link.mean > 0.5f * mean) {
    link.transfer *= mean / link.mean;
    link.ambient *= mean / link.mean;
  } else {  // what shape the samples have says nothing of where the light is
    link.transfer = vec3(0);
    link.ambient = mean;
  }
  link.mean = mean;
}

// What an element gets of another at its own points: means over `at`.
PointSample sample_points(const ElementPool& pool, const Visibility& visibility, ElementId towards,
                          std::span<const SurfacePoint> at, uint32_t rays_per_point, uint32_t seed,
                          RayCount& count) {
  PointSample sum;
  const auto points = static_cast<float>(at.size());
  for (uint32_t i = 0; i < at.size(); ++i) {
    const PointSample sample = sample_point(pool, visibility, towards, at[i], rays_per_point, seed + i, count);
    sum.received += sample.received / points;
    sum.unoccluded += sample.unoccluded / points;
    sum.rays += sample.rays;
  }
  return sum;
}

// A link's mean from the source's end: A_r F_rs = A_s F_sr. Over a large receiver the light of a small source
// near it is a peak between the samples, lost more often than caught; seen from the source the same transfer
// is smooth.
PointSample sample_reciprocal(const ElementPool& pool, const Visibility& visibility, const Link& link,
                              RayCount& count) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  std::array<SurfacePoint, 8> at;
  const std::span<SurfacePoint> points(at.data(), s.flat ? 4 : 8);
  pool.quadrature(link.source, points);
  PointSample sample =
      sample_points(pool, visibility, link.receiver, points, s.flat ? 4 : 2, link.source * 16, count);
  sample.received *= s.area / r.area;
  sample.unoccluded *= s.area / r.area;
  return sample;
}

bool reciprocity_helps(const Element& r, const Element& s) {
  if (r.kind == ElementKind::kVolume || s.kind == ElementKind::kVolume || s.kind > ElementKind::kPatch)
    return false;
  const vec3 apart = s.centre - r.centre;
  return s.area < 0.5f * r.area && dot(apart, apart) < 6.25f * r.radius * r.radius;
}

}  // namespace

Link make_link(const ElementPool& pool, const Visibility& visibility, ElementId receiver, ElementId source,
               uint32_t points, uint32_t rays_per_point, RayCount& ray_count) {
  Link link;
  link.receiver = receiver;
  link.source = source;
  const bool polygon =
      pool[receiver].kind == ElementKind::kTriangle || pool[receiver].kind == ElementKind::kPatch;
  (polygon ? link_polygon : link_cluster)(pool, visibility, link, points, rays_per_point, ray_count);
  if (receiver != source && reciprocity_helps(pool[receiver], pool[source])) {
    const PointSample sample = sample_reciprocal(pool, visibility, link, ray_count);
    link.spread += std::abs(sample.received - link.mean);
    set_mean(link, sample.received);
    link.unoccluded = sample.unoccluded;
    finish(link, sample.received, sample.unoccluded, link.rays + sample.rays);
  }
  return link;
}

void resample_link(const ElementPool& pool, const Visibility& visibility, Link& link, RayCount& ray_count) {
  const Element &r = pool[link.receiver], &s = pool[link.source];
  if (link.receiver == link.source && r.kind == ElementKind::kVolume) return;
  const bool from_source = link.receiver != link.source && reciprocity_helps(r, s);
  const ElementId here = from_source ? link.source : link.receiver,
                  there = from_source ? link.receiver : link.source;
  const float turned = from_source ? s.area / r.area : 1.0f;
  // Anywhere at all: quadrature points lie well inside, and never see past what hides all but an edge.
  std::array<SurfacePoint, kFreshPoints> at;
  const uint32_t seed = hash(link.receiver, link.source);
  for (uint32_t i = 0; i < kFreshPoints; ++i) {
    const UnitSquarePoint uv = r2_point(i, seed);
    at[i] = pool.sample_at(here, uv.u, uv.v);
  }
  const PointSample sample = sample_points(pool, visibility, there, at, kFreshRays, seed, ray_count);
  link.unoccluded = turned * sample.unoccluded;
  set_mean(link, turned * sample.received);
  finish(link, sample.received, sample.unoccluded, sample.rays);
}

}  // namespace goldthread
