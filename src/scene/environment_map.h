// Surroundings as a picture of all directions.
#pragma once
#include <cstdint>
#include <memory>

#include "goldthread/error.h"
#include "math/vec.h"
#include "scene/image.h"

namespace goldthread {

/// An equirectangular picture in nits. Its middle lies towards -Z (azimuth 0) and its right half towards +X
/// (azimuth 90 degrees), its top row at the zenith. Each pixel is one luminance over its piece of the sphere,
/// so that what the map sends is an exact sum. Values: made once, then shared by all copies.
class EnvironmentMap {
 public:
  /// What was wrong with pixels: how many had a channel that is not a number, infinite, negative or above
  /// kMostNits; such channels are taken as 0.
  struct Repairs {
    uint64_t pixels = 0;
  };
  static constexpr float kMostNits = 1e12f;

  /// Takes the picture's values times `scale` as nits and turns it by `rotation` radians: by a right angle,
  /// what was towards -Z comes to +X. Error (kBadInput): no pixels, no pixel that is right, a scale that is
  /// negative or not finite, a rotation that is not finite.
  static Result<EnvironmentMap> make(FloatImage picture, float scale, float rotation,
                                     Repairs* repairs = nullptr);

  /// Nits from where `direction` points to; it need not be of length 1, but not zero.
  vec3 radiance(const vec3& direction) const;

  const FloatImage& picture() const { return *picture_; }  ///< nits, not turned
  float rotation() const { return rotation_; }             ///< radians
  bool is_dark() const { return dark_; }

 private:
  std::shared_ptr<const FloatImage> picture_;
  float rotation_ = 0;
  bool dark_ = true;
};

}  // namespace goldthread
