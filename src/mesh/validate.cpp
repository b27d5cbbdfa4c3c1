#include "mesh/validate.h"

#include <algorithm>
#include <vector>

#include "base/check.h"
#include "mesh/dual_graph.h"

namespace goldthread {

void validate(const TriangleMesh& mesh) {
  GOLDTHREAD_CHECK_EQ(mesh.triangles.size(), mesh.source_triangles.size());
  std::vector<bool> used(mesh.positions.size(), false);
  for (const UVec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      GOLDTHREAD_CHECK_LT(size_t(t[k]), mesh.positions.size());
      used[t[k]] = true;
    }
    const vec3 area = area_vector(mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]);
    GOLDTHREAD_CHECK_EQ(is_finite(area) && area != vec3(0), true);
  }
  GOLDTHREAD_CHECK_EQ(std::count(used.begin(), used.end(), false), 0);
  std::vector<vec3> sorted = mesh.positions;
  for (const vec3& p : sorted) GOLDTHREAD_CHECK_EQ(is_finite(p), true);
  std::sort(sorted.begin(), sorted.end(), [](const vec3& a, const vec3& b) {
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
  });
  GOLDTHREAD_CHECK_EQ(std::adjacent_find(sorted.begin(), sorted.end()) == sorted.end(), true);
}

void validate_twins(const TriangleMesh& mesh, std::span<const uint32_t> twins) {
  GOLDTHREAD_CHECK_EQ(twins.size(), mesh.triangles.size() * 3);
  const auto vertex = [&](size_t h, size_t end) { return mesh.triangles[h / 3][int((h + end) % 3)]; };
  const auto to = [&](size_t h) { return mesh.triangles[h / 3][int((h % 3 + 1) % 3)]; };
  for (size_t h = 0; h < twins.size(); ++h) {
    const uint32_t twin = twins[h];
    if (twin == kNoTwin) continue;
    GOLDTHREAD_CHECK_LT(size_t(twin), twins.size());
    GOLDTHREAD_CHECK_EQ(size_t(twins[twin]), h);
    GOLDTHREAD_CHECK_EQ(twin / 3 != h / 3, true);
    const auto mine = std::minmax({vertex(h, 0), to(h)}), other = std::minmax({vertex(twin, 0), to(twin)});
    GOLDTHREAD_CHECK_EQ(mine.first, other.first);
    GOLDTHREAD_CHECK_EQ(mine.second, other.second);
  }
}

}  // namespace goldthread
