// Light from a Lighting's vertices to an atlas's texels (thesis 5.2.5, 5.2.6).
#pragma once
#include <functional>

#include "scene/light_atlas.h"
#include "scene/scene.h"

namespace goldthread {

/// A place on a face of a mapped mesh: `weights` are those of its corners 1 and 2.
struct MappedPlace {
  const MappedMesh* mesh = nullptr;
  uint32_t face = 0;
  vec2 weights{0};
};

struct AtlasFillOptions {
  uint32_t size = 1024;  ///< texels of a page's side
  uint32_t padding = 2;  ///< texels round a chart that are filled from it alone
  /// Asked of dark places: whether nobody can see them, as the floor beneath a box. Their texels take what is
  /// around them, or filters would draw the dark out from under it. Called from many threads; may be empty.
  std::function<bool(const MappedPlace&)> is_hidden;
};

/// Paints all pages anew. A texel gets the mean of what the lighting has, as it lies interpolated between its
/// vertices, over all that it covers of its chart: light whose mesh was refined until it is right comes out
/// as right, and finer than texels it comes out smooth. Texels that filters read along charts' edges are
/// fitted to the light there (fit_borders); what no chart covers is filled from around (fill_empty).
void fill_atlas(LightAtlas& atlas, const Scene& scene, const Lighting& lighting,
                const AtlasFillOptions& options);

}  // namespace goldthread
