#include "trace/preview.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "trace/lens.h"
#include "trace/shown_scene.h"

namespace goldthread {
namespace {

/// Along one ray, through blended surfaces and glass as far as they let light pass.
vec3 look(const ShownScene& shown, const Sky& sky, Ray ray) {
  constexpr int kMostLayers = 32;
  vec3 nits(0);
  vec3 passed(1);
  for (int layer = 0; layer < kMostLayers; ++layer) {
    const Hit hit = shown.closest(ray);
    if (hit.missed()) return nits + passed * sky.radiance_towards(ray.direction);
    const Appearance seen = shown.appearance(hit, ray);
    nits += passed * seen.alpha * seen.nits;
    passed *= seen.behind;
    if (std::max({passed.x, passed.y, passed.z}) < 1e-3f) break;
    ray.near = hit.distance * 1.0001f + 1e-6f;
  }
  return nits;
}

}  // namespace

FloatImage render_preview(const Scene& scene, const Lighting& lighting, const PreviewOptions& options) {
  const ShownScene shown(scene, lighting);
  const Camera camera = scene.cameras.empty() ? frame_camera(shown) : scene.cameras.front();
  FloatImage image;
  image.width = static_cast<uint32_t>(std::max(1, options.width));
  image.height = picture_height(options.height, image.width, camera);
  image.pixels.resize(size_t{image.width} * image.height);
  const Lens lens(camera, image.width, image.height);
  const int grid = std::max(1, static_cast<int>(std::lround(std::sqrt(std::max(1, options.samples)))));
  const vec2 size(static_cast<float>(image.width), static_cast<float>(image.height));
  parallel_for(image.height, [&](size_t y) {
    for (uint32_t x = 0; x < image.width; ++x) {
      vec3 sum(0);
      for (int s = 0; s < grid * grid; ++s) {
        const vec2 inside = (vec2(static_cast<float>(s % grid), static_cast<float>(s / grid)) + 0.5f) /
                            static_cast<float>(grid);
        sum += look(shown, scene.sky,
                    lens.ray((vec2(static_cast<float>(x), static_cast<float>(y)) + inside) / size));
      }
      image.pixels[y * image.width + x] = sum / static_cast<float>(grid * grid);
    }
  });
  return image;
}

Camera first_camera(const Scene& scene) {
  return scene.cameras.empty() ? frame_camera(scene) : scene.cameras.front();
}

Camera frame_camera(const Scene& scene) {
  const Lighting dark;
  return frame_camera(ShownScene(scene, dark));
}

}  // namespace goldthread
