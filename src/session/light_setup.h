// What is worth knowing of a scene's light before any is computed.
#pragma once
#include <string>
#include <vector>

#include "element/surface_set.h"
#include "scene/lighting.h"
#include "visibility/ray_caster.h"

namespace goldthread {

/// Whether anything gives light: a surface, a lamp, or the sky.
bool has_light(const SurfaceSet& surfaces);
/// Parts that emit.
uint64_t count_emitters(const SurfaceSet& surfaces);

/// Turns shells wound inside out (mesh/orient); returns a line that says how many, empty for none.
std::string fix_scene_normals(Scene& scene);

/// What was skipped or clamped, a line each.
std::vector<std::string> describe_problems(const SurfaceSet& surfaces);
/// The same about triangles in one place; empty when there are none.
std::string describe_overlaps(const SurfaceSet& surfaces);

/// Light that goes straight on through a triangle of the world at a point: all of it where a mask has a hole,
/// what its alpha leaves where it is blended, what is left in its colour where it is glass.
Passing transparency(uint32_t triangle, vec2 weights, const SurfaceSet& surfaces);

/// Whether a ray ends on the side of a one-sided surface that neither reflects nor emits.
bool ends_on_back(const SurfaceSet& surfaces, const RayCaster& caster, const Ray& ray);

/// Nits to COLOR_0 units: a given exposure, or one that maps the log average of what is lit of the scene's
/// outgoing light (`log_average`) to middle grey.
float unlit_exposure(const Scene& scene, const Lighting& lighting, float asked);

/// Least and greatest luminance of all vertices' irradiance, both sides, lx; and how many have none that is a
/// number, which no scene should bring about.
struct IrradianceRange {
  double least = 0, most = 0;
  uint64_t not_finite = 0;
};
IrradianceRange irradiance_range(const Lighting& lighting);

/// Bytes of hierarchies and placed geometry.
uint64_t memory_bytes(const SurfaceSet& surfaces);

}  // namespace goldthread
