#include "files/gltf_build_materials.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "files/png_encode.h"

namespace goldthread {
namespace {

std::vector<uint8_t> encode(const Image& image) {
  const size_t pixels = size_t{image.width} * image.height;
  const std::vector<uint8_t> white{255, 255, 255};
  if (pixels == 0 || image.rgba.size() != 4 * pixels)
    return encode_png(1, 1, 3, white);  // as sample_texture sees it
  bool opaque = true;
  for (size_t i = 0; i < pixels && opaque; ++i) opaque = image.rgba[4 * i + 3] == 255;
  if (!opaque) return encode_png(image.width, image.height, 4, image.rgba);
  std::vector<uint8_t> rgb(3 * pixels);
  for (size_t i = 0; i < pixels; ++i) std::copy_n(image.rgba.begin() + 4 * i, 3, rgb.begin() + 3 * i);
  return encode_png(image.width, image.height, 3, rgb);
}

void build_images(GltfDocument& document, const std::vector<Image>& images) {
  std::vector<std::vector<uint8_t>> files(images.size());
  parallel_for(images.size(), [&](size_t i) { files[i] = encode(images[i]); });
  for (size_t i = 0; i < images.size(); ++i) {
    Json image = {{"bufferView", append_view(document, files[i])}, {"mimeType", "image/png"}};
    if (!images[i].name.empty()) image["name"] = images[i].name;
    append_to(document, "images", std::move(image));
  }
}

/// Makes each sampler and texture once.
class TextureTable {
 public:
  explicit TextureTable(GltfDocument& document) : document_(document) {}

  Json info(const Texture& texture) {
    Json info = {{"index", index_of(texture)}};
    if (texture.texcoord != 0) info["texCoord"] = texture.texcoord;
    Json placed = Json::object();
    if (texture.offset != vec2(0)) placed["offset"] = json_array({&texture.offset.x, 2});
    if (texture.rotation != 0) placed["rotation"] = shortest(texture.rotation);
    if (texture.scale != vec2(1)) placed["scale"] = json_array({&texture.scale.x, 2});
    if (!placed.empty()) {
      info["extensions"]["KHR_texture_transform"] = placed;
      use_extension(document_, "KHR_texture_transform");
    }
    return info;
  }

 private:
  static int wrap_code(Wrap wrap) {
    constexpr int kRepeatCode = 10497, kClampCode = 33071, kMirrorCode = 33648;
    return wrap == Wrap::kRepeat ? kRepeatCode : wrap == Wrap::kClamp ? kClampCode : kMirrorCode;
  }

  uint32_t index_of(const Texture& texture) {
    const std::array<int, 3> key{texture.image, wrap_code(texture.wrap_u), wrap_code(texture.wrap_v)};
    const auto [known, is_new] = textures_.try_emplace(key, 0u);
    if (!is_new) return known->second;
    const auto [sampler, new_sampler] = samplers_.try_emplace(std::pair{key[1], key[2]}, 0u);
    if (new_sampler)
      sampler->second = append_to(document_, "samplers", {{"wrapS", key[1]}, {"wrapT", key[2]}});
    known->second =
        append_to(document_, "textures", {{"sampler", sampler->second}, {"source", texture.image}});
    return known->second;
  }

  GltfDocument& document_;
  std::map<std::array<int, 3>, uint32_t> textures_;
  std::map<std::pair<int, int>, uint32_t> samplers_;
};

float share(float value) {
  return std::clamp(value, 0.0f, 1.0f);
}

Json surface_of(const Material& material, TextureTable& textures) {
  const vec3& colour = material.base_colour;
  const float factor[4] = {share(colour.x), share(colour.y), share(colour.z), share(material.alpha)};
  // Written even where they are glTF's defaults: a missing metallicFactor means metal.
  Json surface = {{"baseColorFactor", json_array(factor)},
                  {"metallicFactor", shortest(share(material.metallic))},
                  {"roughnessFactor", 1.0}};
  if (material.base_colour_texture.present())
    surface["baseColorTexture"] = textures.info(material.base_colour_texture);
  if (material.metallic_texture.present())
    surface["metallicRoughnessTexture"] = textures.info(material.metallic_texture);
  return surface;
}

void add_emission(Json& json, const Material& material, TextureTable& textures, GltfDocument& document) {
  if (!material.emits()) return;
  const vec3 nits = glm::max(material.emission, vec3(0));
  const float strength = std::max(1.0f, std::max(nits.x, std::max(nits.y, nits.z)));
  const vec3 factor = nits / strength;
  json["emissiveFactor"] = json_array({&factor.x, 3});
  if (material.emission_texture.present()) json["emissiveTexture"] = textures.info(material.emission_texture);
  if (strength == 1) return;
  json["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] = shortest(strength);
  use_extension(document, "KHR_materials_emissive_strength");
}

void add_glass(Json& json, const Material& material, TextureTable& textures, GltfDocument& document) {
  if (!(material.transmission > 0)) return;
  Json glass = {{"transmissionFactor", shortest(share(material.transmission))}};
  if (material.transmission_texture.present())
    glass["transmissionTexture"] = textures.info(material.transmission_texture);
  json["extensions"]["KHR_materials_transmission"] = std::move(glass);
  use_extension(document, "KHR_materials_transmission");
  if (material.volume_tint == vec3(1)) return;
  // Each of two surfaces takes its half of a metre.
  const vec3 colour = glm::clamp(material.volume_tint * material.volume_tint, vec3(0), vec3(1));
  json["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1.0},
                                                {"attenuationDistance", 1.0},
                                                {"attenuationColor", json_array({&colour.x, 3})}};
  use_extension(document, "KHR_materials_volume");
}

void add_translucence(Json& json, const Material& material, TextureTable& textures, GltfDocument& document) {
  if (!(material.diffuse_transmission > 0)) return;
  const vec3 colour = glm::clamp(material.diffuse_transmission_colour, vec3(0), vec3(1));
  Json through = {{"diffuseTransmissionFactor", shortest(share(material.diffuse_transmission))},
                  {"diffuseTransmissionColorFactor", json_array({&colour.x, 3})}};
  if (material.diffuse_transmission_texture.present())
    through["diffuseTransmissionTexture"] = textures.info(material.diffuse_transmission_texture);
  if (material.diffuse_transmission_colour_texture.present())
    through["diffuseTransmissionColorTexture"] = textures.info(material.diffuse_transmission_colour_texture);
  json["extensions"]["KHR_materials_diffuse_transmission"] = std::move(through);
  use_extension(document, "KHR_materials_diffuse_transmission");
}

Json build_material(const Material& material, TextureTable& textures, GltfDocument& document) {
  Json json = Json::object();
  if (!material.name.empty()) json["name"] = material.name;
  json["pbrMetallicRoughness"] = surface_of(material, textures);
  add_emission(json, material, textures, document);
  if (material.normal_texture.present()) {
    json["normalTexture"] = textures.info(material.normal_texture);
    if (material.normal_scale != 1) json["normalTexture"]["scale"] = shortest(material.normal_scale);
  }
  add_glass(json, material, textures, document);
  add_translucence(json, material, textures, document);
  if (material.alpha_mode == AlphaMode::kBlend) json["alphaMode"] = "BLEND";
  if (material.alpha_mode == AlphaMode::kMask) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = shortest(std::max(0.0f, material.alpha_cutoff));
  }
  if (material.double_sided) json["doubleSided"] = true;
  if (material.unlit) {
    json["extensions"]["KHR_materials_unlit"] = Json::object();
    use_extension(document, "KHR_materials_unlit");
  }
  return json;
}

}  // namespace

void build_materials(GltfDocument& document, const Scene& scene) {
  build_images(document, scene.images);
  TextureTable textures(document);
  for (const Material& material : scene.materials) {
    Json json = build_material(material, textures, document);
    append_to(document, "materials", std::move(json));
  }
}

}  // namespace goldthread
