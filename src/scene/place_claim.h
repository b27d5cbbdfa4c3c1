// What a scene means where surfaces overlap in one plane: one of them is there, the same for all who look.
#pragma once
#include <cstdint>

#include "math/vec.h"

namespace goldthread {

/// What settles who owns a place.
struct PlaceClaim {
  uint64_t order = 0;       ///< of files: place_order
  float light = 0;          ///< luminance of what it emits, a mean over the triangle
  bool both_sides = false;  ///< whether its back is lit, too
  vec3 area{0};             ///< area vector, to the front
};

/// Primitives count in the order of instances, triangles in that of their primitive.
constexpr uint64_t place_order(uint32_t primitive, uint32_t source_triangle) {
  return uint64_t{primitive} << 32 | source_triangle;
}

/// Whether the first of two that overlap gets their common area: of two that face the same way (two-sided
/// ones face both), what emits more, else what is two-sided, else what comes first. A lamp of one side in a
/// surface of two takes nothing from it, since it is not there on the other: both keep their light.
inline bool owns_place(const PlaceClaim& owner, const PlaceClaim& other) {
  if (owner.light < other.light) return false;
  if (owner.light == other.light) {
    if (owner.both_sides != other.both_sides) return owner.both_sides;
    if (owner.order >= other.order) return false;
  }
  // One side cannot take the place of two.
  return owner.both_sides || (!other.both_sides && dot(owner.area, other.area) > 0);
}

}  // namespace goldthread
