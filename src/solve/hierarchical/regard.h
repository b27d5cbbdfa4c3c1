// What counts in a scene: where its detail is, and how well the eye tells light from light there.
#pragma once
#include "solve/hierarchical/radiosity_state.h"

namespace goldthread {

/// A room on a plain of kilometres: nearly all light lands on the plain, and a bound on errors in shares of
/// that light would let the room be anything. So area counts in full where most triangles are, and beyond by
/// the solid angle that it has from there.
class Regard {
 public:
  /// Everything counts in full.
  Regard() = default;
  /// The middle of the scene's triangles (the median of their first corners) and twice the distance from it
  /// that nine tenths of them keep within. Both are counted, not weighted by area.
  explicit Regard(const SurfaceSet& surfaces);

  /// Share of a surface's area that counts, 0..1.
  float of(const Element& e) const;

 private:
  vec3 centre_{0};
  float radius_ = std::numeric_limits<float>::infinity();
};

/// Irradiance times area (with coverage) times regard over the leaves, lm.
vec3 regarded_power(const ElementPool& pool, const RadiosityState& state, const Regard& regard);
/// Area times regard over the surfaces, m^2.
double regarded_area(const ElementPool& pool, const Regard& regard);

/// Lux (largest channel) that an eye adapts to which looks at `id`: the mean over the first element above it
/// that is no smaller than a two-hundredth of `area`. A gap between books is dark in a bright room; a cellar
/// is dark. Infinite where nobody looks, as under a box.
double adapted_light(const ElementPool& pool, const RadiosityState& state, ElementId id, double area);

/// How much more error counts in the dark, 1..10: from a twentieth of the mean downwards the root of what
/// that is over the light adapted to. Between the mean square, which knows no eye, and lightness, by which
/// every share of a stimulus counts alike.
double weight_of_darkness(double adapted, double mean);

}  // namespace goldthread
