// Lights that have no geometry. Photometric units, linear Rec.709 (KHR_lights_punctual).
#pragma once
#include <memory>
#include <string>

#include "math/vec.h"
#include "scene/light_profile.h"

namespace goldthread {

enum class LightKind : uint8_t { kPoint, kSpot, kDirectional, kRectangle, kDisc };

struct Light {
  std::string name;
  LightKind kind = LightKind::kPoint;
  /// Colour * intensity: candela (point, spot; of one with a profile where it is brightest; of rectangles and
  /// discs straight ahead, which is luminance * area) or lux (directional).
  vec3 intensity{0};
  vec3 position{0};          ///< world, metres
  vec3 direction{0, 0, -1};  ///< world, unit: where the light shines to
  float inner_cone = 0;      ///< radians from the axis
  float outer_cone = 0.7853981634f;
  float range = 0;             ///< metres, 0 for no limit
  float angular_diameter = 0;  ///< radians of a directional light's even disc; 0 for a point at infinity
  /// Metres, of a point or spot light that is an even ball: its intensity is that of the whole, and what its
  /// cone says holds for the way from its centre. 0 for a point; so it is taken for places within it, too.
  float radius = 0;
  /// World, unit, square to `direction`: +X of the light's own frame, which shines to its -Z. It counts for
  /// rectangles and where there is a profile.
  vec3 across{1, 0, 0};
  /// Of a point or spot light, instead of its cone: shares of the intensity by direction. Null for none.
  std::shared_ptr<const LightProfile> profile = nullptr;
  /// Metres, of a rectangle its width along `across` and its height square to that, of a disc its diameter
  /// twice; centred at `position`, in the plane square to `direction`, of even luminance, and dark behind.
  /// Such a lamp is no surface: rays do not meet it, and it stands in no light's way.
  vec2 size{0};

  /// Whether it is an area lamp: a rectangle or a disc.
  bool has_area() const { return kind == LightKind::kRectangle || kind == LightKind::kDisc; }
  /// m^2 of an area lamp; 0 of others.
  float area() const;
  /// Metres from an area lamp's centre to what is farthest of it.
  float reach() const { return kind == LightKind::kDisc ? 0.5f * size.x : 0.5f * glm::length(size); }
};

/// Turns a light to shine along `direction`, its +X along `across` or as near to it as is square to that.
/// Neither need be of length 1.
void aim(Light& light, const vec3& direction, const vec3& across);

}  // namespace goldthread
