#include "session/mapped_texels.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/parallel.h"
#include "base/rng.h"
#include "mesh/texel_raster.h"

namespace goldthread {
namespace {

/// A covered texel's place in the world.
struct TexelPlace {
  uint32_t triangle = 0;  ///< TracedScene::triangles()
  vec2 weights{0};
  bool back = false;
};

/// The traced triangle of each source triangle of each primitive of each instance.
using TracedTriangles = std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>>;

TracedTriangles traced_triangles(const TracedScene& scene) {
  TracedTriangles triangles;
  for (const TracedPart& part : scene.parts()) {
    std::vector<uint32_t>& own = triangles[{part.instance, part.primitive}];
    own.assign(part.source->triangle_count(), Receiver::kNowhere);
    for (uint32_t t = part.first_triangle; t < part.first_triangle + part.triangle_count; ++t)
      own[scene.triangles()[t].source] = t;
  }
  return triangles;
}

void append_page(const LightAtlas& atlas, uint32_t page, const TracedTriangles& traced,
                 std::vector<TexelPlace>& out) {
  std::vector<std::array<vec2, 3>> corners;
  std::vector<TexelPlace> faces;
  for (const MappedMesh& mesh : atlas.meshes) {
    if (mesh.page != page) continue;
    const auto found = traced.find({mesh.instance, mesh.primitive});
    for (size_t f = 0; found != traced.end() && f < mesh.faces.size(); ++f) {
      const uint32_t triangle = found->second[mesh.face_parents[f]];
      if (triangle == Receiver::kNowhere) continue;
      const UVec3& face = mesh.faces[f];
      corners.push_back({mesh.coordinates[face.x], mesh.coordinates[face.y], mesh.coordinates[face.z]});
      faces.push_back({triangle, vec2(0), mesh.back});
    }
  }
  const FloatImage& image = atlas.pages[page].irradiance;
  for (const CoveredTexel& texel : rasterise_texels(corners, image.width, image.height).texels) {
    TexelPlace place = faces[texel.triangle];
    place.weights = texel.weights;
    out.push_back(place);
  }
}

}  // namespace

std::vector<Receiver> mapped_texel_receivers(const TracedScene& scene, const LightAtlas& atlas,
                                             uint64_t count, uint32_t seed) {
  const TracedTriangles traced = traced_triangles(scene);
  std::vector<TexelPlace> places;
  for (uint32_t page = 0; page < atlas.pages.size(); ++page) append_page(atlas, page, traced, places);
  if (count < places.size()) {
    // The first of a shuffled deck, in their old order.
    std::vector<std::pair<uint32_t, size_t>> deck;
    for (size_t i = 0; i < places.size(); ++i)
      deck.emplace_back(hash(hash(seed, 0x7478u), static_cast<uint32_t>(i)), i);
    std::nth_element(deck.begin(), deck.begin() + static_cast<std::ptrdiff_t>(count), deck.end());
    deck.resize(count);
    std::sort(deck.begin(), deck.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    std::vector<TexelPlace> chosen;
    for (const auto& [draw, i] : deck) chosen.push_back(places[i]);
    places = std::move(chosen);
  }
  std::vector<Receiver> receivers(places.size());
  parallel_for(
      places.size(),
      [&](size_t i) {
        const TexelPlace& place = places[i];
        const vec3& front = scene.triangles()[place.triangle].normal;
        Receiver& r = receivers[i];
        r.triangle = place.triangle;
        r.weights = place.weights;
        r.back = place.back;
        r.point = scene.point(r.triangle, r.weights);
        r.normal = place.back ? -front : front;
        r.origin = ray_origin(scene, r.triangle, r.point, r.normal);
        turn_to_shading_normal(scene, r);
      },
      256);
  std::erase_if(receivers, [&](const Receiver& r) { return scene.coverage(r.triangle, r.weights) <= 0; });
  return receivers;
}

}  // namespace goldthread
