// What counts in a scene: where its detail is, and how well the eye tells light from light there.
#pragma once
#include "solve/hierarchical/radiosity_state.h"

namespace goldthread {

/// A room on a plain of kilometres: nearly all light lands on the plain, and a bound on errors in shares of
/// that light would let the room be anything. So area counts in full where most triangles are, and beyond by
/// the solid angle that a plain has from there, which falls with the cube of the distance.
class Regard {
 public:
  /// Everything counts in full.
  Regard() = default;
  /// The middle of the scene's triangles (the median of their first corners) and twice the distance from it
  /// that nine tenths of them keep within, or where that is less four times what three quarters do: beside a
  /// room of a dozen triangles two of a landscape are more than a tenth. Counted, not weighted by area.
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

/// How much less error counts on what is itself uneven to the eye, 1/2..1: from a contrast of 5% on the
/// threshold at which a pattern is seen against another rises as that one's contrast to the power of 0.62 (G.
/// Legge and J. Foley, Contrast Masking in Human Vision, 1980). How coarse the texture is for the error is
/// not asked; hence the bound. `contrast` is ElementPool::texture_contrast.
double weight_of_masking(double contrast);

/// How much more error counts in the dark, 1..10: from a fifth of the mean downwards what that is over the
/// light adapted to, since every share of a stimulus counts alike there.
double weight_of_darkness(double adapted, double mean);

}  // namespace goldthread
