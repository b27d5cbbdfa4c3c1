// A lit scene as one soup of world-space triangles, with what a ray that meets one sees there.
#pragma once
#include <memory>
#include <vector>

#include "scene/lighting.h"
#include "scene/scene.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// The triangles of one primitive of one instance.
struct ShownSurface {
  const Material* material = nullptr;
  bool lit = false;       ///< has irradiance
  bool lit_back = false;  ///< has irradiance on the back too
};

/// What is seen at one point.
struct Appearance {
  vec3 nits{0};
  float alpha = 1;  ///< of a blended surface, else 1
  vec3 behind{0};   ///< share of what is behind that shows through, by channel: blends and glass
};

/// Refers to the scene, which must outlive it.
class ShownScene {
 public:
  ShownScene(const Scene& scene, const Lighting& lighting);
  ShownScene(const ShownScene&) = delete;  // the ray caster calls back into this object
  ShownScene& operator=(const ShownScene&) = delete;

  /// The nearest surface that a viewer would draw: back faces of single-sided materials and holes of
  /// alpha-masked ones are looked through.
  Hit closest(const Ray& ray) const;
  /// Emission plus reflectance * irradiance / pi on the side that the ray comes from.
  Appearance appearance(const Hit& hit, const Ray& ray) const;

  uint32_t surface_of(uint32_t triangle) const { return surface_of_[triangle]; }
  bool seen_from_back(uint32_t triangle, const Ray& ray) const;
  /// World positions of the corners of all triangles, each at least once.
  std::vector<vec3> corner_points() const;
  const Box& bounds() const { return bounds_; }
  bool empty() const { return triangles_.empty(); }

 private:
  void add(const Instance& instance, const Primitive& primitive, const LitPrimitive* lit);
  void add_vertices(const Instance& instance, const Primitive& primitive, const LitPrimitive* lit);
  vec2 texcoord(const Texture& texture, uint32_t triangle, vec2 weights) const;
  float alpha_at(uint32_t triangle, vec2 weights) const;
  bool looked_through(uint32_t triangle, vec2 weights, const Ray& ray) const;
  template <typename T>
  T interpolate(const std::vector<T>& values, uint32_t triangle, vec2 weights) const;

  const Scene& scene_;
  std::vector<ShownSurface> surfaces_;
  std::vector<uint32_t> surface_of_;  ///< per triangle
  std::vector<vec3> positions_;       ///< world
  std::vector<UVec3> triangles_;      ///< counter-clockwise from the front, mirrored instances too
  std::vector<vec2> texcoords_[2];    ///< per vertex, as all below
  std::vector<vec4> colours_;
  std::vector<vec3> irradiance_, irradiance_back_;
  Box bounds_;
  std::unique_ptr<RayCaster> drawn_;
};

/// frame_camera for a scene that is already prepared.
Camera frame_camera(const ShownScene& shown);

}  // namespace goldthread
