#include "trace/lens.h"

#include <algorithm>
#include <cmath>

namespace goldthread {

Lens::Lens(const Camera& camera, uint32_t width, uint32_t height) : camera_(camera) {
  forward_ = normalize_or(camera.forward, vec3(0, 0, -1));
  const vec3 spare = std::abs(forward_.y) < 0.9f ? vec3(0, 1, 0) : vec3(0, 0, -1);
  right_ = normalize_or(cross(forward_, camera.up), normalize(cross(forward_, spare)));
  up_ = cross(right_, forward_);
  const float half_height =
      camera.vertical_fov > 0 ? std::tan(camera.vertical_fov / 2) : camera.orthographic_height / 2;
  half_ = vec2(half_height * static_cast<float>(width) / static_cast<float>(height), half_height);
}

Ray Lens::ray(vec2 at) const {
  const vec3 across = (2 * at.x - 1) * half_.x * right_ + (1 - 2 * at.y) * half_.y * up_;
  Ray ray;
  ray.origin = camera_.vertical_fov > 0 ? camera_.position : camera_.position + across;
  ray.direction = camera_.vertical_fov > 0 ? normalize(forward_ + across) : forward_;
  return ray;
}

uint32_t picture_height(int wanted, uint32_t width, const Camera& camera) {
  constexpr float kDefaultAspect = 16.0f / 9;
  if (wanted > 0) return static_cast<uint32_t>(wanted);
  const float aspect = camera.aspect > 0 ? camera.aspect : kDefaultAspect;
  return static_cast<uint32_t>(std::max(1.0f, std::round(static_cast<float>(width) / aspect)));
}

}  // namespace goldthread
