// The light from beyond the scene.
#pragma once
#include <optional>

#include "scene/environment_map.h"
#include "scene/sky_model.h"

namespace goldthread {

/// Luminance arriving from everywhere beyond the scene: a map of it if there is one, else a model if there is
/// one, else the same all over the whole sphere. Linear Rec.709.
struct Sky {
  vec3 radiance{0};                   ///< nits; of a sky that is the same all over
  std::optional<SkyModel> model;      ///< instead of `radiance`
  std::optional<EnvironmentMap> map;  ///< instead of both

  bool is_uniform() const { return !model && !map; }
  /// Whether any light comes from it.
  bool present() const;
  /// Nits from where `direction` points to, which is not zero and need not be of length 1.
  vec3 radiance_towards(const vec3& direction) const;
};

}  // namespace goldthread
