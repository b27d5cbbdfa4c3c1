#include "trace/emitter_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "math/colour.h"
#include "trace/scrambled_sobol.h"

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
  const double root = std::sqrt(u);
  return {static_cast<float>(root * (1 - v)), static_cast<float>(root * v)};
}

/// Lumens that leave a triangle, its texture averaged over a few dozen points.
double power_of(const TracedScene& scene, uint32_t triangle) {
  const Material& m = scene.material(triangle);
  const bool even = !m.emission_texture.present() && m.alpha_mode == AlphaMode::kOpaque;
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

}  // namespace

EmitterTable::EmitterTable(const TracedScene& scene) : density_(scene.triangles().size(), 0.0f) {
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
    triangles_.push_back(t);
    up_to_.push_back(total);
  }
  double before = 0;
  for (size_t i = 0; i < triangles_.size(); ++i) {
    up_to_[i] = i + 1 < triangles_.size() ? up_to_[i] / total : 1;
    density_[triangles_[i]] =
        static_cast<float>((up_to_[i] - before) / static_cast<double>(scene.area(triangles_[i])));
    before = up_to_[i];
  }
  for (size_t i = 0; i < twins.size(); ++i) density_[twins[i]] = density_[originals[i]];
  guide_.resize(triangles_.size());
  for (uint32_t i = 0, t = 0; i < guide_.size(); ++i) {
    while (up_to_[t] <= static_cast<double>(i) / static_cast<double>(guide_.size())) ++t;
    guide_[i] = t;
  }
}

EmitterTable::Point EmitterTable::sample(double u, double v) const {
  size_t i = guide_[static_cast<size_t>(u * static_cast<double>(guide_.size()))];
  while (up_to_[i] <= u) ++i;
  const double low = i > 0 ? up_to_[i - 1] : 0;
  const double inside = std::clamp((u - low) / (up_to_[i] - low), 0.0, 1.0);
  return {triangles_[i], to_triangle(inside, v), density_[triangles_[i]]};
}

}  // namespace goldthread
