// How much of an element's radiosity arrives at a point, were nothing between.
#pragma once
#include "element/element_pool.h"

namespace goldthread {

/// Vector form factor m of `source` at `x`, without occlusion: dot(n, m) times the source's radiosity is the
/// irradiance on a receiver of unit normal `n`. Equation 4.19 where the source is far; near, face clusters
/// are descended until each piece is small for its distance, and triangles and patches are exact (Lambert's
/// contour formula), so that shared edges and closed sources need no special care. Zero below the receiver's
/// horizon and behind the source. For lights the "radiosity" is what Element::exitance says: candela, lux, or
/// the sky's lm/m^2.
vec3 point_transfer(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n);

// A piece of a source of area A whose points lie within R D of a centroid D away is taken for far when, for
// Q = A/(pi D^2) and the cosines at both ends as large as the piece's extent lets them be,
//   R < 1/2  and  Q cos cos R^2 < kPieceTolerance     if all of it turns its front to x,
//   R < 1/2  and  Q cos cos     < kPieceTolerance     if not,
// triangles and patches only (with the cosine at their end alone) where the horizon does not cut them,
// clusters that it cuts where Q cos cos <= kHorizonTolerance, lamps kLampTolerance, so that what they lose
// adds up to little. By the bounds of math/far_form_factor.h no such piece's form factor is off by more than
//   a triangle:                          5.5 kPieceTolerance = 3.3e-3; largest seen 2e-4
//   a patch:                            11   kPieceTolerance = 6.6e-3; largest seen 6e-4
//   a cluster, not all of it in front:   4   kPieceTolerance = 2.4e-3
//   the same, cut by the horizon:        4   of its tolerance = 8e-4, a lamp 8e-5
//   a cluster, all of it in front:      Q (2 R s + 8 R^2), s^2 = 1 - |S|^2/A^2 (s is at most the sine of its
//                                       cone of normals)
// The first two hold since E|delta|^2 is at most a quarter of the squared radius of a triangle, half of that
// of any convex piece; the next two since what is there and what is taken for it both lie within 0 and
// Q cos cos/(1 - R)^2. Errors of many pieces are of either sign.

/// Form factor that one piece may bring in wrong, about.
constexpr float kPieceTolerance = 6e-4f;
/// The same for a piece that the receiver's horizon cuts: what is above it brings more than its centre says,
/// and such errors add up.
constexpr float kHorizonTolerance = 2e-4f;
/// Of lamps, which outshine all else a thousandfold, next to nothing may be lost.
constexpr float kLampTolerance = 2e-5f;

/// How far dot(n, m) of point_transfer may be from the exact unoccluded form factor (Lambert 1760) of the
/// source's triangles, single precision's rounding apart (1e-5 where pieces are many): the bounds of
/// math/far_form_factor.h, added up over the pieces that were taken for far; 0 where none were, and for
/// lights. Of a volume cluster, whose samples stand for it, what its box leaves open. A proof, for tests and
/// reports: some five times the error of a triangle or patch, fifty times that of a face cluster, and much
/// slower than the transfer.
double point_transfer_error_bound(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n);

/// A ball's or the sun's disc as a point sees it; of lamps without size and of area lamps only the way.
struct LightDisc {
  vec3 axis{0};        ///< unit, to its middle
  float distance = 0;  ///< metres; 0 for the sun
  float sine = 0;      ///< of its angular radius; 0 for lights without size, and of places within the lamp
};
LightDisc light_disc(const Light& light, const vec3& x);

/// What an even disc that brings 1 to a plane facing it brings to one of unit normal `n`, whose horizon may
/// cut it: the cosine, or, cut, the closed form for a ball partly below the horizon (S. Lagarde and C. de
/// Rousiers, Moving Frostbite to Physically Based Rendering, 2014, sphere lights).
float disc_cosine(const LightDisc& disc, const vec3& n);

/// Share of a point or spot light's intensity that goes in unit direction `d`: its profile's, or
/// KHR_lights_punctual's cone falloff.
float light_distribution(const Light& light, const vec3& d);
/// Steradians into which a lamp would have to shine as it does where it is brightest to give off as much
/// light: lumens per candela. Of spot lights that of the whole cone, which is a little too much.
float lamp_solid_angle(const Light& light);
/// Share that is left at `distance` metres of a light with a range (KHR_lights_punctual), besides the inverse
/// square.
float light_range_factor(const Light& light, float distance);

}  // namespace goldthread
