// What the solver knows about every element: light that arrives and leaves.
#pragma once
#include <cstdint>
#include <vector>

#include "element/element_pool.h"

namespace goldthread {

/// Arrays over elements. Pools grow; `grow_to` gives new elements what their parents know.
struct RadiosityState {
  std::vector<vec3> radiosity;    ///< b, lm/m^2, area mean (equation 4.17); for lights as Element::exitance
  std::vector<vec3> irradiance;   ///< lux, area mean
  std::vector<float> low, high;   ///< least and largest radiosity (largest channel) among the leaves below
  std::vector<mat3> vector;       ///< of leaves: columns are the irradiance vectors of R, G, B (equation 4.13)
  std::vector<vec3> ambient;      ///< of leaves: irradiance that every normal gets besides

  void grow_to(const ElementPool& pool);
};

/// The channel that counts in error estimates.
inline float largest(const vec3& c) { return std::max(c.x, std::max(c.y, c.z)); }

}  // namespace goldthread
