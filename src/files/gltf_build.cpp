#include "files/gltf_build.h"

#include <utility>

#include "files/gltf_build_materials.h"
#include "files/gltf_build_nodes.h"

namespace goldthread {
namespace {

std::vector<uint32_t> finite_triangles(const Primitive& primitive) {
  std::vector<uint32_t> indices;
  indices.reserve(primitive.indices.size());
  for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
    const uint32_t* corner = &primitive.indices[i];
    bool finite = true;
    for (int k = 0; k < 3; ++k) finite = finite && is_finite(primitive.positions[corner[k]]);
    if (finite) indices.insert(indices.end(), corner, corner + 3);
  }
  return indices;
}

bool uses_texcoord(const Material& material, uint8_t set) {
  for (const Texture* texture :
       {&material.base_colour_texture, &material.metallic_texture, &material.emission_texture})
    if (texture->present() && texture->texcoord == set) return true;
  return false;
}

void add_texcoords(GltfDocument& document, Json& attributes, const Primitive& primitive,
                   const Material& material) {
  const bool needs[2] = {uses_texcoord(material, 0), uses_texcoord(material, 1)};
  const bool has[2] = {!primitive.texcoords[0].empty(), !primitive.texcoords[1].empty()};
  for (size_t set = 0; set < 2; ++set) {
    // A texture without coordinates is an error to glTF, and so is a second set without a first.
    const bool wanted = has[set] || needs[set] || (set == 0 && (has[1] || needs[1]));
    if (!wanted) continue;
    const std::vector<vec2> origin(has[set] ? 0 : primitive.positions.size(), vec2(0));
    const std::vector<vec2>& texcoords = has[set] ? primitive.texcoords[set] : origin;
    attributes["TEXCOORD_" + std::to_string(set)] =
        append_attribute(document, std::span<const vec2>(texcoords));
  }
}

/// Null when there is no triangle to write.
Json build_primitive(GltfDocument& document, const Primitive& primitive, const Scene& scene) {
  const std::vector<uint32_t> indices = finite_triangles(primitive);
  if (indices.empty()) return nullptr;
  Json attributes;
  attributes["POSITION"] = append_positions(document, primitive.positions);
  if (!primitive.normals.empty())
    attributes["NORMAL"] = append_attribute(document, std::span<const vec3>(unit_normals(primitive.normals)));
  add_texcoords(document, attributes, primitive, scene.materials[primitive.material]);
  if (!primitive.colours.empty())
    attributes["COLOR_0"] =
        append_attribute(document, std::span<const vec4>(clamp_colours(primitive.colours)));
  const uint32_t index = append_indices(document, indices, primitive.positions.size());
  return {{"attributes", attributes}, {"indices", index}, {"material", primitive.material}};
}

/// Per mesh of the Scene: its number in the file, or kNone when nothing of it could be written.
std::vector<uint32_t> build_meshes(BuiltDocument& built, const Scene& scene) {
  std::vector<uint32_t> numbers;
  for (const Mesh& mesh : scene.meshes) {
    std::vector<uint32_t>& places = built.map.primitives.emplace_back();
    Json primitives = Json::array();
    for (const Primitive& primitive : mesh.primitives) {
      Json json = build_primitive(built.document, primitive, scene);
      places.push_back(json.is_null() ? DocumentMap::kNone : static_cast<uint32_t>(primitives.size()));
      if (!json.is_null()) primitives.push_back(std::move(json));
    }
    if (primitives.empty()) {
      numbers.push_back(DocumentMap::kNone);
      continue;
    }
    Json json = {{"primitives", std::move(primitives)}};
    if (!mesh.name.empty()) json["name"] = mesh.name;
    numbers.push_back(append_to(built.document, "meshes", std::move(json)));
  }
  return numbers;
}

}  // namespace

/// glTF demands unit length, so a broken normal gets a direction, any direction.
std::vector<vec3> unit_normals(const std::vector<vec3>& normals) {
  std::vector<vec3> unit(normals.size());
  for (size_t i = 0; i < normals.size(); ++i)
    unit[i] = is_finite(normals[i]) ? normalize_or(normals[i], vec3(0, 1, 0)) : vec3(0, 1, 0);
  return unit;
}

std::vector<vec4> clamp_colours(const std::vector<vec4>& colours) {
  std::vector<vec4> clamped(colours.size());
  for (size_t i = 0; i < colours.size(); ++i) clamped[i] = glm::clamp(colours[i], vec4(0), vec4(1));
  return clamped;
}

BuiltDocument build_document(const Scene& scene) {
  BuiltDocument built;
  GltfDocument& document = built.document;
  document.json["asset"] = {{"version", "2.0"}, {"generator", "goldthread"}};
  document.json["scene"] = 0;
  document.json["scenes"] = Json::array({Json::object()});
  build_materials(document, scene);
  const std::vector<uint32_t> meshes = build_meshes(built, scene);
  for (const Instance& instance : scene.instances) {
    Json node = Json::object();
    if (!instance.name.empty()) node["name"] = instance.name;
    if (meshes[instance.mesh] != DocumentMap::kNone) node["mesh"] = meshes[instance.mesh];
    built.map.nodes.push_back(build_node(document, instance.transform, std::move(node)));
    built.map.copies.push_back(0);
  }
  build_lights(document, scene);
  build_cameras(document, scene);
  return built;
}

}  // namespace goldthread
