// A bake's light as textures: laid out, filled and encoded.
#pragma once
#include <vector>

#include "files/light_map_encode.h"
#include "goldthread/bake.h"
#include "goldthread/error.h"
#include "scene/light_atlas.h"
#include "session/report.h"
#include "solve/hierarchical/solver.h"

namespace goldthread {

struct MappedLight {
  LightAtlas atlas;
  std::vector<EncodedPage> encoded;  ///< one a page
};

/// A usage Error that names the option which is out of its range.
Status check_lightmap(const LightmapOptions& options);

/// Of LightmapOptions::files, which have been checked.
MapEncoding map_encoding(const LightmapOptions& options);

/// Puts the light of `lighting`, which is of the solver's scene, on pages. Fills `report.atlas`, and
/// adds a warning where the density asked for had to be lowered. An Error where no density fits.
Result<MappedLight> map_light(const HierarchicalSolver& solver, const Lighting& lighting,
                              const LightmapOptions& options, BakeReport& report);

/// The maps with the surfaces' colours and emission, as they are shown: nits times `exposure`.
std::vector<BakedPage> baked_pages(const LightAtlas& atlas, const Scene& scene,
                                   const LightmapOptions& options, float exposure);

}  // namespace goldthread
