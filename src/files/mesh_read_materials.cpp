#include "files/mesh_read_materials.h"

#include <assimp/commonMetaData.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "files/gltf_read_container.h"
#include "files/image_decode.h"

namespace goldthread {
namespace {

constexpr vec3 kPlainGrey(0.8f);       // of what has no colour of its own
constexpr vec3 kObjFiller(0.6f);       // assimp's colour for OBJ materials without Kd
constexpr size_t kWarnedTextures = 3;  // by name; more are counted

vec3 to_vec3(const aiColor3D& c) {
  return vec3(c.r, c.g, c.b);
}

Wrap wrap_mode(aiTextureMapMode mode) {
  if (mode == aiTextureMapMode_Clamp || mode == aiTextureMapMode_Decal) return Wrap::kClamp;
  return mode == aiTextureMapMode_Mirror ? Wrap::kMirror : Wrap::kRepeat;
}

/// Blender writes the size of a texture where FBX has the number of its repeats.
bool writes_inverse_scale(const aiScene& source) {
  aiString generator;
  return source.mMetaData && source.mMetaData->Get(AI_METADATA_SOURCE_GENERATOR, generator) &&
         std::string_view(generator.C_Str()).substr(0, 7) == "Blender";
}

class MaterialReader {
 public:
  MaterialReader(const aiScene& source, MeshFormat format, Scene& scene)
      : source_(source), format_(format), inverse_scale_(writes_inverse_scale(source)), scene_(scene) {}

  void read() {
    for (unsigned i = 0; i < source_.mNumMaterials; ++i) read_material(*source_.mMaterials[i]);
    if (scene_.materials.empty()) scene_.materials.push_back(plain());
    if (lost_textures_ > kWarnedTextures)
      scene_.warnings.push_back(
          fmt::format("{} more textures are not there", lost_textures_ - kWarnedTextures));
  }

 private:
  struct TextureUse {
    Texture texture;
    bool named = false;  ///< the material names one, found or not
  };

  static Material plain() {
    Material material;
    material.metallic = 0;
    material.base_colour = kPlainGrey;
    return material;
  }

  void read_material(const aiMaterial& source) {
    Material material = plain();
    aiString name;
    if (source.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();
    read_base_colour(source, material);
    read_emission(source, material);
    float metallic = 0;
    if (source.Get(AI_MATKEY_METALLIC_FACTOR, metallic) == aiReturn_SUCCESS)
      material.metallic = std::clamp(metallic, 0.0f, 1.0f);
    float opacity = 1;
    if (source.Get(AI_MATKEY_OPACITY, opacity) == aiReturn_SUCCESS && opacity < 1 && opacity >= 0) {
      material.alpha = opacity;
      material.alpha_mode = AlphaMode::kBlend;
    }
    int two_sided = 0;
    if (source.Get(AI_MATKEY_TWOSIDED, two_sided) == aiReturn_SUCCESS) material.double_sided = two_sided != 0;
    scene_.materials.push_back(std::move(material));
  }

  void read_base_colour(const aiMaterial& source, Material& material) {
    aiColor3D colour;
    if (source.Get(AI_MATKEY_BASE_COLOR, colour) == aiReturn_SUCCESS ||
        source.Get(AI_MATKEY_COLOR_DIFFUSE, colour) == aiReturn_SUCCESS)
      material.base_colour = glm::clamp(to_vec3(colour), 0.0f, 1.0f);
    const TextureUse use = read_texture(source, aiTextureType_DIFFUSE, aiTextureType_BASE_COLOR);
    material.base_colour_texture = use.texture;
    if (!use.named) return;
    const bool no_colour = format_ == MeshFormat::kCollada ||
                           (format_ == MeshFormat::kObj && material.base_colour == kObjFiller);
    if (!use.texture.present() && no_colour) material.base_colour = kPlainGrey;
    if (use.texture.present() && (no_colour || format_ == MeshFormat::kFbx)) material.base_colour = vec3(1);
  }

  void read_emission(const aiMaterial& source, Material& material) {
    aiColor3D colour;
    if (source.Get(AI_MATKEY_COLOR_EMISSIVE, colour) == aiReturn_SUCCESS) material.emission = to_vec3(colour);
    aiColor3D legacy;  // of FBX before 2009, beside the later name's default; assimp still writes it
    if (!material.emits() && source.Get("$raw.Emissive", 0, 0, legacy) == aiReturn_SUCCESS)
      material.emission = to_vec3(legacy);
    float factor = 1;
    if (source.Get(AI_MATKEY_EMISSIVE_INTENSITY, factor) == aiReturn_SUCCESS) material.emission *= factor;
    material.emission = glm::max(material.emission, vec3(0));
    material.emission_texture =
        read_texture(source, aiTextureType_EMISSIVE, aiTextureType_EMISSION_COLOR).texture;
    if (!material.emission_texture.present() || material.emits()) return;
    material.emission = vec3(1);
    scene_.warnings.push_back(
        fmt::format("material \"{}\": has a texture for emission and no strength; taken as 1 nit where white",
                    plain_text(material.name)));
  }

  /// The first of two kinds that the material has. Channels past the second are left out.
  TextureUse read_texture(const aiMaterial& material, aiTextureType type, aiTextureType or_type) {
    TextureUse use;
    if (material.GetTextureCount(type) == 0) type = or_type;
    aiString path;
    unsigned channel = 0;
    aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
    if (material.GetTexture(type, 0, &path, nullptr, &channel, nullptr, nullptr, modes) != aiReturn_SUCCESS ||
        channel > 1)
      return use;
    use.named = true;
    use.texture.image = read_image(path.C_Str());
    use.texture.texcoord = uint8_t(channel);
    use.texture.wrap_u = wrap_mode(modes[0]);
    use.texture.wrap_v = wrap_mode(modes[1]);
    aiUVTransform placed;
    if (material.Get(AI_MATKEY_UVTRANSFORM(type, 0), placed) == aiReturn_SUCCESS) place(use.texture, placed);
    return use;
  }

  /// v is turned over on both sides of the transform: 1 - v' = scale * (1 - v) + offset. Turned textures stay
  /// as they are: exporters do not agree on their centre.
  void place(Texture& texture, const aiUVTransform& placed) const {
    vec2 scale(placed.mScaling.x, placed.mScaling.y);
    const vec2 offset(placed.mTranslation.x, placed.mTranslation.y);
    const auto usable = [](float v) { return std::isfinite(v) && std::abs(v) < 1e6f; };
    if (inverse_scale_) scale = 1.0f / scale;
    if (!usable(scale.x) || !usable(scale.y) || !usable(offset.x) || !usable(offset.y)) return;
    if (scale.x == 0 || scale.y == 0) return;
    texture.scale = scale;
    texture.offset = vec2(offset.x, 1 - scale.y - offset.y);
  }

  /// -1 and a warning where it cannot be had.
  int32_t read_image(const std::string& path) {
    const auto [known, is_new] = images_.try_emplace(path, -1);
    if (!is_new) return known->second;
    Result<Image> image = load_image(path);
    if (!image) {
      if (++lost_textures_ <= kWarnedTextures)
        scene_.warnings.push_back(fmt::format("texture \"{}\": {}; materials keep their plain colour",
                                              plain_text(path), image.error().message));
      return -1;
    }
    image->name = path;
    scene_.images.push_back(*std::move(image));
    return known->second = int32_t(scene_.images.size()) - 1;
  }

  Result<Image> load_image(const std::string& path) const {
    const aiTexture* inside = source_.GetEmbeddedTexture(path.c_str());
    if (!inside) {
      const Result<Bytes> bytes = find_picture(path);
      return bytes ? decode_image(*bytes) : Result<Image>(bytes.error());
    }
    if (inside->mHeight == 0)  // encoded: mWidth counts bytes
      return decode_image({reinterpret_cast<const uint8_t*>(inside->pcData), inside->mWidth});
    Image image;
    image.width = inside->mWidth;
    image.height = inside->mHeight;
    image.rgba.reserve(size_t(image.width) * image.height * 4);
    for (size_t i = 0; i < size_t(image.width) * image.height; ++i) {
      const aiTexel& t = inside->pcData[i];
      image.rgba.insert(image.rgba.end(), {t.r, t.g, t.b, t.a});
    }
    return image;
  }

  /// Exporters write paths of the machine that they ran on.
  Result<Bytes> find_picture(const std::string& path) const {
    Result<Bytes> bytes = fetch_uri(path, scene_.file);
    if (bytes || path.rfind("data:", 0) == 0) return bytes;
    const std::string name = path.substr(path.find_last_of("/\\") + 1);
    for (const char* folder : {"", "textures/"})
      if (Result<Bytes> found = fetch_uri(folder + name, scene_.file); found || is_there(folder + name))
        return found;
    if (is_there(path)) return bytes;  // it is that one, and cannot be read
    return bad_input(scene_.file, "", "is not there, nor beside the scene file");
  }

  bool is_there(const std::string& path) const {
    std::error_code unknown;
    return std::filesystem::exists(std::filesystem::path(scene_.file).parent_path() / path, unknown);
  }

  const aiScene& source_;
  MeshFormat format_;
  bool inverse_scale_;
  Scene& scene_;
  std::map<std::string, int32_t> images_;  ///< path -> Scene::images
  size_t lost_textures_ = 0;
};

/// assimp's filler for what has no material.
bool is_filler(const Material& material, MeshFormat format) {
  const bool unnamed = material.name == AI_DEFAULT_MATERIAL_NAME || format == MeshFormat::kPly;
  const bool filler_colour = material.base_colour == vec3(1) || material.base_colour == kObjFiller;
  return unnamed && filler_colour && !material.base_colour_texture.present();
}

}  // namespace

void read_mesh_materials(const aiScene& source, MeshFormat format, Scene& scene) {
  MaterialReader(source, format, scene).read();
}

void paint_default_materials(const aiScene& source, MeshFormat format, Scene& scene) {
  if (format == MeshFormat::kFbx || format == MeshFormat::kCollada) return;
  for (unsigned m = 0; m < scene.materials.size(); ++m) {
    if (!is_filler(scene.materials[m], format)) continue;
    const bool painted = std::any_of(
        source.mMeshes, source.mMeshes + source.mNumMeshes,
        [&](const aiMesh* mesh) { return mesh->mMaterialIndex == m && mesh->HasVertexColors(0); });
    scene.materials[m].base_colour = painted ? vec3(1) : kPlainGrey;
  }
}

}  // namespace goldthread
