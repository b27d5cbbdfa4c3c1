#include "session/mapped_texels.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
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

/// The faces of one page: where they lie, in shares of it, and the traced triangle of each.
struct PageFaces {
  std::vector<std::array<vec2, 3>> corners;
  std::vector<TexelPlace> places;  ///< weights unused
};

PageFaces faces_of(const LightAtlas& atlas, uint32_t page, const TracedTriangles& traced) {
  PageFaces faces;
  for (const MappedMesh& mesh : atlas.meshes) {
    if (mesh.page != page) continue;
    const auto found = traced.find({mesh.instance, mesh.primitive});
    for (size_t f = 0; found != traced.end() && f < mesh.faces.size(); ++f) {
      const uint32_t triangle = found->second[mesh.face_parents[f]];
      if (triangle == Receiver::kNowhere) continue;
      const UVec3& face = mesh.faces[f];
      faces.corners.push_back({mesh.coordinates[face.x], mesh.coordinates[face.y], mesh.coordinates[face.z]});
      faces.places.push_back({triangle, vec2(0), mesh.back});
    }
  }
  return faces;
}

/// A texel by its page, column and row, and the place at its centre.
struct Texel {
  uint32_t page = 0, x = 0, y = 0;
  TexelPlace centre;
};

std::vector<Texel> covered_texels(const LightAtlas& atlas, const std::vector<PageFaces>& faces) {
  std::vector<Texel> texels;
  for (uint32_t page = 0; page < atlas.pages.size(); ++page) {
    const FloatImage& image = atlas.pages[page].irradiance;
    for (const CoveredTexel& texel :
         rasterise_texels(faces[page].corners, image.width, image.height).texels) {
      TexelPlace centre = faces[page].places[texel.triangle];
      centre.weights = texel.weights;
      texels.push_back({page, texel.x, texel.y, centre});
    }
  }
  return texels;
}

/// The first of a shuffled deck, in their old order.
std::vector<Texel> choose(std::vector<Texel> texels, uint64_t count, uint32_t seed) {
  if (count >= texels.size()) return texels;
  std::vector<std::pair<uint32_t, size_t>> deck;
  for (size_t i = 0; i < texels.size(); ++i)
    deck.emplace_back(hash(hash(seed, 0x7478u), static_cast<uint32_t>(i)), i);
  std::nth_element(deck.begin(), deck.begin() + static_cast<std::ptrdiff_t>(count), deck.end());
  deck.resize(count);
  std::sort(deck.begin(), deck.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<Texel> chosen;
  for (const auto& [draw, i] : deck) chosen.push_back(texels[i]);
  return chosen;
}

/// Barycentric weights of corners 1 and 2 at `at`, if that lies in the triangle.
std::optional<vec2> weights_at(const std::array<vec2, 3>& corners, const dvec2& at) {
  const dvec2 u = dvec2(corners[1]) - dvec2(corners[0]), v = dvec2(corners[2]) - dvec2(corners[0]);
  const dvec2 p = at - dvec2(corners[0]);
  const double area = u.x * v.y - u.y * v.x;
  const double second = (p.x * v.y - p.y * v.x) / area, third = (u.x * p.y - u.y * p.x) / area;
  if (!(second >= 0 && third >= 0 && second + third <= 1)) return std::nullopt;
  return vec2(second, third);
}

/// The places of one page's chosen texels, `own` their indices by row and column, into `out` by texel.
class PlaceSpread {
 public:
  PlaceSpread(uint32_t width, uint32_t height, std::map<std::pair<uint32_t, uint32_t>, size_t> own,
              std::vector<std::array<TexelPlace, kPlacesInTexel>>& out)
      : width_(width), height_(height), own_(std::move(own)), out_(out) {}

  void add(const std::array<vec2, 3>& corners, const TexelPlace& face) {
    const dvec2 size(width_, height_);
    const dvec2 low = size * dvec2(glm::min(glm::min(corners[0], corners[1]), corners[2]));
    const dvec2 high = size * dvec2(glm::max(glm::max(corners[0], corners[1]), corners[2]));
    const auto first_row = static_cast<uint32_t>(std::clamp(low.y, 0.0, size.y)),
               first_column = static_cast<uint32_t>(std::clamp(low.x, 0.0, size.x));
    // By rows, of which only those that hold a chosen texel are there to be walked.
    for (auto at = own_.lower_bound({first_row, first_column}); at != own_.end();) {
      const auto [row, column] = at->first;
      if (row > high.y) break;
      if (column < first_column) {
        at = own_.lower_bound({row, first_column});
      } else if (column > high.x) {
        at = own_.lower_bound({row + 1, first_column});
      } else {
        add_texel(corners, face, at->first, at->second);
        ++at;
      }
    }
  }

 private:
  static constexpr uint32_t kAside = 4;
  static_assert(kAside * kAside == kPlacesInTexel);

  void add_texel(const std::array<vec2, 3>& corners, const TexelPlace& face,
                 const std::pair<uint32_t, uint32_t>& texel, size_t index) {
    for (uint32_t k = 0; k < kPlacesInTexel; ++k) {
      TexelPlace& place = out_[index][k];
      if (place.triangle != Receiver::kNowhere) continue;
      const dvec2 at((texel.second + (k % kAside + 0.5) / kAside) / width_,
                     (texel.first + (k / kAside + 0.5) / kAside) / height_);
      if (const std::optional<vec2> weights = weights_at(corners, at)) {
        place = face;
        place.weights = *weights;
      }
    }
  }

  uint32_t width_, height_;
  std::map<std::pair<uint32_t, uint32_t>, size_t> own_;
  std::vector<std::array<TexelPlace, kPlacesInTexel>>& out_;
};

Receiver receiver_at(const TracedScene& scene, const TexelPlace& place) {
  const vec3& front = scene.triangles()[place.triangle].normal;
  Receiver r;
  r.triangle = place.triangle;
  r.weights = place.weights;
  r.back = place.back;
  r.point = scene.point(r.triangle, r.weights);
  r.normal = place.back ? -front : front;
  r.origin = ray_origin(scene, r.triangle, r.point, r.normal);
  turn_to_shading_normal(scene, r);
  return r;
}

}  // namespace

MappedTexels mapped_texels(const TracedScene& scene, const LightAtlas& atlas, uint64_t count, uint32_t seed) {
  const TracedTriangles traced = traced_triangles(scene);
  std::vector<PageFaces> faces;
  for (uint32_t page = 0; page < atlas.pages.size(); ++page) faces.push_back(faces_of(atlas, page, traced));
  std::vector<Texel> texels = choose(covered_texels(atlas, faces), count, seed);
  std::erase_if(texels, [&](const Texel& texel) {
    return scene.coverage(texel.centre.triangle, texel.centre.weights) <= 0;
  });

  TexelPlace nowhere;
  nowhere.triangle = Receiver::kNowhere;
  std::array<TexelPlace, kPlacesInTexel> none;
  none.fill(nowhere);
  std::vector<std::array<TexelPlace, kPlacesInTexel>> spread(texels.size(), none);
  for (uint32_t page = 0; page < atlas.pages.size(); ++page) {
    std::map<std::pair<uint32_t, uint32_t>, size_t> own;
    for (size_t i = 0; i < texels.size(); ++i)
      if (texels[i].page == page) own[{texels[i].y, texels[i].x}] = i;
    const FloatImage& image = atlas.pages[page].irradiance;
    PlaceSpread spreader(image.width, image.height, std::move(own), spread);
    for (size_t f = 0; f < faces[page].corners.size(); ++f)
      spreader.add(faces[page].corners[f], faces[page].places[f]);
  }

  MappedTexels out;
  out.centres.resize(texels.size());
  std::vector<std::vector<Receiver>> places(texels.size());
  parallel_for(
      texels.size(),
      [&](size_t i) {
        out.centres[i] = receiver_at(scene, texels[i].centre);
        for (const TexelPlace& place : spread[i]) {
          if (place.triangle == Receiver::kNowhere) continue;
          if (scene.coverage(place.triangle, place.weights) <= 0) continue;
          const Receiver r = receiver_at(scene, place);
          if (!is_buried(scene, r)) places[i].push_back(r);
        }
        if (places[i].empty()) places[i].push_back(out.centres[i]);
      },
      64);
  out.first.push_back(0);
  for (const std::vector<Receiver>& own : places) {
    out.places.insert(out.places.end(), own.begin(), own.end());
    out.first.push_back(out.places.size());
  }
  return out;
}

}  // namespace goldthread
