// The light profiles that a user asks for.
#pragma once
#include "goldthread/error.h"
#include "goldthread/light.h"
#include "scene/scene.h"

namespace goldthread {

/// Gives the scene's point and spot lights the profiles of `options`, in their order: a light's own colour
/// stays, its cone and intensity are the file's instead. Lights that are dark stay dark. Error: a file that
/// cannot be read (kBadInput), a profile for no light or a scale that is none (kUsage).
Status set_requested_profiles(Scene& scene, const LightOptions& options);

/// A warning for each lamp that is tilted and whose profile says that this changes its light.
void warn_of_tilted_lamps(Scene& scene);

}  // namespace goldthread
