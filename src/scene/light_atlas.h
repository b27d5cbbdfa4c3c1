// Light as textures: what a Lighting becomes where texels carry it (thesis 5.2).
#pragma once
#include <cstdint>
#include <vector>

#include "scene/image.h"
#include "scene/lighting.h"

namespace goldthread {

/// Triangles of one side of a primitive of an instance that have their light on one page. Vertices are the
/// source's corners, several of them where charts part: `source_mesh` is false.
struct MappedMesh : LitMesh {
  bool back = false;              ///< the light is that of the back; faces are wound as the source even so
  uint32_t page = 0;              ///< LightAtlas::pages
  std::vector<vec2> coordinates;  ///< per vertex, 0..1 of the page, (0, 0) the corner of its first texel
};

struct AtlasPage {
  FloatImage irradiance;         ///< lux, linear RGB; texels that nothing covers are filled from around
  std::vector<uint8_t> covered;  ///< per texel: 1 where a triangle has some of its area
};

struct LightAtlas {
  std::vector<MappedMesh> meshes;  ///< by instance, primitive, side and page
  std::vector<AtlasPage> pages;
  float texels_per_metre = 0;
};

}  // namespace goldthread
