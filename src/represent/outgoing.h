// Light maps turned into what the eye sees: colour and light in one texture.
#pragma once
#include <vector>

#include "scene/light_atlas.h"
#include "scene/scene.h"

namespace goldthread {

/// A page of what diffuse surfaces send out.
struct OutgoingPage {
  FloatImage nits;           ///< emission + reflectance * irradiance / pi, linear RGB
  std::vector<float> alpha;  ///< per texel, of the base colour; 1 where nothing is
};

/// One for each page of the atlas, which has been filled. Base colour, metallic share, transmission and
/// emission are read at several places of each texel; texels that hold no such place, and `padding` texels
/// round charts, take their neighbours'. What shows through from the other side (diffuse transmission) is not
/// in it.
std::vector<OutgoingPage> outgoing_pages(const LightAtlas& atlas, const Scene& scene, uint32_t padding);

}  // namespace goldthread
