// Half-edges are gathered under the lower of their two vertices (counting sort), sorted there by the other
// vertex, and paired within each run. Vertices are independent of each other, so this is parallel throughout.
#include "mesh/dual_graph.h"

#include <atomic>

#include "base/parallel.h"

namespace goldthread {
namespace {

constexpr size_t kGrain = 16384;

struct EdgeEnds {
  uint32_t low, high;
  bool forward;  ///< the half-edge runs from low to high
};

EdgeEnds ends_of(const TriangleMesh& mesh, uint32_t half_edge) {
  const UVec3& t = mesh.triangles[half_edge / 3];
  const uint32_t k = half_edge % 3, from = t[int(k)], to = t[int(k == 2 ? 0 : k + 1)];
  return from < to ? EdgeEnds{from, to, true} : EdgeEnds{to, from, false};
}

/// A half-edge as seen from its lower vertex; ordered by the other vertex, then by number.
struct Spoke {
  uint32_t high;
  uint32_t half_edge;
  bool forward;
  bool operator<(const Spoke& o) const { return high != o.high ? high < o.high : half_edge < o.half_edge; }
};

void pair(std::vector<uint32_t>& twins, uint32_t a, uint32_t b) {
  twins[a] = b;
  twins[b] = a;
}

/// Pairs the half-edges of one edge as find_twins() promises.
void pair_run(std::span<Spoke> run, std::vector<uint32_t>& twins) {
  if (run.size() == 2) return pair(twins, run[0].half_edge, run[1].half_edge);
  // Stable: both directions stay in triangle order.
  const auto middle = std::stable_partition(run.begin(), run.end(), [](const Spoke& s) { return s.forward; });
  const size_t forward = size_t(middle - run.begin()), backward = run.size() - forward;
  const size_t opposite = std::min(forward, backward);
  for (size_t i = 0; i < opposite; ++i) pair(twins, run[i].half_edge, run[forward + i].half_edge);
  const size_t begin = forward > backward ? opposite : forward + opposite;
  const size_t end = forward > backward ? forward : run.size();
  for (size_t i = begin; i + 1 < end; i += 2) pair(twins, run[i].half_edge, run[i + 1].half_edge);
}

void sort_spokes(std::vector<Spoke>& spokes) {
  if (spokes.size() > 24) return std::sort(spokes.begin(), spokes.end());
  for (size_t i = 1; i < spokes.size(); ++i)
    for (size_t j = i; j > 0 && spokes[j] < spokes[j - 1]; --j) std::swap(spokes[j], spokes[j - 1]);
}

void pair_vertex(const TriangleMesh& mesh, std::span<const uint32_t> half_edges, std::vector<Spoke>& spokes,
                 std::vector<uint32_t>& twins) {
  spokes.clear();
  for (const uint32_t h : half_edges) {
    const EdgeEnds ends = ends_of(mesh, h);
    spokes.push_back({ends.high, h, ends.forward});
  }
  sort_spokes(spokes);
  for (size_t begin = 0; begin < spokes.size();) {
    size_t end = begin + 1;
    while (end < spokes.size() && spokes[end].high == spokes[begin].high) ++end;
    if (end - begin > 1) pair_run(std::span(spokes).subspan(begin, end - begin), twins);
    begin = end;
  }
}

}  // namespace

std::vector<uint32_t> find_twins(const TriangleMesh& mesh) {
  const size_t half_edges = mesh.triangles.size() * 3, vertices = mesh.positions.size();
  // place[v + 2] counts, then place[v + 1] is where v's next half-edge goes: after filling, v's begin at
  // place[v].
  std::vector<uint32_t> place(vertices + 2, 0);
  const auto add = [](uint32_t& value) {
    return std::atomic_ref(value).fetch_add(1, std::memory_order_relaxed);
  };
  const auto for_half_edges = [&](const auto& body) {  // body(half-edge, its lower vertex)
    parallel_for(
        mesh.triangles.size(),
        [&](size_t t) {
          const UVec3& v = mesh.triangles[t];
          body(3 * t, std::min(v.x, v.y));
          body(3 * t + 1, std::min(v.y, v.z));
          body(3 * t + 2, std::min(v.z, v.x));
        },
        kGrain);
  };
  for_half_edges([&](size_t, uint32_t low) { add(place[low + 2]); });
  for (size_t v = 2; v < place.size(); ++v) place[v] += place[v - 1];
  std::vector<uint32_t> by_vertex(half_edges);
  for_half_edges([&](size_t h, uint32_t low) { by_vertex[add(place[low + 1])] = uint32_t(h); });
  std::vector<uint32_t> twins(half_edges, kNoTwin);
  parallel_ranges(
      vertices,
      [&](size_t begin, size_t end) {
        std::vector<Spoke> spokes;
        for (size_t v = begin; v != end; ++v)
          pair_vertex(mesh, std::span(by_vertex).subspan(place[v], place[v + 1] - place[v]), spokes, twins);
      },
      kGrain / 4);
  return twins;
}

}  // namespace goldthread
