// A picture of a lit scene by ray casting through a camera: no light is computed here.
#pragma once
#include "scene/lighting.h"
#include "scene/scene.h"
#include "visibility/ray_caster.h"

namespace goldthread {

struct PreviewOptions {
  int width = 960, height = 0;  ///< height 0: the camera's aspect, or 16:9
  int samples = 4;              ///< rays a pixel, a square number, for antialiasing
};

/// Luminance in nits for each pixel: emission + reflectance * irradiance / pi on the side that is seen, the
/// sky's luminance where nothing is hit. Looks through the scene's first camera, or one that frames it
/// (`frame_camera`).
FloatImage render_preview(const Scene& scene, const Lighting& lighting, const PreviewOptions& options);

/// A camera that shows the whole scene: from inside if it is a closed room, else from outside, above and in
/// front.
Camera frame_camera(const Scene& scene);
/// The file's first camera, or where it has none `frame_camera`.
Camera first_camera(const Scene& scene);

}  // namespace goldthread
