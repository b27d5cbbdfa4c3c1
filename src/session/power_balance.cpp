#include "session/power_balance.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "base/rng.h"
#include "math/colour.h"
#include "session/light_setup.h"
#include "solve/hierarchical/point_transfer.h"

namespace goldthread {
namespace {

// Leaves of the hierarchy with a running sum of some weight, to draw from in proportion.
struct Leaves {
  std::vector<ElementId> ids;
  std::vector<double> up_to;

  double total() const { return up_to.empty() ? 0 : up_to.back(); }
  // The leaf at `share` of the total; `rest` is the position within it, 0..1.
  ElementId at(double share, float& rest) const {
    const double target = share * total();
    const size_t i =
        std::min(ids.size() - 1,
                 static_cast<size_t>(std::upper_bound(up_to.begin(), up_to.end(), target) - up_to.begin()));
    const double low = i > 0 ? up_to[i - 1] : 0;
    rest = static_cast<float>(std::clamp((target - low) / std::max(up_to[i] - low, 1e-300), 0.0, 0.999999));
    return ids[i];
  }
};

template <typename Weight>
Leaves collect(const ElementPool& pool, const Weight& weight) {
  Leaves leaves;
  double sum = 0;
  std::vector<ElementId> stack{pool.root()};
  while (!stack.empty()) {
    const ElementId id = stack.back();
    stack.pop_back();
    const Element& e = pool[id];
    if (e.first_child != kNoElement) {
      stack.push_back(e.first_child + 1);
      stack.push_back(e.first_child);
      continue;
    }
    const double w = weight(id, e);
    if (!(w > 0)) continue;
    sum += w;
    leaves.ids.push_back(id);
    leaves.up_to.push_back(sum);
  }
  return leaves;
}

vec3 cosine_direction(const vec3& n, float u, float v) {
  const float radius = std::sqrt(u), angle = 2 * kPi * v;
  const vec3 t = normalize(std::abs(n.x) > 0.6f ? vec3(n.y, -n.x, 0) : vec3(0, n.z, -n.y));
  return radius * (std::cos(angle) * t + std::sin(angle) * cross(n, t)) +
         std::sqrt(std::max(0.0f, 1 - u)) * n;
}

struct Counter {
  const HierarchicalSolver& solver;
  uint32_t rays, seed;

  const ElementPool& pool() const { return solver.pool(); }

  // Whether a triangle takes light on the side that a ray meets.
  bool takes(uint32_t triangle, const vec3& normal, const vec3& direction) const {
    const Part& part = part_of_triangle(pool().surfaces(), triangle);
    const Material& material = pool().surfaces().scene->materials[part.material];
    return !material.unlit && (material.lit_behind() || part.winding * dot(normal, direction) < 0);
  }

  // Whether light lands where a ray hits: on that triangle, or on one in the same place. Plates without
  // thickness are modelled as two that face opposite ways, and a ray may meet either first.
  bool lands(const Ray& ray, const Hit& hit) const {
    if (takes(hit.triangle, hit.normal, ray.direction)) return true;
    const Visibility& visibility = solver.visibility();
    const vec3 p = ray.origin + hit.distance * ray.direction;
    bool found = false;
    // The hit itself is rounded, too.
    const float tolerance = 2 * visibility.epsilon;
    visibility.caster->near(p, tolerance, [&](uint32_t triangle) {
      const SurfaceSet& set = pool().surfaces();
      const Part& part = part_of_triangle(set, triangle);
      const UVec3& c = set.tree(part).mesh.triangles[triangle - part.first_triangle];
      const vec3 &a = part.positions[c.x], &b = part.positions[c.y], &d = part.positions[c.z];
      const vec3 normal = area_vector(a, b, d);
      found |= std::abs(dot(normalize_or(normal, vec3(0)), normalize_or(hit.normal, vec3(0)))) > 0.999f &&
               takes(triangle, normal, ray.direction) && lies_on_triangle(p, a, b, d, tolerance);
    });
    return found;
  }

  // Averages body(leaf, point, index) over points drawn by the leaves' weights.
  template <typename Body>
  double mean(const Leaves& leaves, const Body& body) const {
    if (leaves.ids.empty()) return 0;
    // Fixed-point, so that the sum does not depend on the order of threads.
    std::atomic<int64_t> sum{0};
    parallel_for(
        rays,
        [&](size_t i) {
          float rest = 0;
          const double jitter = static_cast<double>(unit_float(hash(static_cast<uint32_t>(i), seed)));
          const ElementId leaf = leaves.at((static_cast<double>(i) + jitter) / rays, rest);
          const SurfacePoint x =
              pool().sample_at(leaf, rest, unit_float(hash(static_cast<uint32_t>(i), seed + 1)));
          sum.fetch_add(static_cast<int64_t>(body(leaf, x, static_cast<uint32_t>(i)) * 1e6),
                        std::memory_order_relaxed);
        },
        256);
    return static_cast<double>(sum.load()) / 1e6 / rays;
  }

  Ray cosine_ray(const SurfacePoint& x, uint32_t i) const {
    const UnitSquarePoint uv = r2_point(i, seed + 2);
    Ray ray;
    ray.direction = cosine_direction(x.normal, uv.u, uv.v);
    ray.origin = x.position + solver.visibility().epsilon * x.normal;
    return ray;
  }

  // Where a ray from a surface point in a cosine direction ends: on a lit side, nowhere, or on an unlit back;
  // and what the light that gets there was multiplied by on its way.
  enum class End : uint8_t { kLit, kNowhere, kBack };
  struct Arrival {
    End end = End::kLit;
    vec3 light{1};
  };
  Arrival end_of_ray(const SurfacePoint& x, uint32_t i) const { return arrival(cosine_ray(x, i)); }

  // What is left of the luminance of `light` when it is multiplied by `by`.
  static double relative(const vec3& by, const vec3& light) {
    const auto all = static_cast<double>(luminance(light));
    return all > 0 ? static_cast<double>(luminance(by * light)) / all : 1;
  }

  Arrival arrival(const Ray& ray, float* distance = nullptr) const {
    const Hit hit = solver.visibility().caster->closest(ray);
    if (hit.missed()) return {End::kNowhere, hit.tint};
    if (distance != nullptr) *distance = hit.distance;
    return {lands(ray, hit) ? End::kLit : End::kBack, hit.tint * stopped(hit)};
  }

  // What a stopped ray stands for, of the light that came: coloured glass stops more of some colours.
  vec3 stopped(const Hit& hit) const {
    const SurfaceSet& set = pool().surfaces();
    const Material& material = set.scene->materials[part_of_triangle(set, hit.triangle).material];
    if (!material.is_glass()) return vec3(1);
    const Passing passing = transparency(hit.triangle, hit.weights, set);
    return (1.0f - passing.light) / std::max(1 - passing.rays, 1e-6f);
  }

  // Luminance of what stops at a leaf of the light that comes to it, over its coverage, by which leaves are
  // drawn.
  double share_that_stops(ElementId leaf, const vec3& light) const {
    if (!pool().surfaces().has_glass) return static_cast<double>(luminance(light));
    return static_cast<double>(luminance(pool().stopped(leaf) * light) / pool()[leaf].coverage);
  }

  // Flux that reaches surfaces straight from the sky, lm. Rays are counted in shares of the sky's mean, for
  // `mean` sums in fixed point.
  double from_sky(const Leaves& by_area, const Sky& sky) const {
    double level = 0;
    for (const ElementId id : pool().lights())
      if (pool()[id].kind == ElementKind::kSky)
        level +=
            static_cast<double>(luminance(pool()[id].exitance) * pool().sky_cell(id).solid_angle / (4 * kPi));
    if (!(level > 0)) return 0;
    const double share = mean(by_area, [&](ElementId leaf, const SurfacePoint& x, uint32_t i) {
      const Arrival sky_end = end_of_ray(x, i);
      if (sky_end.end != End::kNowhere) return 0.0;
      return share_that_stops(leaf, kPi * sky_end.light * sky.radiance_towards(cosine_ray(x, i).direction)) /
             level;
    });
    return share * level * by_area.total();
  }

  // Flux that reaches surfaces straight from a sun, lm.
  double from_sun(const Leaves& by_area, ElementId light) const {
    const vec3 to_light = -pool().light(light).direction;
    const double all = static_cast<double>(luminance(pool()[light].exitance));
    if (!(all > 0)) return 0;
    const double share = mean(by_area, [&](ElementId leaf, const SurfacePoint& x, uint32_t) {
      const float cosine = dot(x.normal, to_light);
      if (cosine <= 0) return 0.0;
      const Ray ray{x.position + solver.visibility().epsilon * x.normal, to_light};
      vec3 passing;
      solver.visibility().caster->transmittance({&ray, 1}, {&passing, 1});
      return share_that_stops(leaf, cosine * passing * pool()[light].exitance) / all;
    });
    return share * by_area.total() * all;
  }

  // A ray of a lamp's light: of a point or spot light one of all ways, with the share of the intensity that
  // goes there; of an area lamp from anywhere on it, by the cosine, each of the same share.
  struct LampRay {
    Ray ray;
    double strength = 1;
  };
  LampRay lamp_ray(const Light& light, uint32_t i) const {
    if (!light.has_area()) {
      const UnitSquarePoint uv = r2_point(i, seed + 3);
      const float z = 1 - 2 * uv.u, r = std::sqrt(std::max(0.0f, 1 - z * z)), angle = 2 * kPi * uv.v;
      const vec3 d(r * std::cos(angle), r * std::sin(angle), z);
      return {{light.position, d}, static_cast<double>(light_distribution(light, d))};
    }
    const auto [uv, at] = r4_point(i, seed + 3);
    vec2 place(at.u - 0.5f, at.v - 0.5f);
    if (light.kind == LightKind::kDisc)
      place = 0.5f * std::sqrt(at.u) * vec2(std::cos(2 * kPi * at.v), std::sin(2 * kPi * at.v));
    place *= light.size;
    const vec3 up = cross(light.direction, light.across);
    return {{light.position + place.x * light.across + place.y * up +
                 solver.visibility().epsilon * light.direction,
             cosine_direction(light.direction, uv.u, uv.v)}};
  }

  // Flux of a lamp that is somewhere: all of it, and the shares that land and that fall on backs.
  void from_point(ElementId id, double& all, double& landing, double& on_backs) const {
    const Light& light = pool().light(id);
    const double intensity = static_cast<double>(luminance(light.intensity));
    double sum = 0, landed = 0, backs = 0;
    const uint32_t count = std::min(rays, 100000u);
    for (uint32_t i = 0; i < count; ++i) {
      const auto [ray, strength] = lamp_ray(light, i);
      if (strength <= 0) continue;
      sum += strength;
      float distance = 0;
      const Arrival there = arrival(ray, &distance);
      if (there.end == End::kNowhere) continue;
      const double reach = static_cast<double>(light_range_factor(light, distance));
      (there.end == End::kLit ? landed : backs) += strength * reach * relative(there.light, light.intensity);
      sum -= strength * (1 - reach);  // glTF's range takes light away
    }
    const double scale = intensity * (light.has_area() ? 1 : 4) * static_cast<double>(kPi) / count;
    all = sum * scale;
    landing = landed * scale;
    on_backs = backs * scale;
  }
};

}  // namespace

PowerBalance measure_power(const HierarchicalSolver& solver, uint32_t rays, uint32_t seed) {
  PowerBalance balance;
  const ElementPool& pool = solver.pool();
  if (pool.root() == kNoElement) return balance;
  const RadiosityState& state = solver.state();
  const Counter counter{solver, rays, seed};
  const auto area = [](const Element& e) { return static_cast<double>(e.area); };
  const bool glass = pool.surfaces().has_glass;
  double landing = 0, reflected = 0, own = 0;
  const Leaves by_power = collect(pool, [&](ElementId id, const Element& e) {
    landing += glass ? area(e) * static_cast<double>(luminance(pool.stopped(id) * state.irradiance[id]))
                     : area(e) * static_cast<double>(e.coverage * luminance(state.irradiance[id]));
    reflected += area(e) * static_cast<double>(
                               luminance((e.reflectance + pool.transmittance(id)) * state.irradiance[id]));
    own += area(e) * static_cast<double>(luminance(e.exitance));
    return area(e) * static_cast<double>(luminance(state.radiosity[id]));
  });
  const Leaves by_area =
      collect(pool, [&](ElementId, const Element& e) { return area(e) * static_cast<double>(e.coverage); });

  const double leaving = by_power.total();
  const auto ending = [&](Counter::End end) {
    return leaving * counter.mean(by_power, [&](ElementId id, const SurfacePoint& x, uint32_t i) {
      const Counter::Arrival there = counter.end_of_ray(x, i);
      return there.end == end ? Counter::relative(there.light, state.radiosity[id]) : 0.0;
    });
  };
  balance.escaped = ending(Counter::End::kNowhere);
  double on_backs = ending(Counter::End::kBack);
  balance.emitted = own;
  const Sky& sky = pool.surfaces().scene->sky;
  if (sky.present()) balance.emitted += counter.from_sky(by_area, sky);
  for (const ElementId light : pool.lights()) {
    if (pool[light].kind == ElementKind::kSun) balance.emitted += counter.from_sun(by_area, light);
    if (pool[light].kind != ElementKind::kPoint) continue;
    double all = 0, landed = 0, backs = 0;
    counter.from_point(light, all, landed, backs);
    balance.emitted += all;
    balance.escaped += all - landed - backs;
    on_backs += backs;
  }
  balance.absorbed = landing - reflected + on_backs;
  balance.residual = balance.emitted - balance.absorbed - balance.escaped;
  return balance;
}

}  // namespace goldthread
