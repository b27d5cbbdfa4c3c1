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

/// Lumens that leave a triangle.
double power_of(const TracedScene& scene, uint32_t triangle) {
  const double sides = scene.material(triangle).double_sided ? 2 : 1;
  return static_cast<double>(scene.mean_luminance(triangle)) * sides *
         static_cast<double>(scene.area(triangle) * kPi);
}

Emitter emitter_of(const TracedScene& scene, uint32_t triangle) {
  Emitter e;
  e.corner = scene.corner(triangle, 0);
  e.across = scene.corner(triangle, 1) - e.corner;
  e.up = scene.corner(triangle, 2) - e.corner;
  e.normal = scene.triangles()[triangle].normal;
  e.triangle = triangle;
  const Material& material = scene.material(triangle);
  e.double_sided = material.double_sided;
  e.covered = scene.triangles()[triangle].covered;
  e.even = !material.emission_texture.present() && !material.is_see_through() && !e.covered;
  e.nits = e.even ? scene.emission(triangle, vec2(0)) : vec3(0);
  return e;
}

}  // namespace

EmitterTable::EmitterTable(const TracedScene& scene)
    : scene_(scene), density_(scene.triangles().size(), 0.0f) {
  const auto shines = [&](uint32_t t) { return scene.material(t).emits() && !scene.material(t).unlit; };
  std::map<CornerKey, uint32_t> places;  // and who of all with these corners is there
  for (uint32_t t = 0; t < density_.size(); ++t) {
    if (!shines(t)) continue;
    uint32_t& there = places.try_emplace(key_of(scene, t), t).first->second;
    if (scene.owns(t, there)) there = t;
  }
  std::vector<uint32_t> twins, originals;
  double total = 0;
  for (uint32_t t = 0; t < density_.size(); ++t) {
    if (!shines(t)) continue;
    if (const uint32_t there = places.at(key_of(scene, t)); there != t) {
      twins.push_back(t);
      originals.push_back(there);
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
  const vec3 p = emitter.corner + weights.x * emitter.across + weights.y * emitter.up;
  if (emitter.covered && scene_.is_covered(emitter.triangle, p)) return vec3(0);
  return scene_.emission(emitter.triangle, weights) * scene_.coverage(emitter.triangle, weights);
}

}  // namespace goldthread
