// Scenes put together in a few words, for the tests of the light rooms.
#pragma once
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/shapes.h"
#include "scene/procedural.h"
#include "scene/scene.h"

namespace goldthread::test {

/// A diffuse one-sided material; exitance in lm/m².
inline Material diffuse(const vec3& reflectance, const vec3& exitance = vec3(0)) {
  Material material;
  material.base_colour = reflectance;
  material.metallic = 0;
  material.emission = exitance / kPi;
  return material;
}
inline Material diffuse(float reflectance, float exitance = 0) {
  return diffuse(vec3(reflectance), vec3(exitance));
}

inline uint32_t add(Scene& scene, Material material) {
  scene.materials.push_back(std::move(material));
  return uint32_t(scene.materials.size() - 1);
}

/// A mesh of one primitive with one instance. Returns the mesh.
inline uint32_t add(Scene& scene, const shapes::Soup& soup, uint32_t material,
                    const mat4& transform = mat4(1)) {
  Primitive primitive;
  primitive.positions = soup.positions;
  primitive.indices = soup.indices;
  primitive.material = material;
  Mesh mesh;
  mesh.primitives.push_back(std::move(primitive));
  scene.meshes.push_back(std::move(mesh));
  const auto number = uint32_t(scene.meshes.size() - 1);
  scene.instances.push_back({number, transform, 0, {}});
  return number;
}

/// The same with a material of its own. Returns the primitive, for changes.
inline Primitive& add(Scene& scene, const shapes::Soup& soup, Material material,
                      const mat4& transform = mat4(1)) {
  const uint32_t mesh = add(scene, soup, add(scene, std::move(material)), transform);
  return scene.meshes[mesh].primitives.back();
}

/// The polygon's fan of triangles; its front is where it runs counter-clockwise.
inline shapes::Soup polygon(std::vector<vec3> corners) {
  shapes::Soup soup;
  for (uint32_t i = 1; i + 1 < corners.size(); ++i) soup.triangle(0, i, i + 1);
  soup.positions = std::move(corners);
  return soup;
}

/// A square of the plane z = `height` around the z axis that faces up, or down.
inline shapes::Soup square(float half, float height, bool up) {
  const vec3 a(-half, -half, height), b(half, -half, height), c(half, half, height), d(-half, half, height);
  return polygon(up ? std::vector{a, b, c, d} : std::vector{a, d, c, b});
}

/// n by n quads of the parallelogram, facing cross(across, up).
inline shapes::Soup parallelogram(const vec3& corner, const vec3& across, const vec3& up, uint32_t n = 1) {
  shapes::Soup soup = shapes::flat_grid(n);
  for (vec3& p : soup.positions) p = corner + p.x * across + p.y * up;
  return soup;
}

/// The same triangles, facing the other way.
inline shapes::Soup turned(shapes::Soup soup) {
  for (size_t i = 0; i < soup.indices.size(); i += 3) std::swap(soup.indices[i + 1], soup.indices[i + 2]);
  return soup;
}

inline mat4 move(const vec3& by) {
  mat4 m(1);
  m[3] = vec4(by, 1);
  return m;
}
inline mat4 scale(const vec3& by) {
  mat4 m(1);
  for (int k = 0; k < 3; ++k) m[k][k] = by[k];
  return m;
}
inline mat4 turn(float angle, const vec3& axis) {
  return glm::mat4_cast(glm::angleAxis(angle, normalize(axis)));
}

inline Light lamp(LightKind kind, float intensity, const vec3& position, const vec3& direction = {0, 0, -1}) {
  Light light;
  light.kind = kind;
  light.intensity = vec3(intensity);
  light.position = position;
  light.direction = direction;
  return light;
}

inline Scene procedural(std::string_view name, uint64_t triangles = 0) {
  Result<Scene> scene = build_procedural(name, triangles);
  if (!scene) throw std::runtime_error(scene.error().line());
  return *std::move(scene);
}

}  // namespace goldthread::test
