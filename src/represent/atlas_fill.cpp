#include "represent/atlas_fill.h"

#include <map>
#include <utility>

#include "base/check.h"
#include "base/parallel.h"
#include "represent/fill_empty.h"
#include "represent/texel_sums.h"

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

AtlasPage paint(std::span<const ValueTriangle> triangles, uint32_t size, uint32_t padding) {
  const TexelSums sums = sum_texels(triangles, size, size);
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
  fill_empty(page.irradiance, page.covered, padding);
  return page;
}

}  // namespace

void fill_atlas(LightAtlas& atlas, const Scene& scene, const Lighting& lighting, uint32_t size,
                uint32_t padding) {
  std::map<std::pair<uint32_t, uint32_t>, const LitPrimitive*> lit_of;
  for (const LitPrimitive& lit : lighting.primitives) lit_of[{lit.instance, lit.primitive}] = &lit;
  std::vector<std::vector<ValueTriangle>> triangles(atlas.pages.size());
  for (const MappedMesh& mesh : atlas.meshes) {
    const auto found = lit_of.find({mesh.instance, mesh.primitive});
    GOLDTHREAD_CHECK_LT(0u, lit_of.count({mesh.instance, mesh.primitive}));
    const Primitive& source = scene.meshes[scene.instances[mesh.instance].mesh].primitives[mesh.primitive];
    const SideLight light(source, *found->second, mesh.back);
    for (size_t f = 0; f < mesh.faces.size(); ++f) {
      std::array<vec2, 3> corners;
      for (int k = 0; k < 3; ++k)
        corners[static_cast<size_t>(k)] = mesh.coordinates[mesh.faces[f][k]] * static_cast<float>(size);
      light.append(mesh.face_parents[f], corners, triangles[mesh.page]);
    }
  }
  for (size_t page = 0; page < atlas.pages.size(); ++page) {
    atlas.pages[page] = paint(triangles[page], size, padding);
    triangles[page] = {};
  }
}

}  // namespace goldthread
