#include "files/gltf_light.h"

#include <fmt/format.h>

#include <cstring>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "files/gltf_light_nodes.h"
#include "files/gltf_unlit.h"

namespace goldthread {
namespace {

template <typename T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
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

class LightWriter {
 public:
  LightWriter(GltfDocument& document, const DocumentMap& map, const Scene& scene,
              const SceneWriteOptions& options, const SourceReader& read)
      : document_(document),
        map_(map),
        scene_(scene),
        mode_(options.mode),
        read_(read),
        geometry_(document, scene, read),
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
    geometry_.drop_unused_extensions();
    return Nothing{};
  }

 private:
  uint32_t place(const LitPrimitive& lit) const {
    return map_.primitives[scene_.instances[lit.instance].mesh][lit.primitive];
  }

  /// Lighting may come from a file: nothing below this indexes out of range.
  Status check(const Lighting& lighting) const {
    for (const LitPrimitive& lit : lighting.primitives) {
      for (const std::vector<vec3>* values : {&lit.irradiance, &lit.irradiance_back}) {
        if (values == &lit.irradiance_back && values->empty()) continue;
        if (Status status = check_mesh(scene_, lit, values->size()); !status) return status;
      }
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
      Status status = geometry_.renew(primitive, *lit, group.mesh, place(*lit), Facing::kFront);
      if (!status) return status;
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

  GltfDocument& document_;
  const DocumentMap& map_;
  const Scene& scene_;
  OutputMode mode_;
  const SourceReader& read_;
  GeometryWriter geometry_;
  UnlitMaterials unlit_;
};

}  // namespace

Status add_lighting(GltfDocument& document, const DocumentMap& map, const Scene& scene,
                    const Lighting& lighting, const SceneWriteOptions& options, const SourceReader& read) {
  return LightWriter(document, map, scene, options, read).add(lighting);
}

}  // namespace goldthread
