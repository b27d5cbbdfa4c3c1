#include "files/gltf_unlit.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "files/gltf_elements.h"
#include "math/colour.h"

namespace goldthread {
namespace {

/// The material the primitive has in the document, or an empty one, which is glTF's default.
Json source_material(const GltfDocument& document, const Json& primitive) {
  if (!primitive.contains("material")) return Json::object();
  return document.json.at("materials").at(primitive["material"].get<size_t>());
}

/// KHR_materials_pbrSpecularGlossiness, which many old files have, keeps its base colour elsewhere.
const Json* base_texture(const Json& material) {
  const auto inside = [&](const Json& parent, const char* block, const char* key) -> const Json* {
    if (!parent.contains(block) || !parent[block].contains(key)) return nullptr;
    return &parent[block][key];
  };
  if (const Json* found = inside(material, "pbrMetallicRoughness", "baseColorTexture")) return found;
  if (!material.contains("extensions")) return nullptr;
  return inside(material["extensions"], "KHR_materials_pbrSpecularGlossiness", "diffuseTexture");
}

double source_alpha(const Json& material) {
  if (!material.contains("pbrMetallicRoughness")) return 1;
  const Json& surface = material["pbrMetallicRoughness"];
  return surface.contains("baseColorFactor") ? surface["baseColorFactor"].at(3).get<double>() : 1.0;
}

/// A final vertex's place in its source primitive, ready to interpolate the importer's attributes.
class VertexLookup {
 public:
  VertexLookup(const Primitive& primitive, const LitPrimitive& lit) : primitive_(primitive), lit_(lit) {}

  template <typename T>
  T operator()(const std::vector<T>& values, size_t vertex, const T& otherwise) const {
    if (values.empty()) return otherwise;
    if (lit_.source_mesh) return values[vertex];
    const OriginCorners corners = corners_of(lit_.origins[vertex], primitive_.indices);
    T sum(0);
    for (size_t k = 0; k < 3; ++k) sum += corners.weight[k] * values[corners.vertex[k]];
    return sum;
  }
  vec2 texcoord(const Texture& texture, size_t vertex) const {
    return (*this)(primitive_.texcoords[std::min<uint8_t>(texture.texcoord, 1)], vertex, vec2(0));
  }

 private:
  const Primitive& primitive_;
  const LitPrimitive& lit_;
};

vec3 brighter_side(const LitPrimitive& lit, size_t vertex) {
  const vec3& front = lit.irradiance[vertex];
  if (lit.irradiance_back.empty()) return front;
  const vec3& back = lit.irradiance_back[vertex];
  return luminance(back) > luminance(front) ? back : front;
}

}  // namespace

void drop_shading(Json& material) {
  for (const char* key :
       {"pbrMetallicRoughness", "normalTexture", "occlusionTexture", "emissiveTexture", "emissiveFactor"})
    material.erase(key);
  if (!material.contains("extensions")) return;
  Json kept = Json::object();
  for (const auto& [name, value] : material["extensions"].items())
    if (!name.starts_with("KHR_materials_")) kept[name] = value;
  material["extensions"] = std::move(kept);
}

const vec3& UnlitMaterials::average(int32_t image_index) {
  const auto [known, is_new] = averages_.try_emplace(image_index, vec3(1));
  if (!is_new || static_cast<size_t>(image_index) >= scene_.images.size()) return known->second;
  const Image& image = scene_.images[static_cast<size_t>(image_index)];
  std::array<double, 256> linear;
  for (size_t i = 0; i < 256; ++i)
    linear[i] = static_cast<double>(srgb_to_linear(static_cast<float>(i) / 255));
  dvec3 sum(0);
  for (size_t i = 0; i + 3 < image.rgba.size(); i += 4)
    sum += dvec3(linear[image.rgba[i]], linear[image.rgba[i + 1]], linear[image.rgba[i + 2]]);
  if (!image.rgba.empty()) known->second = vec3(sum / static_cast<double>(image.rgba.size() / 4));
  return known->second;
}

std::vector<vec4> UnlitMaterials::outgoing(const LitPrimitive& lit, bool textured) {
  const Primitive& primitive = scene_.meshes[scene_.instances[lit.instance].mesh].primitives[lit.primitive];
  const Material& material = scene_.materials[primitive.material];
  const VertexLookup at(primitive, lit);
  vec3 divisor(1);
  if (textured && material.emits() && material.base_colour_texture.present())
    divisor = glm::max(average(material.base_colour_texture.image), vec3(0.01f));
  std::vector<vec4> colours(lit.irradiance.size());
  for (size_t i = 0; i < colours.size(); ++i) {
    const vec4 tint = at(primitive.colours, i, vec4(1));
    float metallic = material.metallic;
    if (material.metallic_texture.present())
      metallic *= sample_data_texture(material.metallic_texture, scene_.images,
                                      at.texcoord(material.metallic_texture, i))
                      .z;
    vec3 emission = material.emission;
    if (material.emits() && material.emission_texture.present())
      emission *= vec3(sample_texture(material.emission_texture, scene_.images,
                                      at.texcoord(material.emission_texture, i)));
    const vec3 reflectance = material.base_colour * vec3(tint) * (1 - metallic);
    const vec3 radiance = emission / divisor + reflectance * brighter_side(lit, i) / kPi;
    colours[i] = vec4(glm::clamp(radiance * exposure_, vec3(0), vec3(1)), std::clamp(tint.w, 0.0f, 1.0f));
  }
  return colours;
}

uint32_t UnlitMaterials::material_for(const Json& primitive) {
  const int64_t key = primitive.contains("material") ? primitive["material"].get<int64_t>() : -1;
  const auto [known, is_new] = copies_.try_emplace(key, 0u);
  if (!is_new) return known->second;
  const Json source = source_material(document_, primitive);
  const Json* texture = base_texture(source);
  Json material = source;
  drop_shading(material);
  // Not metallic and rough: what a viewer without the extension should fall back to.
  Json surface = {{"baseColorFactor", Json::array({1.0, 1.0, 1.0, source_alpha(source)})},
                  {"metallicFactor", 0.0},
                  {"roughnessFactor", 1.0}};
  if (texture) surface["baseColorTexture"] = *texture;
  material["pbrMetallicRoughness"] = std::move(surface);
  material["extensions"]["KHR_materials_unlit"] = Json::object();
  use_extension(document_, "KHR_materials_unlit");
  known->second = append_to(document_, "materials", std::move(material));
  return known->second;
}

void UnlitMaterials::apply(Json& primitive, const LitPrimitive& lit) {
  const bool textured = base_texture(source_material(document_, primitive)) != nullptr;
  const std::vector<vec4> colours = outgoing(lit, textured);
  const Primitive& source = scene_.meshes[scene_.instances[lit.instance].mesh].primitives[lit.primitive];
  const bool opaque =
      std::all_of(source.colours.begin(), source.colours.end(), [](const vec4& c) { return c.w >= 1; });
  if (opaque) {
    const std::vector<vec3> rgb(colours.begin(), colours.end());
    primitive["attributes"]["COLOR_0"] = append_attribute(document_, std::span<const vec3>(rgb));
  } else {
    primitive["attributes"]["COLOR_0"] = append_attribute(document_, std::span<const vec4>(colours));
  }
  primitive["material"] = material_for(primitive);
  // A variant would put a shaded material back.
  if (!primitive.contains("extensions")) return;
  primitive["extensions"].erase("KHR_materials_variants");
  if (primitive["extensions"].empty()) primitive.erase("extensions");
}

}  // namespace goldthread
