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

struct Box;
class Shaft;

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
  /// What the light that came this way was multiplied by: 1 unless the ray passed through colour. Rays that
  /// are stopped make up for those that are not, so that it may be above 1.
  vec3 tint{1};

  bool missed() const { return triangle == kMiss; }
};

/// Light that goes on through a surface: its share by channel, 0..1 each, and the share of rays, if they have
/// to end somewhere, that do. Where these differ the rays carry the rest as a tint.
struct Passing {
  vec3 light{0};
  float rays = 0;

  Passing(float share) : light(share), rays(share) {}
  /// As many rays as there is light on the mean, all of one colour if it is grey.
  Passing(const vec3& share)
      : light(share),
        rays(share.x == share.y && share.y == share.z ? share.x : (share.x + share.y + share.z) / 3) {}
};

/// What goes on through `triangle` at barycentric `weights` (alpha mask and blend, glass). Called from many
/// threads at once; must be a pure function of its arguments.
using Transparency = std::function<Passing(uint32_t triangle, vec2 weights, const Ray& ray)>;

/// A static soup of world-space triangles. Thread safe once built.
class RayCaster {
 public:
  /// `see_through` marks, per triangle, those for which `transparency` is asked: 0 stops all light, 1 lets
  /// grey light through, 2 may colour it; both may be empty. The arrays are copied into Embree's own buffers
  /// and may be dropped afterwards.
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
  /// Share of light that gets from near to far: the product over all that lies between. Of colours the one
  /// that passes best.
  float transmittance(const Ray& ray) const;
  /// The same by channel, for many rays, one after another; `out` is as long as `rays`.
  void transmittance(std::span<const Ray> rays, std::span<vec3> out) const;
  /// `transmittance` for up to 16 rays that go much the same way, as a packet; `out` is as long as `rays`,
  /// and so is `colours`, by channel, unless it is empty.
  void packet_transmittance(std::span<const Ray> rays, std::span<float> out,
                            std::span<vec3> colours = {}) const;

  /// Calls `visit(triangle)` for every triangle that comes within `radius` of `point`, and for some others
  /// that are not far, in no order.
  void near(const vec3& point, float radius, const std::function<void(uint32_t triangle)>& visit) const;

  /// Whether no triangle reaches into a shaft (TriangleTree::is_clear). prepare_shafts must have been called.
  bool is_clear(const Shaft& shaft) const;
  /// TriangleTree::visit_near over all triangles. prepare_shafts must have been called.
  void visit_near(const Box& box, const vec3& normal, float offset, float slack,
                  const std::function<void(uint32_t triangle)>& visit) const;
  /// Builds what shafts and boxes are tested against, once. Not from within parallel loops.
  void prepare_shafts() const;

  /// Metres by which ray ends should leave their surfaces: far above the rounding of the triangles'
  /// coordinates, far below anything visible. Surfaces closer than that lie in one place.
  float epsilon() const;

  /// Whether anything colours the light that it lets through.
  bool is_coloured() const;

  uint64_t memory_bytes() const;  ///< what Embree has allocated for this scene, and shafts need

 private:
  void closest(const Ray& ray, Hit& hit) const;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace goldthread
