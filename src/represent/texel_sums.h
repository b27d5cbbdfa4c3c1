// Light that is linear over triangles, summed up by texel exactly.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// A triangle on a page and a value at each of its corners, linear between them.
struct ValueTriangle {
  std::array<vec2, 3> corners;  ///< texels, from the corner of texel (0, 0)
  std::array<vec3, 3> values;
};

/// Integrals over each texel's square, by row and column.
struct TexelSums {
  uint32_t width = 0, height = 0;
  std::vector<double> area;  ///< of all triangles within, texels
  std::vector<dvec3> value;  ///< of all triangles' values
};

/// Triangles are clipped to each texel that they reach, which is exact up to rounding: no texel of a thin
/// triangle is left out, and hard edges come out smooth. Either winding; triangles without area bring
/// nothing, and nothing lies beyond the page. The same for any number of threads.
TexelSums sum_texels(std::span<const ValueTriangle> triangles, uint32_t width, uint32_t height);

}  // namespace goldthread
