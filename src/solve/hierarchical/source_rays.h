// Rays from points to sources: how much of them is seen, and which places.
#pragma once
#include <array>
#include <cstdint>

#include "element/element_pool.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// Rays cast, and the time that took, summed over threads.
struct RayCount {
  uint64_t rays = 0;
  uint64_t nanoseconds = 0;
  void operator+=(const RayCount& other) {
    rays += other.rays;
    nanoseconds += other.nanoseconds;
  }
};

/// Places of a source that a point sees, each with what it brings.
struct SeenPoints {
  static constexpr uint32_t kMost = 16;
  std::array<SurfacePoint, kMost> points;
  std::array<float, kMost> weights;
  std::array<vec3, kMost> tints;  ///< of the light that gets through, its best channel 1
  uint32_t count = 0;
};

/// Form factors of what rays saw of a source and of what was hidden from them. The mean of their sum is the
/// unoccluded form factor; of the sky only their ratio means anything.
struct SeenShare {
  float seen = 0, hidden = 0;
  vec3 by_channel{0};  ///< as `seen`, which is by each ray's best channel
};

/// Whether two elements see each other.
enum class Sight : uint8_t {
  kSampled,  ///< as rays say
  kClear,    ///< all of the one sees all of the other, and so do all their parts
};

/// Rays between points and elements.
struct Visibility {
  const RayCaster* caster = nullptr;  ///< borrowed
  float extent = 0;                   ///< metres: no two places are further apart
  float epsilon = 1e-5f;              ///< metres by which ray ends leave their surfaces
  uint32_t seed = 0;                  ///< chooses among all patterns of points and rays
  // Each can be left out, to learn what it is worth.
  bool shafts = false;           ///< where nothing stands between two elements no rays are cast
  bool discontinuities = false;  ///< cuts follow the edges of shadows and the feet of what stands there
  bool adaptive = true;          ///< as many rays as a link or a point deserves; else as many for all

  /// Casts `rays` rays from `x` with unit normal `n` to points on the triangles or outlines of `source`, or
  /// into the sky. `turn` turns the pattern. Adds the rays cast to `count`, and the first SeenPoints::kMost
  /// places where they arrived to `places` (surfaces only), if given. Not for point lights and suns.
  /// With kClear no ray is cast, and all arrive.
  SeenShare look(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n, uint32_t rays,
                 uint32_t turn, RayCount& count, SeenPoints* places = nullptr,
                 Sight sight = Sight::kSampled) const;

  /// Share of `source` seen from `x`, 0..1. A ratio of two sums over few rays: less noisy than `look`, and a
  /// little biased. `unknown` is the answer where the rays can tell nothing: `x` lies amid the source, and no
  /// place that was drawn faces it. `tint`, if given, becomes the colour of what is seen, relative to that
  /// share: 1 but behind coloured glass, and where nothing is seen.
  float fraction(const ElementPool& pool, ElementId source, const vec3& x, const vec3& n, uint32_t rays,
                 uint32_t turn, RayCount& count, float unknown = 0, vec3* tint = nullptr) const;
};

}  // namespace goldthread
