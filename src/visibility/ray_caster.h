// Everything that asks "what does this ray meet" asks here. Embree 3 or 4 behind it.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <span>

#include "math/vec.h"

namespace goldthread {

struct Ray {
  vec3 origin{0};
  vec3 direction{0};  ///< need not be unit: distances are in its lengths
  float near = 0, far = std::numeric_limits<float>::infinity();
};

struct Hit {
  static constexpr uint32_t kMiss = 0xffffffffu;
  uint32_t triangle = kMiss;  ///< index in the triangles given
  float distance = 0;
  vec2 weights{0};  ///< barycentric weights of corners 1 and 2
  vec3 normal{0};   ///< geometric, not unit, by the winding

  bool missed() const { return triangle == kMiss; }
};

/// Share of a ray's light, 0..1, that goes on through `triangle` at barycentric `weights` (alpha mask and
/// blend). Called from many threads at once; must be a pure function of its arguments.
using Transparency = std::function<float(uint32_t triangle, vec2 weights, const Ray& ray)>;

/// A static soup of world-space triangles. Thread safe once built.
class RayCaster {
 public:
  /// `see_through` marks, per triangle, those for which `transparency` is asked; both may be empty. The
  /// arrays are copied into Embree's own buffers and may be dropped afterwards.
  RayCaster(std::span<const vec3> positions, std::span<const UVec3> triangles,
            std::span<const uint8_t> see_through = {}, Transparency transparency = {});
  ~RayCaster();
  RayCaster(RayCaster&&) noexcept;
  RayCaster& operator=(RayCaster&&) noexcept;

  /// The nearest hit. What is partly transparent stops its share of rays: which, a hash of ray and triangle
  /// says, so that it is the same every time.
  Hit closest(const Ray& ray) const;
  /// `closest` for many rays, one after another; `hits` is as long as `rays`.
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const;
  /// Share of light that gets from near to far: the product over all that lies between.
  float transmittance(const Ray& ray) const;
  /// `transmittance` for many rays, one after another; `out` is as long as `rays`.
  void transmittance(std::span<const Ray> rays, std::span<float> out) const;
  /// `transmittance` for up to 16 rays that go much the same way, as a packet; `out` is as long as `rays`.
  void packet_transmittance(std::span<const Ray> rays, std::span<float> out) const;

  /// Calls `visit(triangle)` for every triangle that comes within `radius` of `point`, and for some others
  /// that are not far, in no order.
  void near(const vec3& point, float radius, const std::function<void(uint32_t triangle)>& visit) const;

  /// Metres by which ray ends should leave their surfaces: far above the rounding of the triangles'
  /// coordinates, far below anything visible. Surfaces closer than that lie in one place.
  float epsilon() const;

  uint64_t memory_bytes() const;  ///< what Embree has allocated for this scene

 private:
  void closest(const Ray& ray, Hit& hit) const;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace goldthread
