#include "scene/scene.h"

namespace goldthread {

size_t Scene::triangle_count() const {
  size_t count = 0;
  for (const Instance& instance : instances)
    for (const Primitive& primitive : meshes[instance.mesh].primitives) count += primitive.triangle_count();
  return count;
}

Box Scene::bounds() const {
  Box box;
  for (const Instance& instance : instances)
    for (const Primitive& primitive : meshes[instance.mesh].primitives)
      for (const vec3& position : primitive.positions) {
        const vec3 world(instance.transform * vec4(position, 1));
        if (is_finite(world)) box.add(world);
      }
  return box;
}

}  // namespace goldthread
