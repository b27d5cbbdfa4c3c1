// What share of the exchange of two shapes, curved or not, gets past polygons: by rays.
#pragma once
#include <cstdint>
#include <span>

#include "math/shape.h"
#include "solve/matrix/form_factor_pair.h"

namespace goldthread {

/// When rays have said enough.
struct ShapeRayLimits {
  double relative = 1e-4;                  ///< two standard errors, of the value
  uint64_t most_rays = uint64_t{1} << 24;  ///< what is not sure then stays in the error
  uint32_t seed = 0;
};

/// `open`, the form factor from -> to with nothing between (greater than nought), times the share of it that
/// rays see past `occluders`, two-sided polygons. Rays go from points of the one, in directions that may meet
/// the other. Sixteen independently shifted sequences tell the standard error; the bound is two of them and
/// that of `open`. Where all rays or none are seen it is three rays' worth (95%), and `standard_error`
/// nought. The same arguments give the same bytes for any number of threads.
FormFactor seen_by_rays(const FormFactor& open, const Shape& from, const Shape& to,
                        std::span<const Polygon> occluders, const ShapeRayLimits& limits);

}  // namespace goldthread
