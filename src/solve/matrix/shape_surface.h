// Curved shapes as maps from the unit square, for quadratures and samples.
#pragma once
#include <functional>

#include "math/shape.h"

namespace goldthread {

/// Area in m²; 0 for a point.
double shape_area(const Shape& shape);

/// Unit axes of a plane, x, y and its unit normal a right-handed frame.
struct PlaneFrame {
  dvec3 x, y;
};
PlaneFrame plane_frame(const dvec3& normal);

/// A place on a surface, its unit normal on the side that sends, and the area that it stands for: the mean of
/// `area` over the unit square is the shape's, in m²; of a point 1.
struct SurfacePlace {
  dvec3 position, normal;
  double area;
};
using ShapeSurface = std::function<SurfacePlace(double u, double v)>;

/// u and v in 0..1; v goes round what is round.
ShapeSurface surface_of(const Shape& shape);

}  // namespace goldthread
