// Sources that are far for their size, as points: the solver's approximations of a form factor, and how far
// each may be off.
//
// A point y of a source, seen from the receiver at the origin, brings K(y) dA / pi with
//   K(y) = (n.y)(t.y) / |y|^4,   n, t unit: the receiver's normal and the source's, turned to the receiver
// (thesis equation 2.17). With d the way to the source's centroid, D = |d|, e = d / D, y = d + delta,
// R = radius / D and rho = |delta| / D < 1, all errors here follow from two facts.
//
// 1. In the plane of d and delta, a complex number z for y, the product of two cosines is half the cosine of
//    their difference and half that of their sum: K = (a / |z|^2 + Re(b / conj(z)^2)) / 2 with |a|, |b| <= 1.
//    The k-th Taylor coefficient of 1/|z|^2 along delta is a Chebyshev polynomial of the second kind, U_k, at
//    most k + 1 (times rho^k / D^2), that of 1/z^2 is k + 1. So the k-th derivative of K along a unit vector
//    is at most
//      C_k / |y|^(k + 2),  C_k = (k + 1)!:  C_1 = 2, C_2 = 6, C_3 = 24,  reached when all look the same way,
//    and what is left of K after the terms below order k is at most the sum of the (j + 1) rho^j from k on,
//      rho^k (k + 1 - k rho) / (1 - rho)^2 / D^2.
// 2. On a plane t.y is the same everywhere: K = (t.d) (n.y) / |y|^4, whose coefficients are at most
//    (k + 1)(k + 2) / 2 times t.e: after the terms below order k at most
//      (t.e) rho^k ((k+1)(k+2)/2 - k (k+2) rho + k (k+1)/2 rho^2) / (1 - rho)^3 / D^2  is left.
//    Less than the first for planes seen edge-on.
//
// About the centroid the terms of first order cancel on a plane. Approximations are templates, in single
// precision for the solver; bounds hold for them in exact arithmetic. Rounding adds some units of the last
// place of d's coordinates, relative to D.
#pragma once
#include <algorithm>
#include <array>
#include <numbers>
#include <span>

#include "math/oriented_box.h"
#include "math/vec.h"

namespace goldthread {

template <typename T>
using Vec3Of = glm::vec<3, T>;

/// The vector form factor m, with dot(n, m) the form factor, of a piece that turns its front to the receiver,
/// all of it at its centroid (thesis equation 4.19): d the way there in metres, `squared` = dot(d, d),
/// `summed_normal` S in m². Zero from behind. The same m for every n; see dipole_error_bound.
template <typename T>
Vec3Of<T> dipole_form_factor(const Vec3Of<T>& d, T squared, const Vec3Of<T>& summed_normal) {
  const T power = -glm::dot(d, summed_normal);
  if (power <= 0) return Vec3Of<T>(0);
  return d * (power / (std::numbers::pi_v<T> * squared * squared));
}

/// The same of a flat piece with its second-order term, as if it varied equally in all directions of its
/// plane: half that variance times the in-plane Laplacian of K,
///   K (1 + rho^2/D^2 (1 - 3 (t.e)^2 - (n.t)(t.e)/(n.e))),
/// where `rho_squared` in m² is twice E|delta|^2 (rho is the radius, for a disc), and t.e > 0. On the axis of
/// a disc that is the start of the exact rho^2/(rho^2 + D^2); without it near pieces bring too much. The
/// factor in brackets is kept within 0.5 and 1.5. For this n only; zero below its horizon. See
/// flat_dipole_error_bound.
template <typename T>
Vec3Of<T> flat_dipole_form_factor(const Vec3Of<T>& d, T squared, const Vec3Of<T>& summed_normal,
                                  const Vec3Of<T>& n, T rho_squared) {
  const T at_receiver = glm::dot(d, n), power = -glm::dot(d, summed_normal);
  if (at_receiver <= 0 || power <= 0) return Vec3Of<T>(0);
  const T area = glm::length(summed_normal);
  const T at_source = power / area;
  const T cosine_squared = at_source * at_source / squared;
  const T bend = 1 - 3 * cosine_squared - glm::dot(n, summed_normal) / area * at_source / at_receiver;
  const T factor = std::clamp(1 + rho_squared / squared * bend, T(0.5), T(1.5));
  return d * (factor * power / (std::numbers::pi_v<T> * squared * squared));
}

/// The same of a far piece that turns both faces and backs to the receiver: a bolt, a chair's leg. Half of
/// the sum of |t.e| and of t.e over its triangles is the projected area that faces the receiver; the second
/// is S's, the first is S's own besides what would be half the `area` (m²), were the normals that cancel in S
/// spread evenly. Taking S alone, a closed object would send nothing. What one part hides of another counts
/// as seen. See rounded_dipole_error_bound.
template <typename T>
Vec3Of<T> rounded_dipole_form_factor(const Vec3Of<T>& d, T squared, const Vec3Of<T>& summed_normal, T area) {
  const T distance = std::sqrt(squared);
  const T net = -glm::dot(d, summed_normal) / distance;
  const T cancelled = std::max(T(0), area - glm::length(summed_normal));
  const T facing = T(0.5) * (std::abs(net) + T(0.5) * cancelled + net);
  return d * (facing / (std::numbers::pi_v<T> * squared * distance));
}

/// How a piece whose points lie within `radius` of its centroid, and whose normals within an angle of S,
/// shows itself to a receiver.
template <typename T>
struct ConeView {
  T facing = 0;  ///< cosine between S and the way back to the receiver
  T slack = 1;   ///< by how much the cosine at a point of the piece may be more, or less, than `facing`
  /// The cosines at both ends, as large as the piece's extent lets them be, times area / (pi D^2).
  T factor = 0;
  bool all_behind = false;    ///< no point of it turns its front to the receiver
  bool all_in_front = false;  ///< every point does
};

/// The view of such a piece from a receiver of unit normal n: d the way to its centroid, S = `summed_normal`
/// and `area` in m², `cone_cosine` that of the largest angle between S and a normal (-1: anything). With R =
/// radius / D < 1
///   F <= factor / (1 - R)^2
/// for what reaches the receiver with nothing in between, the parts of a closed or folded piece included, cut
/// by the horizon or not: no y is nearer than D (1 - R), its direction is within asin R of e, and
/// cos(u - v) <= max(0, cos u) + sin v.
template <typename T>
ConeView<T> view_of_cone(const Vec3Of<T>& d, T squared, const Vec3Of<T>& n, const Vec3Of<T>& summed_normal,
                         T area, T radius, T cone_cosine) {
  ConeView<T> view;
  const T distance = std::sqrt(squared);
  view.facing = -glm::dot(d, summed_normal) / (distance * glm::length(summed_normal) + T(1e-30f));
  const T cone_sine = std::sqrt(std::max(T(0), 1 - cone_cosine * cone_cosine));
  const T extent = std::min(T(1), radius / std::max(distance, T(1e-30f)));
  view.slack = cone_cosine > 0 ? std::min(T(1), cone_sine + extent) : T(1);
  view.all_behind = squared > radius * radius && view.facing < -view.slack && cone_cosine > 0;
  view.all_in_front = view.facing > view.slack;
  const T at_receiver = std::min(T(1), (std::abs(glm::dot(d, n)) + radius) / (distance + T(1e-30f)));
  const T at_source = std::min(T(1), std::max(T(0), view.facing) + view.slack);
  view.factor = area * at_receiver * at_source / (std::numbers::pi_v<T> * squared + T(1e-30f));
  return view;
}

/// A piece of a source as a receiver sees it: all that bounds need to know of its shape.
struct FarPiece {
  dvec3 to_centroid{0};      ///< d, m, from the receiver to the area-weighted centroid
  dvec3 summed_normal{0};    ///< S, m²; its length is `area` when the piece is flat
  double area = 0;           ///< m²
  double radius = 0;         ///< of a ball about the centroid that holds the piece, m
  double second_moment = 0;  ///< E|delta|^2, m²: of a disc radius²/2, of a triangle a 36th of its edges'
                             ///< squares. radius² bounds it where it is not known.
  double deviation = 0;    ///< of a flat piece: half the difference of its largest and least variance, m²; 0
                           ///< for discs and squares. Where it is not known largest_deviation bounds it.
  bool flat = false;       ///< lies in one plane
  bool symmetric = false;  ///< about its centroid: discs, rectangles
};

/// Of any region of a plane: sqrt((E/2)^2 - (A/4 pi)^2), since none of area A has variances with a product
/// below a disc's.
double largest_deviation(double area, double second_moment);

using DoubleTriangle = std::array<dvec3, 3>;

/// What triangles (counter-clockwise from their fronts, some area in all) are together to a receiver at x.
/// Told apart as flat when all normals agree to within rounding; never as symmetric.
FarPiece far_piece_of(const dvec3& x, std::span<const DoubleTriangle> triangles);
/// A disc that sends to the side of its unit normal.
FarPiece far_piece_of_disc(const dvec3& x, const dvec3& centre, const dvec3& unit_normal, double radius);

// Bounds of |F - approximation|, F the exact form factor without occlusion (Lambert 1760), for every unit
// normal n of a receiver with the whole piece above its horizon. Infinite where the receiver is within the
// piece's ball.

/// Of dipole_form_factor, for a piece all of whose points turn their front to the receiver.
///   flat:  A/(pi D^2) ((V_iso E/2 + V_dev s)/D^2 + rest_3 E R/D^2)  or  A/(pi D^2) rest_2 E/D^2  if less,
/// with E = E|delta|^2 and p = 1 - (t.e)^2. V_iso = 4 (t.e) sqrt(3 p^2 - 3 p + 1) and
/// V_dev = 4 (t.e) sqrt(p (1 + 3 p)) are the largest terms of second order, for all n, of a unit of variance
/// in both directions, and of one more in the one and less in the other; s is piece.deviation. rest_k is the
/// lesser of the two remainders above over rho^k at rho = R, both of which grow with it, and E|delta|^k at
/// most E R^(k - 2) D^(k - 2); rest_3 R becomes rest_4 R^2 when the piece is symmetric.
///   else:  A/(pi D^2) (2 sqrt(E)/D sqrt(1 - |S|^2/A^2) + rest_2 E/D^2),
/// for the first-order term is what place and normal vary together: C_1 times the root mean squares of both.
double dipole_error_bound(const FarPiece& piece);

/// Of flat_dipole_form_factor at n, for a flat piece (piece.flat) that turns its front to the receiver:
///   A/(pi D^2) ((V_iso |E/2 - rho^2/4| + V_dev s)/D^2 + rest_3 E R/D^2),
/// which is what the assumption of equal variance and the second-order term leave over. For a disc s and
/// E/2 - rho^2/4 are nought. n says only whether the factor ran into 0.5 or 1.5: the answer then lies between
/// that of the dipole and of the second-order term, and the larger of both bounds holds.
double flat_dipole_error_bound(const FarPiece& piece, const dvec3& n, double rho_squared);

/// Of rounded_dipole_form_factor at n (zero for n.d <= 0), for any piece: the horizon may cut it.
///   what cut_dipole_error_bound has with c = 1, + max(0, n.e) spread/(pi D^2);  0 for what is all below.
/// The first is for the piece's extent, the second for its normals: the sum of |t.e| lies between |S.e| and
/// sqrt(A^2 - |S|^2 + (S.e)^2) (Cauchy-Schwarz, for mean squares of the cosines along and across e); `spread`
/// is half of the larger distance of what is taken from either. That stays as far as one goes: a share of F,
/// not of a higher order.
double rounded_dipole_error_bound(const FarPiece& piece, const dvec3& n);

/// Of dipole_form_factor at n (zero for n.d <= 0) where the horizon cuts a piece that turns its front to the
/// receiver. Of flat_dipole_form_factor as much more as it differs from the dipole. The lesser of
///   A/(pi D^2) rest_1 sqrt(E)/D   and   A/(pi D^2) (c sqrt(E)/D + slope (max(0, n.e) sqrt(E)/D + E/D^2)):
/// n.y above the horizon has a mean between n.d and half E|n.delta| more (c = (t.e)/2; 1 when the piece is
/// not flat, since place and normal then vary together), and besides (t.y)/|y|^4 varies, whose Taylor
/// coefficients are those of a plane's K: slope = ((1 - R)^-3 - 1)/R, or (t.e) ((1 - R)^-4 - 1)/R on a plane
/// if less. Holds above the horizon, too; of first order only.
double cut_dipole_error_bound(const FarPiece& piece, const dvec3& n);

/// Bounds of a form factor over all sources of a kind.
struct FormFactorBounds {
  double low = 0, high = 0;
};

/// Bounds of F at x, for a receiver of unit normal n, of any source of `area` m² within a box, without
/// occlusion by others or itself; all its unit normals lie within acos(cone_cosine) of the unit vector `axis`
/// (-1 for a closed one). Holds for every x outside the box, whatever the source's shape: curved, closed,
/// thin or in layers, each of which counts. Both are A cos cos / (pi r^2) with all three as large and as
/// small as the box and the cone let them be; `high` is infinite for x in the box. Rounding: 1e-12 of the
/// value.
FormFactorBounds box_form_factor_bounds(const dvec3& x, const dvec3& n, const OrientedBox& box, double area,
                                        const dvec3& axis, double cone_cosine);

/// The form factor of a box as a whole, 0..1: of its faces that turn to x, what lies below the horizon cut
/// away. No less than that of the visible part of anything in it, since whatever reaches x passes a face.
/// For x in the box 1.
double box_form_factor(const dvec3& x, const dvec3& n, const OrientedBox& box);

}  // namespace goldthread
