// Light that no lamp can send.
#pragma once
#include "scene/scene.h"

namespace goldthread {

/// The most that a lamp's intensity (candela, lux) and a material's emission (nits) may be.
constexpr float kMostLight = 1e12f;

/// Puts out what is negative, infinite, not a number or above kMostLight: such a channel of a lamp's
/// intensity or of a material's emission becomes 0. A lamp whose place or direction is no number becomes
/// dark. Each lamp and material that was changed is named in the scene's warnings.
void put_out_absurd_lights(Scene& scene);

}  // namespace goldthread
