#include "files/gltf_light.h"

#include <fmt/format.h>

#include <cstring>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "files/gltf_light_nodes.h"
#include "files/gltf_read_container.h"
#include "files/gltf_unlit.h"

namespace goldthread {
namespace {

constexpr const char* kDraco = "KHR_draco_mesh_compression";
/// Extensions of a primitive that number its vertices or triangles: meaningless on a refined mesh.
constexpr const char* kTiedToMesh[] = {"CESIUM_primitive_outline", "FB_ngon_encoding"};

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_mesh(const LitPrimitive& a, const LitPrimitive& b) {
  return a.source_mesh == b.source_mesh && same_bytes(a.origins, b.origins) && same_bytes(a.faces, b.faces);
}

bool same_light(const LitPrimitive& a, const LitPrimitive& b) {
  return same_mesh(a, b) && same_bytes(a.irradiance, b.irradiance) &&
         same_bytes(a.irradiance_back, b.irradiance_back);
}

/// The lit primitives of one instance.
using InstanceLight = std::vector<const LitPrimitive*>;

void hash_values(uint64_t& hash, const std::vector<vec3>& values) {
  const auto* bytes = reinterpret_cast<const uint8_t*>(values.data());
  for (size_t i = 0; i < values.size() * sizeof(vec3); ++i)
    hash = (hash ^ bytes[i]) * 0x100000001b3u;  // FNV-1a
}

uint64_t hash_of(const InstanceLight& light) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const LitPrimitive* lit : light) {
    hash_values(hash, lit->irradiance);
    hash_values(hash, lit->irradiance_back);
  }
  return hash;
}

/// Drops the name from extensionsUsed and extensionsRequired when nothing in the document uses it.
bool mentions_extension(const Json& json, const char* name) {
  if (json.is_object() && json.contains("extensions") && json["extensions"].contains(name)) return true;
  if (!json.is_structured()) return false;
  for (const Json& child : json)
    if (mentions_extension(child, name)) return true;
  return false;
}

void drop_unused_extension(Json& json, const char* name) {
  if (mentions_extension(json, name)) return;
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!json.contains(list)) continue;
    Json kept = Json::array();
    for (const Json& known : json[list])
      if (known != name) kept.push_back(known);
    json[list] = kept;
    if (kept.empty()) json.erase(list);
  }
}

class LightWriter {
 public:
  LightWriter(GltfDocument& document, const DocumentMap& map, const Scene& scene,
              const SceneWriteOptions& options, const SourceReader& read)
      : document_(document),
        map_(map),
        scene_(scene),
        mode_(options.mode),
        read_(read),
        unlit_(document, scene, options.exposure) {}

  Status add(const Lighting& lighting) {
    if (Status status = check(lighting); !status) return status;
    std::map<uint32_t, InstanceLight> instances;
    for (const LitPrimitive& lit : lighting.primitives)
      if (place(lit) != DocumentMap::kNone && (lit.source_mesh || !lit.faces.empty()))
        instances[lit.instance].push_back(&lit);
    std::vector<LitGroup> groups;
    std::vector<const InstanceLight*> lights;
    collect_groups(instances, groups, lights);
    for (size_t g = 0; g < groups.size(); ++g)
      if (Status status = light_mesh(groups[g], *lights[g]); !status) return status;
    if (Status status = assign_meshes(document_, map_, groups, read_, scene_.file); !status) return status;
    for (const char* name : {kDraco, "EXT_mesh_gpu_instancing", kTiedToMesh[0], kTiedToMesh[1]})
      drop_unused_extension(document_.json, name);
    return Nothing{};
  }

 private:
  const Primitive& source(const LitPrimitive& lit) const {
    return scene_.meshes[scene_.instances[lit.instance].mesh].primitives[lit.primitive];
  }
  uint32_t place(const LitPrimitive& lit) const {
    return map_.primitives[scene_.instances[lit.instance].mesh][lit.primitive];
  }

  /// Lighting may come from a file: nothing below this indexes out of range.
  Status check(const Lighting& lighting) const {
    for (const LitPrimitive& lit : lighting.primitives) {
      bool fits = lit.instance < scene_.instances.size() &&
                  lit.primitive < scene_.meshes[scene_.instances[lit.instance].mesh].primitives.size();
      if (fits) {
        const Primitive& primitive = source(lit);
        const size_t vertices = lit.source_mesh ? primitive.positions.size() : lit.origins.size();
        fits = lit.irradiance.size() == vertices &&
               (lit.irradiance_back.empty() || lit.irradiance_back.size() == vertices);
        for (const VertexOrigin& origin : lit.origins)
          fits = fits && origin.triangle < primitive.triangle_count();
        for (const UVec3& face : lit.faces)
          fits = fits && glm::all(glm::lessThan(face, UVec3(uint32_t(vertices))));
      }
      if (!fits)
        return bad_input(scene_.file, fmt::format("instance {} primitive {}", lit.instance, lit.primitive),
                         "the light does not fit the scene", "bake it again");
    }
    return Nothing{};
  }

  void collect_groups(const std::map<uint32_t, InstanceLight>& instances, std::vector<LitGroup>& groups,
                      std::vector<const InstanceLight*>& lights) const {
    std::unordered_multimap<uint64_t, size_t> by_hash;
    for (const auto& [instance, light] : instances) {
      const uint32_t mesh = document_.json["nodes"][map_.nodes[instance]]["mesh"].get<uint32_t>();
      const uint64_t hash = hash_of(light);
      std::optional<size_t> match;
      const auto [first, last] = by_hash.equal_range(hash);
      for (auto candidate = first; candidate != last && !match; ++candidate)
        if (groups[candidate->second].mesh == mesh && same(light, *lights[candidate->second]))
          match = candidate->second;
      if (!match) {
        match = groups.size();
        by_hash.emplace(hash, groups.size());
        groups.push_back({mesh, {}, nullptr});
        lights.push_back(&light);
      }
      groups[*match].instances.push_back(instance);
    }
  }

  bool same(const InstanceLight& a, const InstanceLight& b) const {
    bool equal = a.size() == b.size();
    for (size_t i = 0; equal && i < a.size(); ++i)
      equal = place(*a[i]) == place(*b[i]) && same_light(*a[i], *b[i]);
    return equal;
  }

  Status light_mesh(LitGroup& group, const InstanceLight& light) {
    group.lit_mesh = document_.json["meshes"].at(group.mesh);
    for (const LitPrimitive* lit : light) {
      Json& primitive = group.lit_mesh["primitives"].at(place(*lit));
      if (Status status = renew_geometry(primitive, *lit, group.mesh); !status) return status;
      if (mode_ == OutputMode::kUnlit) {
        unlit_.apply(primitive, *lit);
        continue;
      }
      Json& attributes = primitive["attributes"];
      attributes["_IRRADIANCE"] = append_attribute(document_, std::span<const vec3>(lit->irradiance));
      if (!lit->irradiance_back.empty())
        attributes["_IRRADIANCE_BACK"] =
            append_attribute(document_, std::span<const vec3>(lit->irradiance_back));
    }
    return Nothing{};
  }

  /// Writes the primitive's attributes and indices anew where the mesh was refined or is compressed;
  /// otherwise the file's own accessors stay. Instances with the same vertices share all that.
  Status renew_geometry(Json& primitive, const LitPrimitive& lit, uint32_t mesh) {
    Json& attributes = primitive.at("attributes");
    for (const char* light : {"_IRRADIANCE", "_IRRADIANCE_BACK"})
      attributes.erase(light);  // of an earlier bake
    const bool draco = primitive.contains("extensions") && primitive["extensions"].contains(kDraco);
    if (lit.source_mesh && !draco) return check_vertex_count(primitive, lit);
    for (const auto& [example, written] : renewed_[{mesh, place(lit)}])
      if (same_mesh(*example, lit)) {
        primitive = written;
        return Nothing{};
      }
    if (Status status = rewrite_attributes(attributes, lit, mesh, -1); !status) return status;
    if (primitive.contains("targets"))
      for (size_t t = 0; t < primitive["targets"].size(); ++t) {
        Status status = rewrite_attributes(primitive["targets"][t], lit, mesh, static_cast<int>(t));
        if (!status) return status;
      }
    rewrite_indices(primitive, lit);
    drop_extensions(primitive, lit.source_mesh);
    renewed_[{mesh, place(lit)}].emplace_back(&lit, primitive);
    return Nothing{};
  }

  Status check_vertex_count(const Json& primitive, const LitPrimitive& lit) const {
    const size_t accessor = primitive["attributes"].at("POSITION");
    const size_t count = document_.json["accessors"].at(accessor).at("count");
    if (count == lit.irradiance.size()) return Nothing{};
    return bad_input(scene_.file, fmt::format("accessor {}", accessor),
                     fmt::format("has {} vertices where {} are lit", count, lit.irradiance.size()),
                     "if the file has changed since it was read, bake it again");
  }

  Status rewrite_attributes(Json& attributes, const LitPrimitive& lit, uint32_t mesh, int target) {
    for (auto& [name, accessor] : attributes.items()) {
      Result<Elements> elements = read_.attribute(lit, mesh, place(lit), name, target);
      if (!elements) return elements.error();
      if (!lit.source_mesh)
        *elements = refine_elements(*elements, name, target >= 0, source(lit).indices, lit.origins);
      accessor = append_elements(document_, *elements, name);
    }
    return Nothing{};
  }

  void rewrite_indices(Json& primitive, const LitPrimitive& lit) {
    std::vector<uint32_t> corners;
    for (const UVec3& face : lit.faces) corners.insert(corners.end(), {face.x, face.y, face.z});
    if (lit.source_mesh) corners = source(lit).indices;  // strips expanded, compression undone
    primitive["indices"] = append_indices(document_, corners, lit.irradiance.size());
    primitive.erase("mode");  // absent means triangles
  }

  static void drop_extensions(Json& primitive, bool source_mesh) {
    if (!primitive.contains("extensions")) return;
    Json& extensions = primitive["extensions"];
    extensions.erase(kDraco);
    if (!source_mesh)
      for (const char* name : kTiedToMesh) extensions.erase(name);
    if (extensions.empty()) primitive.erase("extensions");
  }

  GltfDocument& document_;
  const DocumentMap& map_;
  const Scene& scene_;
  OutputMode mode_;
  const SourceReader& read_;
  UnlitMaterials unlit_;
  /// By file mesh and primitive: what was written for whom, for others with the same vertices.
  std::map<std::pair<uint32_t, uint32_t>, std::vector<std::pair<const LitPrimitive*, Json>>> renewed_;
};

}  // namespace

Status add_lighting(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                    const Lighting& lighting, const SceneWriteOptions& options, const SourceReader& read) {
  return LightWriter(document, map, scene, options, read).add(lighting);
}

}  // namespace goldthread
