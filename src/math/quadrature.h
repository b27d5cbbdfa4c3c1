// Integrals to a stated tolerance.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <queue>
#include <span>

#include "math/vec.h"

namespace goldthread {

/// A value and how far it may be off.
struct Estimate {
  double value = 0;
  double error = 0;

  Estimate& operator+=(const Estimate& other) {
    value += other.value;
    error += other.error;
    return *this;
  }
};

/// Gauss's 7-point rule inside Kronrod's 15-point rule on [a, b]: exact to degree 22. The error is the
/// difference of both, which is that of the poorer one.
/// `rounding` is given what rounding may do to it.
template <typename Function>
Estimate gauss_kronrod(const Function& f, double a, double b, double* rounding = nullptr) {
  constexpr std::array<double, 8> kNodes{
      0.991455371120812639206854697526329, 0.949107912342758524526189684047851,
      0.864864423359769072789712788640926, 0.741531185599394439863864773280788,
      0.586087235467691130294144691258,    0.405845151377397166906606412076961,
      0.207784955007898467600689403773245, 0};
  constexpr std::array<double, 8> kKronrod{
      0.022935322010529224963732008058970, 0.063092092629978553290700663189204,
      0.104790010322250183839876322541518, 0.140653259715525918745189590510238,
      0.169004726639267902826583426598550, 0.190350578064785409913256402421014,
      0.204432940075298892414161999234649, 0.209482141084727828012999174891714};
  constexpr std::array<double, 4> kGauss{
      0.129484966168869693270611432679082, 0.279705391489276667901467771423780,
      0.381830050505118944950369775488975, 0.417959183673469387755102040816327};
  const double middle = 0.5 * (a + b), half = 0.5 * (b - a);
  const double centre = f(middle);
  double kronrod = kKronrod[7] * centre, gauss = kGauss[3] * centre, size = std::abs(kronrod);
  for (size_t i = 0; i < 7; ++i) {
    const double pair = f(middle - half * kNodes[i]) + f(middle + half * kNodes[i]);
    kronrod += kKronrod[i] * pair;
    size += kKronrod[i] * std::abs(pair);
    if (i % 2 == 1) gauss += kGauss[i / 2] * pair;
  }
  if (rounding != nullptr) *rounding = 32 * std::numeric_limits<double>::epsilon() * std::abs(half) * size;
  return {half * kronrod, std::abs(half * (kronrod - gauss))};
}

/// The integral of f over [a, b], halved where the rule is not sure to `tolerance` (absolute, of the whole).
/// Singularities that can be integrated are met at a geometric rate; `depth` halvings are the most, and what
/// is not sure then stays in the error.
template <typename Function>
Estimate integrate(const Function& f, double a, double b, double tolerance, int depth = 48) {
  double rounding = 0;
  const Estimate whole = gauss_kronrod(f, a, b, &rounding);
  // Halving what is rounding already would go on for ever.
  if (whole.error <= std::max(tolerance, rounding) || depth == 0) return whole;
  const double middle = 0.5 * (a + b);
  // Half the tolerance would be fair to smooth functions; towards a singular end nearly all of it is needed
  // by one half.
  Estimate sum = integrate(f, a, middle, 0.7 * tolerance, depth - 1);
  return sum += integrate(f, middle, b, 0.7 * tolerance, depth - 1);
}

/// Radon's 7-point rule on a triangle: the mean of f, exact to degree 5. `f` takes a dvec3.
template <typename Function>
double triangle_mean(const Function& f, const std::array<dvec3, 3>& corners) {
  const double root = std::sqrt(15.0);
  const auto at = [&](double first, size_t k) {  // `first` to one corner, the rest evenly to the others
    const double rest = 0.5 * (1 - first);
    return f(first * corners[k] + rest * (corners[(k + 1) % 3] + corners[(k + 2) % 3]));
  };
  double sum = 9.0 / 40 * at(1.0 / 3, 0);
  for (const double sign : {-1.0, 1.0}) {
    const double beside = (6 + sign * root) / 21, weight = (155 + sign * root) / 1200;
    for (size_t k = 0; k < 3; ++k) sum += weight * at(1 - 2 * beside, k);
  }
  return sum;
}

inline double triangle_area(const std::array<dvec3, 3>& corners) {
  return 0.5 * glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
}

/// The four equal triangles between a triangle's corners and the middles of its sides, wound as it is: one at
/// each corner, then the one between them.
inline std::array<std::array<dvec3, 3>, 4> cut_in_four(const std::array<dvec3, 3>& corners) {
  const auto& t = corners;
  const dvec3 a = 0.5 * (t[1] + t[2]), b = 0.5 * (t[2] + t[0]), c = 0.5 * (t[0] + t[1]);
  return {{{t[0], c, b}, {c, t[1], a}, {b, a, t[2]}, {a, b, c}}};
}

struct CubatureLimits {
  double relative = 1e-5;       ///< of the value
  double absolute = 0;          ///< in the value's unit
  size_t evaluations = 300000;  ///< of the function, at most; what is not sure then stays in the error
};

/// The integral of f over triangles. Again and again the one whose value changes most when it is cut into
/// four is cut into four; the error is the sum of these changes, which for smooth functions is far too much,
/// and about right where f has kinks.
template <typename Function>
Estimate integrate_triangles(const Function& f, std::span<const std::array<dvec3, 3>> triangles,
                             const CubatureLimits& limits) {
  struct Cell {
    std::array<dvec3, 3> corners;
    std::array<double, 4> quarters;  // integrals over the four parts
    double value = 0, error = 0;
    bool operator<(const Cell& other) const { return error < other.error; }
  };
  size_t evaluations = 0;
  const auto cell = [&](const std::array<dvec3, 3>& corners, double coarse, double parent_error) {
    Cell out{corners, {}, 0, 0};
    const auto quarters = cut_in_four(corners);
    for (size_t k = 0; k < 4; ++k)
      out.value += out.quarters[k] = triangle_area(quarters[k]) * triangle_mean(f, quarters[k]);
    evaluations += 28;
    // Coarse and fine may agree by chance. Where the parent's did not they hardly do so for good: smooth
    // functions gain 2^8 from one to the next.
    out.error = std::max(std::abs(out.value - coarse), parent_error / 64);
    return out;
  };
  std::priority_queue<Cell> cells;
  Estimate sum;
  const auto add = [&](const Cell& c) {
    sum += {c.value, c.error};
    cells.push(c);
  };
  for (const auto& triangle : triangles)
    for (const auto& quarter : cut_in_four(triangle))
      for (const auto& part : cut_in_four(quarter))
        add(cell(part, triangle_area(part) * triangle_mean(f, part), 0));
  while (!cells.empty() && evaluations < limits.evaluations &&
         sum.error > std::max(limits.absolute, limits.relative * std::abs(sum.value))) {
    const Cell worst = cells.top();
    if (worst.error <= 0) break;
    cells.pop();
    sum += {-worst.value, -worst.error};
    const auto quarters = cut_in_four(worst.corners);
    for (size_t k = 0; k < 4; ++k) add(cell(quarters[k], worst.quarters[k], worst.error));
  }
  // Summed anew: what was added and taken away has left its rounding.
  sum = {};
  for (; !cells.empty(); cells.pop()) sum += {cells.top().value, cells.top().error};
  sum.error = std::max({sum.error, limits.absolute, limits.relative * std::abs(sum.value)});
  return sum;
}

}  // namespace goldthread
