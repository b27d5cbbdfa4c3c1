// What is known of many paths at once, by coordinate: so that a loop over them needs no shuffling to be
// worked out several at a time.
#pragma once
#include <array>
#include <cstddef>

#include "math/vec.h"

namespace goldthread {

/// So many paths go together: as many as make little of what is done once a bundle, and of its last paths.
constexpr size_t kLanes = 512;

using FloatLanes = std::array<float, kLanes>;

struct Vec3Lanes {
  FloatLanes x, y, z;

  vec3 operator[](size_t i) const { return {x[i], y[i], z[i]}; }
  void set(size_t i, const vec3& v) {
    x[i] = v.x;
    y[i] = v.y;
    z[i] = v.z;
  }
};

/// Where light is asked for.
struct Places {
  size_t count = 0;   ///< at most kLanes
  Vec3Lanes points;   ///< on surfaces
  Vec3Lanes normals;  ///< unit
};

}  // namespace goldthread
