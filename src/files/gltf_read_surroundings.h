// The surroundings that a glTF file's scene has.
#pragma once
#include "files/gltf_load.h"
#include "scene/scene.h"

namespace goldthread {

/// Makes EXT_lights_image_based's light of the shown scene its sky. That is the first level of the
/// extension's cube map, times its intensity in nits: what a perfect mirror would show, so the light itself.
/// The blurred levels and the spherical harmonics beside it follow from it, and cannot cast a shadow. The
/// specification calls the pixels lux; a mirror shows luminance, and only as that do they and the harmonics
/// agree. Faces are mirrored left to right against the usual cube maps, as the specification wants them, so
/// that they are as seen from inside; RGB of PNG is divided by alpha.
///
/// Surroundings that cannot be read are left out with a warning, as textures are.
void read_gltf_surroundings(const tinygltf::Model& model, Scene& scene);

}  // namespace goldthread
