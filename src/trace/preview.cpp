#include "trace/preview.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "trace/shown_scene.h"

namespace goldthread {
namespace {

constexpr float kDefaultAspect = 16.0f / 9;

/// Rays through the pixels of a camera's picture.
class Lens {
 public:
  Lens(const Camera& camera, uint32_t width, uint32_t height) : camera_(camera) {
    forward_ = normalize_or(camera.forward, vec3(0, 0, -1));
    const vec3 spare = std::abs(forward_.y) < 0.9f ? vec3(0, 1, 0) : vec3(0, 0, -1);
    right_ = normalize_or(cross(forward_, camera.up), normalize(cross(forward_, spare)));
    up_ = cross(right_, forward_);
    const float half_height =
        camera.vertical_fov > 0 ? std::tan(camera.vertical_fov / 2) : camera.orthographic_height / 2;
    half_ = vec2(half_height * static_cast<float>(width) / static_cast<float>(height), half_height);
  }

  /// `at` runs from (0, 0), top left, to (1, 1).
  Ray ray(vec2 at) const {
    const vec3 across = (2 * at.x - 1) * half_.x * right_ + (1 - 2 * at.y) * half_.y * up_;
    Ray ray;
    ray.origin = camera_.vertical_fov > 0 ? camera_.position : camera_.position + across;
    ray.direction = camera_.vertical_fov > 0 ? normalize(forward_ + across) : forward_;
    return ray;
  }

 private:
  const Camera& camera_;
  vec3 forward_, right_, up_;
  vec2 half_{1};
};

/// Along one ray, through blended surfaces as far as they let light pass.
vec3 look(const ShownScene& shown, const Sky& sky, Ray ray) {
  constexpr int kMostLayers = 32;
  vec3 nits(0);
  float passed = 1;
  for (int layer = 0; layer < kMostLayers; ++layer) {
    const Hit hit = shown.closest(ray);
    if (hit.missed()) return nits + passed * sky.radiance;
    const Appearance seen = shown.appearance(hit, ray);
    nits += passed * seen.alpha * seen.nits;
    passed *= 1 - seen.alpha;
    if (passed < 1e-3f) break;
    ray.near = hit.distance * 1.0001f + 1e-6f;
  }
  return nits;
}

uint32_t picture_height(const PreviewOptions& options, const Camera& camera) {
  if (options.height > 0) return static_cast<uint32_t>(options.height);
  const float aspect = camera.aspect > 0 ? camera.aspect : kDefaultAspect;
  return static_cast<uint32_t>(std::max(1.0f, std::round(static_cast<float>(options.width) / aspect)));
}

}  // namespace

FloatImage render_preview(const Scene& scene, const Lighting& lighting, const PreviewOptions& options) {
  const ShownScene shown(scene, lighting);
  const Camera camera = scene.cameras.empty() ? frame_camera(shown) : scene.cameras.front();
  FloatImage image;
  image.width = static_cast<uint32_t>(std::max(1, options.width));
  image.height = picture_height(options, camera);
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

Camera frame_camera(const Scene& scene) {
  const Lighting dark;
  return frame_camera(ShownScene(scene, dark));
}

}  // namespace goldthread
