#include "files/gltf_build_nodes.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "files/ies_write.h"

namespace goldthread {
namespace {

struct Placement {
  vec3 translation{0};
  mat3 rotation{1};
  vec3 scale{1};
};

void add_placement(Json& node, const Placement& placement) {
  if (placement.translation != vec3(0)) node["translation"] = json_array({&placement.translation.x, 3});
  if (placement.rotation != mat3(1)) {
    const glm::quat q = glm::normalize(glm::quat_cast(placement.rotation));
    const float xyzw[4] = {q.x, q.y, q.z, q.w};
    node["rotation"] = json_array(xyzw);
  }
  if (placement.scale != vec3(1)) node["scale"] = json_array({&placement.scale.x, 3});
}

/// Writes `m` into `node` when its columns are at right angles: then it is translation * rotation * scale.
bool add_unsheared(Json& node, const mat4& m) {
  Placement placement{vec3(m[3]), mat3(m), vec3(1)};
  for (int c = 0; c < 3; ++c) {
    placement.scale[c] = length(vec3(m[c]));
    if (!(placement.scale[c] > 1e-20f)) return false;  // flat: its axes are the SVD's to find
    if (placement.scale[c] > 0.999999f && placement.scale[c] < 1.000001f) placement.scale[c] = 1;
    placement.rotation[c] = vec3(m[c]) / length(vec3(m[c]));
  }
  const mat3& r = placement.rotation;
  constexpr float kRight = 1e-5f;
  if (std::abs(dot(r[0], r[1])) > kRight || std::abs(dot(r[1], r[2])) > kRight ||
      std::abs(dot(r[2], r[0])) > kRight)
    return false;
  if (glm::determinant(r) < 0) {
    placement.scale.x = -placement.scale.x;
    placement.rotation[0] = -placement.rotation[0];
  }
  add_placement(node, placement);
  return true;
}

mat3 to_mat3(const Eigen::Matrix3d& m) {
  mat3 result;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) result[column][row] = static_cast<float>(m(row, column));
  return result;
}

/// Any linear map is U * S * V^T: the outer node turns and scales, the inner one only turns.
void split(const mat4& m, Placement& outer, Placement& inner) {
  Eigen::Matrix3d linear;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row) linear(row, column) = static_cast<double>(m[column][row]);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(linear, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU(), v = svd.matrixV();
  Eigen::Vector3d s = svd.singularValues();
  if (u.determinant() < 0) {  // a rotation may not mirror; a scale may
    u.col(0) *= -1;
    s[0] *= -1;
  }
  if (v.determinant() < 0) {
    v.col(0) *= -1;
    s[0] *= -1;
  }
  outer.translation = vec3(m[3]);
  outer.rotation = to_mat3(u);
  outer.scale = vec3(static_cast<float>(s[0]), static_cast<float>(s[1]), static_cast<float>(s[2]));
  inner.rotation = to_mat3(v.transpose());
}

bool all_finite(const mat4& m) {
  for (int c = 0; c < 4; ++c)
    if (!is_finite(vec3(m[c]))) return false;
  return true;
}

uint32_t add_root(GltfDocument& document, Json node) {
  const uint32_t index = append_to(document, "nodes", std::move(node));
  document.json["scenes"][0]["nodes"].push_back(index);
  return index;
}

/// A frame whose -Z axis looks along `forward`, as lights and cameras do.
mat4 looking(const vec3& position, const vec3& forward, const vec3& up) {
  const vec3 back = normalize_or(-forward, vec3(0, 0, 1));
  const vec3 spare = std::abs(back.y) < 0.9f ? vec3(0, 1, 0) : vec3(1, 0, 0);
  const vec3 right = normalize_or(cross(up, back), normalize(cross(spare, back)));
  mat4 frame(1);
  frame[0] = vec4(right, 0);
  frame[1] = vec4(cross(back, right), 0);
  frame[2] = vec4(back, 0);
  frame[3] = vec4(position, 1);
  return frame;
}

/// What all kinds of lights have; of an intensity per m^2 where `area` is one.
Json describe(const Light& light, const char* type, float area = 1) {
  const vec3 colour = glm::max(light.intensity, vec3(0));
  const float intensity = std::max(colour.x, std::max(colour.y, colour.z));
  const vec3 hue = intensity > 0 ? colour / intensity : vec3(1);
  Json json = {{"type", type}, {"color", json_array({&hue.x, 3})}, {"intensity", shortest(intensity / area)}};
  if (!light.name.empty()) json["name"] = light.name;
  return json;
}

Json describe_punctual(const Light& light) {
  constexpr const char* kNames[] = {"point", "spot", "directional"};
  Json json = describe(light, kNames[static_cast<size_t>(light.kind)]);
  if (light.range > 0 && light.kind != LightKind::kDirectional) json["range"] = shortest(light.range);
  if (light.kind == LightKind::kSpot) {
    const float outer = std::clamp(light.outer_cone, 1e-4f, kPi / 2);
    json["spot"] = {{"innerConeAngle", shortest(std::clamp(light.inner_cone, 0.0f, outer * 0.9999f))},
                    {"outerConeAngle", outer == kPi / 2 ? double{1.5707963} : shortest(outer)}};
  }
  return json;
}

/// EXT_lights_area, a draft: size is a rectangle's height, aspect its width over that, or a disc's diameter.
Json describe_area(const Light& light) {
  Json json = describe(light, light.kind == LightKind::kDisc ? "disk" : "rect", light.area());
  json["size"] = shortest(light.size.y);
  if (light.kind == LightKind::kRectangle) json["rect"] = {{"aspect", shortest(light.size.x / light.size.y)}};
  return json;
}

/// Puts lights into the document's extensions. Each function returns a node's extensions that name the light.
class LightBuilder {
 public:
  explicit LightBuilder(GltfDocument& document) : document_(document) {}

  Json punctual(const Light& light) {
    return {{"KHR_lights_punctual", {{"light", append("KHR_lights_punctual", describe_punctual(light))}}}};
  }

  Json area(const Light& light) {
    return {{"EXT_lights_area", {{"light", append("EXT_lights_area", describe_area(light))}}}};
  }

  Json profiled(const Light& light) {
    const auto [place, is_new] = profiles_.try_emplace(light.profile.get(), 0u);
    if (is_new) place->second = append("EXT_lights_ies", describe(*light.profile));
    const vec3 colour = glm::max(light.intensity, vec3(0));
    const float candela = std::max(colour.x, std::max(colour.y, colour.z));
    const vec3 hue = candela > 0 ? colour / candela : vec3(1);
    return {{"EXT_lights_ies",
             {{"light", place->second},
              {"multiplier", shortest(candela / kFileCandela)},
              {"color", json_array({&hue.x, 3})}}}};
  }

 private:
  static constexpr float kFileCandela = 1000;  // peaks of the files that are written

  uint32_t append(const char* extension, Json light) {
    use_extension(document_, extension);
    Json& lights = document_.json["extensions"][extension]["lights"];
    lights.push_back(std::move(light));
    return static_cast<uint32_t>(lights.size() - 1);
  }

  Json describe(const LightProfile& profile) {
    const std::string text = ies_text(profile, kFileCandela);
    Json json = {
        {"bufferView", append_view(document_, {reinterpret_cast<const uint8_t*>(text.data()), text.size()})},
        {"mimeType", "application/x-ies-lm-63"}};
    if (!profile.name.empty()) json["name"] = profile.name;
    return json;
  }

  GltfDocument& document_;
  std::map<const LightProfile*, uint32_t> profiles_;
};

Json describe(const Camera& camera, float diagonal) {
  Json json = Json::object();
  if (!camera.name.empty()) json["name"] = camera.name;
  const double near = diagonal > 0 ? shortest(diagonal * 1e-4f) : 0.01;
  if (camera.vertical_fov > 0) {
    json["type"] = "perspective";
    json["perspective"] = {{"yfov", shortest(std::min(camera.vertical_fov, 3.1f))}, {"znear", near}};
    if (camera.aspect > 0) json["perspective"]["aspectRatio"] = shortest(camera.aspect);
    return json;
  }
  const float half_height = camera.orthographic_height > 0 ? camera.orthographic_height / 2 : 1;
  json["type"] = "orthographic";
  json["orthographic"] = {{"xmag", shortest(half_height * (camera.aspect > 0 ? camera.aspect : 1))},
                          {"ymag", shortest(half_height)},
                          {"zfar", shortest(10 * diagonal + 1)},
                          {"znear", near}};
  return json;
}

}  // namespace

uint32_t build_node(GltfDocument& document, const mat4& transform, Json content) {
  if (!all_finite(transform) || transform == mat4(1)) return add_root(document, std::move(content));
  if (add_unsheared(content, transform)) return add_root(document, std::move(content));
  Placement outer, inner;
  split(transform, outer, inner);
  add_placement(content, inner);
  const uint32_t child = append_to(document, "nodes", std::move(content));
  Json parent = {{"children", Json::array({child})}};
  add_placement(parent, outer);
  add_root(document, std::move(parent));
  return child;
}

void build_lights(GltfDocument& document, const Scene& scene) {
  LightBuilder builder(document);
  for (const Light& light : scene.lights) {
    Json node = {{"extensions", light.profile      ? builder.profiled(light)
                                : light.has_area() ? builder.area(light)
                                                   : builder.punctual(light)}};
    if (!light.name.empty()) node["name"] = light.name;
    const vec3 up = light.profile || light.has_area() ? cross(light.across, light.direction) : vec3(0, 1, 0);
    build_node(document, looking(light.position, light.direction, up), std::move(node));
  }
}

void build_cameras(GltfDocument& document, const Scene& scene) {
  const float diagonal = scene.bounds().diagonal();
  for (const Camera& camera : scene.cameras) {
    const uint32_t index = append_to(document, "cameras", describe(camera, diagonal));
    Json node = {{"camera", index}};
    if (!camera.name.empty()) node["name"] = camera.name;
    build_node(document, looking(camera.position, camera.forward, camera.up), std::move(node));
  }
}

}  // namespace goldthread
