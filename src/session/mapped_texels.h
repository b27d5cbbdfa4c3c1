// The texels of a solution's own light maps as places at which light is measured.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/light_atlas.h"
#include "trace/receivers.h"

namespace goldthread {

/// Texels, and what each of them stands for.
struct MappedTexels {
  std::vector<Receiver> centres;  ///< one a texel, on the shading normal
  /// Of texel i the places [first[i], first[i + 1]): spread evenly over what triangles have of it, as far as
  /// anybody can see it; at least one.
  std::vector<Receiver> places;
  std::vector<size_t> first;
};

/// Places in a texel, where triangles cover it whole.
constexpr uint32_t kPlacesInTexel = 16;

/// `count` of the texels whose centre lies in a triangle, chosen evenly, or all where there are no more.
/// Charts have one density, so that each texel stands for as much area.
MappedTexels mapped_texels(const TracedScene& scene, const LightAtlas& atlas, uint64_t count, uint32_t seed);

}  // namespace goldthread
