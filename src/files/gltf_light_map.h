// Light maps into a glTF document: MOZ_lightmap, as viewers on the web read it.
#pragma once
#include <span>

#include "files/gltf_build.h"
#include "files/gltf_document.h"
#include "files/gltf_geometry.h"
#include "files/light_map_encode.h"
#include "goldthread/error.h"
#include "scene/light_atlas.h"

namespace goldthread {

/// Every mesh of the atlas becomes a primitive with texture coordinates of its own (TEXCOORD_1, or the first
/// set that is free) and a material that is the source's with MOZ_lightmap {index, texCoord, intensity}
/// added: irradiance in lux is the texture's linear value times the intensity. Pages, of which `encoded` has
/// one each, are linear 8-bit PNG inside the file. What is lit on both sides becomes a front and a back, each
/// one-sided, since a texture has one light for a place. Material variants keep their kinds, each with the
/// light map. Instances, whose light differs, get meshes of their own that share all attributes but these
/// coordinates. May throw Json::exception on a document whose members have other types than glTF gives them.
Status add_light_maps(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                      const LightAtlas& atlas, std::span<const EncodedPage> encoded,
                      const SourceReader& read);

/// The same with unlit materials whose base colour is the page, of which `baked` has one each: sRGB PNG, with
/// alpha where a material needs it. Lamps stay, for such materials do not see them.
Status add_baked_pages(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                       const LightAtlas& atlas, std::span<const BakedPage> baked, const SourceReader& read);

/// The same with materials as they were but for their occlusionTexture, which is the page, of which `grey`
/// has one each: a viewer's own ambient light is darkened to what the light is of its brightest. The
/// texture's `extras.goldthread_lux` says what white stands for. An occlusion texture that was there goes.
/// Lamps are written with intensity 0, or their light would come twice.
Status add_occlusion_pages(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                           const LightAtlas& atlas, std::span<const EncodedPage> grey,
                           const SourceReader& read);

}  // namespace goldthread
