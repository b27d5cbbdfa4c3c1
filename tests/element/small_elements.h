// The elements of small scenes, and numbers at random.
#pragma once
#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "element/element_pool.h"
#include "element/surface_set.h"
#include "scene/small_scenes.h"

namespace goldthread::test {

/// Numbers that are the same on every machine.
struct Random {
  std::mt19937 engine;
  explicit Random(uint32_t seed) : engine(seed) {}
  float in(float low, float high) {
    return low + (high - low) * static_cast<float>(engine() >> 8) * 0x1p-24f;
  }
  uint32_t below(uint32_t count) { return uint32_t(engine() % count); }
  vec3 point() { return {in(-1, 1), in(-1, 1), in(-1, 1)}; }
  vec3 direction() {
    const float z = in(-1, 1), angle = in(0, 2 * kPi), r = std::sqrt(std::max(0.0f, 1 - z * z));
    return normalize(vec3(r * std::cos(angle), r * std::sin(angle), z));
  }
};

/// A scene with its surfaces and elements; keeps all three where they are.
struct Elements {
  std::unique_ptr<Scene> scene;
  std::unique_ptr<SurfaceSet> set;
  std::unique_ptr<ElementPool> pool;

  explicit Elements(Scene s) : scene(std::make_unique<Scene>(std::move(s))) {
    set = std::make_unique<SurfaceSet>(build_surfaces(*scene, CancelToken()));
    pool = std::make_unique<ElementPool>(*set);
  }

  /// Childless elements of surfaces and lights, ascending.
  std::vector<ElementId> leaves() const {
    std::vector<ElementId> out;
    for (ElementId id = 0; id < pool->size(); ++id)
      if ((*pool)[id].first_child == kNoElement) out.push_back(id);
    return out;
  }
  /// Makes children everywhere, `times` over.
  void expand(int times) {
    for (int i = 0; i < times; ++i) pool->expand(leaves());
  }
  /// Makes children of a random share of the leaves, `times` over.
  void expand_some(Random& random, int times, float share) {
    for (int i = 0; i < times; ++i) {
      std::vector<ElementId> some;
      for (const ElementId id : leaves())
        if (random.in(0, 1) < share) some.push_back(id);
      pool->expand(some);
    }
  }
};

}  // namespace goldthread::test
