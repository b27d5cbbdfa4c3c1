// Made-up light for a scene, so that writers can be tested without a solver.
#pragma once
#include "scene/lighting.h"
#include "scene/scene.h"

namespace goldthread::test {

/// Light on every primitive of every instance, vertex i of instance n getting (n + 1, i, 0.5) lux.
inline Lighting light_all(const Scene& scene) {
  Lighting lighting;
  for (uint32_t n = 0; n < scene.instances.size(); ++n) {
    const Mesh& mesh = scene.meshes[scene.instances[n].mesh];
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      LitPrimitive lit;
      lit.instance = n;
      lit.primitive = p;
      for (size_t i = 0; i < mesh.primitives[p].positions.size(); ++i)
        lit.irradiance.emplace_back(float(n + 1), float(i), 0.5f);
      if (scene.materials[mesh.primitives[p].material].double_sided) lit.irradiance_back = lit.irradiance;
      lighting.primitives.push_back(std::move(lit));
    }
  }
  return lighting;
}

/// The same light on meshes in which every triangle is halved: a vertex for each corner and one between
/// corners 1 and 2.
inline Lighting light_refined(const Scene& scene) {
  Lighting lighting = light_all(scene);
  for (LitPrimitive& lit : lighting.primitives) {
    const Primitive& primitive = scene.meshes[scene.instances[lit.instance].mesh].primitives[lit.primitive];
    lit.source_mesh = false;
    const bool two_sided = !lit.irradiance_back.empty();
    for (uint32_t t = 0; t < primitive.triangle_count(); ++t) {
      const uint32_t first = 4 * t;
      for (const vec2& weights : {vec2(0), vec2(1, 0), vec2(0, 1), vec2(0.5f)})
        lit.origins.push_back({t, weights});
      lit.faces.insert(lit.faces.end(),
                       {UVec3(first, first + 1, first + 3), UVec3(first, first + 3, first + 2)});
      lit.face_parents.insert(lit.face_parents.end(), 2, t);
    }
    lit.irradiance.assign(lit.origins.size(), vec3(100, 50, 25));
    lit.irradiance_back.assign(two_sided ? lit.origins.size() : 0, vec3(1));
  }
  return lighting;
}

}  // namespace goldthread::test
