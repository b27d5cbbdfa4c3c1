// The fit quadric of a cluster's vertices (thesis equations 4.1 to 4.7) in the form that does not cancel.
#pragma once
#include <algorithm>
#include <cmath>

#include "math/vec.h"

namespace goldthread {

/// Ten coefficients as in equation 4.3, but kept as mean and covariance rather than A, b, c: the covariance
/// of a union follows from those of its parts without subtracting large numbers (Chan, Golub and LeVeque
/// 1979), so that single precision is enough however far from the origin the mesh lies.
struct FaceQuadric {
  float points = 0;                                      ///< c: how many
  vec3 mean{0};                                          ///< equation 4.6
  float xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;  ///< Z of equation 4.5

  static FaceQuadric of_triangle(const vec3& a, const vec3& b, const vec3& c) {
    FaceQuadric q;
    q.points = 3;
    q.mean = (a + b + c) * (1 / 3.0f);
    for (const vec3& p : {a, b, c}) q.add_outer(1, p - q.mean);
    return q;
  }

  void add_outer(float weight, const vec3& d) {
    const vec3 w = weight * d;
    xx += w.x * d.x;
    yy += w.y * d.y;
    zz += w.z * d.z;
    xy += w.x * d.y;
    yz += w.y * d.z;
    zx += w.z * d.x;
  }
};

inline FaceQuadric merged(const FaceQuadric& a, const FaceQuadric& b) {
  FaceQuadric q;
  q.points = a.points + b.points;
  const float share = b.points / q.points;
  const vec3 d = b.mean - a.mean;
  q.mean = a.mean + share * d;
  q.xx = a.xx + b.xx;
  q.yy = a.yy + b.yy;
  q.zz = a.zz + b.zz;
  q.xy = a.xy + b.xy;
  q.yz = a.yz + b.yz;
  q.zx = a.zx + b.zx;
  q.add_outer(a.points * share, d);
  return q;
}

/// E_fit of the best plane (equation 4.1): the smallest eigenvalue of Z over the number of points. It is the
/// lowest root of the characteristic polynomial, all of whose roots are real and not negative; Laguerre's
/// iteration climbs to it from 0 without overshooting, its error cubed in every step. For flat clusters one
/// step is enough; three leave a few thousandths where all eigenvalues are nearly equal, and far less
/// otherwise.
inline float fit_error(const FaceQuadric& q) {
  const double trace = double(q.xx) + double(q.yy) + double(q.zz);
  if (!(trace > 0)) return 0;
  const double s = 1 / trace;
  const double xx = s * double(q.xx), yy = s * double(q.yy), zz = s * double(q.zz);
  const double xy = s * double(q.xy), yz = s * double(q.yz), zx = s * double(q.zx);
  const double minor = yy * zz - yz * yz;
  const double c1 = minor + (xx * zz - zx * zx) + (xx * yy - xy * xy);
  const double c0 = xx * minor - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
  double root = 0;
  const int steps = c0 <= 1e-3 * c1 * c1 ? 1 : 3;
  for (int i = 0; i < steps; ++i) {  // x^3 - x^2 + c1 x - c0
    const double p = ((root - 1) * root + c1) * root - c0, slope = (3 * root - 2) * root + c1,
                 curve = 6 * root - 2;
    const double bottom = slope + std::sqrt(std::max(0.0, 4 * slope * slope - 6 * p * curve));
    if (!(bottom > 0)) break;
    root -= 3 * p / bottom;
  }
  return float(std::max(0.0, root) * trace) / q.points;
}

}  // namespace goldthread
