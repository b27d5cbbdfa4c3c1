#include "session/power_balance.h"

#include <algorithm>
#include <atomic>

#include "base/parallel.h"
#include "base/rng.h"
#include "math/colour.h"
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

// Triangles in whose plane, within their reach, others of the same part face the opposite way: plates without
// thickness are modelled so, and a ray may meet either first.
std::vector<uint8_t> find_backed(const SurfaceSet& set) {
  struct Plane {
    std::array<int32_t, 4> key;
    bool turned = false;
    Box box;
    uint32_t triangle = 0;
  };
  std::vector<uint8_t> backed(set.triangles, 0);
  for (const Part& part : set.parts) {
    const TriangleMesh& mesh = set.tree(part).mesh;
    Box bounds;
    for (const vec3& p : part.positions)
      if (is_finite(p)) bounds.add(p);
    const float step = std::max(1e-5f * bounds.diagonal(), 1e-20f);
    std::vector<Plane> planes(mesh.triangles.size());
    for (uint32_t t = 0; t < planes.size(); ++t) {
      Plane& plane = planes[t];
      const UVec3& c = mesh.triangles[t];
      const vec3 &p = part.positions[c.x], &q = part.positions[c.y], &r = part.positions[c.z];
      vec3 n = normalize_or(area_vector(p, q, r), vec3(0, 1, 0));
      plane.turned = n.x + 0.6f * n.y + 0.3f * n.z < 0;
      if (plane.turned) n = -n;
      plane.key = {static_cast<int32_t>(std::lround(n.x * 500)), static_cast<int32_t>(std::lround(n.y * 500)),
                   static_cast<int32_t>(std::lround(n.z * 500)),
                   static_cast<int32_t>(std::lround(dot(n, p - bounds.centre()) / (10 * step)))};
      plane.triangle = part.first_triangle + t;
      for (const vec3& corner : {p, q, r}) plane.box.add(corner);
    }
    std::sort(planes.begin(), planes.end(), [](const Plane& x, const Plane& y) {
      return x.key != y.key ? x.key < y.key : x.triangle < y.triangle;
    });
    for (size_t i = 0, end = 0; i < planes.size(); i = end) {
      Box straight, turned;
      for (end = i; end < planes.size() && planes[end].key == planes[i].key; ++end)
        (planes[end].turned ? turned : straight).add(planes[end].box);
      if (straight.empty() || turned.empty()) continue;
      for (size_t k = i; k < end; ++k) {
        const Box &own = planes[k].box, &other = planes[k].turned ? straight : turned;
        const bool apart = glm::any(glm::greaterThan(own.low, other.high + step)) ||
                           glm::any(glm::greaterThan(other.low, own.high + step));
        if (!apart) backed[planes[k].triangle] = 1;
      }
    }
  }
  return backed;
}

struct Counter {
  const HierarchicalSolver& solver;
  uint32_t rays, seed;
  std::vector<uint8_t> backed;

  const ElementPool& pool() const { return solver.pool(); }

  // Whether a hit triangle takes light on the side that the ray meets.
  bool lands(const Hit& hit, const vec3& direction) const {
    const SurfaceSet& set = pool().surfaces();
    const Part& part = part_of_triangle(set, hit.triangle);
    const Material& material = set.scene->materials[part.material];
    if (material.unlit) return false;
    return material.double_sided || backed[hit.triangle] != 0 ||
           part.winding * dot(hit.normal, direction) < 0;
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

  // Where a ray from a surface point in a cosine direction ends: 0 on a lit side, 1 nowhere, 2 on an unlit
  // back.
  int end_of_ray(const SurfacePoint& x, uint32_t i) const {
    const UnitSquarePoint uv = r2_point(i, seed + 2);
    Ray ray;
    ray.direction = cosine_direction(x.normal, uv.u, uv.v);
    ray.origin = x.position + solver.visibility().epsilon * x.normal;
    const Hit hit = solver.visibility().caster->closest(ray);
    return hit.missed() ? 1 : lands(hit, ray.direction) ? 0 : 2;
  }

  // Flux that reaches surfaces straight from a sun, lm.
  double from_sun(const Leaves& by_area, ElementId light) const {
    const vec3 to_light = -pool().light(light).direction;
    const double share = mean(by_area, [&](ElementId, const SurfacePoint& x, uint32_t) {
      const float cosine = dot(x.normal, to_light);
      if (cosine <= 0) return 0.0;
      const Ray ray{x.position + solver.visibility().epsilon * x.normal, to_light};
      return solver.visibility().caster->occluded(ray) ? 0.0 : static_cast<double>(cosine);
    });
    return share * by_area.total() * static_cast<double>(luminance(pool()[light].exitance));
  }

  // Flux of a point or spot light: all of it, and the shares that land and that fall on backs.
  void from_point(ElementId id, double& all, double& landing, double& on_backs) const {
    const Light& light = pool().light(id);
    const double intensity = static_cast<double>(luminance(light.intensity));
    double sum = 0, landed = 0, backs = 0;
    const uint32_t count = std::min(rays, 100000u);
    for (uint32_t i = 0; i < count; ++i) {
      const UnitSquarePoint uv = r2_point(i, seed + 3);
      const float z = 1 - 2 * uv.u, r = std::sqrt(std::max(0.0f, 1 - z * z)), angle = 2 * kPi * uv.v;
      const vec3 d(r * std::cos(angle), r * std::sin(angle), z);
      // The transfer at unit distance is the light's own distribution.
      Light open = light;
      open.range = 0;
      const double strength = static_cast<double>(light_distribution(open, d));
      if (strength <= 0) continue;
      sum += strength;
      const Hit hit = solver.visibility().caster->closest({light.position, d});
      if (hit.missed()) continue;
      const double reach = static_cast<double>(light_range_factor(light, hit.distance));
      (lands(hit, d) ? landed : backs) += strength * reach;
      sum -= strength * (1 - reach);  // glTF's range takes light away
    }
    const double scale = intensity * 4 * static_cast<double>(kPi) / count;
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
  const Counter counter{solver, rays, seed, find_backed(pool.surfaces())};
  const auto area = [](const Element& e) { return static_cast<double>(e.area); };
  double landing = 0, reflected = 0, own = 0;
  const Leaves by_power = collect(pool, [&](ElementId id, const Element& e) {
    landing += area(e) * static_cast<double>(e.coverage * luminance(state.irradiance[id]));
    reflected += area(e) * static_cast<double>(luminance(e.reflectance * state.irradiance[id]));
    own += area(e) * static_cast<double>(luminance(e.exitance));
    return area(e) * static_cast<double>(luminance(state.radiosity[id]));
  });
  const Leaves by_area =
      collect(pool, [&](ElementId, const Element& e) { return area(e) * static_cast<double>(e.coverage); });

  const double leaving = by_power.total();
  balance.escaped = leaving * counter.mean(by_power, [&](ElementId, const SurfacePoint& x, uint32_t i) {
    return counter.end_of_ray(x, i) == 1 ? 1.0 : 0.0;
  });
  double on_backs = leaving * counter.mean(by_power, [&](ElementId, const SurfacePoint& x, uint32_t i) {
    return counter.end_of_ray(x, i) == 2 ? 1.0 : 0.0;
  });
  balance.emitted = own;
  const Sky& sky = pool.surfaces().scene->sky;
  if (sky.present())
    balance.emitted += by_area.total() * static_cast<double>(kPi * luminance(sky.radiance)) *
                       counter.mean(by_area, [&](ElementId, const SurfacePoint& x, uint32_t i) {
                         return counter.end_of_ray(x, i) == 1 ? 1.0 : 0.0;
                       });
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
