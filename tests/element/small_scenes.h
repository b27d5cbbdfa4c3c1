// Scenes put together in a few words, for the tests of the light rooms.
#pragma once
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "element/element_pool.h"
#include "element/surface_set.h"
#include "mesh/shapes.h"
#include "scene/scene.h"

namespace goldthread::test {

/// A diffuse material; exitance in lm/m^2.
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

/// The polygon's fan of triangles, sending to the side from which it runs counter-clockwise.
inline shapes::Soup polygon(std::vector<vec3> corners) {
  shapes::Soup soup;
  for (uint32_t i = 1; i + 1 < corners.size(); ++i) soup.triangle(0, i, i + 1);
  soup.positions = std::move(corners);
  return soup;
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

/// Numbers that are the same on every machine.
struct Random {
  std::mt19937 engine;
  explicit Random(uint32_t seed) : engine(seed) {}
  float in(float low, float high) {
    return low + (high - low) * static_cast<float>(engine() >> 8) * 0x1p-24f;
  }
  uint32_t below(uint32_t count) { return uint32_t(engine() % count); }
  vec3 point() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
  vec3 direction() {
    const float z = in(-1, 1), angle = in(0, 2 * kPi), r = std::sqrt(std::max(0.0f, 1 - z * z));
    return normalize(vec3(r * std::cos(angle), r * std::sin(angle), z));
  }
};

/// A scene with its surfaces and elements; keeps all three where they are.
struct Elements {
  std::unique_ptr<Scene> scene;
  std::unique_ptr<SurfaceSet> set;
  std::unique_ptr<ElementPool> pool;

  explicit Elements(Scene s) : scene(std::make_unique<Scene>(std::move(s))) {
    set = std::make_unique<SurfaceSet>(build_surfaces(*scene, CancelToken()));
    pool = std::make_unique<ElementPool>(*set);
  }

  /// Childless elements of surfaces and lights, ascending.
  std::vector<ElementId> leaves() const {
    std::vector<ElementId> out;
    for (ElementId id = 0; id < pool->size(); ++id)
      if ((*pool)[id].first_child == kNoElement) out.push_back(id);
    return out;
  }
  /// Makes children everywhere, `times` over.
  void expand(int times) {
    for (int i = 0; i < times; ++i) pool->expand(leaves());
  }
  /// Makes children of a random share of the leaves, `times` over.
  void expand_some(Random& random, int times, float share) {
    for (int i = 0; i < times; ++i) {
      std::vector<ElementId> some;
      for (const ElementId id : leaves())
        if (random.in(0, 1) < share) some.push_back(id);
      pool->expand(some);
    }
  }
};

}  // namespace goldthread::test
