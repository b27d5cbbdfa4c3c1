// `info`: reads a scene and tells what is in it and what is wrong with it.
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "element/paint.h"
#include "files/scene_read.h"
#include "goldthread/bake.h"
#include "math/colour.h"
#include "session/mesh_facts.h"
#include "session/profile_facts.h"

namespace goldthread {
namespace {

/// What the surfaces do with light, summed over the world's triangles.
struct LightFacts {
  double area = 0;  ///< m2, one side
  double emissive_area = 0;
  double emitted_power = 0;  ///< lumen, of surfaces, both sides where two-sided
  double reflectance_sum = 0;
  std::vector<uint8_t> too_bright;  ///< per material: 1 where a triangle reflects more than the solver allows
  float least_reflectance = 1, most_reflectance = 0;  ///< luminance

  double mean_reflectance() const { return area > 0 ? reflectance_sum / area : 0; }
};

/// The area lamps of a scene, rectangles and discs.
struct AreaLampFacts {
  uint64_t count = 0;
  double area = 0;   ///< m2
  double power = 0;  ///< lumen: pi * luminance * area
};

AreaLampFacts area_lamps_in(const Scene& scene) {
  AreaLampFacts facts;
  for (const Light& light : scene.lights) {
    if (!light.has_area()) continue;
    ++facts.count;
    facts.area += double(light.area());
    facts.power += double(kPi * luminance(light.intensity));
  }
  return facts;
}

struct SceneFacts {
  MeshFacts mesh;
  LightFacts light;
  uint64_t primitives = 0;
  uint64_t clamped_materials = 0;
  Box bounds;
};

struct TrianglePaint {
  vec3 reflectance, emission;
};

/// Colours at the middle of a triangle: good enough for a summary of textured surfaces.
TrianglePaint paint_of(const Scene& scene, const Primitive& p, size_t first_index) {
  const Material& material = scene.materials[p.material];
  const auto middle = [&](const auto& values, auto none) {
    if (values.empty()) return none;
    return (values[p.indices[first_index]] + values[p.indices[first_index + 1]] +
            values[p.indices[first_index + 2]]) /
           3.0f;
  };
  const auto uv = [&](const Texture& texture) { return middle(p.texcoords[texture.texcoord], vec2(0)); };
  TrianglePaint paint{material.base_colour * vec3(middle(p.colours, vec4(1))), material.emission};
  if (material.base_colour_texture.present())
    paint.reflectance *=
        vec3(sample_texture(material.base_colour_texture, scene.images, uv(material.base_colour_texture)));
  float metallic = material.metallic;
  if (material.metallic_texture.present())
    metallic *= sample_data_texture(material.metallic_texture, scene.images, uv(material.metallic_texture)).z;
  float transmission = material.transmission;
  if (material.transmission_texture.present())
    transmission *=
        sample_data_texture(material.transmission_texture, scene.images, uv(material.transmission_texture)).x;
  paint.reflectance *= (1 - metallic) * (1 - transmission);
  if (material.emits() && material.emission_texture.present())
    paint.emission *=
        vec3(sample_texture(material.emission_texture, scene.images, uv(material.emission_texture)));
  return paint;
}

void add_light(const Scene& scene, const Instance& instance, const Primitive& p, LightFacts& facts) {
  const mat3 area_map = area_vector_transform(mat3(instance.transform));
  const Material& material = scene.materials[p.material];
  for (size_t i = 0; i + 2 < p.indices.size(); i += 3) {
    const vec3 vector =
        area_vector(p.positions[p.indices[i]], p.positions[p.indices[i + 1]], p.positions[p.indices[i + 2]]);
    const double area = double(length(area_map * vector));
    if (!std::isfinite(area) || area <= 0) continue;
    const TrianglePaint paint = paint_of(scene, p, i);
    facts.area += area;
    const float reflectance = luminance(paint.reflectance), emission = luminance(paint.emission);
    if (std::max({paint.reflectance.x, paint.reflectance.y, paint.reflectance.z}) > kMaxReflectance)
      facts.too_bright[p.material] = 1;
    facts.reflectance_sum += area * double(reflectance);
    facts.least_reflectance = std::min(facts.least_reflectance, reflectance);
    facts.most_reflectance = std::max(facts.most_reflectance, reflectance);
    if (emission <= 0) continue;
    facts.emissive_area += area;
    facts.emitted_power += area * double(kPi * emission) * (material.double_sided ? 2 : 1);
  }
}

SceneFacts gather_facts(const Scene& scene) {
  SceneFacts facts;
  facts.bounds = scene.bounds();
  facts.light.too_bright.assign(scene.materials.size(), 0);
  std::vector<uint64_t> copies(scene.meshes.size(), 0);
  for (const Instance& instance : scene.instances) {
    ++copies[instance.mesh];
    for (const Primitive& primitive : scene.meshes[instance.mesh].primitives) {
      ++facts.primitives;
      add_light(scene, instance, primitive, facts.light);
    }
  }
  const ShellCheck check(scene);
  for (uint32_t m = 0; m < scene.meshes.size(); ++m)
    if (copies[m] > 0) add_facts(facts.mesh, measure_mesh(scene, m, check), copies[m]);
  facts.clamped_materials =
      uint64_t(std::count(facts.light.too_bright.begin(), facts.light.too_bright.end(), 1));
  return facts;
}

bool gives_light(const Scene& scene, const SceneFacts& facts) {
  return facts.light.emitted_power > 0 || scene.sky.present() ||
         std::any_of(scene.lights.begin(), scene.lights.end(),
                     [](const Light& light) { return luminance(light.intensity) > 0; });
}

std::vector<std::string> find_problems(const Scene& scene, const SceneFacts& facts) {
  std::vector<std::string> lines = scene.warnings;
  const auto tell = [&](uint64_t count, const char* text) {
    if (count > 0) lines.push_back(fmt::format(fmt::runtime(text), count));
  };
  if (facts.mesh.triangles == 0) lines.emplace_back("no triangles: nothing to bake");
  if (!gives_light(scene, facts))
    lines.emplace_back("no light: add --sky or --sun when baking, or give a material an emission");
  if (facts.light.emitted_power <= 0 && std::any_of(scene.materials.begin(), scene.materials.end(),
                                                    [](const Material& m) { return m.emits(); }))
    lines.emplace_back("an emissive material is on no surface with an area: it gives no light");
  if (facts.clamped_materials > 0)
    lines.push_back(fmt::format("{} materials reflect more than {}: clamped to it when baking",
                                facts.clamped_materials, kMaxReflectance));
  tell(facts.mesh.not_finite, "{} triangles have corners that are not finite: skipped when baking");
  tell(facts.mesh.degenerate, "{} triangles have no area: skipped when baking");
  tell(facts.mesh.duplicate, "{} triangles lie on others with the same corners");
  tell(facts.mesh.inside_out_shells, "{} closed shells are wound inside out: --fix-normals turns them");
  tell(facts.mesh.inconsistent_shells,
       "{} shells have triangles wound both ways: --fix-normals turns the fewer");
  return lines;
}

std::string share(uint64_t part, uint64_t whole) {
  return fmt::format("{} ({:.1f}%)", part, whole > 0 ? 100.0 * double(part) / double(whole) : 0.0);
}

std::string counts_text(const Scene& scene, const SceneFacts& facts) {
  const MeshFacts& m = facts.mesh;
  const vec3 size = facts.bounds.size();
  std::string text = fmt::format("{}\n", scene.file);
  const auto add = [&](const char* name, const std::string& value) {
    text += fmt::format("  {:<18}{}\n", name, value);
  };
  add("triangles", fmt::format("{} in {} instances of {} meshes, {} primitives", m.triangles,
                               scene.instances.size(), scene.meshes.size(), facts.primitives));
  add("materials", fmt::format("{}, {} textures", scene.materials.size(), scene.images.size()));
  add("lamps", fmt::format("{}", scene.lights.size()));
  for (const ProfileUse& use : profiles_in(scene))
    add("", fmt::format("{} by {}, {:.4g} lm", use.lamps, use.name, use.lumens));
  if (const AreaLampFacts lamps = area_lamps_in(scene); lamps.count > 0)
    add("", fmt::format("{} area lamps, {:.4g} m2, {:.4g} lm", lamps.count, lamps.area, lamps.power));
  add("cameras", fmt::format("{}", scene.cameras.size()));
  add("size", fmt::format("{:.4g} x {:.4g} x {:.4g} m", size.x, size.y, size.z));
  add("area", fmt::format("{:.4g} m2", facts.light.area));
  add("emissive", fmt::format("{:.4g} m2, {:.4g} lm", facts.light.emissive_area, facts.light.emitted_power));
  add("reflectance", fmt::format("{:.2f} to {:.2f}, mean {:.2f}", facts.light.least_reflectance,
                                 facts.light.most_reflectance, facts.light.mean_reflectance()));
  add("shells", fmt::format("{}, {} of them closed", m.shells, m.closed_shells));
  add("edges",
      fmt::format("{} on a boundary, {} of more than two triangles", m.boundary_edges, m.non_manifold_edges));
  add("thin (over 1:20)", share(m.thin, m.triangles));
  add("without area", share(m.degenerate, m.triangles));
  return text;
}

nlohmann::ordered_json to_json(const vec3& v) {
  return {v.x, v.y, v.z};
}

nlohmann::ordered_json facts_json(const Scene& scene, const SceneFacts& facts) {
  const MeshFacts& m = facts.mesh;
  nlohmann::ordered_json json = {{"file", scene.file},
                                 {"triangles", m.triangles},
                                 {"meshes", scene.meshes.size()},
                                 {"instances", scene.instances.size()},
                                 {"primitives", facts.primitives},
                                 {"materials", scene.materials.size()},
                                 {"textures", scene.images.size()},
                                 {"lights", scene.lights.size()},
                                 {"cameras", scene.cameras.size()}};
  const AreaLampFacts lamps = area_lamps_in(scene);
  json["area_lamps"] = {{"count", lamps.count}, {"area_m2", lamps.area}, {"power_lm", lamps.power}};
  json["light_profiles"] = to_json(profiles_in(scene));
  if (!facts.bounds.empty())
    json["bounds"] = {{"low", to_json(facts.bounds.low)}, {"high", to_json(facts.bounds.high)}};
  json["area_m2"] = facts.light.area;
  json["emissive"] = {{"area_m2", facts.light.emissive_area}, {"power_lm", facts.light.emitted_power}};
  json["reflectance"] = {{"least", std::min(facts.light.least_reflectance, facts.light.most_reflectance)},
                         {"most", facts.light.most_reflectance},
                         {"mean", facts.light.mean_reflectance()},
                         {"clamped_materials", facts.clamped_materials}};
  json["problems"] = {{"degenerate", m.degenerate},
                      {"not_finite", m.not_finite},
                      {"thin", m.thin},
                      {"duplicate", m.duplicate},
                      {"boundary_edges", m.boundary_edges},
                      {"non_manifold_edges", m.non_manifold_edges},
                      {"inside_out_shells", m.inside_out_shells},
                      {"inconsistent_shells", m.inconsistent_shells},
                      {"wrong_triangles", m.wrong_triangles}};
  json["shells"] = {{"count", m.shells}, {"closed", m.closed_shells}};
  return json;
}

}  // namespace

Result<SceneInfo> inspect(const std::string& file) {
  const Result<Scene> scene = read_scene(file);
  if (!scene) return scene.error();
  SceneFacts facts = gather_facts(*scene);
  if (facts.light.area <= 0) facts.light.least_reflectance = 0;
  const std::vector<std::string> problems = find_problems(*scene, facts);
  SceneInfo info;
  info.text = counts_text(*scene, facts);
  for (const std::string& line : problems) info.text += "  warning: " + line + "\n";
  nlohmann::ordered_json json = facts_json(*scene, facts);
  json["warnings"] = problems;
  // A file name need not be UTF-8.
  info.json = json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  return info;
}

}  // namespace goldthread
