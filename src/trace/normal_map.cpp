#include "trace/normal_map.h"

#include <algorithm>
#include <cmath>

namespace goldthread {
namespace {

/// Half a step of 8 bits, and a little for rounding, of numbers from -1 to 1.
constexpr float kFlat = 1.001f / 255;

/// Unit vectors along which the texture's red and green count; zero where there are none.
struct Tangents {
  vec3 tangent{0}, bitangent{0};
};

Tangents about(const vec3& front, const vec3& along_u, float sign) {
  const vec3 tangent = normalize_or(along_u - dot(along_u, front) * front, vec3(0));
  return {tangent, sign * cross(front, tangent)};
}

/// By the file's tangents. A mirrored instance mirrors their bitangent, too, which the cross product of what
/// is carried to the world does not know of.
Tangents given_tangents(const TracedScene& scene, const TracedPart& part, uint32_t triangle, vec2 weights,
                        const vec3& front) {
  const uint32_t* index = &part.source->indices[3 * size_t{scene.triangles()[triangle].source}];
  const std::vector<vec4>& tangents = part.source->tangents;
  const vec4 mixed = (1 - weights.x - weights.y) * tangents[index[0]] + weights.x * tangents[index[1]] +
                     weights.y * tangents[index[2]];
  const mat3 linear(scene.scene().instances[part.instance].transform);
  const bool turned = (mixed.w < 0) != (glm::determinant(linear) < 0);
  return about(front, linear * vec3(mixed), turned ? -1.0f : 1.0f);
}

/// By the triangle's texture coordinates alone. Green counts against v, which runs down the picture.
Tangents derived_tangents(const TracedScene& scene, const TracedPart& part, uint32_t triangle,
                          const std::vector<vec2>& texcoords, const vec3& front) {
  const uint32_t* index = &part.source->indices[3 * size_t{scene.triangles()[triangle].source}];
  const dvec2 a(texcoords[index[0]]), uv1 = dvec2(texcoords[index[1]]) - a,
                                      uv2 = dvec2(texcoords[index[2]]) - a;
  const double area = uv1.x * uv2.y - uv1.y * uv2.x;
  if (!(std::abs(area) > 0) || !std::isfinite(area)) return {};
  const dvec3 p(scene.corner(triangle, 0)), p1 = dvec3(scene.corner(triangle, 1)) - p,
                                            p2 = dvec3(scene.corner(triangle, 2)) - p;
  const vec3 along_u(glm::normalize((uv2.y * p1 - uv1.y * p2) / area));
  const vec3 along_v(glm::normalize((uv1.x * p2 - uv2.x * p1) / area));
  return about(front, along_u, dot(cross(front, along_u), along_v) > 0 ? -1.0f : 1.0f);
}

}  // namespace

vec3 bent_normal(const TracedScene& scene, uint32_t triangle, vec2 weights, const vec3& front) {
  const TracedPart& part = scene.parts()[scene.triangles()[triangle].part];
  const Material& material = *part.material;
  const Texture& texture = material.normal_texture;
  if (!texture.present()) return front;
  const std::vector<vec2>& texcoords = part.source->texcoords[std::min<uint8_t>(texture.texcoord, 1)];
  if (texcoords.empty()) return front;
  const uint32_t* index = &part.source->indices[3 * size_t{scene.triangles()[triangle].source}];
  const vec2 uv = (1 - weights.x - weights.y) * texcoords[index[0]] + weights.x * texcoords[index[1]] +
                  weights.y * texcoords[index[2]];
  vec3 local = 2.0f * vec3(sample_data_texture(texture, scene.scene().images, uv)) - 1.0f;
  for (int k = 0; k < 2; ++k)
    local[k] = std::abs(local[k]) <= kFlat ? 0.0f : local[k] * material.normal_scale;
  if (local.x == 0 && local.y == 0) return front;
  const Tangents t = part.source->tangents.empty() ? derived_tangents(scene, part, triangle, texcoords, front)
                                                   : given_tangents(scene, part, triangle, weights, front);
  if (t.tangent == vec3(0)) return front;
  return normalize_or(local.x * t.tangent + local.y * t.bitangent + local.z * front, front);
}

}  // namespace goldthread
