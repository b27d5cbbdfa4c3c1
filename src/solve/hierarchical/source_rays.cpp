#include "solve/hierarchical/source_rays.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "base/rng.h"
#include "math/form_factor.h"
#include "math/spherical_triangle.h"
#include "solve/hierarchical/area_lamp.h"
#include "solve/hierarchical/point_transfer.h"

namespace goldthread {
namespace {

// Squared distance over squared radius below which a source is sampled by solid angle instead of by area.
constexpr float kNearSource = 6;

// Reaches from surface to surface without touching either.
Ray ray_between(const vec3& from, const vec3& from_normal, const vec3& to, const vec3& to_normal,
                float epsilon) {
  Ray ray;
  ray.origin = from + epsilon * from_normal;
  ray.direction = to + epsilon * to_normal - ray.origin;
  ray.near = 0;
  // All the way, or what stands beside a wall on the far side would be seen through the gap; at close
  // quarters nothing fits between.
  ray.far = length(ray.direction) > 4 * epsilon ? 1.0f : 0.0f;
  return ray;
}

// Transmittance of each of up to 16 rays; in `colours` by channel, if anything colours light at all.
void timed_packet(const RayCaster& caster, std::span<const Ray> rays, std::span<float> passing,
                  std::span<vec3> colours, RayCount& count) {
  const auto start = std::chrono::steady_clock::now();
  caster.packet_transmittance(rays, passing, caster.is_coloured() ? colours : std::span<vec3>());
  const auto time = std::chrono::steady_clock::now() - start;
  count.rays += rays.size();
  count.nanoseconds +=
      static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
}

// The colour of light that sums up to `by_channel`, where its best channel has `best`.
vec3 tint_of(const vec3& by_channel, float best) {
  return best > 0 ? by_channel / best : vec3(1);
}

float timed_ray(const RayCaster& caster, const Ray& ray, RayCount& count, vec3* tint) {
  float passing = 0;
  vec3 colour(1);
  timed_packet(caster, {&ray, 1}, {&passing, 1}, {&colour, 1}, count);
  if (tint != nullptr && caster.is_coloured()) *tint = tint_of(colour, passing);
  return passing;
}

// What the horizon of a point leaves of a piece of sky.
struct SkyView {
  std::optional<SphericalPolygon> above;  // where it cuts

  SkyView(const ElementPool& pool, ElementId source, const vec3& n) {
    if (pool[source].kind != ElementKind::kSky) return;
    // Of a piece so small that polygons of directions are no longer precise, most will do.
    constexpr float kSmall = 0.05f;
    const SkyCell& cell = pool.sky_cell(source);
    if (cell.solid_angle <= kSmall) return;
    bool cut = false;
    for (const vec3& c : cell.corners) cut |= dot(c, n) < 0;
    if (!cut) return;
    std::array<vec3, kMaxPolygon + 1> corners;
    const size_t count = clip_to_horizon(n, cell.corners, corners);
    above.emplace(std::span<const vec3>(corners.data(), count));
  }
};

// Draws points of a source as one point sees them.
struct SourceSampler {
  const ElementPool& pool;
  const ElementId source;
  const vec3 x, n;
  const float epsilon;
  const uint32_t turn;
  const Element& e = pool[source];
  const vec3 way = e.centre - x;
  const bool near = is_surface(e.kind) && e.kind != ElementKind::kVolume &&
                    dot(way, way) < kNearSource * e.radius * e.radius;
  const SkyView sky{pool, source, n};
  const std::optional<PolygonSampler> polygon = is_surface(e.kind) ? pool.one_polygon(source) : std::nullopt;
  const std::optional<PolygonView> view =
      near && polygon ? std::optional<PolygonView>(std::in_place, *polygon, x) : std::nullopt;

  // Of what turns many ways, or sinks below the horizon, most points may be out of sight.
  bool hides_itself() const {
    return e.kind == ElementKind::kVolume || (e.kind == ElementKind::kCluster && !e.flat) ||
           e.kind == ElementKind::kSky || dot(way, n) < e.radius;
  }

  // Point i, a ray to it, and what it brings: on surfaces, the mean over all i is the form factor.
  float draw(uint32_t i, Ray& ray, SurfacePoint& y) const {
    const UnitSquarePoint uv = r2_point(i, turn);
    if (e.kind == ElementKind::kSky) {
      ray = {x + epsilon * n, pool.sky_direction(source, uv.u, uv.v)};
      if (sky.above) ray.direction = sky.above->sample(uv.u, uv.v);
      const float cosine = std::max(0.0f, dot(ray.direction, n));
      return cosine > 0 ? cosine * pool.sky_relative_luminance(source, ray.direction) : 0.0f;
    }
    float weight = 0;
    if (near) {
      y = view ? view->sample(n, uv.u, uv.v, weight) : pool.sample_towards(source, x, n, uv.u, uv.v, weight);
    } else {
      // Not one of the stored samples: the same sixteen for all receivers would err the same way for all.
      y = polygon ? polygon->sample(uv.u, uv.v) : pool.sample_at(source, uv.u, uv.v);
      const vec3 d = y.position - x;
      const float here = dot(d, n), there = -dot(d, y.normal), squared = dot(d, d);
      if (here <= 0 || there <= 0) return 0;
      // The disc of area pi r^2 bounds what a point of a volume cluster that happens to lie close may bring.
      weight =
          here * there * e.area / (squared * (squared + (e.kind == ElementKind::kVolume ? e.area : 0.0f)));
    }
    if (weight > 0) ray = ray_between(x, n, y.position, y.normal, epsilon);
    return weight / kPi;
  }
};

constexpr uint32_t kPacket = 16, kLooked = 8;

// Rays to places of one lamp, each with what it would bring.
struct LampPacket {
  std::array<Ray, kPacket> rays;
  std::array<float, kPacket> weight;
  uint32_t size = 0;

  void add(const Ray& ray, float brings) {
    rays[size] = ray;
    weight[size++] = brings;
  }

  // Share of the light that gets through; 0 of none.
  float cast(const RayCaster& caster, RayCount& count, vec3* tint) const {
    if (size == 0) return 0;
    std::array<float, kPacket> passing;
    std::array<vec3, kPacket> colour;
    timed_packet(caster, {rays.data(), size}, {passing.data(), size}, {colour.data(), size}, count);
    float all = 0, seen = 0;
    for (uint32_t k = 0; k < size; ++k) {
      all += weight[k];
      seen += weight[k] * passing[k];
    }
    if (tint != nullptr && caster.is_coloured()) {
      vec3 by_channel(0);
      for (uint32_t k = 0; k < size; ++k) by_channel += weight[k] * colour[k];
      *tint = tint_of(by_channel, seen);
    }
    return seen / all;
  }
};

// Share of a light's disc seen from `origin`, by a packet of rays spread evenly over it; of what is above the
// horizon.
float disc_fraction(const RayCaster& caster, const LightDisc& disc, const vec3& origin, const vec3& n,
                    uint32_t turn, RayCount& count, vec3* tint) {
  const vec3 across = normalize(std::abs(disc.axis.x) > 0.6f ? vec3(disc.axis.y, -disc.axis.x, 0)
                                                             : vec3(0, disc.axis.z, -disc.axis.y));
  const vec3 up = cross(disc.axis, across);
  LampPacket packet;
  for (uint32_t i = 0; i < kPacket; ++i) {
    const UnitSquarePoint uv = r2_point(i, turn);
    const float aside = disc.sine * std::sqrt(uv.u), along = std::sqrt(1 - aside * aside);
    const vec3 way =
        along * disc.axis + aside * (std::cos(2 * kPi * uv.v) * across + std::sin(2 * kPi * uv.v) * up);
    const float weight = dot(way, n) / along;
    if (!(weight > 0)) continue;
    Ray ray{origin, way};
    if (disc.distance > 0) {  // to where it meets the ball
      ray.direction *=
          disc.distance * (along - std::sqrt(std::max(0.0f, disc.sine * disc.sine - aside * aside)));
      ray.far = 0.9999f;
    }
    packet.add(ray, weight);
  }
  return packet.cast(caster, count, tint);
}

// The same of an area lamp.
float area_lamp_fraction(const RayCaster& caster, const Light& light, const vec3& origin, const vec3& n,
                         uint32_t turn, RayCount& count, vec3* tint) {
  const AreaLampView view(light, origin, n);
  if (view.empty()) return 0;
  LampPacket packet;
  for (uint32_t i = 0; i < kPacket; ++i) {
    const UnitSquarePoint uv = r2_point(i, turn);
    float weight = 0;
    Ray ray{origin, view.way(uv.u, uv.v, weight)};
    ray.far = 0.9999f;  // it may be fixed to a surface
    if (weight > 0) packet.add(ray, weight);
  }
  return packet.cast(caster, count, tint);
}

}  // namespace

SeenShare Visibility::look(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n,
                           uint32_t rays, uint32_t turn, RayCount& count, SeenPoints* places,
                           Sight sight) const {
  const SourceSampler sampler{pool, source, x, n, epsilon, hash(turn ^ seed, source)};
  const bool hides = sampler.hides_itself();
  const bool keep = places != nullptr && is_surface(sampler.e.kind);
  SeenShare sum;
  std::array<Ray, kPacket> found, packet;
  std::array<SurfacePoint, kPacket> at;
  std::array<float, kPacket> weight, share, passing;
  std::array<vec3, kPacket> colour;
  const bool coloured = caster->is_coloured();
  std::array<uint32_t, kPacket> chosen;
  for (uint32_t first = 0; first < rays; first += kPacket) {
    const uint32_t batch = std::min(kPacket, rays - first);
    // Of two or three drawn blindly often all would bring nothing: then more are looked at, and rays go to
    // them in proportion to what they would bring.
    const uint32_t looked = hides ? std::max(batch, kLooked) : batch;
    uint32_t size = 0;
    float all = 0;
    for (uint32_t i = 0; i < looked; ++i) {
      weight[size] = sampler.draw(first + i, found[size], at[size]);
      if (weight[size] > 0) all += weight[size++];
    }
    if (size == 0) continue;
    const uint32_t cast = hides ? batch : size;
    const float start = unit_float(hash(sampler.turn, first));
    float up_to = weight[0];
    for (uint32_t k = 0, next = 0; k < cast; ++k) {
      if (hides) {
        share[k] = all / static_cast<float>(cast);
        for (const float target = share[k] * (static_cast<float>(k) + start);
             up_to < target && next + 1 < size;)
          up_to += weight[++next];
        chosen[k] = next;
      } else {
        share[k] = weight[k];
        chosen[k] = k;
      }
      packet[k] = found[chosen[k]];
      share[k] *= static_cast<float>(batch) / static_cast<float>(looked * rays);
    }
    if (sight == Sight::kClear) {
      std::fill_n(passing.begin(), cast, 1.0f);
      std::fill_n(colour.begin(), cast, vec3(1));
    } else {
      timed_packet(*caster, {packet.data(), cast}, {passing.data(), cast}, {colour.data(), cast}, count);
    }
    for (uint32_t k = 0; k < cast; ++k) {
      sum.seen += share[k] * passing[k];
      sum.hidden += share[k] * (1 - passing[k]);
      if (coloured) sum.by_channel += share[k] * colour[k];
      if (passing[k] <= 0 || !keep || places->count == SeenPoints::kMost) continue;
      places->points[places->count] = at[chosen[k]];
      places->tints[places->count] = coloured ? tint_of(colour[k], passing[k]) : vec3(1);
      places->weights[places->count++] = share[k] * passing[k];
    }
  }
  if (!coloured) sum.by_channel = vec3(sum.seen);
  return sum;
}

float Visibility::fraction(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n,
                           uint32_t rays, uint32_t turn, RayCount& count, float unknown, vec3* tint) const {
  if (tint != nullptr) *tint = vec3(1);
  const Element& e = pool[source];
  const vec3 origin = x + epsilon * n;
  if (e.kind == ElementKind::kPoint || e.kind == ElementKind::kSun) {
    const Light& light = pool.light(source);
    const uint32_t turned = hash(turn ^ seed, source);
    if (light.has_area()) return area_lamp_fraction(*caster, light, origin, n, turned, count, tint);
    const LightDisc disc = light_disc(light, x);
    if (disc.sine > 0) return disc_fraction(*caster, disc, origin, n, turned, count, tint);
    Ray ray{origin, -pool.light(source).direction};
    if (e.kind == ElementKind::kPoint) {
      ray.direction = e.centre - origin;
      ray.far = 0.9999f;
    }
    return timed_ray(*caster, ray, count, tint);
  }
  const SeenShare share = look(pool, source, x, n, rays, turn, count);
  if (share.seen + share.hidden > 0) {
    if (tint != nullptr && caster->is_coloured()) *tint = tint_of(share.by_channel, share.seen);
    return share.seen / (share.seen + share.hidden);
  }
  // No sample faces x although a little of the source does (a silhouette): a ray to just before it must do.
  if (e.kind == ElementKind::kSky) {
    const vec3 m = sky_form_factor(n, pool.sky_corners(source));
    return m == vec3(0) ? unknown : timed_ray(*caster, {origin, normalize(m)}, count, tint);
  }
  const vec3 to_centre = e.centre - origin;
  const float distance = length(to_centre);
  if (distance <= 1.01f * e.radius) return unknown;
  Ray ray{origin, to_centre};
  ray.far = 1 - 1.01f * e.radius / distance;
  return timed_ray(*caster, ray, count, tint);
}

}  // namespace goldthread
