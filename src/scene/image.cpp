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
  if (texel >= 0 && texel < n) return uint32_t(texel);  // often, and divisions are slow
  if (wrap == Wrap::kClamp) return uint32_t(std::clamp<int64_t>(texel, 0, n - 1));
  const int64_t period = wrap == Wrap::kRepeat ? n : 2 * n, rest = texel % period;
  const int64_t m = rest < 0 ? rest + period : rest;
  return uint32_t(m < n ? m : 2 * n - 1 - m);
}

/// The two neighbours along one axis and the weight of the second.
struct Neighbours {
  uint32_t first, second;
  float weight;
};

inline Neighbours neighbours(float coordinate, uint32_t size, Wrap wrap) {
  // Beyond 1e6 repeats a float has no fraction left; infinite and undefined coordinates end up there too.
  const float bounded = std::isfinite(coordinate) ? std::clamp(coordinate, -1e6f, 1e6f) : 0.0f;
  const double texel = double(bounded) * size - 0.5;
  int64_t below = int64_t(texel);
  if (double(below) > texel) --below;  // as std::floor, which is a call
  const uint32_t first = wrapped(below, size, wrap);
  const bool inside = wrap == Wrap::kRepeat && first + 1 < size;
  return {first, inside ? first + 1 : wrapped(below + 1, size, wrap), float(texel - double(below))};
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

TexelView image_of(const Texture& texture, const std::vector<Image>& images) {
  const bool known = texture.present() && size_t(texture.image) < images.size();
  return known ? TexelView(images[size_t(texture.image)]) : TexelView();
}

inline vec4 texel_at(const uint8_t* t, const std::array<float, 256>& colour) {
  return {colour[t[0]], colour[t[1]], colour[t[2]], kShares[t[3]]};
}

}  // namespace

TextureLookup::TextureLookup(const Texture& texture, const TexelView& image, vec2 uv) {
  if (image.rgba == nullptr) return;
  const vec2 at = placed(texture, uv);
  const Neighbours u = neighbours(at.x, image.width, texture.wrap_u);
  const Neighbours v = neighbours(at.y, image.height, texture.wrap_v);
  top_ = image.rgba + size_t(v.first) * image.width * 4;
  bottom_ = image.rgba + size_t(v.second) * image.width * 4;
  left_ = u.first * 4;
  right_ = u.second * 4;
  weights_ = {u.weight, v.weight};
}

vec4 TextureLookup::mixed(const std::array<float, 256>& decoded) const {
  if (top_ == nullptr) return vec4(1);
  const auto across = [&](const uint8_t* row) {
    return glm::mix(texel_at(row + left_, decoded), texel_at(row + right_, decoded), weights_.x);
  };
  return glm::mix(across(top_), across(bottom_), weights_.y);
}

vec4 TextureLookup::colour() const {
  return mixed(kLinear);
}

vec4 TextureLookup::data() const {
  return mixed(kShares);
}

float TextureLookup::data(int channel) const {
  if (top_ == nullptr) return 1;
  const auto across = [&](const uint8_t* row) {
    return glm::mix(kShares[row[left_ + uint32_t(channel)]], kShares[row[right_ + uint32_t(channel)]],
                    weights_.x);
  };
  return glm::mix(across(top_), across(bottom_), weights_.y);
}

vec4 sample_texture(const Texture& texture, const std::vector<Image>& images, vec2 uv) {
  return TextureLookup(texture, image_of(texture, images), uv).colour();
}

vec4 sample_data_texture(const Texture& texture, const std::vector<Image>& images, vec2 uv) {
  return TextureLookup(texture, image_of(texture, images), uv).data();
}

}  // namespace goldthread
