// A lit scene as glTF: the source file with light added, and nothing else changed.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "files/light_map_encode.h"
#include "goldthread/bake.h"
#include "goldthread/error.h"
#include "scene/light_atlas.h"
#include "scene/lighting.h"
#include "scene/scene.h"

namespace goldthread {

struct SceneWriteOptions {
  OutputMode mode = OutputMode::kVertexLight;
  float exposure = 1;  ///< kUnlit: outgoing radiance in nits * exposure becomes COLOR_0, clamped to 0..1
};

/// Writes `scene` with `lighting` to `file` (.glb or .gltf + .bin). When scene.file is glTF, that file is
/// read again and everything in it survives (animations, extras, unknown extensions): only primitives in
/// `lighting` change. Draco and meshopt compressed primitives that change are written uncompressed. An
/// instance whose light differs from another of the same mesh gets a mesh of its own.
Status write_lit_scene(const std::string& file, const Scene& scene, const Lighting& lighting,
                       const SceneWriteOptions& options);

/// The same with the light on textures, which materials get by MOZ_lightmap (add_light_maps). Punctual lamps,
/// whose light is in the textures, are written with intensity 0; reading goldthread's files undoes that.
Status write_mapped_scene(const std::string& file, const Scene& scene, const LightAtlas& atlas,
                          std::span<const EncodedPage> encoded);

/// The same for any viewer: what the eye sees of the diffuse light is on the textures, and materials are
/// unlit (KHR_materials_unlit). `exposure` times nits are shown, clamped to 0..1 and sRGB encoded, with alpha
/// where a material is not opaque. `pages` has one for each of the atlas's.
Status write_baked_scene(const std::string& file, const Scene& scene, const LightAtlas& atlas,
                         std::span<const BakedPage> pages);

/// The same for viewers that know no light maps and whose ambient light is to be darkened: pages of luminance
/// become occlusion textures (add_occlusion_pages).
Status write_occluded_scene(const std::string& file, const Scene& scene, const LightAtlas& atlas,
                            std::span<const EncodedPage> grey);

/// Writes a scene that came from no glTF file (procedural, OBJ ...), without light.
Status write_scene(const std::string& file, const Scene& scene);

}  // namespace goldthread
