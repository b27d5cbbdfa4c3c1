#include "element/surface_set.h"

#include <algorithm>
#include <map>

#include "base/parallel.h"
#include "base/rng.h"

namespace goldthread {
namespace {

const Primitive& primitive_of(const Scene& scene, const Part& part) {
  return scene.meshes[scene.instances[part.instance].mesh].primitives[part.primitive];
}

// Whether `m` keeps angles: its columns orthogonal and of one length.
bool is_similarity(const mat3& m) {
  const float a = dot(m[0], m[0]), b = dot(m[1], m[1]), c = dot(m[2], m[2]);
  const float most = std::max({a, b, c});
  const float tolerance = 1e-4f * most;
  return std::abs(a - b) < tolerance && std::abs(b - c) < tolerance &&
         std::abs(dot(m[0], m[1])) < tolerance && std::abs(dot(m[1], m[2])) < tolerance &&
         std::abs(dot(m[2], m[0])) < tolerance;
}

std::vector<vec3> transformed(const std::vector<vec3>& positions, const mat4& m) {
  std::vector<vec3> out(positions.size());
  parallel_for(
      positions.size(), [&](size_t i) { out[i] = vec3(m * vec4(positions[i], 1)); }, 4096);
  return out;
}

// What is to be clustered: one mesh primitive, or a bent copy of it for one instance.
struct TreeJob {
  const Primitive* primitive;
  bool bend = false;
  mat4 transform{1};
};

// Lists the parts of the scene, and the trees they need.
std::vector<TreeJob> list_parts(const Scene& scene, SurfaceSet& set) {
  std::vector<TreeJob> jobs;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> shared;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Instance& instance = scene.instances[i];
    const Mesh& mesh = scene.meshes[instance.mesh];
    const mat3 linear(instance.transform);
    const bool bend = !is_similarity(linear);
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      Part part;
      part.instance = i;
      part.primitive = p;
      part.material = mesh.primitives[p].material;
      const bool mirrored = glm::determinant(linear) < 0;
      part.winding = mirrored ? -1.0f : 1.0f;
      if (bend) {
        part.tree = static_cast<uint32_t>(jobs.size());
        part.area_map = mat3(part.winding);
        jobs.push_back({&mesh.primitives[p], true, instance.transform});
      } else {
        const auto [entry, added] =
            shared.try_emplace({instance.mesh, p}, static_cast<uint32_t>(jobs.size()));
        if (added) jobs.push_back({&mesh.primitives[p]});
        part.tree = entry->second;
        part.to_world = instance.transform;
        part.scale = std::sqrt(std::cbrt(
            std::abs(dot(linear[0], linear[0]) * dot(linear[1], linear[1]) * dot(linear[2], linear[2]))));
        part.area_map = part.winding * area_vector_transform(linear);
      }
      set.parts.push_back(std::move(part));
    }
  }
  return jobs;
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

Paint paint_of_source(const Scene& scene, const Primitive& primitive, uint32_t source, vec2 weights) {
  const Material& material = scene.materials[primitive.material];
  const vec4 colour = base_colour_at(scene, primitive, source, weights);
  Paint paint;
  paint.coverage = coverage_of(material, colour.w);
  float metallic = material.metallic;
  if (material.metallic_texture.present() && metallic > 0)
    metallic *= sample_data_texture(material.metallic_texture, scene.images,
                                    texcoord_at(primitive, material.metallic_texture, source, weights))
                    .z;
  const vec3 reflectance = glm::clamp(vec3(colour) * (1 - metallic), vec3(0), vec3(kMaxReflectance));
  paint.reflectance = paint.coverage * reflectance;
  vec3 emission = material.emission;
  if (material.emits() && material.emission_texture.present())
    emission *= vec3(sample_texture(material.emission_texture, scene.images,
                                    texcoord_at(primitive, material.emission_texture, source, weights)));
  paint.exitance = paint.coverage * kPi * emission;
  return paint;
}

bool varies(const Scene& scene, const Primitive& primitive) {
  const Material& material = scene.materials[primitive.material];
  return material.base_colour_texture.present() || !primitive.colours.empty() ||
         (material.metallic > 0 && material.metallic_texture.present()) ||
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

Paint average_paint(const Scene& scene, const Primitive& primitive, uint32_t source) {
  Paint sum{vec3(0), vec3(0), 0};
  const uint32_t count = paint_samples(scene, primitive, source);
  for (uint32_t i = 0; i < count; ++i) {
    const Paint one = paint_of_source(scene, primitive, source, to_triangle(r2_point(i, source)));
    sum.reflectance += one.reflectance;
    sum.exitance += one.exitance;
    sum.coverage += one.coverage;
  }
  const float share = 1.0f / static_cast<float>(count);
  return {sum.reflectance * share, sum.exitance * share, sum.coverage * share};
}

// Averages the paint of every triangle, and of the whole part by area.
void paint_part(const SurfaceSet& set, Part& part) {
  const Scene& scene = *set.scene;
  const Primitive& primitive = primitive_of(scene, part);
  const TriangleMesh& mesh = set.tree(part).mesh;
  if (mesh.triangles.empty()) return;
  if (!varies(scene, primitive)) {
    const Paint paint = paint_of_source(scene, primitive, mesh.source_triangles[0], {1 / 3.0f, 1 / 3.0f});
    part.reflectance = paint.reflectance;
    part.exitance = paint.exitance;
    part.coverage = paint.coverage;
    return;
  }
  const size_t count = mesh.triangles.size();
  std::vector<Paint> paints(count);
  parallel_for(
      count, [&](size_t t) { paints[t] = average_paint(scene, primitive, mesh.source_triangles[t]); }, 64);
  part.triangle_reflectance.resize(count);
  part.triangle_exitance.resize(count);
  part.triangle_coverage.resize(count);
  glm::dvec3 reflectance(0), exitance(0);
  double coverage = 0, area = 0;
  for (size_t t = 0; t < count; ++t) {
    part.triangle_reflectance[t] = paints[t].reflectance;
    part.triangle_exitance[t] = paints[t].exitance;
    part.triangle_coverage[t] = paints[t].coverage;
    const UVec3& c = mesh.triangles[t];
    const double a = static_cast<double>(
        length(area_vector(mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z])));
    area += a;
    reflectance += a * dvec3(paints[t].reflectance);
    exitance += a * dvec3(paints[t].exitance);
    coverage += a * static_cast<double>(paints[t].coverage);
  }
  part.reflectance = vec3(reflectance / std::max(area, 1e-300));
  part.exitance = vec3(exitance / std::max(area, 1e-300));
  part.coverage = static_cast<float>(coverage / std::max(area, 1e-300));
}

uint32_t count_clamped(const Scene& scene) {
  uint32_t clamped = 0;
  for (const Material& m : scene.materials) {
    const vec3 reflectance = m.base_colour * (1 - m.metallic);
    if (std::max({reflectance.x, reflectance.y, reflectance.z}) > kMaxReflectance) ++clamped;
  }
  return clamped;
}

void list_surfaces(SurfaceSet& set) {
  for (uint32_t p = 0; p < set.parts.size(); ++p) {
    Part& part = set.parts[p];
    part.first_triangle = set.triangles;
    const FaceClusterTree& tree = set.tree(part);
    set.triangles += static_cast<uint32_t>(tree.mesh.triangles.size());
    set.skipped.degenerate += tree.mesh.skipped.degenerate;
    set.skipped.not_finite += tree.mesh.skipped.not_finite;
    set.skipped.duplicate += tree.mesh.skipped.duplicate;
    for (const ClusterRef root : tree.roots) {
      if (is_triangle(root)) {
        const UVec3& c = tree.mesh.triangles[triangle_of(root)];
        set.area += static_cast<double>(
            length(area_vector(part.positions[c.x], part.positions[c.y], part.positions[c.z])));
      } else {
        set.area += static_cast<double>(tree.nodes[root].area * part.scale * part.scale);
      }
    }
    const Material& material = set.scene->materials[part.material];
    if (material.unlit) continue;
    for (const ClusterRef root : tree.roots) {
      set.surfaces.push_back({p, root, false});
      if (material.double_sided) set.surfaces.push_back({p, root, true});
    }
  }
}

}  // namespace

SurfaceSet build_surfaces(const Scene& scene, const CancelToken& cancel) {
  SurfaceSet set;
  set.scene = &scene;
  const std::vector<TreeJob> jobs = list_parts(scene, set);
  set.trees.resize(jobs.size());
  parallel_for(jobs.size(), [&](size_t j) {
    if (cancel.cancelled()) return;
    const Primitive& primitive = *jobs[j].primitive;
    TriangleMesh mesh = jobs[j].bend
                            ? weld(transformed(primitive.positions, jobs[j].transform), primitive.indices)
                            : weld(primitive.positions, primitive.indices);
    set.trees[j] = build_face_clusters(std::move(mesh));
  });
  for (const FaceClusterTree& tree : set.trees) set.face_clusters += tree.nodes.size();
  parallel_for(set.parts.size(), [&](size_t p) {
    Part& part = set.parts[p];
    part.positions = transformed(set.tree(part).mesh.positions, part.to_world);
    if (!cancel.cancelled()) paint_part(set, part);
  });
  list_surfaces(set);
  set.clamped_materials = count_clamped(scene);
  return set;
}

WorldTriangles world_triangles(const SurfaceSet& set) {
  WorldTriangles world;
  size_t vertices = 0;
  for (const Part& part : set.parts) vertices += part.positions.size();
  world.positions.reserve(vertices);
  world.triangles.reserve(set.triangles);
  bool see_through = false;
  std::vector<uint8_t> marks;
  for (const Part& part : set.parts) {
    const auto offset = static_cast<uint32_t>(world.positions.size());
    world.positions.insert(world.positions.end(), part.positions.begin(), part.positions.end());
    const bool alpha = set.scene->materials[part.material].alpha_mode != AlphaMode::kOpaque;
    see_through |= alpha;
    for (const UVec3& t : set.tree(part).mesh.triangles) world.triangles.push_back(t + UVec3(offset));
    marks.resize(world.triangles.size(), alpha ? 1 : 0);
  }
  if (see_through) world.see_through = std::move(marks);
  return world;
}

float alpha_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights) {
  const Primitive& primitive = primitive_of(*set.scene, part);
  const uint32_t source = set.tree(part).mesh.source_triangles[triangle];
  return coverage_of(set.scene->materials[part.material],
                     base_colour_at(*set.scene, primitive, source, weights).w);
}

const Part& part_of_triangle(const SurfaceSet& set, uint32_t triangle) {
  const auto after = std::upper_bound(set.parts.begin(), set.parts.end(), triangle,
                                      [](uint32_t t, const Part& part) { return t < part.first_triangle; });
  return *(after - 1);
}

Paint paint_at(const SurfaceSet& set, const Part& part, uint32_t triangle, vec2 weights) {
  return paint_of_source(*set.scene, primitive_of(*set.scene, part),
                         set.tree(part).mesh.source_triangles[triangle], weights);
}

}  // namespace goldthread
