// Surroundings as six squares.
#pragma once
#include <array>

#include "math/vec.h"
#include "scene/image.h"

namespace goldthread {

/// Luminance of all directions on the faces of a cube, in the order +X, -X, +Y, -Y, +Z, -Z: squares of one
/// size, each as it is seen from the middle of the cube. The top of the four at the sides is +Y, that of +Y
/// is -Z, that of -Y is +Z.
struct CubeMap {
  std::array<FloatImage, 6> faces;

  /// Whether all faces are squares of one size with all their pixels.
  bool is_whole() const;
  /// The pixel that `direction` meets; it need not be of length 1, but not zero.
  const vec3& towards(const vec3& direction) const;
};

/// The cube turned by `rotation` (a unit quaternion) as EnvironmentMap wants it, each pixel the mean of
/// sixteen places. Four pixels across for one of a face, but at most kMostPixelsRound.
FloatImage equirectangular_of(const CubeMap& cube, const glm::quat& rotation);

constexpr uint32_t kMostPixelsRound = 2048;

}  // namespace goldthread
