// The vector types used everywhere: glm's, under short names. Metres, right-handed, Y up as glTF.
#pragma once
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include <cmath>
#include <cstdint>

namespace goldthread {

using glm::cross;
using glm::dot;
using glm::dvec2;
using glm::dvec3;
using glm::length;
using glm::mat3;
using glm::mat4;
using glm::normalize;
using glm::vec2;
using glm::vec3;
using glm::vec4;
using UVec3 = glm::uvec3;

constexpr float kPi = 3.14159265358979323846f;

inline bool is_finite(const vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// v scaled to length 1, or `otherwise` when v is (nearly) zero.
inline vec3 normalize_or(const vec3& v, const vec3& otherwise) {
  const float squared = dot(v, v);
  return squared > 1e-30f ? v / std::sqrt(squared) : otherwise;
}

/// The linear map that carries area vectors when points are carried by `m`: its cofactor matrix.
inline mat3 area_vector_transform(const mat3& m) {
  return mat3(cross(m[1], m[2]), cross(m[2], m[0]), cross(m[0], m[1]));
}

}  // namespace goldthread
