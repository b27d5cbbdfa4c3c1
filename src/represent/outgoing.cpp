#include "represent/outgoing.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "mesh/texel_raster.h"
#include "represent/fill_empty.h"
#include "scene/light_atlas_lookup.h"

namespace goldthread {
namespace {

/// A texel is looked at in so many places across and up: textures are finer than light maps.
constexpr uint32_t kLooks = 2;

/// A face of a mapped mesh with what its material is read by.
struct Painted {
  const MappedMesh* mesh = nullptr;
  uint32_t face = 0;
};

/// What a material does at a place of a source triangle.
struct Look {
  vec3 emission{0}, reflectance{0};
  float alpha = 1;
};

Look look_at(const Scene& scene, const Painted& painted, const vec2& weights) {
  const MappedMesh& mesh = *painted.mesh;
  const Primitive& source = scene.meshes[scene.instances[mesh.instance].mesh].primitives[mesh.primitive];
  const Material& material = scene.materials[source.material];
  const uint32_t* index = &source.indices[3 * size_t{mesh.face_parents[painted.face]}];
  const auto between = [&](const auto& values, auto otherwise) {
    if (values.empty()) return otherwise;
    return (1 - weights.x - weights.y) * values[index[0]] + weights.x * values[index[1]] +
           weights.y * values[index[2]];
  };
  const auto at = [&](const Texture& texture) {
    return between(source.texcoords[std::min<uint8_t>(texture.texcoord, 1)], vec2(0));
  };
  const vec4 tint = between(source.colours, vec4(1));
  const vec4 painted_colour =
      sample_texture(material.base_colour_texture, scene.images, at(material.base_colour_texture));
  float diffuse =
      1 - material.metallic *
              sample_data_texture(material.metallic_texture, scene.images, at(material.metallic_texture)).z;
  diffuse *= 1 - material.transmission * sample_data_texture(material.transmission_texture, scene.images,
                                                             at(material.transmission_texture))
                                             .x;
  Look look;
  look.reflectance = diffuse * material.base_colour * vec3(tint) * vec3(painted_colour);
  const bool shines = material.emits() && (!mesh.back || material.double_sided);
  if (shines)
    look.emission = material.emission * vec3(sample_texture(material.emission_texture, scene.images,
                                                            at(material.emission_texture)));
  look.alpha = std::clamp(material.alpha * tint.w * painted_colour.w, 0.0f, 1.0f);
  return look;
}

OutgoingPage paint(const LightAtlas& atlas, const Scene& scene, uint32_t number, uint32_t padding) {
  const FloatImage& light = atlas.pages[number].irradiance;
  std::vector<std::array<vec2, 3>> corners;
  std::vector<Painted> faces;
  for (const MappedMesh& mesh : atlas.meshes)
    for (uint32_t f = 0; mesh.page == number && f < mesh.faces.size(); ++f) {
      const UVec3& face = mesh.faces[f];
      corners.push_back({mesh.coordinates[face.x], mesh.coordinates[face.y], mesh.coordinates[face.z]});
      faces.push_back({&mesh, f});
    }
  const uint32_t width = light.width, height = light.height;
  const std::vector<CoveredTexel> places = rasterise_texels(corners, kLooks * width, kLooks * height).texels;
  struct Seen {
    vec3 nits{0};
    float alpha = 0;
  };
  std::vector<Seen> seen(places.size());
  parallel_for(
      places.size(),
      [&](size_t i) {
        const CoveredTexel& place = places[i];
        const Look look = look_at(scene, faces[place.triangle], place.weights);
        const vec2 at((static_cast<float>(place.x) + 0.5f) / static_cast<float>(kLooks * width),
                      (static_cast<float>(place.y) + 0.5f) / static_cast<float>(kLooks * height));
        seen[i] = {look.emission + look.reflectance * sample_page(light, at) / kPi, look.alpha};
      },
      1024);
  OutgoingPage page;
  page.nits = {width, height, std::vector<vec3>(light.pixels.size(), vec3(0))};
  std::vector<float> count(light.pixels.size(), 0);
  page.alpha.assign(light.pixels.size(), 0);
  for (size_t i = 0; i < places.size(); ++i) {
    const size_t texel = size_t{places[i].y / kLooks} * width + places[i].x / kLooks;
    page.nits.pixels[texel] += seen[i].nits;
    page.alpha[texel] += seen[i].alpha;
    ++count[texel];
  }
  std::vector<uint8_t> known(count.size());
  FloatImage alpha{width, height, std::vector<vec3>(count.size(), vec3(0))};
  for (size_t i = 0; i < count.size(); ++i) {
    known[i] = count[i] > 0;
    if (!known[i]) continue;
    page.nits.pixels[i] /= count[i];
    alpha.pixels[i] = vec3(page.alpha[i] / count[i]);
  }
  fill_empty(page.nits, known, padding);
  fill_empty(alpha, known, padding);
  for (size_t i = 0; i < count.size(); ++i) page.alpha[i] = faces.empty() ? 1.0f : alpha.pixels[i].x;
  return page;
}

}  // namespace

std::vector<OutgoingPage> outgoing_pages(const LightAtlas& atlas, const Scene& scene, uint32_t padding) {
  std::vector<OutgoingPage> pages;
  for (uint32_t page = 0; page < atlas.pages.size(); ++page)
    pages.push_back(paint(atlas, scene, page, padding));
  return pages;
}

}  // namespace goldthread
