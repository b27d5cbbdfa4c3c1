// What the solver knows about every element: light that arrives and leaves.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "element/element_pool.h"

namespace goldthread {

/// Arrays over elements. Pools grow; `grow_to` gives new elements what their parents know.
struct RadiosityState {
  std::vector<vec3> radiosity;   ///< b, lm/m^2, area mean (equation 4.17); for lights as Element::exitance
  std::vector<vec3> irradiance;  ///< lux, area mean
  /// b as others see it: the mean weighted by how open each leaf lies. A floor is dark where a box stands on
  /// it, and just there nobody sees it; with the plain mean, the links' visibility would take that dark away
  /// a second time.
  std::vector<vec3> shown;
  std::vector<float> openness;  ///< m^2: area times the share of what a leaf faces that it also sees
  std::vector<float> low,
      high;  ///< least and largest radiosity (largest channel) among the open leaves below
  std::vector<mat3>
      vector;  ///< of leaves, a column a channel: irradiance vectors (equation 4.13); gradients on flat ones
  std::vector<vec3> ambient;  ///< of leaves: irradiance that every normal gets besides

  void grow_to(const ElementPool& pool);
};

/// What leaves a surface element on which `irradiance` falls, lm/m^2: its own light, what it reflects, and
/// what comes through from the other side. `all` are the irradiances of elements, as many as are known: what
/// lies behind is the same piece of the other side, or where that is coarser what holds it.
inline vec3 leaving_light(const ElementPool& pool, ElementId id, const vec3& irradiance,
                          std::span<const vec3> all) {
  const vec3 b = pool[id].exitance + pool[id].reflectance * irradiance;
  const vec3 through = pool.transmittance(id);
  if (through == vec3(0)) return b;
  const ElementId behind = pool.behind(id, all.size());
  return behind == kNoElement ? b : b + through * all[behind];
}

/// The channel that counts in error estimates.
inline float largest(const vec3& c) {
  return std::max(c.x, std::max(c.y, c.z));
}

}  // namespace goldthread
