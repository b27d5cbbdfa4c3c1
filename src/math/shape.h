// Shapes whose form factors have names.
#pragma once
#include <variant>

#include "math/polygon.h"

namespace goldthread {

/// An element of area so small that only its place and unit normal count.
struct PointShape {
  dvec3 position{0}, normal{0};
};
/// Sends to the side of its unit normal.
struct DiscShape {
  dvec3 centre{0}, normal{0};
  double radius = 0;
};
struct SphereShape {
  dvec3 centre{0};
  double radius = 0;
  bool inside = false;  ///< sends inwards
};
/// The lateral surface only; `axis` is of unit length.
struct CylinderShape {
  dvec3 base{0}, axis{0};
  double radius = 0, height = 0;
  bool inside = false;
};
/// All of the inside of a sphere within `half_angle` radians of `axis`, as seen from the centre.
struct CapShape {
  dvec3 centre{0}, axis{0};
  double radius = 0, half_angle = 0;
};

using Shape = std::variant<PointShape, Polygon, DiscShape, SphereShape, CylinderShape, CapShape>;

}  // namespace goldthread
