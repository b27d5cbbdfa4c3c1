#include "trace/shown_scene.h"

#include <algorithm>
#include <map>
#include <utility>

namespace goldthread {
namespace {

/// Attribute values at a primitive's final vertices: the source's own, or interpolated where it was refined.
template <typename T>
void append_final(std::vector<T>& to, const std::vector<T>& values, const Primitive& primitive,
                  const LitPrimitive* lit, const T& otherwise) {
  const bool refined = lit && !lit->source_mesh;
  const size_t count = refined ? lit->origins.size() : primitive.positions.size();
  for (size_t i = 0; i < count; ++i) {
    if (values.empty()) {
      to.push_back(otherwise);
    } else if (!refined) {
      to.push_back(values[i]);
    } else {
      const VertexOrigin& origin = lit->origins[i];
      const uint32_t* corner = &primitive.indices[3 * size_t{origin.triangle}];
      const float first = 1 - origin.weights.x - origin.weights.y;
      to.push_back(first * values[corner[0]] + origin.weights.x * values[corner[1]] +
                   origin.weights.y * values[corner[2]]);
    }
  }
}

std::vector<UVec3> final_faces(const Primitive& primitive, const LitPrimitive* lit) {
  if (lit && !lit->source_mesh) return lit->faces;
  std::vector<UVec3> faces(primitive.triangle_count());
  for (size_t t = 0; t < faces.size(); ++t)
    faces[t] = UVec3(primitive.indices[3 * t], primitive.indices[3 * t + 1], primitive.indices[3 * t + 2]);
  return faces;
}

bool see_through(const Material& material) {
  return !material.double_sided || material.alpha_mode == AlphaMode::kMask;
}

}  // namespace

ShownScene::ShownScene(const Scene& scene, const Lighting& lighting) : scene_(scene) {
  std::map<std::pair<uint32_t, uint32_t>, const LitPrimitive*> light;
  for (const LitPrimitive& lit : lighting.primitives) light[{lit.instance, lit.primitive}] = &lit;
  for (uint32_t i = 0; i < scene.instances.size(); ++i) {
    const Mesh& mesh = scene.meshes[scene.instances[i].mesh];
    for (uint32_t p = 0; p < mesh.primitives.size(); ++p) {
      const auto found = light.find({i, p});
      add(scene.instances[i], mesh.primitives[p], found == light.end() ? nullptr : found->second);
    }
  }
  std::vector<uint8_t> marks(triangles_.size());
  for (size_t t = 0; t < marks.size(); ++t) marks[t] = see_through(*surfaces_[surface_of_[t]].material);
  if (triangles_.empty()) return;
  drawn_ = std::make_unique<RayCaster>(positions_, triangles_, marks,
                                       [this](uint32_t triangle, vec2 weights, const Ray& ray) {
                                         return looked_through(triangle, weights, ray) ? 1.0f : 0.0f;
                                       });
}

void ShownScene::add(const Instance& instance, const Primitive& primitive, const LitPrimitive* lit) {
  const auto first_vertex = static_cast<uint32_t>(positions_.size());
  add_vertices(instance, primitive, lit);
  const bool mirrored = glm::determinant(mat3(instance.transform)) < 0;
  const auto surface = static_cast<uint32_t>(surfaces_.size());
  surfaces_.push_back({&scene_.materials[primitive.material], lit != nullptr,
                       lit != nullptr && !lit->irradiance_back.empty()});
  for (UVec3 face : final_faces(primitive, lit)) {
    face += first_vertex;
    if (!is_finite(positions_[face.x]) || !is_finite(positions_[face.y]) || !is_finite(positions_[face.z]))
      continue;
    if (mirrored) std::swap(face.y, face.z);
    for (int k = 0; k < 3; ++k) bounds_.add(positions_[face[k]]);
    triangles_.push_back(face);
    surface_of_.push_back(surface);
  }
}

void ShownScene::add_vertices(const Instance& instance, const Primitive& primitive, const LitPrimitive* lit) {
  const size_t first = positions_.size();
  append_final(positions_, primitive.positions, primitive, lit, vec3(0));
  for (size_t i = first; i < positions_.size(); ++i)
    positions_[i] = vec3(instance.transform * vec4(positions_[i], 1));
  for (size_t set = 0; set < 2; ++set)
    append_final(texcoords_[set], primitive.texcoords[set], primitive, lit, vec2(0));
  append_final(colours_, primitive.colours, primitive, lit, vec4(1));
  if (lit) {
    irradiance_.insert(irradiance_.end(), lit->irradiance.begin(), lit->irradiance.end());
    irradiance_back_.insert(irradiance_back_.end(), lit->irradiance_back.begin(), lit->irradiance_back.end());
  }
  irradiance_.resize(positions_.size(), vec3(0));
  irradiance_back_.resize(positions_.size(), vec3(0));
}

template <typename T>
T ShownScene::interpolate(const std::vector<T>& values, uint32_t triangle, vec2 weights) const {
  const UVec3& face = triangles_[triangle];
  return (1 - weights.x - weights.y) * values[face.x] + weights.x * values[face.y] +
         weights.y * values[face.z];
}

vec2 ShownScene::texcoord(const Texture& texture, uint32_t triangle, vec2 weights) const {
  return interpolate(texcoords_[std::min<uint8_t>(texture.texcoord, 1)], triangle, weights);
}

float ShownScene::alpha_at(uint32_t triangle, vec2 weights) const {
  const Material& material = *surfaces_[surface_of_[triangle]].material;
  float alpha = material.alpha * interpolate(colours_, triangle, weights).w;
  const Texture& texture = material.base_colour_texture;
  if (texture.present())
    alpha *= sample_texture(texture, scene_.images, texcoord(texture, triangle, weights)).w;
  return alpha;
}

bool ShownScene::seen_from_back(uint32_t triangle, const Ray& ray) const {
  const UVec3& face = triangles_[triangle];
  const vec3& a = positions_[face.x];
  return dot(cross(positions_[face.y] - a, positions_[face.z] - a), ray.direction) > 0;
}

bool ShownScene::looked_through(uint32_t triangle, vec2 weights, const Ray& ray) const {
  const Material& material = *surfaces_[surface_of_[triangle]].material;
  if (!material.double_sided && seen_from_back(triangle, ray)) return true;
  return material.alpha_mode == AlphaMode::kMask && alpha_at(triangle, weights) < material.alpha_cutoff;
}

std::vector<vec3> ShownScene::corner_points() const {
  std::vector<uint8_t> used(positions_.size());  // vertices that no triangle uses may be anywhere
  for (const UVec3& face : triangles_) used[face.x] = used[face.y] = used[face.z] = 1;
  std::vector<vec3> points;
  for (size_t i = 0; i < used.size(); ++i)
    if (used[i]) points.push_back(positions_[i]);
  return points;
}

Hit ShownScene::closest(const Ray& ray) const {
  return drawn_ ? drawn_->closest(ray) : Hit{};
}

Appearance ShownScene::appearance(const Hit& hit, const Ray& ray) const {
  const ShownSurface& surface = surfaces_[surface_of_[hit.triangle]];
  const Material& material = *surface.material;
  const auto look_up = [&](const Texture& texture) {
    return texture.present()
               ? sample_texture(texture, scene_.images, texcoord(texture, hit.triangle, hit.weights))
               : vec4(1);
  };
  const vec4 colour = vec4(material.base_colour, material.alpha) * look_up(material.base_colour_texture) *
                      interpolate(colours_, hit.triangle, hit.weights);
  Appearance seen;
  if (material.alpha_mode == AlphaMode::kBlend) seen.alpha = std::clamp(colour.w, 0.0f, 1.0f);
  seen.behind = vec3(1 - seen.alpha);
  if (material.unlit) {
    seen.nits = vec3(colour);
    return seen;
  }
  if (material.emits()) seen.nits = material.emission * vec3(look_up(material.emission_texture));
  const auto factor = [&](float value, const Texture& texture, int channel) {
    if (!texture.present()) return value;
    return value *
           sample_data_texture(texture, scene_.images, texcoord(texture, hit.triangle, hit.weights))[channel];
  };
  const float metallic = factor(material.metallic, material.metallic_texture, 2);
  const float transmission = factor(material.transmission, material.transmission_texture, 0);
  seen.behind += seen.alpha * (1 - metallic) * transmission *
                 glm::clamp(vec3(colour) * material.volume_tint, vec3(0), vec3(1));
  if (!surface.lit) return seen;
  const bool back = seen_from_back(hit.triangle, ray);
  const auto light = [&](bool behind) {
    if (behind && !surface.lit_back) return vec3(0);
    return interpolate(behind ? irradiance_back_ : irradiance_, hit.triangle, hit.weights);
  };
  const vec3 irradiance = light(back);
  const float share = (1 - metallic) * (1 - transmission) / kPi;
  if (!material.is_translucent()) {
    seen.nits += share * vec3(colour) * irradiance;
    return seen;
  }
  const Texture& texture = material.diffuse_transmission_colour_texture;
  const float through = factor(material.diffuse_transmission, material.diffuse_transmission_texture, 3);
  const vec3 other = material.diffuse_transmission_colour * vec3(look_up(texture));
  seen.nits += share * ((1 - through) * vec3(colour) * irradiance + through * other * light(!back));
  return seen;
}

}  // namespace goldthread
