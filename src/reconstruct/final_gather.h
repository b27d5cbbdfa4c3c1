// Irradiance at a single point from the links of the solution.
#pragma once
#include "solve/hierarchical/solver.h"

namespace goldthread {

struct GatherOptions {
  uint32_t light_rays = 32;
  float ray_share = 0.01f;
  /// Whether a link's rays are believed where they all met the same: a weak link whose rays were stopped is
  /// dark at every point, and a strong one gets fewer rays than where something is in between.
  bool trust_hidden = true;
  /// Whether the normal is bent from the surface's: then links say little of what comes, and of what they say
  /// is wholly seen a part may be below the surface. All are evaluated, with rays.
  bool bent = false;
};

/// The elements' radiosity as gathering reads it, by element: the solver's, or a better one.
struct ShownLight {
  std::vector<vec3> shown;       ///< lm/m^2, as RadiosityState::shown
  std::vector<float> low, high;  ///< lm/m^2: the range below, as RadiosityState's
  /// Change of radiosity (rows: colours) a metre of place, of the leaves; empty where leaves are even.
  std::vector<mat3> rise;

  explicit ShownLight(const RadiosityState& state) : shown(state.shown), low(state.low), high(state.high) {}

  /// lm/m^2 at a place of a leaf, `from_centre` metres from the element's centre; at most twice the leaf's.
  vec3 at(ElementId leaf, const vec3& from_centre) const {
    if (rise.empty()) return shown[leaf];
    return glm::clamp(shown[leaf] + rise[leaf] * from_centre, vec3(0), 2.0f * shown[leaf]);
  }
};

struct Gathered {
  vec3 irradiance{0};  ///< lux
  float openness = 1;  ///< of what lies before the point, the share that it sees
  float seen = 1;      ///< sum of the visible form factors, once those of clusters are cut back
  float variance = 0;  ///< of the luminance of `irradiance`, lux^2, as far as the rays' luck goes
  /// The brightest leaf that lies next to the point, of which only the mean is known; kNoElement if none
  /// does.
  ElementId nearest_leaf = kNoElement;
};

/// Irradiance at `x` with unit normal `n`, which belongs to leaf element `leaf`: the links into it and all
/// elements above it, each evaluated exactly at x (equation 4.12 with the transfer of 4.19 taken anew), but
/// for those that bring next to nothing, which serve as they are. Rays are cast for links that bring a share
/// of the light worth them; for the rest the links' own sampled visibility serves. A source next to x whose
/// radiosity varies is descended: what x has before it may be in the shadow of x's own surface. And
/// of what outshines all that the leaf has, or may have faces turned away from each other, the leaves that
/// rays meet tell, not its mean. Where all that x sees is more than there is, what comes from dark clusters,
/// whose form factors are guesses, is cut back to what flat and glowing sources leave of it.
Gathered gather_at(const HierarchicalSolver& solver, const ShownLight& light, ElementId leaf, const vec3& x,
                   const vec3& n, const GatherOptions& options, uint32_t seed, RayCount& rays);

/// What a gathered light is to be multiplied with. A vertex normal that leans from its face, by `cosine`,
/// looks partly below it, where nothing comes from: (1 - cos) / 2 of its hemisphere. What it would get of an
/// even surrounding is restored, as far as it does see (Gathered::seen) less than all there is. And no point
/// sees much more than all there is. (A little more is the luck of its rays: to take just that away would
/// darken all points on the average.)
float horizon_gain(float cosine, float seen);

}  // namespace goldthread
