#include "session/mesh_facts.h"

#include <algorithm>

namespace goldthread {
namespace {

constexpr float kThin = 20;

bool is_thin(const TriangleMesh& mesh, const UVec3& t) {
  const vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
  const float longest = std::max({length(b - a), length(c - b), length(a - c)});
  return longest * longest > kThin * 2 * length(area_vector(a, b, c));
}

void count_edges(const TriangleMesh& mesh, MeshFacts& facts) {
  std::vector<uint64_t> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const UVec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({t[k], t[(k + 1) % 3]});
      edges.push_back(uint64_t{low} << 32 | high);
    }
  }
  std::sort(edges.begin(), edges.end());
  for (size_t i = 0; i < edges.size();) {
    const size_t start = i;
    while (i < edges.size() && edges[i] == edges[start]) ++i;
    if (i - start == 1) ++facts.boundary_edges;
    if (i - start > 2) ++facts.non_manifold_edges;
  }
}

uint64_t count_duplicates(const TriangleMesh& mesh) {
  std::vector<std::array<uint32_t, 3>> corners;
  corners.reserve(mesh.triangles.size());
  for (const UVec3& t : mesh.triangles) {
    corners.push_back({t.x, t.y, t.z});
    std::sort(corners.back().begin(), corners.back().end());
  }
  std::sort(corners.begin(), corners.end());
  const auto end = std::unique(corners.begin(), corners.end());
  return static_cast<uint64_t>(corners.end() - end);
}

void count_shells(const Winding& winding, const std::vector<uint8_t>& rooms, bool two_sided,
                  MeshFacts& facts) {
  facts.shells = winding.shells.size();
  for (size_t s = 0; s < winding.shells.size(); ++s) {
    const Shell& shell = winding.shells[s];
    const bool inside_out = shell.faces_inwards() && !rooms[s];
    facts.closed_shells += shell.closed;
    if (two_sided) continue;
    facts.inside_out_shells += inside_out;
    facts.inconsistent_shells += shell.against > 0;
    facts.wrong_triangles += inside_out ? shell.triangles - shell.against : shell.against;
  }
}

}  // namespace

MeshFacts measure_mesh(const Scene& scene, uint32_t number, const ShellCheck& check) {
  const Mesh& mesh = scene.meshes[number];
  MeshFacts facts;
  bool two_sided = true;
  for (const Primitive& primitive : mesh.primitives) {
    facts.triangles += primitive.triangle_count();
    two_sided = two_sided && scene.materials[primitive.material].double_sided;
  }
  const JoinedMesh joined = join_primitives(mesh);
  facts.not_finite = joined.mesh.skipped.not_finite;
  facts.degenerate = joined.mesh.skipped.degenerate;
  for (const UVec3& t : joined.mesh.triangles) facts.thin += is_thin(joined.mesh, t);
  // Those wound alike, and those that face the other way.
  facts.duplicate = joined.mesh.skipped.duplicate + count_duplicates(joined.mesh);
  count_edges(joined.mesh, facts);
  const Winding winding = find_winding(joined.mesh, joined.twins);
  count_shells(winding, check.find_rooms(number, winding), two_sided, facts);
  return facts;
}

void add_facts(MeshFacts& sum, const MeshFacts& more, uint64_t copies) {
  for (uint64_t MeshFacts::*field :
       {&MeshFacts::triangles, &MeshFacts::not_finite, &MeshFacts::degenerate, &MeshFacts::thin,
        &MeshFacts::duplicate, &MeshFacts::boundary_edges, &MeshFacts::non_manifold_edges, &MeshFacts::shells,
        &MeshFacts::closed_shells, &MeshFacts::inside_out_shells, &MeshFacts::inconsistent_shells,
        &MeshFacts::wrong_triangles})
    sum.*field += copies * (more.*field);
}

}  // namespace goldthread
