// Light from a Lighting's vertices to an atlas's texels (thesis 5.2.5, 5.2.6).
#pragma once
#include "base/progress.h"
#include "scene/light_atlas.h"
#include "scene/scene.h"

namespace goldthread {

/// Paints all pages, `size` texels aside, anew. A texel gets the mean of what the lighting has, as it lies
/// interpolated between its vertices, over all that it covers of its chart: light whose mesh was refined
/// until it is right comes out as right, and finer than texels it comes out smooth. What no chart covers is
/// filled from around, `padding` texels of it from the chart next to them (fill_empty).
void fill_atlas(LightAtlas& atlas, const Scene& scene, const Lighting& lighting, uint32_t size,
                uint32_t padding);

}  // namespace goldthread
