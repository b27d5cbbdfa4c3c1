#include "scene/image.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "math/colour.h"

namespace goldthread {
namespace {

/// KHR_texture_transform: scale, then rotate counter-clockwise as seen with v pointing down, then move.
vec2 placed(const Texture& texture, vec2 uv) {
  uv *= texture.scale;
  if (texture.rotation == 0) return uv + texture.offset;
  const float c = std::cos(texture.rotation), s = std::sin(texture.rotation);
  return vec2(c * uv.x + s * uv.y, c * uv.y - s * uv.x) + texture.offset;
}

/// Column or row of a texel that may lie outside of the picture.
uint32_t wrapped(int64_t texel, uint32_t size, Wrap wrap) {
  const int64_t n = int64_t(size);
  if (texel >= 0 && texel < n) return uint32_t(texel);  // nearly always, and divisions are slow
  if (wrap == Wrap::kClamp) return uint32_t(std::clamp<int64_t>(texel, 0, n - 1));
  if (wrap == Wrap::kRepeat) return uint32_t(((texel % n) + n) % n);
  const int64_t m = ((texel % (2 * n)) + 2 * n) % (2 * n);
  return uint32_t(m < n ? m : 2 * n - 1 - m);
}

/// The two neighbours along one axis and the weight of the second.
struct Neighbours {
  uint32_t first, second;
  float weight;
};

Neighbours neighbours(float coordinate, uint32_t size, Wrap wrap) {
  // Beyond 1e6 repeats a float has no fraction left; infinite and undefined coordinates end up there too.
  const float bounded = std::isfinite(coordinate) ? std::clamp(coordinate, -1e6f, 1e6f) : 0.0f;
  const double texel = double(bounded) * size - 0.5;
  int64_t below = int64_t(texel);
  if (double(below) > texel) --below;  // as std::floor, which is a call
  return {wrapped(below, size, wrap), wrapped(below + 1, size, wrap), float(texel - double(below))};
}

template <typename Decode>
std::array<float, 256> table_of(const Decode& decode) {
  std::array<float, 256> table{};
  for (size_t i = 0; i < table.size(); ++i) table[i] = decode(float(i) / 255);
  return table;
}

// Divisions and powers for all that a byte can be, worked out once.
const std::array<float, 256> kShares = table_of([](float share) { return share; });
const std::array<float, 256> kLinear = table_of(srgb_to_linear);

/// Where in an image a lookup finds its four texels, and their weights.
struct Footprint {
  const uint8_t *top = nullptr, *bottom = nullptr;  ///< rows; null where there is no image
  Neighbours u{0, 0, 0}, v{0, 0, 0};
};

Footprint footprint(const Texture& texture, const std::vector<Image>& images, vec2 uv) {
  Footprint f;
  if (!texture.present() || size_t(texture.image) >= images.size()) return f;
  const Image& image = images[size_t(texture.image)];
  if (image.empty()) return f;
  const vec2 at = placed(texture, uv);
  f.u = neighbours(at.x, image.width, texture.wrap_u);
  f.v = neighbours(at.y, image.height, texture.wrap_v);
  f.top = &image.rgba[size_t(f.v.first) * image.width * 4];
  f.bottom = &image.rgba[size_t(f.v.second) * image.width * 4];
  return f;
}

inline vec4 texel_at(const uint8_t* row, uint32_t x, bool srgb) {
  const uint8_t* t = row + size_t(x) * 4;
  const std::array<float, 256>& colour = srgb ? kLinear : kShares;
  return {colour[t[0]], colour[t[1]], colour[t[2]], kShares[t[3]]};
}

vec4 sample(const Texture& texture, const std::vector<Image>& images, vec2 uv, bool srgb) {
  const Footprint f = footprint(texture, images, uv);
  if (f.top == nullptr) return vec4(1);
  const auto mixed = [&](const uint8_t* row) {
    return glm::mix(texel_at(row, f.u.first, srgb), texel_at(row, f.u.second, srgb), f.u.weight);
  };
  return glm::mix(mixed(f.top), mixed(f.bottom), f.v.weight);
}

}  // namespace

vec4 sample_texture(const Texture& texture, const std::vector<Image>& images, vec2 uv) {
  return sample(texture, images, uv, true);
}

void prefetch_texture(const Texture& texture, const std::vector<Image>& images, vec2 uv) {
  const Footprint f = footprint(texture, images, uv);
  if (f.top == nullptr) return;
  __builtin_prefetch(f.top + size_t(f.u.first) * 4);
  __builtin_prefetch(f.bottom + size_t(f.u.first) * 4);
}

vec4 sample_data_texture(const Texture& texture, const std::vector<Image>& images, vec2 uv) {
  return sample(texture, images, uv, false);
}

}  // namespace goldthread
