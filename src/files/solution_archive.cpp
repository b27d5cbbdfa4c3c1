#include "files/solution_archive.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <map>
#include <memory>
#include <type_traits>

namespace goldthread {
namespace {

static_assert(std::endian::native == std::endian::little, "the format is little-endian");

/// Copied as it lies in memory.
template <typename T>
concept Plain =
    (std::is_arithmetic_v<T> && !std::same_as<T, bool>) || std::same_as<T, vec2> || std::same_as<T, vec3> ||
    std::same_as<T, vec4> || std::same_as<T, mat4> || std::same_as<T, UVec3> || std::same_as<T, VertexOrigin>;

class Packer {
 public:
  std::vector<uint8_t> bytes;

  template <typename... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }

 private:
  void raw(const void* data, size_t size) {
    const auto* first = static_cast<const uint8_t*>(data);
    bytes.insert(bytes.end(), first, first + size);
  }
  template <typename T>
  void put(const T& value) {
    if constexpr (Plain<T>) {
      raw(&value, sizeof value);
    } else if constexpr (std::is_enum_v<T> || std::same_as<T, bool>) {
      bytes.push_back(static_cast<uint8_t>(value));
    } else {
      fields(*this, value);
    }
  }
  void put(const std::string& text) {
    put(uint64_t{text.size()});
    raw(text.data(), text.size());
  }
  template <typename T>
  void put(const std::vector<T>& values) {
    put(uint64_t{values.size()});
    if constexpr (Plain<T>) {
      raw(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) put(value);
    }
  }
};

class Unpacker {
 public:
  explicit Unpacker(const std::vector<uint8_t>& bytes)
      : at_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  bool finished() const { return !failed_ && at_ == end_; }

  template <typename... T>
  void operator()(T&... values) {
    (take(values), ...);
  }

 private:
  size_t left() const { return static_cast<size_t>(end_ - at_); }
  void raw(void* data, size_t size) {
    failed_ = failed_ || size > left();
    if (failed_ || size == 0) return;
    std::memcpy(data, at_, size);
    at_ += size;
  }
  template <typename T>
  void take(T& value) {
    if constexpr (Plain<T>) {
      raw(&value, sizeof value);
    } else if constexpr (std::is_enum_v<T> || std::same_as<T, bool>) {
      uint8_t byte = 0;
      raw(&byte, 1);
      value = static_cast<T>(byte);
    } else {
      fields(*this, value);
    }
  }
  void take(std::string& text) {
    uint64_t size = 0;
    take(size);
    if (!fits(size, 1)) return;
    text.resize(size);
    raw(text.data(), size);
  }
  template <typename T>
  void take(std::vector<T>& values) {
    uint64_t count = 0;
    take(count);
    if constexpr (Plain<T>) {
      if (!fits(count, sizeof(T))) return;
      values.resize(count);
      raw(values.data(), count * sizeof(T));
    } else {  // grown as they come: a false count ends with the bytes
      for (uint64_t i = 0; i < count && !failed_; ++i) take(values.emplace_back());
    }
  }
  bool fits(uint64_t count, size_t size) {
    failed_ = failed_ || count > left() / size;
    return !failed_;
  }

  const uint8_t* at_;
  const uint8_t* end_;
  bool failed_ = false;
};

// A Sky as plain values: models and maps are made, not filled in.
struct StoredSky {
  enum class Kind : uint8_t { kUniform, kModel, kMap };
  Kind kind = Kind::kUniform;
  vec3 radiance{0};
  SkyDescription model;
  FloatImage picture;
  float rotation = 0;
};

StoredSky store(const Sky& sky) {
  StoredSky stored;
  stored.radiance = sky.radiance;
  if (sky.model) {
    stored.kind = StoredSky::Kind::kModel;
    stored.model = sky.model->description();
  }
  if (sky.map) {
    stored.kind = StoredSky::Kind::kMap;
    stored.picture = sky.map->picture();
    stored.rotation = sky.map->rotation();
  }
  return stored;
}

// A lamp as plain values: profiles, which lamps share, lie beside them.
struct StoredLight {
  Light light;
  uint32_t profile = kNoProfile;
  static constexpr uint32_t kNoProfile = 0xffffffffu;
};

struct StoredLights {
  std::vector<LightProfile> profiles;
  std::vector<StoredLight> lights;
};

StoredLights store(const std::vector<Light>& lights) {
  StoredLights stored;
  std::map<const LightProfile*, uint32_t> known;
  for (const Light& light : lights) {
    StoredLight& s = stored.lights.emplace_back();
    s.light = light;
    if (!light.profile) continue;
    const auto [place, is_new] =
        known.try_emplace(light.profile.get(), static_cast<uint32_t>(stored.profiles.size()));
    if (is_new) stored.profiles.push_back(*light.profile);
    s.profile = place->second;
  }
  return stored;
}

bool ascends(const std::vector<float>& angles) {
  // What is not a number is neither more nor less.
  for (size_t i = 0; i + 1 < angles.size(); ++i)
    if (!(angles[i] < angles[i + 1])) return false;
  return !angles.empty() && std::isfinite(angles.front()) && std::isfinite(angles.back());
}

bool is_sound(const LightProfile& profile) {
  return profile.pole <= LightProfile::Pole::kSide && ascends(profile.polar) && ascends(profile.azimuth) &&
         profile.candela.size() / profile.polar.size() == profile.azimuth.size() &&
         profile.candela.size() % profile.polar.size() == 0 &&
         std::all_of(profile.candela.begin(), profile.candela.end(),
                     [](float share) { return share >= 0 && share <= 1; });
}

// False for lamps that cannot be.
bool restore(StoredLights stored, std::vector<Light>& lights) {
  std::vector<std::shared_ptr<const LightProfile>> profiles;
  for (LightProfile& profile : stored.profiles) {
    if (!is_sound(profile)) return false;
    profiles.push_back(std::make_shared<const LightProfile>(std::move(profile)));
  }
  lights.clear();
  for (StoredLight& s : stored.lights) {
    if (s.profile != StoredLight::kNoProfile) {
      if (s.profile >= profiles.size()) return false;
      s.light.profile = profiles[s.profile];
    }
    lights.push_back(std::move(s.light));
  }
  return true;
}

// False for one that cannot be.
bool restore(const StoredSky& stored, Sky& sky) {
  sky = Sky();
  sky.radiance = stored.radiance;
  if (stored.kind == StoredSky::Kind::kModel) {
    const Result<SkyModel> model = SkyModel::make(stored.model);
    if (model) sky.model = *model;
    return bool(model);
  }
  if (stored.kind != StoredSky::Kind::kMap) return stored.kind == StoredSky::Kind::kUniform;
  EnvironmentMap::Repairs repairs;
  const Result<EnvironmentMap> map = EnvironmentMap::make(stored.picture, 1, stored.rotation, &repairs);
  if (map) sky.map = *map;
  return map && repairs.pixels == 0;
}

// What light does in a material besides being reflected.
struct StoredPassage {
  float transmission = 0;
  Texture transmission_texture;
  vec3 volume_tint{1};
  float diffuse_transmission = 0;
  Texture diffuse_transmission_texture;
  vec3 diffuse_transmission_colour{1};
  Texture diffuse_transmission_colour_texture;
};

// How a material's normals are bent.
struct StoredNormalMap {
  Texture texture;
  float scale = 1;
};

struct StoredNormalMaps {
  std::vector<StoredNormalMap> materials;
  std::vector<std::vector<vec4>> tangents;  ///< by mesh and primitive, one after another
};

template <typename V, typename T>
concept Is = std::same_as<std::remove_const_t<V>, T>;

// One list of members serves both ways, so that they cannot disagree.
template <typename A, Is<Texture> V>
void fields(A& a, V& v) {
  a(v.image, v.texcoord, v.wrap_u, v.wrap_v, v.offset, v.scale, v.rotation);
}
template <typename A, Is<Material> V>
void fields(A& a, V& v) {
  a(v.name, v.base_colour, v.alpha, v.base_colour_texture, v.metallic, v.metallic_texture, v.emission,
    v.emission_texture, v.alpha_mode, v.alpha_cutoff, v.double_sided, v.unlit);
}
template <typename A, Is<StoredPassage> V>
void fields(A& a, V& v) {
  a(v.transmission, v.transmission_texture, v.volume_tint, v.diffuse_transmission,
    v.diffuse_transmission_texture, v.diffuse_transmission_colour, v.diffuse_transmission_colour_texture);
}
template <typename A, Is<StoredNormalMap> V>
void fields(A& a, V& v) {
  a(v.texture, v.scale);
}
template <typename A, Is<StoredNormalMaps> V>
void fields(A& a, V& v) {
  a(v.materials, v.tangents);
}
template <typename A, Is<Image> V>
void fields(A& a, V& v) {
  a(v.name, v.width, v.height, v.rgba);
}
template <typename A, Is<Primitive> V>
void fields(A& a, V& v) {
  a(v.positions, v.normals, v.texcoords[0], v.texcoords[1], v.colours, v.indices, v.material,
    v.source_primitive);
}
template <typename A, Is<Mesh> V>
void fields(A& a, V& v) {
  a(v.name, v.primitives);
}
template <typename A, Is<Instance> V>
void fields(A& a, V& v) {
  a(v.name, v.mesh, v.transform, v.source_node);
}
template <typename A, Is<Light> V>
void fields(A& a, V& v) {
  a(v.name, v.kind, v.intensity, v.position, v.direction, v.inner_cone, v.outer_cone, v.range,
    v.angular_diameter, v.radius, v.across);
}
template <typename A, Is<StoredLight> V>
void fields(A& a, V& v) {
  a(v.light, v.profile);
}
template <typename A, Is<LightProfile> V>
void fields(A& a, V& v) {
  a(v.name, v.pole, v.polar, v.azimuth, v.candela, v.changes_with_tilt);
}
template <typename A, Is<StoredLights> V>
void fields(A& a, V& v) {
  a(v.profiles, v.lights);
}
template <typename A, Is<SkyDescription> V>
void fields(A& a, V& v) {
  a(v.kind, v.cie_type, v.sun_direction, v.level.measure, v.level.value, v.turbidity, v.ground_reflectance,
    v.sunlight);
}
template <typename A, Is<FloatImage> V>
void fields(A& a, V& v) {
  a(v.width, v.height, v.pixels);
}
template <typename A, Is<StoredSky> V>
void fields(A& a, V& v) {
  a(v.kind, v.radiance, v.model, v.picture, v.rotation);
}
template <typename A, Is<Camera> V>
void fields(A& a, V& v) {
  a(v.name, v.position, v.forward, v.up, v.vertical_fov, v.orthographic_height, v.aspect);
}
template <typename A, Is<LitPrimitive> V>
void fields(A& a, V& v) {
  a(v.instance, v.primitive, v.source_mesh, v.origins, v.faces, v.face_parents, v.irradiance,
    v.irradiance_back);
}

template <typename A, Is<MappedMesh> V>
void fields(A& a, V& v) {
  a(v.instance, v.primitive, v.back, v.page, v.origins, v.faces, v.face_parents, v.coordinates);
}
template <typename A, Is<AtlasPage> V>
void fields(A& a, V& v) {
  a(v.irradiance, v.covered);
}
template <typename A, Is<LightAtlas> V>
void fields(A& a, V& v) {
  a(v.texels_per_metre, v.meshes, v.pages);
}

bool visit_sky(Packer& a, const Sky& sky) {
  a(store(sky));
  return true;
}
bool visit_sky(Unpacker& a, Sky& sky) {
  StoredSky stored;
  a(stored);
  return a.finished() && restore(stored, sky);
}

bool visit_passages(Packer& a, const std::vector<Material>& materials) {
  std::vector<StoredPassage> passages;
  bool any = false;
  for (const Material& m : materials) {
    passages.push_back({m.transmission, m.transmission_texture, m.volume_tint, m.diffuse_transmission,
                        m.diffuse_transmission_texture, m.diffuse_transmission_colour,
                        m.diffuse_transmission_colour_texture});
    any |= m.transmission > 0 || m.diffuse_transmission > 0;
  }
  if (any) a(passages);
  return true;
}
bool visit_passages(Unpacker& a, std::vector<Material>& materials) {
  std::vector<StoredPassage> passages;
  a(passages);
  if (!a.finished() || passages.size() != materials.size()) return false;
  for (size_t i = 0; i < passages.size(); ++i) {
    const StoredPassage& p = passages[i];
    materials[i].transmission = p.transmission;
    materials[i].transmission_texture = p.transmission_texture;
    materials[i].volume_tint = p.volume_tint;
    materials[i].diffuse_transmission = p.diffuse_transmission;
    materials[i].diffuse_transmission_texture = p.diffuse_transmission_texture;
    materials[i].diffuse_transmission_colour = p.diffuse_transmission_colour;
    materials[i].diffuse_transmission_colour_texture = p.diffuse_transmission_colour_texture;
  }
  return true;
}

bool visit_lights(Packer& a, const std::vector<Light>& lights) {
  a(store(lights));
  return true;
}
bool visit_lights(Unpacker& a, std::vector<Light>& lights) {
  StoredLights stored;
  a(stored);
  return a.finished() && restore(std::move(stored), lights);
}

// Widths and heights, where there are area lamps: files without them are as they were before there were any.
bool visit_lamp_sizes(Packer& a, const std::vector<Light>& lights) {
  std::vector<vec2> sizes;
  bool any = false;
  for (const Light& light : lights) {
    sizes.push_back(light.size);
    any |= light.has_area();
  }
  if (any) a(sizes);
  return true;
}
bool visit_lamp_sizes(Unpacker& a, std::vector<Light>& lights) {
  std::vector<vec2> sizes;
  a(sizes);
  if (!a.finished() || sizes.size() != lights.size()) return false;
  for (size_t i = 0; i < sizes.size(); ++i) lights[i].size = sizes[i];
  return true;
}

bool visit_normal_maps(Packer& a, const Scene& scene) {
  StoredNormalMaps maps;
  bool any = false;
  for (const Material& m : scene.materials) {
    maps.materials.push_back({m.normal_texture, m.normal_scale});
    any |= m.normal_texture.present();
  }
  for (const Mesh& mesh : scene.meshes)
    for (const Primitive& primitive : mesh.primitives) maps.tangents.push_back(primitive.tangents);
  if (any) a(maps);
  return true;
}
bool visit_normal_maps(Unpacker& a, Scene& scene) {
  StoredNormalMaps maps;
  a(maps);
  size_t primitives = 0;
  for (const Mesh& mesh : scene.meshes) primitives += mesh.primitives.size();
  if (!a.finished() || maps.materials.size() != scene.materials.size() || maps.tangents.size() != primitives)
    return false;
  for (size_t i = 0; i < maps.materials.size(); ++i) {
    scene.materials[i].normal_texture = maps.materials[i].texture;
    scene.materials[i].normal_scale = maps.materials[i].scale;
  }
  auto tangents = maps.tangents.begin();
  for (Mesh& mesh : scene.meshes)
    for (Primitive& primitive : mesh.primitives) primitive.tangents = std::move(*tangents++);
  return true;
}

bool visit_atlas(Packer& a, const std::optional<LightAtlas>& atlas) {
  if (atlas) a(*atlas);
  return true;
}
bool visit_atlas(Unpacker& a, std::optional<LightAtlas>& atlas) {
  a(atlas.emplace());
  for (MappedMesh& mesh : atlas->meshes) mesh.source_mesh = false;
  return true;
}

template <typename A, Is<Solution> V>
bool visit_section(A& a, V& solution, const std::string& name) {
  auto& scene = solution.scene;
  if (name == "report") return a(solution.report_json), true;
  if (name == "scene") return a(scene.file, scene.warnings), true;
  if (name == "sky") return visit_sky(a, scene.sky);
  if (name == "images") return a(scene.images), true;
  if (name == "materials") return a(scene.materials), true;
  if (name == "passages") return visit_passages(a, scene.materials);
  if (name == "meshes") return a(scene.meshes), true;
  if (name == "instances") return a(scene.instances), true;
  if (name == "lights") return visit_lights(a, scene.lights);
  if (name == "lamp_sizes") return visit_lamp_sizes(a, scene.lights);
  if (name == "normal_maps") return visit_normal_maps(a, scene);
  if (name == "cameras") return a(scene.cameras), true;
  if (name == "lighting") return a(solution.lighting.revision, solution.lighting.primitives), true;
  if (name == "light_maps") return visit_atlas(a, solution.atlas);
  return false;
}

}  // namespace

std::vector<std::string> section_names() {
  return {"report", "scene",   "sky",      "images",   "materials",  "meshes",      "instances",
          "lights", "cameras", "lighting", "passages", "lamp_sizes", "normal_maps", "light_maps"};
}

bool is_optional_section(const std::string& name) {
  return name == "passages" || name == "lamp_sizes" || name == "normal_maps" || name == "light_maps";
}

std::vector<uint8_t> pack_section(const Solution& solution, const std::string& name) {
  Packer packer;
  visit_section(packer, solution, name);
  return std::move(packer.bytes);
}

bool unpack_section(Solution& solution, const std::string& name, const std::vector<uint8_t>& bytes) {
  Unpacker unpacker(bytes);
  return visit_section(unpacker, solution, name) && unpacker.finished();
}

}  // namespace goldthread
