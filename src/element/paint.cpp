#include "element/paint.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/rng.h"
#include "element/overlap.h"
#include "math/colour.h"

namespace goldthread {
namespace {

constexpr Paint kNoPaint{vec3(0), vec3(0), 0, vec3(0), vec3(0)};

const Primitive& primitive_of(const Scene& scene, const Part& part) {
  return scene.meshes[scene.instances[part.instance].mesh].primitives[part.primitive];
}

vec2 texcoord_at(const Primitive& primitive, const Texture& texture, uint32_t source, vec2 weights) {
  const std::vector<vec2>& uv = primitive.texcoords[std::min<int>(texture.texcoord, 1)];
  if (uv.empty()) return vec2(0);
  const uint32_t* corner = &primitive.indices[3 * size_t{source}];
  return (1 - weights.x - weights.y) * uv[corner[0]] + weights.x * uv[corner[1]] + weights.y * uv[corner[2]];
}

vec4 base_colour_at(const Scene& scene, const Primitive& primitive, uint32_t source, vec2 weights) {
  const Material& material = scene.materials[primitive.material];
  vec4 colour(material.base_colour, material.alpha);
  if (material.base_colour_texture.present())
    colour *= sample_texture(material.base_colour_texture, scene.images,
                             texcoord_at(primitive, material.base_colour_texture, source, weights));
  if (!primitive.colours.empty()) {
    const uint32_t* corner = &primitive.indices[3 * size_t{source}];
    colour *= (1 - weights.x - weights.y) * primitive.colours[corner[0]] +
              weights.x * primitive.colours[corner[1]] + weights.y * primitive.colours[corner[2]];
  }
  return colour;
}

float coverage_of(const Material& material, float alpha) {
  switch (material.alpha_mode) {
    case AlphaMode::kOpaque:
      return 1;
    case AlphaMode::kMask:
      return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
    case AlphaMode::kBlend:
      return std::clamp(alpha, 0.0f, 1.0f);
  }
  return 1;
}

// A factor times one channel of its texture.
float factor_at(const Scene& scene, const Primitive& primitive, float factor, const Texture& texture,
                int channel, uint32_t source, vec2 weights) {
  if (factor <= 0 || !texture.present()) return factor;
  return factor * sample_data_texture(texture, scene.images,
                                      texcoord_at(primitive, texture, source, weights))[channel];
}

float metallic_at(const Scene& scene, const Primitive& primitive, uint32_t source, vec2 weights) {
  const Material& material = scene.materials[primitive.material];
  return factor_at(scene, primitive, material.metallic, material.metallic_texture, 2, source, weights);
}

float transmission_at(const Scene& scene, const Primitive& primitive, uint32_t source, vec2 weights) {
  const Material& material = scene.materials[primitive.material];
  return factor_at(scene, primitive, material.transmission, material.transmission_texture, 0, source,
                   weights);
}

// Share of light, by channel, that glass of base colour `colour` lets through. Vertex colours may be brighter
// than white; glass is not.
vec3 through_glass(const Material& material, const vec4& colour, float metallic, float transmission) {
  return (1 - metallic) * transmission * glm::clamp(vec3(colour) * material.volume_tint, vec3(0), vec3(1));
}

// Mixes diffuse transmission in. What is neither metal nor glass, in `paint.reflectance` times its colour, is
// taken here times another.
void let_through(const Scene& scene, const Primitive& primitive, uint32_t source, vec2 weights,
                 float metallic, Paint& paint) {
  const Material& material = scene.materials[primitive.material];
  const float through = factor_at(scene, primitive, material.diffuse_transmission,
                                  material.diffuse_transmission_texture, 3, source, weights);
  vec3 colour = material.diffuse_transmission_colour;
  const Texture& texture = material.diffuse_transmission_colour_texture;
  if (texture.present())
    colour *= vec3(sample_texture(texture, scene.images, texcoord_at(primitive, texture, source, weights)));
  const float glass = transmission_at(scene, primitive, source, weights);
  const float alpha = coverage_of(material, base_colour_at(scene, primitive, source, weights).w);
  paint.reflectance *= 1 - through;
  paint.transmittance = alpha * (1 - metallic) * (1 - glass) * through * glm::clamp(colour, vec3(0), vec3(1));
  // Together no more than what light may lose nothing of.
  const vec3 most = glm::max(paint.reflectance + paint.transmittance, vec3(kMaxReflectance * alpha));
  const vec3 kept = alpha > 0 ? vec3(kMaxReflectance * alpha) / most : vec3(1);
  paint.reflectance *= kept;
  paint.transmittance *= kept;
}

Paint paint_of_source(const Scene& scene, const Primitive& primitive, uint32_t source, vec2 weights) {
  const Material& material = scene.materials[primitive.material];
  const vec4 colour = base_colour_at(scene, primitive, source, weights);
  const float coverage = coverage_of(material, colour.w);
  const float metallic = metallic_at(scene, primitive, source, weights);
  Paint paint;
  paint.coverage = coverage;
  paint.stopped = vec3(coverage);
  const vec3 reflectance = glm::clamp(vec3(colour) * (1 - metallic), vec3(0), vec3(kMaxReflectance));
  paint.reflectance = coverage * reflectance;
  if (material.is_glass()) {
    const float transmission = transmission_at(scene, primitive, source, weights);
    paint.stopped *= 1.0f - through_glass(material, colour, metallic, transmission);
    paint.coverage = luminance(paint.stopped);
    paint.reflectance *= 1 - transmission;
  }
  if (material.is_translucent()) let_through(scene, primitive, source, weights, metallic, paint);
  vec3 emission = material.emission;
  if (material.emits() && material.emission_texture.present())
    emission *= vec3(sample_texture(material.emission_texture, scene.images,
                                    texcoord_at(primitive, material.emission_texture, source, weights)));
  paint.exitance = coverage * kPi * emission;
  return paint;
}

bool varies(const Scene& scene, const Primitive& primitive) {
  const Material& material = scene.materials[primitive.material];
  return material.base_colour_texture.present() || !primitive.colours.empty() ||
         (material.metallic > 0 && material.metallic_texture.present()) ||
         (material.is_glass() && material.transmission_texture.present()) ||
         (material.is_translucent() && (material.diffuse_transmission_texture.present() ||
                                        material.diffuse_transmission_colour_texture.present())) ||
         (material.emits() && material.emission_texture.present());
}

// How many samples a triangle's average deserves: one for every few texels it covers, within reason.
uint32_t paint_samples(const Scene& scene, const Primitive& primitive, uint32_t source) {
  const Material& material = scene.materials[primitive.material];
  float texels = 1;
  for (const Texture* texture : {&material.base_colour_texture, &material.emission_texture}) {
    if (!texture->present()) continue;
    const Image& image = scene.images[static_cast<size_t>(texture->image)];
    const vec2 a = texcoord_at(primitive, *texture, source, {0, 0});
    const vec2 b = texcoord_at(primitive, *texture, source, {1, 0}) - a;
    const vec2 c = texcoord_at(primitive, *texture, source, {0, 1}) - a;
    const float area = 0.5f * std::abs(b.x * c.y - b.y * c.x) * std::abs(texture->scale.x * texture->scale.y);
    texels = std::max(texels, area * static_cast<float>(image.width) * static_cast<float>(image.height));
  }
  return static_cast<uint32_t>(std::clamp(texels / 4, 3.0f, 256.0f));
}

vec2 to_triangle(UnitSquarePoint p) {
  // The fold keeps the points' even spread.
  if (p.u + p.v > 1) return {1 - p.u, 1 - p.v};
  return {p.u, p.v};
}

// Mean of paint(weights) over a triangle, by `count` points; `seed` shifts them.
template <typename PaintAt>
Paint average(uint32_t count, uint32_t seed, const PaintAt& paint) {
  Paint sum = kNoPaint;
  for (uint32_t i = 0; i < count; ++i) {
    const Paint one = paint(to_triangle(r2_point(i, seed)));
    sum.reflectance += one.reflectance;
    sum.exitance += one.exitance;
    sum.coverage += one.coverage;
    sum.stopped += one.stopped;
    sum.transmittance += one.transmittance;
  }
  const float share = 1.0f / static_cast<float>(count);
  return {sum.reflectance * share, sum.exitance * share, sum.coverage * share, sum.stopped * share,
          sum.transmittance * share};
}

Paint average_paint(const SurfaceSet& set, const Part& part, uint32_t triangle) {
  constexpr uint32_t kWhereCovered = 256;
  const Primitive& primitive = primitive_of(*set.scene, part);
  const uint32_t source = set.tree(part).mesh.source_triangles[triangle];
  if (!part.covering.empty() && part.covering_first[triangle + 1] > part.covering_first[triangle])
    return average(kWhereCovered, source, [&](vec2 w) { return paint_at(set, part, triangle, w); });
  return average(paint_samples(*set.scene, primitive, source), source,
                 [&](vec2 w) { return paint_of_source(*set.scene, primitive, source, w); });
}

}  // namespace

void paint_part(const SurfaceSet& set, Part& part) {
  const Scene& scene = *set.scene;
  const Primitive& primitive = primitive_of(scene, part);
  const TriangleMesh& mesh = set.tree(part).mesh;
  if (mesh.triangles.empty()) return;
  if (!varies(scene, primitive) && part.covering.empty()) {
    const Paint paint = paint_of_source(scene, primitive, mesh.source_triangles[0], {1 / 3.0f, 1 / 3.0f});
    part.reflectance = paint.reflectance;
    part.exitance = paint.exitance;
    part.coverage = paint.coverage;
    part.stopped = paint.stopped;
    part.transmittance = paint.transmittance;
    return;
  }
  const bool glass = scene.materials[part.material].is_glass();
  const size_t count = mesh.triangles.size();
  std::vector<Paint> paints(count);
  parallel_for(
      count, [&](size_t t) { paints[t] = average_paint(set, part, static_cast<uint32_t>(t)); }, 64);
  part.triangle_reflectance.resize(count);
  part.triangle_exitance.resize(count);
  part.triangle_coverage.resize(count);
  const bool translucent = scene.materials[part.material].is_translucent();
  if (glass) part.triangle_stopped.resize(count);
  if (translucent) part.triangle_transmittance.resize(count);
  glm::dvec3 reflectance(0), exitance(0), stopped(0), transmittance(0);
  double coverage = 0, area = 0;
  for (size_t t = 0; t < count; ++t) {
    part.triangle_reflectance[t] = paints[t].reflectance;
    part.triangle_exitance[t] = paints[t].exitance;
    part.triangle_coverage[t] = paints[t].coverage;
    if (glass) part.triangle_stopped[t] = paints[t].stopped;
    if (translucent) part.triangle_transmittance[t] = paints[t].transmittance;
    const UVec3& c = mesh.triangles[t];
    const double a = static_cast<double>(
        length(area_vector(mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z])));
    area += a;
    reflectance += a * dvec3(paints[t].reflectance);
    exitance += a * dvec3(paints[t].exitance);
    coverage += a * static_cast<double>(paints[t].coverage);
    stopped += a * dvec3(paints[t].stopped);
    transmittance += a * dvec3(paints[t].transmittance);
  }
  part.reflectance = vec3(reflectance / std::max(area, 1e-300));
  part.exitance = vec3(exitance / std::max(area, 1e-300));
  part.coverage = static_cast<float>(coverage / std::max(area, 1e-300));
  part.stopped = vec3(stopped / std::max(area, 1e-300));
  part.transmittance = vec3(transmittance / std::max(area, 1e-300));
}

vec3 passing_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights) {
  const Scene& scene = *set.scene;
  const Primitive& primitive = primitive_of(scene, part);
  const Material& material = scene.materials[part.material];
  const uint32_t source = set.tree(part).mesh.source_triangles[triangle];
  const vec4 colour = base_colour_at(scene, primitive, source, weights);
  const float coverage = coverage_of(material, colour.w);
  vec3 passing(1 - coverage);
  if (!material.is_glass()) return passing;
  return passing + coverage * through_glass(material, colour, metallic_at(scene, primitive, source, weights),
                                            transmission_at(scene, primitive, source, weights));
}

Paint paint_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights) {
  const TriangleMesh& mesh = set.tree(part).mesh;
  if (!part.covering.empty()) {
    const UVec3& c = mesh.triangles[triangle];
    const vec3 p = (1 - weights.x - weights.y) * part.positions[c.x] + weights.x * part.positions[c.y] +
                   weights.y * part.positions[c.z];
    if (is_covered(set, part, triangle, p)) return kNoPaint;
  }
  return paint_of_source(*set.scene, primitive_of(*set.scene, part), mesh.source_triangles[triangle],
                         weights);
}

}  // namespace goldthread
