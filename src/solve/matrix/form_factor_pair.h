// The form factor of one pair of polygons, others in between or not.
#pragma once
#include <span>
#include <vector>

#include "math/polygon.h"
#include "math/quadrature.h"

namespace goldthread {

/// How a form factor was found.
enum class FormFactorMethod : uint8_t {
  kFacesAway,     ///< neither sees any of the other's front: exactly nought
  kPoint,         ///< from a point, closed form (Lambert 1760)
  kContour,       ///< double contour integral, nothing in between
  kVisibleParts,  ///< from each point the exact visible part of the target, integrated over the source
  kShape,         ///< quadrature of closed forms over a curved shape
  kRays,          ///< sample points and rays
  kHemicube,      ///< item buffers at sample points
  kCovered,       ///< a mask and what it covers, face to face: all of it
};
const char* method_name(FormFactorMethod method);

struct FormFactor {
  double value = 0;        ///< 0..1
  double error_bound = 0;  ///< absolute; of rays two standard errors
  FormFactorMethod method = FormFactorMethod::kFacesAway;
  double standard_error = 0;  ///< of the value, where rays were cast
};

/// Occluders as convex polygons, and where they are.
class Blockers {
 public:
  /// Each polygon planar and simple; `owners` are numbers that queries may leave out, one a polygon.
  Blockers(std::span<const Polygon> polygons, std::span<const uint32_t> owners);
  explicit Blockers(std::span<const Polygon> polygons);

  /// Those that may hide part of one polygon from the other: not wholly behind either, and not parted from
  /// both by a plane through an edge of the one and a corner of the other. Leaves out two owners.
  std::vector<Polygon> between(std::span<const dvec3> from, std::span<const dvec3> to, uint32_t not_this,
                               uint32_t nor_this) const;

 private:
  struct Part {
    Polygon corners;
    dvec3 low, high;
    uint32_t owner;
  };
  std::vector<Part> parts_;
};

/// Exchange area A1 F12 = A2 F21 in m² of two polygons past `blockers` (convex). With none the double contour
/// integral; else the integral over the one of what its points see of the other, or of what they do not see
/// if that is less. Of both ways round the better one, if the first misses the tolerance.
struct Exchange {
  Estimate area;
  FormFactorMethod method = FormFactorMethod::kFacesAway;
};
Exchange visible_exchange(std::span<const dvec3> first, std::span<const dvec3> second,
                          std::span<const Polygon> blockers, const CubatureLimits& limits);

/// F from -> to. Occluders block from both sides; `from` and `to` do not occlude.
FormFactor polygon_form_factor(std::span<const dvec3> from, std::span<const dvec3> to,
                               std::span<const Polygon> occluders, const CubatureLimits& limits = {});

/// The same from a point of unit normal `n`; closed form.
FormFactor point_to_polygon(const dvec3& x, const dvec3& n, std::span<const dvec3> to,
                            std::span<const Polygon> occluders);

}  // namespace goldthread
