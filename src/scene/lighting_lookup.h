// A Lighting as a function: how much light falls on this point of this surface.
#pragma once
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "scene/lighting.h"
#include "scene/scene.h"

namespace goldthread {

/// Interpolates between vertices as every viewer does. Borrows both, which must outlive it.
class LightingLookup {
 public:
  LightingLookup(const Scene& scene, const Lighting& lighting);

  /// Irradiance (lux, linear RGB) on one side of a source triangle, `weights` those of its corners 1 and 2.
  /// Nothing where the surface is not lit, or not on that side.
  std::optional<vec3> irradiance(uint32_t instance, uint32_t primitive, uint32_t triangle, vec2 weights,
                                 bool back) const;

 private:
  struct Lit {
    const LitPrimitive* light;
    const Primitive* source;
    /// Of a refined mesh: faces of source triangle t are faces[first[t]] to faces[first[t + 1] - 1].
    std::vector<uint32_t> first, faces;
  };
  std::pair<UVec3, vec2> find_face(const Lit& lit, uint32_t triangle, vec2 weights) const;

  std::map<std::pair<uint32_t, uint32_t>, Lit> lit_;
};

}  // namespace goldthread
