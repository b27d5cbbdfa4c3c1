#include "files/gltf_read_surroundings.h"

#include <fmt/format.h>

#include <utility>

#include "files/gltf_read_container.h"
#include "files/gltf_read_values.h"
#include "files/image_decode.h"
#include "math/colour.h"
#include "scene/cube_map.h"

namespace goldthread {
namespace {

constexpr const char* kName = "EXT_lights_image_based";

Error broken(std::string message) {
  return bad_input("", "", std::move(message));
}

/// The light that the shown scene names, or null where it names none.
Result<const tinygltf::Value*> light_of_scene(const tinygltf::Model& model) {
  const size_t shown = model.defaultScene == -1 ? 0 : size_t(model.defaultScene);
  if (shown >= model.scenes.size()) return nullptr;
  const tinygltf::Value* use = find_extension(model.scenes[shown].extensions, kName);
  if (!use) return nullptr;
  const tinygltf::Value* root = find_extension(model.extensions, kName);
  const int index = int_member(*use, "light").value_or(-1);
  const bool known = root && root->Has("lights") && root->Get("lights").IsArray() && index >= 0 &&
                     size_t(index) < root->Get("lights").ArrayLen() &&
                     root->Get("lights").Get(index).IsObject();
  if (!known) return broken(fmt::format("there is no light {}", index));
  return &root->Get("lights").Get(index);
}

/// Linear, with the range that alpha keeps (RGBD).
FloatImage unpack(const Image& image) {
  FloatImage out{image.width, image.height, {}};
  out.pixels.reserve(image.rgba.size() / 4);
  for (size_t i = 0; i + 4 <= image.rgba.size(); i += 4) {
    const auto linear = [&](size_t k) { return srgb_to_linear(float(image.rgba[i + k]) / 255); };
    out.pixels.push_back(vec3(linear(0), linear(1), linear(2)) / (float(image.rgba[i + 3]) / 255));
  }
  return out;
}

Result<CubeMap> read_cube(const tinygltf::Model& model, const tinygltf::Value& light) {
  const auto is_list = [](const tinygltf::Value& value, size_t least) {
    return value.IsArray() && value.ArrayLen() >= least;
  };
  if (!light.Has("specularImages") || !is_list(light.Get("specularImages"), 1) ||
      !is_list(light.Get("specularImages").Get(0), 6))
    return broken("there are no six specularImages");
  CubeMap cube;
  for (int face = 0; face < 6; ++face) {
    const tinygltf::Value& number = light.Get("specularImages").Get(0).Get(face);
    const int index = number.IsInt() ? number.GetNumberAsInt() : -1;
    if (size_t(index) >= model.images.size()) return broken(fmt::format("there is no image {}", index));
    const Result<Image> image = decode_image(model.images[size_t(index)].image);
    if (!image) return broken(fmt::format("image {}: {}", index, image.error().message));
    cube.faces[size_t(face)] = unpack(*image);
  }
  if (!cube.is_whole()) return broken("its six pictures are not squares of one size");
  return cube;
}

Result<EnvironmentMap> read_map(const tinygltf::Model& model, const tinygltf::Value& light, Scene& scene) {
  const Result<CubeMap> cube = read_cube(model, light);
  if (!cube) return cube.error();
  const vec4 r = vector_member(light, "rotation", vec4(0, 0, 0, 1));  // x, y, z, w
  const float size = glm::length(r);
  if (!(size > 0) || !std::isfinite(size)) return broken("its rotation is none");
  EnvironmentMap::Repairs repairs;
  Result<EnvironmentMap> map =
      EnvironmentMap::make(equirectangular_of(*cube, glm::quat(r.w, r.x, r.y, r.z) / size),
                           number_member(light, "intensity", 1), 0, &repairs);
  if (map && repairs.pixels > 0)
    scene.warnings.push_back(
        fmt::format("its surroundings ({}): {} of their directions are no light; taken as 0 there", kName,
                    repairs.pixels));
  return map;
}

}  // namespace

void read_gltf_surroundings(const tinygltf::Model& model, Scene& scene) {
  const Result<const tinygltf::Value*> light = light_of_scene(model);
  if (light && *light == nullptr) return;
  Result<EnvironmentMap> map =
      light ? read_map(model, **light, scene) : Result<EnvironmentMap>(light.error());
  if (map) {
    scene.sky = Sky{vec3(0), std::nullopt, *std::move(map)};
    return;
  }
  scene.warnings.push_back(
      fmt::format("its surroundings ({}) are left out, for {}: give them as --environment FILE", kName,
                  map.error().message));
}

}  // namespace goldthread
