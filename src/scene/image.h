// A picture in memory, and how a texture looks one up.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// Decoded texture: 8-bit RGBA, rows from the top, as glTF stores them. Colour channels are sRGB-encoded.
struct Image {
  uint32_t width = 0, height = 0;
  std::vector<uint8_t> rgba;  ///< width * height * 4
  std::string name;

  bool empty() const { return rgba.empty(); }
};

/// Floating-point picture, scene-linear RGB, rows from the top.
struct FloatImage {
  uint32_t width = 0, height = 0;
  std::vector<vec3> pixels;  ///< width * height
};

/// A picture with more to a pixel than its colour, and words that go with it.
struct LayeredImage {
  FloatImage image;
  std::map<std::string, std::vector<float>> layers;  ///< by channel name, width * height values each
  std::map<std::string, std::string> notes;          ///< by name, which starts with a letter
};

enum class Wrap : uint8_t { kRepeat, kClamp, kMirror };

/// A use of an image by a material: which, where on the mesh, how placed (KHR_texture_transform).
struct Texture {
  int32_t image = -1;  ///< index in Scene::images, -1 for none
  uint8_t texcoord = 0;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  vec2 offset{0}, scale{1};
  float rotation = 0;  ///< radians, counter-clockwise, as KHR_texture_transform

  bool present() const { return image >= 0; }
};

/// An image's texels, wherever they lie.
struct TexelView {
  TexelView() = default;
  explicit TexelView(const Image& image)
      : rgba(image.empty() ? nullptr : image.rgba.data()), width(image.width), height(image.height) {}

  const uint8_t* rgba = nullptr;  ///< as Image::rgba; null of an empty image
  uint32_t width = 0, height = 0;
};

/// A bilinear lookup that is worked out but not made: where its texels are, so that memory can be asked for
/// them some time before they are needed. Refers to the image, which must outlive it.
class TextureLookup {
 public:
  /// Of no image: white.
  TextureLookup() = default;
  /// In the image that `texture` uses; `uv` before the texture transform.
  TextureLookup(const Texture& texture, const TexelView& image, vec2 uv);

  /// Asks memory for what the lookup will read, and does not wait for it.
  void prefetch() const {
    __builtin_prefetch(top_ + left_);
    __builtin_prefetch(bottom_ + left_);
  }
  /// Colour linear, alpha as stored, in 0..1.
  vec4 colour() const;
  /// All four as stored, in 0..1: of data textures (metallic, roughness).
  vec4 data() const;
  /// One of them.
  float data(int channel) const;

 private:
  /// With what a byte of the three colours stands for.
  vec4 mixed(const std::array<float, 256>& decoded) const;

  const uint8_t *top_ = nullptr, *bottom_ = nullptr;  // rows; null where there is no image
  uint32_t left_ = 0, right_ = 0;                     // bytes from a row's begin
  vec2 weights_{0};                                   // of right and bottom
};

/// TextureLookup::colour at once. An absent or empty image gives white.
vec4 sample_texture(const Texture& texture, const std::vector<Image>& images, vec2 uv);

/// TextureLookup::data at once.
vec4 sample_data_texture(const Texture& texture, const std::vector<Image>& images, vec2 uv);

}  // namespace goldthread
