// Axis-aligned box.
#pragma once
#include <limits>

#include "math/vec.h"

namespace goldthread {

struct Box {
  vec3 low{std::numeric_limits<float>::max()};
  vec3 high{std::numeric_limits<float>::lowest()};

  bool empty() const { return low.x > high.x; }
  void add(const vec3& p) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  void add(const Box& b) {
    low = glm::min(low, b.low);
    high = glm::max(high, b.high);
  }
  vec3 centre() const { return 0.5f * (low + high); }
  vec3 size() const { return empty() ? vec3(0) : high - low; }
  float diagonal() const { return length(size()); }
  float surface_area() const {
    const vec3 s = size();
    return 2 * (s.x * s.y + s.y * s.z + s.z * s.x);
  }
};

}  // namespace goldthread
