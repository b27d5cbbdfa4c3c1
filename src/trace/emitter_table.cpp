#include "trace/emitter_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/check.h"
#include "math/colour.h"

namespace goldthread {
namespace {

using CornerKey = std::array<float, 9>;

/// A triangle's corners in their order, starting from the least: equal for triangles in the same place that
/// face the same way.
CornerKey key_of(const TracedScene& scene, uint32_t triangle) {
  std::array<std::array<float, 3>, 3> corners;
  for (int k = 0; k < 3; ++k) {
    const vec3& p = scene.corner(triangle, k);
    corners[static_cast<size_t>(k)] = {p.x, p.y, p.z};
  }
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  CornerKey key;
  for (size_t i = 0; i < key.size(); ++i) key[i] = corners[i / 3][i % 3];
  return key;
}

vec2 to_triangle(double u, double v) {
  const float root = std::sqrt(static_cast<float>(u)), share = static_cast<float>(v);
  return {root * (1 - share), root * share};
}

bool is_even(const Material& m) {
  return !m.emission_texture.present() && !m.is_see_through();
}

/// Lumens that leave a triangle, its texture averaged over a few dozen points.
double power_of(const TracedScene& scene, uint32_t triangle) {
  const Material& m = scene.material(triangle);
  const bool even = is_even(m);
  const uint32_t count = even ? 1 : 64;
  double sum = 0;
  for (uint32_t i = 0; i < count; ++i) {
    const SobolPoint p = sobol_point(i, triangle);
    const vec2 weights = even ? vec2(1 / 3.0f) : to_triangle(unit_double(p.u), unit_double(p.v));
    sum +=
        static_cast<double>(luminance(scene.emission(triangle, weights)) * scene.coverage(triangle, weights));
  }
  const double sides = m.double_sided ? 2 : 1;
  return sum / count * sides * static_cast<double>(scene.area(triangle) * kPi);
}

Emitter emitter_of(const TracedScene& scene, uint32_t triangle) {
  Emitter e;
  e.corner = scene.corner(triangle, 0);
  e.across = scene.corner(triangle, 1) - e.corner;
  e.up = scene.corner(triangle, 2) - e.corner;
  e.normal = scene.triangles()[triangle].normal;
  e.triangle = triangle;
  e.double_sided = scene.material(triangle).double_sided;
  e.even = is_even(scene.material(triangle));
  e.nits = e.even ? scene.emission(triangle, vec2(0)) : vec3(0);
  return e;
}

}  // namespace

EmitterTable::EmitterTable(const TracedScene& scene)
    : scene_(scene), density_(scene.triangles().size(), 0.0f) {
  std::map<CornerKey, uint32_t> places;
  std::vector<uint32_t> twins, originals;
  double total = 0;
  for (uint32_t t = 0; t < density_.size(); ++t) {
    if (!scene.material(t).emits() || scene.material(t).unlit) continue;
    const auto [place, is_new] = places.try_emplace(key_of(scene, t), t);
    if (!is_new) {
      twins.push_back(t);
      originals.push_back(place->second);
      continue;
    }
    const double power = power_of(scene, t);
    if (!(power > 0) || !std::isfinite(power)) continue;
    total += power;
    emitters_.push_back(emitter_of(scene, t));
    emitters_.back().up_to = total;
  }
  double before = 0;
  for (Emitter& e : emitters_) {
    e.up_to = &e == &emitters_.back() ? 1 : e.up_to / total;
    e.from = before;
    e.per_share = 1 / (e.up_to - e.from);
    e.density = static_cast<float>((e.up_to - e.from) / static_cast<double>(scene.area(e.triangle)));
    density_[e.triangle] = e.density;
    before = e.up_to;
  }
  for (size_t i = 0; i < twins.size(); ++i) density_[twins[i]] = density_[originals[i]];
  guide_.resize(emitters_.size());
  for (uint32_t i = 0, e = 0; i < guide_.size(); ++i) {
    while (emitters_[e].up_to <= static_cast<double>(i) / static_cast<double>(guide_.size())) ++e;
    guide_[i] = e;
  }
}

const Emitter& EmitterTable::at(double share) const {
  size_t i = guide_[static_cast<size_t>(share * static_cast<double>(guide_.size()))];
  while (emitters_[i].up_to <= share) ++i;
  return emitters_[i];
}

void EmitterTable::sample(std::span<const SobolPoint> points, EmitterPoints& drawn) const {
  GOLDTHREAD_CHECK_LE(points.size(), kLanes);
  for (size_t i = 0; i < points.size(); ++i) {
    const double u = unit_double(points[i].u);
    const Emitter& e = at(u);
    const vec2 weights =
        to_triangle(std::clamp((u - e.from) * e.per_share, 0.0, 1.0), unit_double(points[i].v));
    drawn.points.set(i, e.corner + weights.x * e.across + weights.y * e.up);
    drawn.normals.set(i, e.normal);
    drawn.density[i] = e.density;
    drawn.two_sided[i] = e.double_sided ? 1.0f : 0.0f;
    drawn.emitters[i] = &e;
    drawn.weights[i] = weights;
  }
}

vec3 EmitterTable::nits(const Emitter& emitter, vec2 weights) const {
  if (emitter.even) return emitter.nits;
  return scene_.emission(emitter.triangle, weights) * scene_.coverage(emitter.triangle, weights);
}

}  // namespace goldthread
