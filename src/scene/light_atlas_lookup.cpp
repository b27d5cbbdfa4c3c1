#include "scene/light_atlas_lookup.h"

#include <algorithm>
#include <cmath>

namespace goldthread {

LightAtlasLookup::LightAtlasLookup(const Scene& scene, const LightAtlas& atlas) : atlas_(atlas) {
  for (uint32_t m = 0; m < atlas.meshes.size(); ++m) {
    const MappedMesh& mesh = atlas.meshes[m];
    std::vector<Place>& places = places_[{mesh.instance, mesh.primitive, mesh.back}];
    places.resize(
        scene.meshes[scene.instances[mesh.instance].mesh].primitives[mesh.primitive].triangle_count());
    for (uint32_t f = 0; f < mesh.faces.size(); ++f) places[mesh.face_parents[f]] = {m, f};
  }
}

std::optional<vec3> LightAtlasLookup::irradiance(uint32_t instance, uint32_t primitive, uint32_t triangle,
                                                 vec2 weights, bool back) const {
  const auto found = places_.find({instance, primitive, back});
  if (found == places_.end() || found->second[triangle].mesh == kNowhere) return std::nullopt;
  const Place& place = found->second[triangle];
  const MappedMesh& mesh = atlas_.meshes[place.mesh];
  const UVec3& face = mesh.faces[place.face];
  const vec2 at = (1 - weights.x - weights.y) * mesh.coordinates[face.x] +
                  weights.x * mesh.coordinates[face.y] + weights.y * mesh.coordinates[face.z];
  return sample_page(atlas_.pages[mesh.page].irradiance, at);
}

vec3 sample_page(const FloatImage& page, const vec2& at) {
  const vec2 size(static_cast<float>(page.width), static_cast<float>(page.height));
  const vec2 texel = glm::clamp(at * size - 0.5f, vec2(0), size - 1.0f);
  const auto x = static_cast<size_t>(texel.x), y = static_cast<size_t>(texel.y);
  const size_t right = std::min<size_t>(x + 1, page.width - 1),
               below = std::min<size_t>(y + 1, page.height - 1);
  const vec2 part = texel - vec2(static_cast<float>(x), static_cast<float>(y));
  const auto pixel = [&](size_t u, size_t v) { return page.pixels[v * page.width + u]; };
  return (1 - part.y) * ((1 - part.x) * pixel(x, y) + part.x * pixel(right, y)) +
         part.y * ((1 - part.x) * pixel(x, below) + part.x * pixel(right, below));
}

}  // namespace goldthread
