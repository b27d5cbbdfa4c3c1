// The texels of a solution's own light maps as places at which light is measured.
#pragma once
#include <cstdint>
#include <vector>

#include "scene/light_atlas.h"
#include "trace/receivers.h"

namespace goldthread {

/// `count` of the texels whose centre lies in a triangle, chosen evenly, or all where there are no more:
/// places of the scene, on the shading normal. Charts have one density, so that each texel stands for as much
/// area.
std::vector<Receiver> mapped_texel_receivers(const TracedScene& scene, const LightAtlas& atlas,
                                             uint64_t count, uint32_t seed);

}  // namespace goldthread
