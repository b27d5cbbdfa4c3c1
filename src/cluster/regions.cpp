#include "cluster/regions.h"

#include <algorithm>

#include "base/parallel.h"
#include "math/box.h"

namespace goldthread {
namespace {

struct Centre {
  vec3 position;
  uint32_t triangle;
};

int widest_axis(std::span<const Centre> centres) {
  Box box;
  for (const Centre& c : centres) box.add(c.position);
  const vec3 size = box.size();
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Orders centres so that halving the span again and again gives compact boxes. Ties go by triangle number.
void sort_into_boxes(std::span<Centre> centres, size_t region_triangles) {
  if (centres.size() <= region_triangles) return;
  const int axis = widest_axis(centres);
  const size_t half = centres.size() / 2;
  std::nth_element(centres.begin(), centres.begin() + ptrdiff_t(half), centres.end(),
                   [axis](const Centre& a, const Centre& b) {
                     return a.position[axis] != b.position[axis] ? a.position[axis] < b.position[axis]
                                                                 : a.triangle < b.triangle;
                   });
  parallel_invoke([&] { sort_into_boxes(centres.first(half), region_triangles); },
                  [&] { sort_into_boxes(centres.subspan(half), region_triangles); });
}

/// The spans at which sort_into_boxes() ended.
void list_regions(uint32_t begin, uint32_t end, uint32_t region_triangles,
                  std::vector<MergeForest::Region>& regions) {
  if (end - begin <= region_triangles) {
    regions.push_back({begin, end});
    return;
  }
  const uint32_t middle = begin + (end - begin) / 2;
  list_regions(begin, middle, region_triangles, regions);
  list_regions(middle, end, region_triangles, regions);
}

void cut_component(const TriangleMesh& mesh, uint32_t region_triangles, std::span<uint32_t> triangles,
                   std::span<const MergeForest::Region> regions) {
  std::vector<Centre> centres(triangles.size());
  parallel_for(
      triangles.size(),
      [&](size_t i) {
        const UVec3& t = mesh.triangles[triangles[i]];
        // A third of the sum, without the division: only the order counts. Halved first, so that it cannot
        // overflow.
        centres[i].position =
            0.25f * mesh.positions[t.x] + 0.25f * mesh.positions[t.y] + 0.25f * mesh.positions[t.z];
        centres[i].triangle = triangles[i];
      },
      8192);
  sort_into_boxes(centres, region_triangles);
  const uint32_t first = regions[0].begin;
  parallel_for(regions.size(), [&](size_t r) {
    const uint32_t begin = regions[r].begin - first, end = regions[r].end - first;
    for (uint32_t i = begin; i < end; ++i) triangles[i] = centres[i].triangle;
    std::sort(triangles.begin() + begin,
              triangles.begin() + end);  // the mesh's own order is the best known for caches
  });
}

}  // namespace

void make_regions(const TriangleMesh& mesh, const Components& components, uint32_t region_triangles,
                  MergeForest& forest) {
  region_triangles = std::max(region_triangles, 2u);
  std::vector<uint32_t> place(components.count + 1, 0);
  for (const uint32_t c : components.of_triangle) ++place[c + 1];
  for (uint32_t c = 0; c < components.count; ++c) place[c + 1] += place[c];
  forest.components.reserve(components.count);
  for (uint32_t c = 0; c < components.count; ++c) {
    const uint32_t first_region = uint32_t(forest.regions.size());
    list_regions(place[c], place[c + 1], region_triangles, forest.regions);
    forest.components.push_back({place[c], place[c + 1], first_region, uint32_t(forest.regions.size()), {}});
  }
  forest.triangle_at.resize(mesh.triangles.size());
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    forest.triangle_at[place[components.of_triangle[t]]++] = t;
  for (const auto& c : forest.components)
    if (c.region_end - c.first_region > 1)
      cut_component(mesh, region_triangles, std::span(forest.triangle_at).subspan(c.begin, c.end - c.begin),
                    std::span(forest.regions).subspan(c.first_region, c.region_end - c.first_region));
}

}  // namespace goldthread
