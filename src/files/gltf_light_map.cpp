#include "files/gltf_light_map.h"

#include <fmt/format.h>

#include <map>
#include <tuple>
#include <utility>

#include "files/gltf_light_nodes.h"
#include "files/gltf_read_values.h"
#include "files/gltf_unlit.h"
#include "files/png_encode.h"

namespace goldthread {
namespace {

constexpr const char* kLightMap = "MOZ_lightmap";
constexpr const char* kUnlit = "KHR_materials_unlit";
constexpr const char* kVariants = "KHR_materials_variants";
constexpr const char* kLux = "goldthread_lux";
constexpr const char* kOcclusionLux = "/occlusionTexture/extras/goldthread_lux";
constexpr int64_t kNoMaterial = -1;

/// A page in the document.
struct PageTexture {
  uint32_t texture = 0;
  float intensity = 1;
};

/// How materials are to show the pages.
enum class PageUse { kLight, kBaked, kOcclusion };

/// What textures hold: what the eye sees (kBaked), or light alone. The other is empty.
struct Textures {
  PageUse use = PageUse::kLight;
  std::span<const EncodedPage> light;
  std::span<const BakedPage> baked;
};

const char* name_of(PageUse use) {
  if (use == PageUse::kBaked) return "baked";
  return use == PageUse::kOcclusion ? "occlusion" : "light map";
}

class LightMapWriter {
 public:
  LightMapWriter(GltfDocument& document, const DocumentMap& map, const Scene& scene, const LightAtlas& atlas,
                 const Textures& textures, const SourceReader& read)
      : document_(document),
        map_(map),
        scene_(scene),
        atlas_(atlas),
        textures_(textures),
        shows_all_(textures.use == PageUse::kBaked),
        read_(read),
        geometry_(document, scene, read) {}

  Status add() {
    std::map<uint32_t, std::vector<const MappedMesh*>> instances;
    for (const MappedMesh& mesh : atlas_.meshes) {
      if (Status status = check_mesh(scene_, mesh, mesh.coordinates.size()); !status) return status;
      if (place(mesh) != DocumentMap::kNone) instances[mesh.instance].push_back(&mesh);
    }
    if (Status status = add_pages(); !status) return status;
    std::vector<LitGroup> groups;
    for (const auto& [instance, meshes] : instances) {
      const uint32_t mesh = document_.json["nodes"][map_.nodes[instance]]["mesh"].get<uint32_t>();
      groups.push_back({mesh, {instance}, nullptr});
      if (Status status = map_mesh(groups.back(), meshes); !status) return status;
    }
    if (Status status = assign_meshes(document_, map_, groups, read_, scene_.file); !status) return status;
    if (!groups.empty() && textures_.use != PageUse::kOcclusion)
      use_extension(document_, shows_all_ ? kUnlit : kLightMap);
    geometry_.drop_unused_extensions();
    if (!shows_all_) turn_lamps_off();
    return Nothing{};
  }

 private:
  uint32_t place(const MappedMesh& mesh) const {
    return map_.primitives[scene_.instances[mesh.instance].mesh][mesh.primitive];
  }

  Status add_pages() {
    const uint32_t linear = 9729, mipmapped = 9987, clamp = 33071;  // OpenGL's numbers
    const uint32_t sampler =
        append_to(document_, "samplers",
                  {{"magFilter", linear}, {"minFilter", mipmapped}, {"wrapS", clamp}, {"wrapT", clamp}});
    for (size_t p = 0; p < atlas_.pages.size(); ++p) {
      const std::vector<uint8_t> png = picture_of(p);
      if (png.empty())
        return Error{ErrorCode::kCannotWrite, "a page of the light map is larger than PNG holds", scene_.file,
                     "", "give a smaller --page-size"};
      const std::string name = fmt::format("{} {}", name_of(textures_.use), p);
      const uint32_t view = append_view(document_, png);
      const uint32_t source =
          append_to(document_, "images", {{"name", name}, {"mimeType", "image/png"}, {"bufferView", view}});
      pages_.push_back(
          {append_to(document_, "textures", {{"name", name}, {"sampler", sampler}, {"source", source}}),
           shows_all_ ? 1.0f : textures_.light[p].intensity});
    }
    return Nothing{};
  }

  std::vector<uint8_t> picture_of(size_t page) const {
    const FloatImage& image = atlas_.pages[page].irradiance;
    if (shows_all_) return encode_png(image.width, image.height, 4, textures_.baked[page].rgba);
    return encode_png(image.width, image.height, 3, textures_.light[page].rgb, PngContent::kData);
  }

  Status map_mesh(LitGroup& group, const std::vector<const MappedMesh*>& meshes) {
    const Json source = document_.json["meshes"].at(group.mesh);
    group.lit_mesh = source;
    const MappedMesh* before = nullptr;
    for (const MappedMesh* mesh : meshes) {
      Json primitive = source.at("primitives").at(place(*mesh));
      const bool two_sided = is_two_sided(meshes, *mesh);
      if (Status status = map_primitive(primitive, *mesh, group.mesh, two_sided); !status) return status;
      const bool first = before == nullptr || before->primitive != mesh->primitive;
      Json& primitives = group.lit_mesh["primitives"];
      if (first)
        primitives.at(place(*mesh)) = std::move(primitive);
      else
        primitives.push_back(std::move(primitive));
      before = mesh;
    }
    return Nothing{};
  }

  static bool is_two_sided(const std::vector<const MappedMesh*>& meshes, const MappedMesh& one) {
    for (const MappedMesh* mesh : meshes)
      if (mesh->primitive == one.primitive && mesh->back) return true;
    return false;
  }

  Status map_primitive(Json& primitive, const MappedMesh& mesh, uint32_t file_mesh, bool two_sided) {
    const uint32_t set = free_coordinates(primitive);
    const Facing facing = mesh.back ? Facing::kBack : Facing::kFront;
    if (Status status = geometry_.renew(primitive, mesh, file_mesh, place(mesh), facing); !status)
      return status;
    Json& attributes = primitive["attributes"];
    const uint32_t coordinates = append_attribute(document_, std::span<const vec2>(mesh.coordinates));
    attributes[fmt::format("TEXCOORD_{}", set)] = coordinates;
    // glTF has no second set without a first.
    if (!attributes.contains("TEXCOORD_0")) attributes["TEXCOORD_0"] = coordinates;
    const int64_t material = primitive.value("material", kNoMaterial);
    primitive["material"] = material_for(material, mesh.page, set, two_sided);
    if (primitive.contains("extensions") && primitive["extensions"].contains(kVariants))
      map_variants(primitive, mesh.page, set, two_sided);
    return Nothing{};
  }

  /// A page of light serves all variants; one with colours in it would be the wrong one for all but the
  /// first.
  void map_variants(Json& primitive, uint32_t page, uint32_t set, bool two_sided) {
    Json& extensions = primitive["extensions"];
    if (shows_all_) {
      extensions.erase(kVariants);
      if (extensions.empty()) primitive.erase("extensions");
      return;
    }
    for (Json& mapping : extensions[kVariants].at("mappings"))
      mapping["material"] = material_for(mapping.at("material").get<int64_t>(), page, set, two_sided);
  }

  /// The set that an earlier light map had, which goes, or the first free one after TEXCOORD_0.
  uint32_t free_coordinates(const Json& primitive) const {
    if (primitive.contains("material")) {
      const Json& material = document_.json.at("materials").at(primitive["material"].get<size_t>());
      if (material.contains("extensions") && material["extensions"].contains(kLightMap))
        return material["extensions"][kLightMap].value("texCoord", 1u);
      if (material.contains(Json::json_pointer(kOcclusionLux)))
        return material["occlusionTexture"].value("texCoord", 1u);
    }
    uint32_t set = 1;
    while (primitive.at("attributes").contains(fmt::format("TEXCOORD_{}", set))) ++set;
    return set;
  }

  /// Of each material in use a copy for each page; `source` stays as it is.
  uint32_t material_for(int64_t source, uint32_t page, uint32_t set, bool two_sided) {
    const auto [known, is_new] = materials_.try_emplace(std::tuple(source, page, set, two_sided), 0u);
    if (!is_new) return known->second;
    Json material = Json::object();
    if (source != kNoMaterial) material = document_.json.at("materials").at(static_cast<size_t>(source));
    if (two_sided) material.erase("doubleSided");  // front and back are triangles of their own now
    drop_earlier_light(material);
    if (shows_all_)
      show_page(material, page, set);
    else if (textures_.use == PageUse::kOcclusion)
      material["occlusionTexture"] = {{"index", pages_[page].texture},
                                      {"texCoord", set},
                                      {"extras", {{kLux, shortest(pages_[page].intensity)}}}};
    else
      material["extensions"][kLightMap] = {{"index", pages_[page].texture},
                                           {"texCoord", set},
                                           {"intensity", shortest(pages_[page].intensity)}};
    known->second = append_to(document_, "materials", std::move(material));
    return known->second;
  }

  /// Its set of coordinates is the new one's (free_coordinates): it would be read at the wrong places.
  static void drop_earlier_light(Json& material) {
    if (material.contains(Json::json_pointer(kOcclusionLux))) material.erase("occlusionTexture");
    if (!material.contains("extensions")) return;
    material["extensions"].erase(kLightMap);
    if (material["extensions"].empty()) material.erase("extensions");
  }

  /// The factor's alpha is on the page.
  void show_page(Json& material, uint32_t page, uint32_t set) {
    drop_shading(material);
    material["pbrMetallicRoughness"] = {
        {"baseColorTexture", {{"index", pages_[page].texture}, {"texCoord", set}}},
        {"metallicFactor", 0.0},
        {"roughnessFactor", 1.0}};
    material["extensions"][kUnlit] = Json::object();
  }

  /// Their light is on the pages: a viewer would light the scene twice.
  void turn_lamps_off() {
    const Json::json_pointer lamps("/extensions/KHR_lights_punctual/lights");
    if (!document_.json.contains(lamps)) return;
    for (Json& lamp : document_.json[lamps]) {
      if (lamp.contains("extras") && !lamp["extras"].is_object())
        lamp["extras"] = {{"extras", lamp["extras"]}};
      if (!lamp["extras"].contains(kBakedIntensity))
        lamp["extras"][kBakedIntensity] = lamp.value("intensity", 1.0);
      lamp["intensity"] = 0.0;
    }
  }

  GltfDocument& document_;
  const DocumentMap& map_;
  const Scene& scene_;
  const LightAtlas& atlas_;
  Textures textures_;
  bool shows_all_;
  const SourceReader& read_;
  GeometryWriter geometry_;
  std::vector<PageTexture> pages_;
  std::map<std::tuple<int64_t, uint32_t, uint32_t, bool>, uint32_t> materials_;
};

}  // namespace

Status add_light_maps(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                      const LightAtlas& atlas, std::span<const EncodedPage> encoded,
                      const SourceReader& read) {
  return LightMapWriter(document, map, scene, atlas, {PageUse::kLight, encoded, {}}, read).add();
}

Status add_baked_pages(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                       const LightAtlas& atlas, std::span<const BakedPage> baked, const SourceReader& read) {
  return LightMapWriter(document, map, scene, atlas, {PageUse::kBaked, {}, baked}, read).add();
}

Status add_occlusion_pages(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                           const LightAtlas& atlas, std::span<const EncodedPage> grey,
                           const SourceReader& read) {
  return LightMapWriter(document, map, scene, atlas, {PageUse::kOcclusion, grey, {}}, read).add();
}

}  // namespace goldthread
