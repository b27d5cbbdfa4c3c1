// From pixels to rays: the camera model that all pictures share.
#pragma once
#include <cstdint>

#include "scene/scene.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// Rays through the pixels of a camera's picture, perspective or orthographic.
class Lens {
 public:
  /// `camera` must outlive the lens; width and height are in pixels.
  Lens(const Camera& camera, uint32_t width, uint32_t height);

  /// `at` runs from (0, 0), top left, to (1, 1). The ray's direction is unit.
  Ray ray(vec2 at) const;

 private:
  const Camera& camera_;
  vec3 forward_, right_, up_;
  vec2 half_{1};
};

/// Rows of a picture `width` pixels wide: `wanted`, or where that is 0 what the camera's aspect (16:9 where
/// it has none) makes of it.
uint32_t picture_height(int wanted, uint32_t width, const Camera& camera);

}  // namespace goldthread
