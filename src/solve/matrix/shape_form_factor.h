// Form factors of shapes that may be curved.
#pragma once
#include <span>

#include "goldthread/error.h"
#include "math/shape.h"
#include "solve/matrix/form_factor_pair.h"

namespace goldthread {

/// Area in m²; 0 for a point.
double shape_area(const Shape& shape);

/// F from -> to: the share of what leaves `from` that arrives at `to`, with nothing in the way but
/// `occluders` (two-sided polygons, only between points and polygons) and the two themselves: closed forms at
/// points, integrated over one of the two. What sends inwards must hold the other within it. The inside of a
/// cylinder to itself is an error, since it depends on what stands in the cylinder.
Result<FormFactor> shape_form_factor(const Shape& from, const Shape& to, std::span<const Polygon> occluders,
                                     const CubatureLimits& limits = {});

}  // namespace goldthread
