#include "represent/atlas_fill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "base/check.h"
#include "base/parallel.h"
#include "math/colour.h"
#include "mesh/texel_raster.h"
#include "represent/fill_empty.h"
#include "represent/fit_borders.h"
#include "represent/texel_sums.h"
#include "scene/lighting_lookup.h"

namespace goldthread {
namespace {

/// One side of a primitive's light, by source triangle.
class SideLight {
 public:
  SideLight(const Primitive& source, const LitPrimitive& lit, bool back)
      : source_(source), lit_(lit), values_(back ? lit.irradiance_back : lit.irradiance) {
    if (lit.source_mesh) return;
    first_.assign(source.triangle_count() + 1, 0);
    for (const uint32_t parent : lit.face_parents) ++first_[parent + 1];
    for (size_t t = 1; t < first_.size(); ++t) first_[t] += first_[t - 1];
    faces_.resize(lit.faces.size());
    std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
    for (uint32_t f = 0; f < lit.faces.size(); ++f) faces_[next[lit.face_parents[f]]++] = f;
  }

  /// Appends the light of a source triangle whose corners lie at `corners` on the page.
  void append(uint32_t triangle, const std::array<vec2, 3>& corners, std::vector<ValueTriangle>& out) const {
    if (lit_.source_mesh) {
      const uint32_t* index = &source_.indices[3 * size_t{triangle}];
      out.push_back({corners, {values_[index[0]], values_[index[1]], values_[index[2]]}});
      return;
    }
    for (uint32_t i = first_[triangle]; i < first_[triangle + 1]; ++i) {
      const UVec3& face = lit_.faces[faces_[i]];
      ValueTriangle piece;
      for (int k = 0; k < 3; ++k) {
        const vec2 weights = weights_in(triangle, face[k]);
        const auto at = static_cast<size_t>(k);
        piece.corners[at] =
            (1 - weights.x - weights.y) * corners[0] + weights.x * corners[1] + weights.y * corners[2];
        piece.values[at] = values_[face[k]];
      }
      out.push_back(piece);
    }
  }

 private:
  dvec3 position(uint32_t triangle, uint32_t corner) const {
    return dvec3(source_.positions[source_.indices[3 * size_t{triangle} + corner]]);
  }

  /// Of a light's vertex, where it lies in a source triangle. One between two triangles has its origin in
  /// either.
  vec2 weights_in(uint32_t triangle, uint32_t vertex) const {
    const VertexOrigin& origin = lit_.origins[vertex];
    if (origin.triangle == triangle) return origin.weights;
    const dvec3 a = position(triangle, 0), u = position(triangle, 1) - a, v = position(triangle, 2) - a;
    const dvec3 from = position(origin.triangle, 0);
    const dvec2 w(origin.weights);
    const dvec3 p =
        from + w.x * (position(origin.triangle, 1) - from) + w.y * (position(origin.triangle, 2) - from) - a;
    const dvec3 n = glm::cross(u, v);
    const double squared = glm::dot(n, n);
    if (!(squared > 0)) return vec2(0);
    return vec2(glm::dot(glm::cross(p, v), n) / squared, glm::dot(glm::cross(u, p), n) / squared);
  }

  const Primitive& source_;
  const LitPrimitive& lit_;
  const std::vector<vec3>& values_;
  std::vector<uint32_t> first_, faces_;  ///< of a refined mesh: faces of source triangle t
};

/// All that is needed of one page.
struct PageWork {
  std::vector<ValueTriangle> light;
  std::vector<std::array<vec2, 3>> corners;  ///< of each mapped face, 0..1 of the page
  std::vector<MappedPlace> faces;            ///< the same; weights unused
};

AtlasPage average(const TexelSums& sums) {
  const uint32_t size = sums.width;
  AtlasPage page;
  page.irradiance = {size, size, std::vector<vec3>(size_t{size} * size, vec3(0))};
  page.covered.assign(size_t{size} * size, 0);
  parallel_for(
      sums.area.size(),
      [&](size_t i) {
        if (!(sums.area[i] > 0)) return;
        page.irradiance.pixels[i] = vec3(sums.value[i] / sums.area[i]);
        page.covered[i] = 1;
      },
      4096);
  return page;
}

/// A texel is dark below this share of the page's mean.
constexpr float kDark = 1e-3f;

/// Which covered texels are dark.
std::vector<uint8_t> dark_texels(const AtlasPage& page) {
  double sum = 0, count = 0;
  for (size_t i = 0; i < page.covered.size(); ++i) {
    sum += page.covered[i] ? static_cast<double>(luminance(page.irradiance.pixels[i])) : 0.0;
    count += page.covered[i];
  }
  const float limit = count > 0 ? kDark * static_cast<float>(sum / count) : 0;
  std::vector<uint8_t> dark(page.covered.size());
  for (size_t i = 0; i < dark.size(); ++i)
    dark[i] = page.covered[i] && luminance(page.irradiance.pixels[i]) <= limit;
  return dark;
}

/// Texels in whose middle there is a dark place that nobody sees, and dark ones without a place in their
/// middle beside such: slivers on the edge of what is hidden.
std::vector<uint8_t> hidden_texels(const AtlasPage& page, const PageWork& work,
                                   const std::function<bool(const MappedPlace&)>& is_hidden) {
  const uint32_t width = page.irradiance.width, height = page.irradiance.height;
  std::vector<uint8_t> hidden(page.covered.size(), 0), open = dark_texels(page);
  const std::vector<CoveredTexel> texels = rasterise_texels(work.corners, width, height).texels;
  parallel_for(
      texels.size(),
      [&](size_t i) {
        const CoveredTexel& texel = texels[i];
        const size_t at = size_t{texel.y} * width + texel.x;
        if (!open[at]) return;
        MappedPlace place = work.faces[texel.triangle];
        place.weights = texel.weights;
        hidden[at] = is_hidden(place);
        open[at] = 0;
      },
      64);
  std::vector<size_t> slivers;
  for (uint32_t y = 1; y + 1 < height; ++y)
    for (uint32_t x = 1; x + 1 < width; ++x) {
      const size_t at = size_t{y} * width + x;
      if (open[at] && (hidden[at - 1] || hidden[at + 1] || hidden[at - width] || hidden[at + width]))
        slivers.push_back(at);
    }
  for (const size_t at : slivers) hidden[at] = 1;
  return hidden;
}

/// An edge of a face by where its ends lie, whichever way it runs.
using EdgeKey = std::array<float, 4>;

EdgeKey key_of(const vec2& a, const vec2& b) {
  const bool forward = std::pair(a.x, a.y) < std::pair(b.x, b.y);
  const vec2 &first = forward ? a : b, &second = forward ? b : a;
  return {first.x, first.y, second.x, second.y};
}

/// Places along the edges that one face alone has, two a texel.
std::vector<BorderSample> border_samples(const PageWork& work, const LightingLookup& light, uint32_t size,
                                         const std::vector<uint8_t>& hidden) {
  struct Edge {
    EdgeKey key;
    uint32_t face = 0;
    int corner = 0;
  };
  std::vector<Edge> edges;
  for (uint32_t f = 0; f < work.corners.size(); ++f)
    for (int k = 0; k < 3; ++k)
      edges.push_back(
          {key_of(work.corners[f][static_cast<size_t>(k)], work.corners[f][static_cast<size_t>(k + 1) % 3]),
           f, k});
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
    return std::tie(a.key, a.face, a.corner) < std::tie(b.key, b.face, b.corner);
  });
  std::vector<Edge> alone;
  for (size_t i = 0; i < edges.size();) {
    size_t end = i + 1;
    while (end < edges.size() && edges[end].key == edges[i].key) ++end;
    if (end == i + 1) alone.push_back(edges[i]);
    i = end;
  }
  const auto reads_hidden = [&](const vec2& at) {
    for (const float dy : {-0.5f, 0.5f})
      for (const float dx : {-0.5f, 0.5f}) {
        const auto x = static_cast<int64_t>(std::floor(at.x + dx)),
                   y = static_cast<int64_t>(std::floor(at.y + dy));
        if (x < 0 || y < 0 || x >= size || y >= size) continue;
        if (hidden[static_cast<size_t>(y) * size + static_cast<size_t>(x)]) return true;
      }
    return false;
  };
  std::vector<std::vector<BorderSample>> samples(alone.size());
  parallel_for(
      alone.size(),
      [&](size_t i) {
        const MappedPlace& face = work.faces[alone[i].face];
        const std::array<vec2, 3>& corners = work.corners[alone[i].face];
        const auto from = static_cast<size_t>(alone[i].corner), to = (from + 1) % 3;
        const float texels = glm::distance(corners[from], corners[to]) * static_cast<float>(size);
        const auto count = static_cast<uint32_t>(std::ceil(2 * texels));
        for (uint32_t s = 0; s < count; ++s) {
          const float share = (static_cast<float>(s) + 0.5f) / static_cast<float>(count);
          vec3 weights(0);
          weights[static_cast<int>(from)] = 1 - share;
          weights[static_cast<int>(to)] = share;
          const vec2 at = static_cast<float>(size) * ((1 - share) * corners[from] + share * corners[to]);
          if (reads_hidden(at)) continue;
          const std::optional<vec3> value =
              light.irradiance(face.mesh->instance, face.mesh->primitive, face.mesh->face_parents[face.face],
                               vec2(weights.y, weights.z), face.mesh->back);
          if (value) samples[i].push_back({at, *value});
        }
      },
      16);
  std::vector<BorderSample> all;
  for (const std::vector<BorderSample>& own : samples) all.insert(all.end(), own.begin(), own.end());
  return all;
}

AtlasPage paint(const PageWork& work, const LightingLookup& light, const AtlasFillOptions& options) {
  const TexelSums sums = sum_texels(work.light, options.size, options.size);
  AtlasPage page = average(sums);
  std::vector<uint8_t> hidden(page.covered.size(), 0);
  if (options.is_hidden) hidden = hidden_texels(page, work, options.is_hidden);
  std::vector<uint8_t> known = page.covered;
  for (size_t i = 0; i < known.size(); ++i) known[i] = known[i] && !hidden[i];
  fill_empty(page.irradiance, known, 1);  // what the fit begins with beyond the edges
  // A texel that is covered whole has its own light; of one that is not, what is beyond the edge is open.
  std::vector<float> trust(known.size());
  for (size_t i = 0; i < known.size(); ++i)
    trust[i] = known[i] ? static_cast<float>(std::min(1.0, sums.area[i])) : 0.0f;
  fit_borders(page.irradiance, trust, border_samples(work, light, options.size, hidden), known);
  fill_empty(page.irradiance, known, options.padding);
  return page;
}

}  // namespace

void fill_atlas(LightAtlas& atlas, const Scene& scene, const Lighting& lighting,
                const AtlasFillOptions& options) {
  std::map<std::pair<uint32_t, uint32_t>, const LitPrimitive*> lit_of;
  for (const LitPrimitive& lit : lighting.primitives) lit_of[{lit.instance, lit.primitive}] = &lit;
  std::vector<PageWork> work(atlas.pages.size());
  for (const MappedMesh& mesh : atlas.meshes) {
    GOLDTHREAD_CHECK_LT(0u, lit_of.count({mesh.instance, mesh.primitive}));
    const Primitive& source = scene.meshes[scene.instances[mesh.instance].mesh].primitives[mesh.primitive];
    const SideLight light(source, *lit_of[{mesh.instance, mesh.primitive}], mesh.back);
    PageWork& page = work[mesh.page];
    for (uint32_t f = 0; f < mesh.faces.size(); ++f) {
      std::array<vec2, 3> shares, corners;
      for (int k = 0; k < 3; ++k) {
        shares[static_cast<size_t>(k)] = mesh.coordinates[mesh.faces[f][k]];
        corners[static_cast<size_t>(k)] = shares[static_cast<size_t>(k)] * static_cast<float>(options.size);
      }
      page.corners.push_back(shares);
      page.faces.push_back({&mesh, f, vec2(0)});
      light.append(mesh.face_parents[f], corners, page.light);
    }
  }
  const LightingLookup light(scene, lighting);
  for (size_t page = 0; page < atlas.pages.size(); ++page) {
    atlas.pages[page] = paint(work[page], light, options);
    work[page] = {};
  }
}

}  // namespace goldthread
