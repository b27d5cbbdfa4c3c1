#include "files/gltf_read_lights.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>

#include "files/gltf_read_container.h"
#include "files/gltf_read_values.h"
#include "files/ies_read.h"
#include "scene/light_check.h"

namespace goldthread {
namespace {

constexpr const char* kExportAgain = "export the file again";
constexpr const char* kPunctual = "KHR_lights_punctual";
constexpr const char* kProfiled = "EXT_lights_ies";
constexpr const char* kArea = "EXT_lights_area";

/// No lamp is larger.
constexpr float kMostMetres = 1e6f;

/// A number of the extras, which are anything; 0 where there is none within 0 to `most`.
float extra_number(const tinygltf::Value& extras, const char* key, double most) {
  if (!extras.IsObject() || !extras.Has(key) || !extras.Get(key).IsNumber()) return 0;
  const double value = extras.Get(key).GetNumberAsDouble();
  return value > 0 && value < most ? float(value) : 0.0f;
}

/// The format has no word for a lamp's size; exporters that keep it write it in the extras: a ball's radius
/// in metres, and the degrees across a directional light's disc.
float radius_of(const tinygltf::Value& extras) {
  return extra_number(extras, "radius", kMostMetres);
}

void place_light(const glm::dmat4& world, Light& light) {
  light.position = vec3(world[3]);
  aim(light, vec3(-world[2]), vec3(world[0]));
}

Light convert_light(const tinygltf::Light& source, const glm::dmat4& world) {
  Light light;
  if (source.type == "spot") light.kind = LightKind::kSpot;
  if (source.type == "directional") light.kind = LightKind::kDirectional;
  light.intensity = vector_of(source.color, vec3(1)) * float(source.intensity);
  place_light(world, light);
  light.outer_cone = std::clamp(float(source.spot.outerConeAngle), 0.0f, kPi / 2);
  light.inner_cone = std::clamp(float(source.spot.innerConeAngle), 0.0f, light.outer_cone);
  light.range = std::max(float(source.range), 0.0f);
  if (light.kind == LightKind::kDirectional)
    light.angular_diameter = extra_number(source.extras, "angular_diameter", 90) * kPi / 180;
  else
    light.radius = radius_of(source.extras);
  return light;
}

/// A number, `otherwise` where there is none; not a number where something else is.
float strict_number(const tinygltf::Value& object, const char* key, float otherwise) {
  return object.Has(key) ? number_member(object, key, std::numeric_limits<float>::quiet_NaN()) : otherwise;
}

/// Width and height, metres, before the node's scale; of a disc its diameter twice. The draft's first version
/// has a width and a height, or a radius.
vec2 area_lamp_size(const tinygltf::Value& source, LightKind kind) {
  const float size = strict_number(source, "size", 1);
  if (kind == LightKind::kDisc)
    return vec2(source.Has("radius") ? 2 * strict_number(source, "radius", 0) : size);
  if (source.Has("width") || source.Has("height"))
    return {strict_number(source, "width", 1), strict_number(source, "height", 1)};
  const tinygltf::Value* rectangle = object_member(source, "rect");
  return {size * (rectangle ? strict_number(*rectangle, "aspect", 1) : 1.0f), size};
}

/// Reads the lights of one node after another.
class LightReader {
 public:
  LightReader(const tinygltf::Model& model, const std::string& file, const NodePlacements& nodes,
              Scene& scene)
      : model_(model), file_(file), nodes_(nodes), scene_(scene) {}

  Status read(size_t node) {
    const auto* punctual = find_extension(model_.nodes[node].extensions, kPunctual);
    const auto* profiled = find_extension(model_.nodes[node].extensions, kProfiled);
    if (const auto* area = find_extension(model_.nodes[node].extensions, kArea))
      if (Status status = read_area(node, *area); !status) return status;
    if (profiled && punctual) ++with_both_;
    if (profiled) return read_profiled(node, *profiled);
    return punctual ? read_punctual(node, *punctual) : Nothing{};
  }

  void warn() {
    if (with_both_ > 0)
      scene_.warnings.push_back(fmt::format(
          "{} nodes have a light profile and a punctual light: each is one lamp, which shines as its profile "
          "says",
          with_both_));
  }

 private:
  std::string place_of(size_t node) const { return fmt::format("node {}", node); }

  Status read_punctual(size_t node, const tinygltf::Value& extension) {
    const int index = int_member(extension, "light").value_or(-1);
    if (size_t(index) >= model_.lights.size())
      return bad_input(file_, place_of(node), fmt::format("there is no light {}", index), kExportAgain);
    const tinygltf::Light& source = model_.lights[size_t(index)];
    if (source.type != "point" && source.type != "spot" && source.type != "directional") {
      scene_.warnings.push_back(
          fmt::format("light {}: kind \"{}\" is unknown; left out", index, source.type));
      return Nothing{};
    }
    tinygltf::Light lamp = source;
    if (source.extras.IsObject())
      lamp.intensity = static_cast<double>(
          number_member(source.extras, kBakedIntensity, static_cast<float>(lamp.intensity)));
    Light light = convert_light(lamp, nodes_.world[node]);
    light.name = source.name.empty() ? model_.nodes[node].name : source.name;
    scene_.lights.push_back(std::move(light));
    return Nothing{};
  }

  /// An entry of a document's extension's array `lights`, or null.
  const tinygltf::Value* entry(const char* extension, int index) const {
    const tinygltf::Value* root = find_extension(model_.extensions, extension);
    if (!root || !root->Has("lights") || !root->Get("lights").IsArray() || index < 0) return nullptr;
    const tinygltf::Value& all = root->Get("lights");
    return size_t(index) < all.ArrayLen() && all.Get(index).IsObject() ? &all.Get(index) : nullptr;
  }

  /// The draft scales evenly, by the largest of the node's scales, and its luminance stays.
  Status read_area(size_t node, const tinygltf::Value& extension) {
    const int index = int_member(extension, "light").value_or(-1);
    const tinygltf::Value* source = entry(kArea, index);
    if (!source)
      return bad_input(file_, place_of(node), fmt::format("there is no area light {}", index), kExportAgain);
    Light light;
    light.name = string_member(*source, "name");
    const std::string shown = light.name.empty() ? fmt::format("area light {}", index)
                                                 : fmt::format("area light {} \"{}\"", index, light.name);
    if (light.name.empty()) light.name = model_.nodes[node].name;
    const char* key = source->Has("type") || !source->Has("shape") ? "type" : "shape";
    const std::string type = source->Has(key) ? string_member(*source, key) : "rect";
    if (type != "rect" && type != "disk") {
      scene_.warnings.push_back(
          fmt::format("{}: kind \"{}\" is unknown; left out: write rect or disk", shown, type));
      return Nothing{};
    }
    light.kind = type == "disk" ? LightKind::kDisc : LightKind::kRectangle;
    const glm::dmat4& world = nodes_.world[node];
    place_light(world, light);
    const auto scale = static_cast<float>(
        std::max({glm::length(dvec3(world[0])), glm::length(dvec3(world[1])), glm::length(dvec3(world[2]))}));
    const vec2 own = area_lamp_size(*source, light.kind);
    light.size = scale * own;
    if (!is_length(light.size.x) || !is_length(light.size.y)) {
      scene_.warnings.push_back(fmt::format(
          "{}: a size of {:g} x {:g} m, {:g} times that on node {}, has no area; left out: give it lengths "
          "above 0",
          shown, own.x, own.y, scale, node));
      return Nothing{};
    }
    float nits = strict_number(*source, "intensity", 1000);
    if (!(nits >= 0 && nits <= kMostLight)) {
      scene_.warnings.push_back(
          fmt::format("{}: an intensity of {:g} nits is no light; taken as 0", shown, nits));
      nits = 0;
    }
    light.intensity = vector_member(*source, "color", vec3(1)) * (nits * light.area());
    scene_.lights.push_back(std::move(light));
    return Nothing{};
  }

  static bool is_length(float metres) { return metres > 0 && metres < kMostMetres; }

  Status read_profiled(size_t node, const tinygltf::Value& extension) {
    const int index = int_member(extension, "light").value_or(-1);
    const tinygltf::Value* source = entry(kProfiled, index);
    if (!source)
      return bad_input(file_, place_of(node), fmt::format("there is no light profile {}", index),
                       kExportAgain);
    const Result<SharedProfile> profile = profile_of(index, *source);
    if (!profile) return profile.error();
    Light light;
    place_light(nodes_.world[node], light);
    const vec3 colour = glm::clamp(vector_member(extension, "color", vec3(1)), vec3(0), vec3(1));
    light.intensity = colour * (number_member(extension, "multiplier", 1) * profile->peak);
    light.profile = profile->shares;
    if (source->Has("extras")) light.radius = radius_of(source->Get("extras"));
    light.name = model_.nodes[node].name.empty() ? string_member(*source, "name") : model_.nodes[node].name;
    scene_.lights.push_back(std::move(light));
    return Nothing{};
  }

  static std::string string_member(const tinygltf::Value& object, const char* key) {
    return object.Has(key) && object.Get(key).IsString() ? object.Get(key).Get<std::string>() : std::string();
  }

  Result<SharedProfile> profile_of(int index, const tinygltf::Value& source) {
    const auto known = profiles_.find(index);
    if (known != profiles_.end()) return known->second;
    Result<LightProfile> profile = load_profile(index, source);
    if (!profile) return profile.error();
    return profiles_[index] = share_profile(*std::move(profile));
  }

  Result<LightProfile> load_profile(int index, const tinygltf::Value& source) const {
    const std::string place = fmt::format("light profile {}", index), uri = string_member(source, "uri");
    const bool beside = !uri.empty() && uri.rfind("data:", 0) != 0;
    const Result<Bytes> bytes = uri.empty() ? view_bytes(source) : fetch_uri(uri, file_);
    if (!bytes) return bad_input(file_, place, bytes.error().message, bytes.error().cure);
    const std::string name =
        beside ? (std::filesystem::path(file_).parent_path() / uri).string() : std::string();
    Result<LightProfile> profile =
        parse_ies({reinterpret_cast<const char*>(bytes->data()), bytes->size()}, name);
    if (!profile) {
      Error error = profile.error();
      if (beside) return error;
      error.file = file_;
      error.place = error.place.empty() ? place : fmt::format("{}, {}", place, error.place);
      return error;
    }
    const std::string own = string_member(source, "name");
    profile->name = beside ? uri : own.empty() ? place : own;
    return profile;
  }

  Result<Bytes> view_bytes(const tinygltf::Value& source) const {
    const int index = int_member(source, "bufferView").value_or(-1);
    if (size_t(index) >= model_.bufferViews.size())
      return bad_input(file_, "", "it has neither a uri nor a bufferView that is there", kExportAgain);
    const tinygltf::BufferView& view = model_.bufferViews[size_t(index)];
    const std::vector<unsigned char>& data = model_.buffers.at(size_t(view.buffer)).data;
    const auto begin = data.begin() + std::ptrdiff_t(view.byteOffset);
    return Bytes(begin, begin + std::ptrdiff_t(view.byteLength));
  }

  const tinygltf::Model& model_;
  const std::string& file_;
  const NodePlacements& nodes_;
  Scene& scene_;
  std::map<int, SharedProfile> profiles_;
  size_t with_both_ = 0;
};

}  // namespace

Status read_gltf_lights(const tinygltf::Model& model, const std::string& file, const NodePlacements& nodes,
                        Scene& scene) {
  LightReader reader(model, file, nodes, scene);
  for (size_t i = 0; i < model.nodes.size(); ++i) {
    if (!nodes.shown[i]) continue;
    if (Status status = reader.read(i); !status) return status;
  }
  reader.warn();
  return Nothing{};
}

}  // namespace goldthread
