// Form factors of shapes that may be curved.
#pragma once
#include <span>

#include "goldthread/error.h"
#include "math/shape.h"
#include "solve/matrix/form_factor_pair.h"
#include "solve/matrix/shape_rays.h"
#include "solve/matrix/shape_surface.h"

namespace goldthread {

/// F from -> to: the share of what leaves `from` that arrives at `to`, with nothing in the way but
/// `occluders` (two-sided polygons) and the two themselves: closed forms at points, integrated over one of
/// the two. Past occluders that is done between points and polygons; where one is curved, rays say what share
/// of it is seen (`seen_by_rays`). What sends inwards must hold the other within it. ErrorCode::kBadInput
/// where a pair is not known: the insides of two cylinders, and what is sent to a point.
Result<FormFactor> shape_form_factor(const Shape& from, const Shape& to, std::span<const Polygon> occluders,
                                     const CubatureLimits& limits = {},
                                     const ShapeRayLimits& ray_limits = {});

}  // namespace goldthread
