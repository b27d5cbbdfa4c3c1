// What surfaces are painted with: reflectance, emission and coverage, from materials, textures and vertex
// colours.
#pragma once
#include "element/surface_set.h"

namespace goldthread {

/// Share of light, by channel, that goes straight on at a point of one of the tree's triangles: past alpha
/// and through glass.
vec3 passing_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights);

/// What becomes of light at a point, as the element averages are made of.
struct Paint {
  vec3 reflectance{0}, exitance{0};
  float coverage = 1;     ///< share of light that stops there, of colours the luminance
  vec3 stopped{1};        ///< the same by channel
  vec3 transmittance{0};  ///< share of light that leaves diffusely on the other side
};
Paint paint_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights);

/// Averages the paint of every triangle of `part`, and of the whole part by area.
void paint_part(const SurfaceSet& set, Part& part);

}  // namespace goldthread
