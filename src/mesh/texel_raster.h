// Which triangle holds the centre of each texel, when triangles are laid out by their texture coordinates.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// A texel whose centre a triangle covers.
struct CoveredTexel {
  uint32_t x = 0, y = 0;  ///< column from u = 0, row from v = 0, which glTF has at the top
  uint32_t triangle = 0;  ///< index of the input
  vec2 weights{0};        ///< of the centre: barycentric, of corners 1 and 2
};

struct TexelRaster {
  std::vector<CoveredTexel> texels;  ///< by row and column, each at most once
  size_t overlapping = 0;            ///< triangles that hold a centre which an earlier one has taken
  size_t outside = 0;                ///< triangles that reach half a texel or more beyond 0..1 in u or v
  size_t without_area = 0;           ///< triangles without area in u and v, or not finite there
};

/// The centre of texel x, y of width x height is u = (x + 1/2) / width, v = (y + 1/2) / height. Centres on an
/// edge that two triangles share, corner for corner, belong to one of them. What lies beyond 0..1 has no
/// texels: coordinates are not wrapped. Sides of 1 to 2^20 texels, else a failed check.
TexelRaster rasterise_texels(std::span<const std::array<vec2, 3>> triangles, uint32_t width, uint32_t height);

}  // namespace goldthread
