#include "session/light_setup.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <utility>

#include "element/paint.h"
#include "math/colour.h"
#include "math/tone_map.h"

namespace goldthread {

uint64_t count_emitters(const SurfaceSet& surfaces) {
  uint64_t count = 0;
  for (const Part& part : surfaces.parts)
    if (luminance(part.exitance) > 0 && !surfaces.tree(part).mesh.triangles.empty()) ++count;
  return count;
}

bool has_light(const SurfaceSet& surfaces) {
  if (surfaces.scene->sky.present() || count_emitters(surfaces) > 0) return true;
  for (const Light& light : surfaces.scene->lights)
    if (luminance(light.intensity) > 0) return true;
  return false;
}

std::vector<std::string> describe_problems(const SurfaceSet& surfaces) {
  std::vector<std::string> lines;
  if (surfaces.skipped.degenerate > 0)
    lines.push_back(
        fmt::format("{} degenerate triangles without area were skipped", surfaces.skipped.degenerate));
  if (surfaces.skipped.not_finite > 0)
    lines.push_back(fmt::format("{} triangles with corners that are not finite were skipped",
                                surfaces.skipped.not_finite));
  if (surfaces.skipped.duplicate > 0)
    lines.push_back(
        fmt::format("{} triangles that lie twice in the file are lit as one", surfaces.skipped.duplicate));
  if (surfaces.clamped_materials > 0)
    lines.push_back(fmt::format("{} materials reflect more than {} and were clamped to that",
                                surfaces.clamped_materials, kMaxReflectance));
  return lines;
}

std::string describe_overlaps(const SurfaceSet& surfaces) {
  if (surfaces.overlapping == 0) return {};
  return fmt::format("{} pairs of triangles overlap in one plane; each place is lit once",
                     surfaces.overlapping);
}

Passing transparency(uint32_t triangle, vec2 weights, const SurfaceSet& surfaces) {
  const Part& part = part_of_triangle(surfaces, triangle);
  return passing_at(surfaces, part, triangle - part.first_triangle, weights);
}

bool ends_on_back(const SurfaceSet& surfaces, const RayCaster& caster, const Ray& ray) {
  const Hit hit = caster.closest(ray);
  if (hit.missed()) return false;
  const Part& part = part_of_triangle(surfaces, hit.triangle);
  return !surfaces.scene->materials[part.material].double_sided &&
         part.winding * dot(hit.normal, ray.direction) > 0;
}

float unlit_exposure(const Scene& scene, const Lighting& lighting, float asked) {
  if (asked > 0) return asked;
  std::vector<float> nits;
  for (const LitPrimitive& lit : lighting.primitives) {
    const Mesh& mesh = scene.meshes[scene.instances[lit.instance].mesh];
    const Material& material = scene.materials[mesh.primitives[lit.primitive].material];
    const vec3 reflectance = material.base_colour * (1 - material.metallic) * (1 - material.transmission);
    for (const vec3& e : lit.irradiance) nits.push_back(luminance(reflectance * e) / kPi);
  }
  // A little above middle grey: COLOR_0 cannot go past 1, but is seldom near it.
  const std::vector<float> seen = lit_luminances(std::move(nits));
  return seen.empty() ? 1.0f : static_cast<float>(0.25 / log_average(seen));
}

IrradianceRange irradiance_range(const Lighting& lighting) {
  IrradianceRange range;
  double least = std::numeric_limits<double>::infinity();
  for (const LitPrimitive& lit : lighting.primitives)
    for (const std::vector<vec3>* side : {&lit.irradiance, &lit.irradiance_back})
      for (const vec3& e : *side) {
        const double lux = luminance(e);
        if (!std::isfinite(lux)) {
          ++range.not_finite;
          continue;
        }
        least = std::min(least, lux);
        range.most = std::max(range.most, lux);
      }
  range.least = std::min(least, range.most);
  return range;
}

uint64_t memory_bytes(const SurfaceSet& surfaces) {
  uint64_t bytes = 0;
  for (const FaceClusterTree& tree : surfaces.trees)
    bytes += tree.nodes.capacity() * sizeof(FaceCluster) + tree.roots.capacity() * sizeof(ClusterRef) +
             tree.mesh.positions.capacity() * sizeof(vec3) + tree.mesh.triangles.capacity() * sizeof(UVec3) +
             tree.mesh.source_triangles.capacity() * sizeof(uint32_t) + tree.outlines.memory_bytes();
  for (const Part& part : surfaces.parts)
    bytes += sizeof(Part) + part.positions.capacity() * sizeof(vec3) +
             (part.triangle_reflectance.capacity() + part.triangle_exitance.capacity()) * sizeof(vec3) +
             part.triangle_coverage.capacity() * sizeof(float) +
             (part.covering_first.capacity() + part.covering.capacity()) * sizeof(uint32_t);
  return bytes + surfaces.surfaces.capacity() * sizeof(Surface);
}

}  // namespace goldthread
