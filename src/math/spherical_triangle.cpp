#include "math/spherical_triangle.h"

#include <algorithm>
#include <array>

#include "math/form_factor.h"

namespace goldthread {

float solid_angle(const vec3& a, const vec3& b, const vec3& c) {
  const float triple = std::abs(dot(a, cross(b, c)));
  return 2 * std::atan2(triple, 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

vec3 sample_spherical_triangle(const vec3& a, const vec3& b, const vec3& c, float u, float v) {
  const vec3 ab = normalize_or(cross(a, b), vec3(0)), bc = normalize_or(cross(b, c), vec3(0)),
             ca = normalize_or(cross(c, a), vec3(0));
  const auto angle = [](const vec3& p, const vec3& q) {
    return std::acos(std::clamp(dot(p, q), -1.0f, 1.0f));
  };
  const float alpha = angle(ab, -ca), beta = angle(bc, -ab), gamma = angle(ca, -bc);
  const float area = u * (alpha + beta + gamma - kPi);
  const float cos_alpha = std::cos(alpha), sin_alpha = std::sin(alpha), cos_c = dot(a, b);
  // The triangle a, b, c' of that area has its third corner on the arc from a to c.
  const float s = std::sin(area - alpha), t = std::cos(area - alpha);
  const float p = t - cos_alpha, q = s + sin_alpha * cos_c;
  const float denominator = (q * s + p * t) * sin_alpha;
  const float cos_b = std::abs(denominator) > 1e-12f
                          ? std::clamp(((q * t - p * s) * cos_alpha - q) / denominator, -1.0f, 1.0f)
                          : dot(a, c);
  const vec3 towards_c = normalize_or(c - dot(c, a) * a, b);
  const vec3 corner = cos_b * a + std::sqrt(std::max(0.0f, 1 - cos_b * cos_b)) * towards_c;
  const float z = 1 - v * (1 - dot(corner, b));
  return z * b + std::sqrt(std::max(0.0f, 1 - z * z)) * normalize_or(corner - dot(corner, b) * b, a);
}

vec3 sample_spherical_polygon(std::span<const vec3> corners, float u, float v) {
  std::array<vec3, kMaxPolygon> unit;
  for (size_t i = 0; i < corners.size(); ++i) unit[i] = normalize_or(corners[i], vec3(0));
  std::array<float, kMaxPolygon> angles{};
  float total = 0;
  for (size_t i = 1; i + 1 < corners.size(); ++i)
    total += angles[i] = solid_angle(unit[0], unit[i], unit[i + 1]);
  if (!(total > 0)) return vec3(0);
  float target = u * total;
  size_t i = 1;
  while (i + 2 < corners.size() && target >= angles[i]) target -= angles[i++];
  const float share = angles[i] > 0 ? std::clamp(target / angles[i], 0.0f, 1.0f) : 0.5f;
  return sample_spherical_triangle(unit[0], unit[i], unit[i + 1], share, v);
}

}  // namespace goldthread
