// The lights that a user asks for.
#pragma once
#include "goldthread/error.h"
#include "goldthread/light.h"
#include "scene/scene.h"

namespace goldthread {

/// Gives the scene the sky and the sun of `options` and its lamps the sizes and profiles, and a warning for
/// what of it had to be changed. Error: a sky said twice, a model, moment, lamp or value that does not exist
/// (kUsage), an environment or profile that cannot be read, or has no pixel that is luminance (kBadInput).
Status add_requested_lights(Scene& scene, const LightOptions& options);

}  // namespace goldthread
