// What surfaces are painted with: reflectance, emission and coverage, from materials, textures and vertex
// colours.
#pragma once
#include "element/surface_set.h"

namespace goldthread {

/// Alpha of the part's material at a point of one of its tree's triangles, 0..1 (1 or 0 for a mask).
float alpha_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights);

/// Reflectance, exitance and coverage at a point, as the element averages are made of.
struct Paint {
  vec3 reflectance{0}, exitance{0};
  float coverage = 1;
};
Paint paint_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights);

/// Averages the paint of every triangle of `part`, and of the whole part by area.
void paint_part(const SurfaceSet& set, Part& part);

}  // namespace goldthread
