// The texels of light maps as places at which light is measured.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "trace/receivers.h"

namespace goldthread {

/// The same layout for every primitive.
struct TexelLayout {
  uint32_t width = 0, height = 0;  ///< texels; width 0: there is no layout
  std::optional<uint32_t> uv;      ///< TEXCOORD_0 or 1; absent: 1 where the primitive has it, else 0
};

/// What of the lit primitives of all instances could not be laid out as one would wish.
struct TexelProblems {
  size_t parts = 0;            ///< lit primitives of instances, for comparison
  size_t without_uv = 0;       ///< of these, those that have no such coordinates
  size_t without_texel = 0;    ///< and those of whose triangles none holds a texel's centre
  size_t overlapping = 0;      ///< triangles, as in TexelRaster
  size_t outside = 0;          ///< triangles, as in TexelRaster
  size_t without_uv_area = 0;  ///< triangles, as in TexelRaster
};

struct TexelReceivers {
  std::vector<Receiver> receivers;
  TexelProblems problems;
  bool too_many = false;  ///< there are more than kMostTexelReceivers; receivers are then empty
};

constexpr size_t kMostTexelReceivers = 100'000'000;
constexpr uint32_t kMostTexelsAside = 16384;

/// A receiver for each texel whose centre lies in a triangle's texture coordinates, at that place of the
/// triangle, by instance, primitive, row and column; for what is two-sided one a side, all fronts of a
/// primitive before all its backs. Where triangles overlap the first in the file has the texel. The normal is
/// the file's, interpolated (where the file has none, faces are flat as glTF demands), and bent by the
/// material's normal texture (bent_normal); what lies below the surface itself then brings nothing. Holes of
/// alpha masks, unlit materials and triangles without area have no receivers.
TexelReceivers texel_receivers(const TracedScene& scene, const TexelLayout& layout);

}  // namespace goldthread
