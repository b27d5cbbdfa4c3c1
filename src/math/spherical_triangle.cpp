#include "math/spherical_triangle.h"

#include <algorithm>

namespace goldthread {

float solid_angle(const vec3& a, const vec3& b, const vec3& c) {
  const float triple = std::abs(dot(a, cross(b, c)));
  return 2 * std::atan2(triple, 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

vec3 sample_spherical_triangle(const vec3& a, const vec3& b, const vec3& c, float angle, float u, float v) {
  const vec3 ab = normalize_or(cross(a, b), vec3(0)), ac = normalize_or(cross(a, c), vec3(0));
  // alpha is the angle at a; the sine by its own, or small ones would be lost in rounding.
  const vec2 alpha = vec2(dot(ab, ac), length(cross(ab, ac)));
  const float unit = 1 / std::max(length(alpha), 1e-20f);
  const float cos_alpha = unit * alpha.x, sin_alpha = unit * alpha.y, cos_c = dot(a, b), whole_b = dot(a, c);
  // The triangle a, b, c' of the wanted area has its third corner on the arc from a to c. Here s and t are
  // sine and cosine of area - alpha.
  const float area = u * angle, sin_area = std::sin(area), cos_area = std::cos(area);
  const float s = sin_area * cos_alpha - cos_area * sin_alpha,
              t = cos_area * cos_alpha + sin_area * sin_alpha;
  const float p = t - cos_alpha, q = s + sin_alpha * cos_c;
  const float denominator = (q * s + p * t) * sin_alpha;
  const float cos_b = std::abs(denominator) > 1e-12f
                          ? std::min(std::max(((q * t - p * s) * cos_alpha - q) / denominator, whole_b), 1.0f)
                          : whole_b;
  const vec3 towards_c = normalize_or(c - whole_b * a, b);
  const vec3 corner = cos_b * a + std::sqrt(std::max(0.0f, 1 - cos_b * cos_b)) * towards_c;
  const float z = 1 - v * (1 - dot(corner, b));
  return z * b + std::sqrt(std::max(0.0f, 1 - z * z)) * normalize_or(corner - dot(corner, b) * b, a);
}

SphericalPolygon::SphericalPolygon(std::span<const vec3> corners) : count_(corners.size()) {
  for (size_t i = 0; i < count_; ++i) unit_[i] = normalize_or(corners[i], vec3(0));
  for (size_t i = 1; i + 1 < count_; ++i)
    total_ += angles_[i] = goldthread::solid_angle(unit_[0], unit_[i], unit_[i + 1]);
}

vec3 SphericalPolygon::sample(float u, float v) const {
  if (!(total_ > 0)) return vec3(0);
  float target = u * total_;
  size_t i = 1;
  while (i + 2 < count_ && target >= angles_[i]) target -= angles_[i++];
  const float share = angles_[i] > 0 ? std::clamp(target / angles_[i], 0.0f, 1.0f) : 0.5f;
  return sample_spherical_triangle(unit_[0], unit_[i], unit_[i + 1], angles_[i], share, v);
}

}  // namespace goldthread
