// How much two polygons exchange where nothing stands between them, exactly.
#pragma once
#include <span>

#include "math/polygon.h"
#include "math/quadrature.h"

namespace goldthread {

/// The form factor of a polygon at `x` for a receiver of unit normal `n`, in double precision (Lambert 1760;
/// see polygon_form_factor): 0..1. The polygon may be of any simple shape and size; it sends to its front.
double point_form_factor(const dvec3& x, const dvec3& n, std::span<const dvec3> polygon);

/// The exchange area of two polygons, A1 F12 = A2 F21 in m², with nothing between them, by Stokes's theorem
/// (Sparrow 1963; Walton 2002, NISTIR 6925):
///   A1 F12 = 1/(2 pi) * sum over edge pairs of dot(d1, d2) * double integral of ln r ds dt,
/// d1, d2 the unit directions of the edges. The inner integral is taken in closed form, the outer by adaptive
/// quadrature, edges that meet included. What lies behind the other's plane is cut off first. The error
/// covers quadrature and rounding; with nothing cancelled it is 1e-14 of the value, and grows with the ratio
/// of distance to size.
Estimate polygon_exchange(std::span<const dvec3> first, std::span<const dvec3> second);

}  // namespace goldthread
