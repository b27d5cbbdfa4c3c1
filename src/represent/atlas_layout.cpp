#include "represent/atlas_layout.h"

#include <algorithm>
#include <map>
#include <unordered_map>
#include <utility>

#include "base/check.h"

namespace goldthread {
namespace {

/// One side of a lit primitive: its charts are [first, first + charts->size()) of those that are packed.
struct Side {
  const LitPrimitive* lit = nullptr;
  const AtlasPart* part = nullptr;
  const std::vector<Chart>* charts = nullptr;
  bool back = false;
  size_t first = 0;
};

/// Takes a chart's triangles into a mesh that grows chart by chart.
class MeshBuilder {
 public:
  MeshBuilder(const Primitive& source, const Side& side, float page_size, float density)
      : source_(source), tree_(*side.part->tree), density_(density), page_size_(page_size) {
    mesh_.instance = side.lit->instance;
    mesh_.primitive = side.lit->primitive;
    mesh_.source_mesh = false;
    mesh_.back = side.back;
  }

  void add(const Chart& chart, const PackChart& shape, const Placement& placement,
           std::span<const std::pair<uint32_t, uint32_t>> twins) {
    vertices_.clear();
    for (size_t i = 0; i < chart.triangles.size(); ++i) {
      const uint32_t triangle = chart.triangles[i];
      add_face(tree_.mesh.source_triangles[triangle], 0, chart.faces[i], shape, placement);
      auto twin = std::lower_bound(twins.begin(), twins.end(), std::pair(triangle, 0u));
      for (; twin != twins.end() && twin->first == triangle; ++twin) {
        const DuplicateTriangle& copy = tree_.mesh.duplicates[twin->second];
        add_face(copy.source, copy.turn, chart.faces[i], shape, placement);
      }
    }
  }

  MappedMesh take(uint32_t page) {
    mesh_.page = page;
    return std::move(mesh_);
  }

 private:
  /// Corner k of the source triangle lies where corner (k + turn) % 3 of the chart's face does.
  void add_face(uint32_t triangle, uint32_t turn, const UVec3& face, const PackChart& shape,
                const Placement& placement) {
    UVec3 corners;
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t vertex = source_.indices[3 * size_t{triangle} + k];
      const uint32_t corner = face[static_cast<int>((k + turn) % 3)];
      const auto [known, is_new] =
          vertices_.try_emplace(uint64_t{vertex} << 32 | corner, static_cast<uint32_t>(mesh_.origins.size()));
      if (is_new) {
        mesh_.origins.push_back({triangle, vec2(k == 1 ? 1 : 0, k == 2 ? 1 : 0)});
        mesh_.coordinates.push_back(place(shape, placement, density_, shape.coordinates[corner]) /
                                    page_size_);
      }
      corners[static_cast<int>(k)] = known->second;
    }
    mesh_.faces.push_back(corners);
    mesh_.face_parents.push_back(triangle);
  }

  const Primitive& source_;
  const FaceClusterTree& tree_;
  float density_, page_size_;
  MappedMesh mesh_;
  std::unordered_map<uint64_t, uint32_t> vertices_;  ///< of one chart: by the source's vertex and the corner
};

/// By kept triangle, its duplicates' numbers.
std::vector<std::pair<uint32_t, uint32_t>> twins_of(const TriangleMesh& mesh) {
  std::vector<std::pair<uint32_t, uint32_t>> twins;
  for (uint32_t d = 0; d < mesh.duplicates.size(); ++d) twins.emplace_back(mesh.duplicates[d].twin, d);
  std::sort(twins.begin(), twins.end());
  return twins;
}

const Primitive& source_of(const Scene& scene, const LitMesh& mesh) {
  return scene.meshes[scene.instances[mesh.instance].mesh].primitives[mesh.primitive];
}

/// One, or two where viewers show the back: what is lit behind because light comes through it shows its front
/// alone.
int sides_of(const Scene& scene, const LitPrimitive& lit) {
  const bool both =
      !lit.irradiance_back.empty() && scene.materials[source_of(scene, lit).material].double_sided;
  return both ? 2 : 1;
}

}  // namespace

double surface_of(const FaceClusterTree& tree) {
  double sum = 0;
  for (const ClusterRef root : tree.roots) {
    if (!is_triangle(root)) {
      sum += static_cast<double>(tree.nodes[root].area);
      continue;
    }
    const UVec3& corners = tree.mesh.triangles[triangle_of(root)];
    const auto at = [&](int k) { return tree.mesh.positions[corners[k]]; };
    sum += static_cast<double>(length(area_vector(at(0), at(1), at(2))));
  }
  return sum;
}

std::optional<LightAtlas> lay_out_atlas(const Scene& scene, const Lighting& lighting,
                                        std::span<const AtlasPart> parts, const AtlasOptions& options,
                                        const CancelToken& cancel, AtlasStats& stats) {
  std::map<std::pair<uint32_t, uint32_t>, const AtlasPart*> part_of;
  for (const AtlasPart& part : parts) part_of[{part.instance, part.primitive}] = &part;
  double area = 0;
  for (const LitPrimitive& lit : lighting.primitives)
    if (const auto part = part_of.find({lit.instance, lit.primitive}); part != part_of.end()) {
      const auto scale = static_cast<double>(part->second->scale);
      area += surface_of(*part->second->tree) * scale * scale * sides_of(scene, lit);
    }
  std::map<const FaceClusterTree*, std::vector<Chart>> charts;
  std::vector<Side> sides;
  std::vector<PackChart> shapes;
  for (const LitPrimitive& lit : lighting.primitives) {
    const auto found = part_of.find({lit.instance, lit.primitive});
    GOLDTHREAD_CHECK_LT(0u, part_of.count({lit.instance, lit.primitive}));
    const AtlasPart& part = *found->second;
    const auto [known, is_new] = charts.try_emplace(part.tree);
    if (is_new) {
      ChartOptions limits = options.charts;
      limits.most_waste =
          std::min(limits.most_waste, static_cast<float>(area * kMostWaste) / (part.scale * part.scale));
      known->second = make_charts(*part.tree, limits, cancel, stats.charts);
    }
    if (cancel.cancelled()) return std::nullopt;
    for (int back = 0; back < sides_of(scene, lit); ++back) {
      sides.push_back({&lit, &part, &known->second, back == 1, shapes.size()});
      for (const Chart& chart : known->second) shapes.push_back({chart.faces, chart.coordinates, part.scale});
    }
  }
  stats.placed = shapes.size();
  const std::optional<Packing> packing = pack(shapes, options.pages, cancel);
  if (!packing) return std::nullopt;
  stats.use = packing->use;

  LightAtlas atlas;
  atlas.texels_per_metre = packing->texels_per_metre;
  atlas.pages.resize(packing->pages);
  std::map<const FaceClusterTree*, std::vector<std::pair<uint32_t, uint32_t>>> twins;
  for (const Side& side : sides) {
    const auto [own, is_new] = twins.try_emplace(side.part->tree);
    if (is_new) own->second = twins_of(side.part->tree->mesh);
    std::map<uint32_t, MeshBuilder> builders;  // by page
    for (size_t c = 0; c < side.charts->size(); ++c) {
      const Placement& placement = packing->placements[side.first + c];
      const auto [builder, added] =
          builders.try_emplace(placement.page, source_of(scene, *side.lit), side,
                               static_cast<float>(options.pages.page_size), packing->texels_per_metre);
      builder->second.add((*side.charts)[c], shapes[side.first + c], placement, own->second);
    }
    for (auto& [page, builder] : builders) atlas.meshes.push_back(builder.take(page));
  }
  return atlas;
}

}  // namespace goldthread
