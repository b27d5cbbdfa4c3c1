// What a surface does with light, as far as diffuse exchange is concerned.
#pragma once
#include <string>

#include "math/vec.h"
#include "scene/image.h"

namespace goldthread {

/// All that computes light takes brighter surfaces as this: light that is reflected for ever converges too
/// slowly to be told from light that grows.
constexpr float kMaxReflectance = 0.95f;

enum class AlphaMode : uint8_t { kOpaque, kMask, kBlend };

/// A glTF metallic-roughness material reduced to its diffuse light. Reflectance is base colour * (1 -
/// metallic) (glTF 2.0 appendix B); exitance is pi * emission.
struct Material {
  std::string name;
  vec3 base_colour{1};          ///< linear, factor only
  float alpha = 1;              ///< factor only
  Texture base_colour_texture;  ///< colour and alpha
  float metallic = 1;           ///< factor only (glTF's default is 1)
  Texture metallic_texture;     ///< blue channel
  vec3 emission{0};             ///< nits: emissiveFactor * KHR_materials_emissive_strength
  Texture emission_texture;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;  ///< KHR_materials_unlit: shows its colour, receives no light, still blocks it

  bool emits() const { return emission.x > 0 || emission.y > 0 || emission.z > 0; }
};

}  // namespace goldthread
