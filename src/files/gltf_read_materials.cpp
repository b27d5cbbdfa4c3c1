#include "files/gltf_read_materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "files/gltf_read_container.h"
#include "files/gltf_read_values.h"
#include "files/image_decode.h"

namespace goldthread {
namespace {

constexpr const char* kExportAgain = "export the file again";

Wrap wrap_mode(int mode) {
  if (mode == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE) return Wrap::kClamp;
  if (mode == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::kMirror;
  return Wrap::kRepeat;
}

/// A textureInfo of the file, from wherever it stood.
struct TextureUse {
  int texture = -1;
  int texcoord = 0;
  const tinygltf::Value* transform = nullptr;  ///< KHR_texture_transform
};

TextureUse texture_use(const tinygltf::TextureInfo& info) {
  return {info.index, info.texCoord, find_extension(info.extensions, "KHR_texture_transform")};
}

TextureUse texture_use(const tinygltf::Value* info) {
  TextureUse use;
  if (!info) return use;
  use.texture = int_member(*info, "index").value_or(-1);
  use.texcoord = int_member(*info, "texCoord").value_or(0);
  if (const tinygltf::Value* extensions = object_member(*info, "extensions"))
    use.transform = object_member(*extensions, "KHR_texture_transform");
  return use;
}

class MaterialReader {
 public:
  MaterialReader(const tinygltf::Model& model, const std::string& file, NormalTextures normals, Scene& scene)
      : model_(model), file_(file), normals_(normals), scene_(scene) {}

  Status read(size_t index) {
    const tinygltf::Material& source = model_.materials[index];
    place_ = fmt::format("material {}", index);
    Material material;
    material.name = source.name;
    TextureUse base, metallic, emission = texture_use(source.emissiveTexture);
    read_reflectance(source, material, base, metallic);
    read_emission(source, material);
    const TextureUse transmission = read_transmission(source, material);
    TextureUse through, through_colour;
    read_diffuse_transmission(source, material, through, through_colour);
    read_volume(source, material);
    if (source.alphaMode == "MASK") material.alpha_mode = AlphaMode::kMask;
    if (source.alphaMode == "BLEND") material.alpha_mode = AlphaMode::kBlend;
    material.alpha_cutoff = float(source.alphaCutoff);
    material.double_sided = source.doubleSided;
    material.unlit = find_extension(source.extensions, "KHR_materials_unlit") != nullptr;
    if (Status status = place_texture(base, material.base_colour_texture); !status) return status;
    // A texture that only multiplies zero is not worth decoding.
    if (material.metallic > 0)
      if (Status status = place_texture(metallic, material.metallic_texture); !status) return status;
    if (material.transmission > 0)
      if (Status status = place_texture(transmission, material.transmission_texture); !status) return status;
    if (material.diffuse_transmission > 0) {
      if (Status status = place_texture(through, material.diffuse_transmission_texture); !status)
        return status;
      if (Status status = place_texture(through_colour, material.diffuse_transmission_colour_texture);
          !status)
        return status;
    }
    if (normals_ == NormalTextures::kRead)
      if (Status status = read_normals(source, material); !status) return status;
    if (material.emits())
      if (Status status = place_texture(emission, material.emission_texture); !status) return status;
    scene_.materials.push_back(std::move(material));
    return Nothing{};
  }

 private:
  /// `value` of member `key`, within 0 and 1; what is not is named.
  float share(const char* key, float value) {
    if (value >= 0 && value <= 1) return value;
    const float kept = value > 1 ? 1.0f : 0.0f;  // not a number: none
    scene_.warnings.push_back(
        fmt::format("{}: {} is {}, not within 0 to 1; taken as {}", place_, key, value, kept));
    return kept;
  }

  vec3 share(const char* key, const vec3& value) {
    vec3 kept = value;
    for (int c = 0; c < 3; ++c) kept[c] = value[c] >= 0 ? std::min(value[c], 1.0f) : 0.0f;
    if (kept != value)
      scene_.warnings.push_back(fmt::format("{}: {} is not within 0 to 1; taken as [{}, {}, {}]", place_, key,
                                            kept.x, kept.y, kept.z));
    return kept;
  }

  Status read_normals(const tinygltf::Material& source, Material& material) {
    const tinygltf::NormalTextureInfo& info = source.normalTexture;
    material.normal_scale = float(info.scale);
    if (!std::isfinite(material.normal_scale)) {
      scene_.warnings.push_back(
          fmt::format("{}: a normalTexture scale of {} is no number; taken as 1", place_, info.scale));
      material.normal_scale = 1;
    }
    // What is unlit receives no light, and what is scaled to nothing is flat.
    if (info.index == -1 || material.unlit || material.normal_scale == 0) return Nothing{};
    return place_texture(
        {info.index, info.texCoord, find_extension(info.extensions, "KHR_texture_transform")},
        material.normal_texture);
  }

  TextureUse read_transmission(const tinygltf::Material& source, Material& material) {
    const auto* glass = find_extension(source.extensions, "KHR_materials_transmission");
    if (glass == nullptr) return {};
    material.transmission = share("transmissionFactor", number_member(*glass, "transmissionFactor", 0));
    return texture_use(object_member(*glass, "transmissionTexture"));
  }

  void read_diffuse_transmission(const tinygltf::Material& source, Material& material, TextureUse& share_use,
                                 TextureUse& colour_use) {
    const auto* through = find_extension(source.extensions, "KHR_materials_diffuse_transmission");
    if (through == nullptr) return;
    material.diffuse_transmission =
        share("diffuseTransmissionFactor", number_member(*through, "diffuseTransmissionFactor", 0));
    material.diffuse_transmission_colour = share(
        "diffuseTransmissionColorFactor", vector_member(*through, "diffuseTransmissionColorFactor", vec3(1)));
    share_use = texture_use(object_member(*through, "diffuseTransmissionTexture"));
    colour_use = texture_use(object_member(*through, "diffuseTransmissionColorTexture"));
  }

  /// Beer's law over half the thickness, as a surface's own colour: light goes in by one surface and out by
  /// another, straight on; how long its way is in between is left to the file's thickness.
  void read_volume(const tinygltf::Material& source, Material& material) {
    const auto* volume = find_extension(source.extensions, "KHR_materials_volume");
    if (volume == nullptr || material.transmission <= 0) return;
    const float thickness = number_member(*volume, "thicknessFactor", 0);
    const float distance = number_member(*volume, "attenuationDistance", 0);
    if (!(thickness > 0) || !(distance > 0) || !std::isfinite(thickness)) return;  // thin, or clear
    const vec3 colour = share("attenuationColor", vector_member(*volume, "attenuationColor", vec3(1)));
    material.volume_tint = glm::pow(colour, vec3(0.5f * thickness / distance));
    if (volume->Has("thicknessTexture"))
      scene_.warnings.push_back(
          fmt::format("{}: its glass is taken as thick as thicknessFactor says all over", place_));
  }

  static void read_reflectance(const tinygltf::Material& source, Material& material, TextureUse& base,
                               TextureUse& metallic) {
    vec4 colour(1);
    if (const auto* glossy = find_extension(source.extensions, "KHR_materials_pbrSpecularGlossiness")) {
      colour = vector_member(*glossy, "diffuseFactor", vec4(1));
      material.metallic = 0;
      base = texture_use(object_member(*glossy, "diffuseTexture"));
    } else {
      colour = vector_of(source.pbrMetallicRoughness.baseColorFactor, vec4(1));
      material.metallic = float(source.pbrMetallicRoughness.metallicFactor);
      base = texture_use(source.pbrMetallicRoughness.baseColorTexture);
      metallic = texture_use(source.pbrMetallicRoughness.metallicRoughnessTexture);
    }
    colour = glm::clamp(colour, 0.0f, 1.0f);
    material.base_colour = vec3(colour);
    material.alpha = colour.w;
    material.metallic = std::clamp(material.metallic, 0.0f, 1.0f);
  }

  static void read_emission(const tinygltf::Material& source, Material& material) {
    float strength = 1;
    if (const auto* extension = find_extension(source.extensions, "KHR_materials_emissive_strength"))
      strength = number_member(*extension, "emissiveStrength", 1);
    material.emission = glm::max(vector_of(source.emissiveFactor, vec3(0)) * strength, vec3(0));
  }

  /// Resolves texture, sampler and picture; leaves `out` absent where the picture cannot be had.
  Status place_texture(const TextureUse& use, Texture& out) {
    if (use.texture == -1) return Nothing{};
    if (size_t(use.texture) >= model_.textures.size())
      return bad_input(file_, place_, fmt::format("there is no texture {}", use.texture), kExportAgain);
    const tinygltf::Texture& texture = model_.textures[size_t(use.texture)];
    Texture placed;
    int texcoord = use.texcoord;
    if (use.transform) {
      placed.offset = vector_member(*use.transform, "offset", vec2(0));
      placed.scale = vector_member(*use.transform, "scale", vec2(1));
      placed.rotation = number_member(*use.transform, "rotation", 0);
      texcoord = int_member(*use.transform, "texCoord").value_or(texcoord);
    }
    if (texcoord < 0 || texcoord > 1) {
      scene_.warnings.push_back(
          fmt::format("{}: uses TEXCOORD_{}; left without that texture", place_, texcoord));
      return Nothing{};
    }
    placed.texcoord = uint8_t(texcoord);
    if (texture.sampler != -1) {
      if (size_t(texture.sampler) >= model_.samplers.size())
        return bad_input(file_, fmt::format("texture {}", use.texture),
                         fmt::format("there is no sampler {}", texture.sampler), kExportAgain);
      placed.wrap_u = wrap_mode(model_.samplers[size_t(texture.sampler)].wrapS);
      placed.wrap_v = wrap_mode(model_.samplers[size_t(texture.sampler)].wrapT);
    }
    const Result<int32_t> image = texture_image(size_t(use.texture));
    if (!image) return image.error();
    placed.image = *image;
    if (placed.present()) out = placed;
    return Nothing{};
  }

  /// Scene image of a texture, -1 if none can be decoded. WebP first, then what older programs use.
  Result<int32_t> texture_image(size_t index) {
    const tinygltf::Texture& texture = model_.textures[index];
    std::vector<int> sources;
    if (const auto* webp = find_extension(texture.extensions, "EXT_texture_webp"))
      if (const auto source = int_member(*webp, "source")) sources.push_back(*source);
    if (texture.source != -1) sources.push_back(texture.source);
    if (const auto* basis = find_extension(texture.extensions, "KHR_texture_basisu"))
      if (const auto source = int_member(*basis, "source")) sources.push_back(*source);
    for (const int source : sources) {
      if (size_t(source) >= model_.images.size())
        return bad_input(file_, fmt::format("texture {}", index), fmt::format("there is no image {}", source),
                         kExportAgain);
      const int32_t image = scene_image(size_t(source));
      if (image >= 0) return image;
    }
    if (sources.empty())
      scene_.warnings.push_back(fmt::format("texture {}: has no picture that can be read; left out", index));
    return -1;
  }

  /// Decodes each picture once, and warns once.
  int32_t scene_image(size_t index) {
    const auto [known, is_new] = images_.try_emplace(index, -1);
    if (!is_new) return known->second;
    const tinygltf::Image& source = model_.images[index];
    Result<Image> image =
        source.image.empty()
            ? Error{ErrorCode::kBadInput,
                    source.uri.empty() ? "it has no data" : "cannot open \"" + source.uri + "\"", "", "", ""}
            : decode_image(source.image);
    if (!image) {
      const std::string named = source.name.empty() ? "" : fmt::format(" \"{}\"", source.name);
      scene_.warnings.push_back(fmt::format("image {}{}: {}; materials keep their plain colour", index, named,
                                            image.error().message));
      return -1;
    }
    image->name = source.name.empty() ? source.uri : source.name;
    scene_.images.push_back(*std::move(image));
    return known->second = int32_t(scene_.images.size()) - 1;
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  NormalTextures normals_;
  Scene& scene_;
  std::string place_;
  std::map<size_t, int32_t> images_;  ///< the file's image -> Scene::images
};

}  // namespace

Status read_gltf_materials(const tinygltf::Model& model, const std::string& file, NormalTextures normals,
                           Scene& scene) {
  MaterialReader reader(model, file, normals, scene);
  for (size_t i = 0; i < model.materials.size(); ++i)
    if (Status status = reader.read(i); !status) return status;
  return Nothing{};
}

Material default_material() {
  Material material;
  material.name = "default";
  material.base_colour = vec3(0.8f);
  material.metallic = 0;
  return material;
}

}  // namespace goldthread
