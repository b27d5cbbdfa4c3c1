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
/// metallic) * (1 - transmission) (glTF 2.0 appendix B, KHR_materials_transmission); exitance is pi *
/// emission, on the back only where it is double-sided. Nothing is taken off for Fresnel's mirror, 4% of what
/// comes straight at a dielectric and on the whole 9% of diffuse light: that light stays in the room, and
/// where there are no mirrors it is the diffuse surface that has to carry it.
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
  /// KHR_materials_transmission: share of what is no metal that lets light go straight on, factor only. Such
  /// light takes the base colour, and does not bend.
  float transmission = 0;
  Texture transmission_texture;  ///< red channel
  /// KHR_materials_volume: what is left of light that crosses half the thickness, since it meets a surface on
  /// its way in and another on its way out; 1 where there is no thickness.
  vec3 volume_tint{1};

  /// KHR_materials_diffuse_transmission: share of what is neither metal nor glass that lets light through to
  /// leave diffusely on the other side, in a colour of its own; factors only.
  float diffuse_transmission = 0;
  Texture diffuse_transmission_texture;  ///< alpha channel
  vec3 diffuse_transmission_colour{1};
  Texture diffuse_transmission_colour_texture;

  /// Red, green, blue, 0..1 for -1..1 along tangent, bitangent (see Primitive::tangents) and normal. It bends
  /// the plane on which light is measured at texels and given places. What vertices receive and what a
  /// surface sends on are those of the unbent one: the viewer bends the former, and the latter is a mean over
  /// more than its bumps.
  Texture normal_texture;
  float normal_scale = 1;  ///< multiplies what the texture says along tangent and bitangent

  bool emits() const { return emission.x > 0 || emission.y > 0 || emission.z > 0; }
  bool is_glass() const { return transmission > 0 && metallic < 1 && !unlit; }
  bool is_translucent() const { return diffuse_transmission > 0 && metallic < 1 && !unlit; }
  /// Whether light on its back counts: what is translucent brings it to the front.
  bool lit_behind() const { return double_sided || is_translucent(); }
  /// Whether its colour, but for that of vertices, may be other than grey.
  bool is_coloured() const {
    const vec3 colour = base_colour * volume_tint;
    return base_colour_texture.present() || colour.x != colour.y || colour.y != colour.z;
  }
  /// Whether rays may go on through it.
  bool is_see_through() const { return alpha_mode != AlphaMode::kOpaque || is_glass(); }
};

}  // namespace goldthread
