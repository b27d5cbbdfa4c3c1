// Rates and memory of the preprocess: weld, twins, face clusters, volume clusters, beside Embree's build of
// the same mesh and the thesis's 16-21 thousand triangles/s and 365-455 bytes/triangle (chapter 7, one core
// of 2002).
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <new>
#include <numeric>

#include "cluster/face_cluster_tree.h"
#include "cluster/volume_cluster_tree.h"
#include "mesh/dual_graph.h"
#include "visibility/ray_caster.h"

namespace {
std::atomic<size_t> heap_now{0}, heap_peak{0};

void note(size_t bytes) {
  const size_t now = heap_now.fetch_add(bytes, std::memory_order_relaxed) + bytes;
  size_t peak = heap_peak.load(std::memory_order_relaxed);
  while (now > peak && !heap_peak.compare_exchange_weak(peak, now, std::memory_order_relaxed)) {
  }
}
void* counted(void* p) {
  if (!p) throw std::bad_alloc();
  note(malloc_usable_size(p));
  return p;
}
void uncounted(void* p) {
  if (p) heap_now.fetch_sub(malloc_usable_size(p), std::memory_order_relaxed);
  std::free(p);
}
}  // namespace

// Every container of the build goes through these, so that its true peak is known and not that of the
// process.
void* operator new(size_t n) {
  return counted(std::malloc(n ? n : 1));
}
void* operator new(size_t n, std::align_val_t a) {
  const size_t align = size_t(a);
  return counted(std::aligned_alloc(align, (n + align - 1) / align * align));
}
void operator delete(void* p) noexcept {
  uncounted(p);
}
void operator delete(void* p, size_t) noexcept {
  uncounted(p);
}
void operator delete(void* p, std::align_val_t) noexcept {
  uncounted(p);
}
void operator delete(void* p, size_t, std::align_val_t) noexcept {
  uncounted(p);
}

namespace goldthread {
namespace {

struct Source {
  std::vector<vec3> positions;
  std::vector<uint32_t> indices;
  size_t triangles() const { return indices.size() / 3; }
};

/// A grid of `columns` by `rows` quads through `place(u, v)`.
template <typename Place>
void add_grid(Source& source, uint32_t columns, uint32_t rows, const Place& place) {
  const uint32_t base = uint32_t(source.positions.size()), row = columns + 1;
  for (uint32_t j = 0; j <= rows; ++j)
    for (uint32_t i = 0; i <= columns; ++i)
      source.positions.push_back(place(float(i) / float(columns), float(j) / float(rows)));
  for (uint32_t j = 0; j < rows; ++j)
    for (uint32_t i = 0; i < columns; ++i) {
      const uint32_t a = base + j * row + i;
      source.indices.insert(source.indices.end(), {a, a + 1, a + row + 1, a, a + row + 1, a + row});
    }
}

Source wavy(size_t triangles) {
  Source source;
  const uint32_t n = uint32_t(std::sqrt(double(triangles) / 2));
  add_grid(source, n, n,
           [](float u, float v) { return vec3(u, 0.05f * std::sin(20 * u) * std::cos(15 * v), v); });
  return source;
}

Source sphere(size_t triangles) {
  Source source;
  const uint32_t n = uint32_t(std::sqrt(double(triangles) / 4));
  add_grid(source, 2 * n, n, [](float u, float v) {
    const float theta = v * kPi, phi = u * 2 * kPi;
    return vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  });
  return source;
}

/// Rolled panels as a CAD tessellator writes them: long thin triangles, thousand by thousand unconnected.
Source panels(size_t triangles) {
  Source source;
  for (uint32_t p = 0; source.triangles() < triangles; ++p)
    add_grid(source, 500, 1, [p](float u, float v) {
      const float angle = 2 * u;
      return vec3(std::cos(angle) + 0.01f * float(p % 37), std::sin(angle) + 2 * float(p / 16),
                  3 * v + 4 * float(p % 16));
    });
  return source;
}

Source make(int64_t shape, int64_t triangles) {
  return shape == 0   ? wavy(size_t(triangles))
         : shape == 1 ? sphere(size_t(triangles))
                      : panels(size_t(triangles));
}

void start_heap() {
  heap_peak = heap_now.load();
}

void report(benchmark::State& state, size_t triangles, size_t heap_before) {
  state.SetItemsProcessed(state.iterations() * int64_t(triangles));
  state.counters["triangles"] = double(triangles);
  state.counters["peak_B/tri"] = double(heap_peak - heap_before) / double(triangles);
}

void bench_weld(benchmark::State& state) {
  const Source source = make(state.range(0), state.range(1));
  const size_t before = heap_now;
  start_heap();
  for (auto _ : state) benchmark::DoNotOptimize(weld(source.positions, source.indices));
  report(state, source.triangles(), before);
}

void bench_twins(benchmark::State& state) {
  const Source source = make(state.range(0), state.range(1));
  const TriangleMesh mesh = weld(source.positions, source.indices);
  const size_t before = heap_now;
  start_heap();
  for (auto _ : state) benchmark::DoNotOptimize(find_twins(mesh));
  report(state, source.triangles(), before);
}

std::vector<Box> items_of(const FaceClusterTree& tree) {
  std::vector<Box> items;
  for (const ClusterRef root : tree.roots) {
    Box& item = items.emplace_back();
    if (is_triangle(root)) {
      for (int k = 0; k < 3; ++k) item.add(tree.mesh.positions[tree.mesh.triangles[triangle_of(root)][k]]);
      continue;
    }
    item.add(tree.nodes[root].centre - tree.nodes[root].radius);
    item.add(tree.nodes[root].centre + tree.nodes[root].radius);
  }
  return items;
}

/// Everything between a triangle list and the hierarchy.
void bench_preprocess(benchmark::State& state) {
  const Source source = make(state.range(0), state.range(1));
  const size_t before = heap_now;
  double tree_bytes = 0;
  start_heap();
  for (auto _ : state) {
    const FaceClusterTree tree = build_face_clusters(weld(source.positions, source.indices));
    const VolumeClusterTree volumes = build_volume_clusters(items_of(tree));
    tree_bytes = double(heap_now - before);
    if (tree.mesh.triangles.empty()) state.SkipWithError("no triangles were left");
  }
  report(state, source.triangles(), before);
  state.counters["tree_B/tri"] = tree_bytes / double(source.triangles());
}

void bench_face_clusters(benchmark::State& state) {
  const Source source = make(state.range(0), state.range(1));
  const size_t before = heap_now;
  start_heap();
  for (auto _ : state) {
    state.PauseTiming();
    TriangleMesh mesh = weld(source.positions, source.indices);
    start_heap();
    state.ResumeTiming();
    benchmark::DoNotOptimize(build_face_clusters(std::move(mesh)));
  }
  report(state, source.triangles(), before);
}

void bench_volume_clusters(benchmark::State& state) {
  std::vector<Box> items(size_t(state.range(0)));
  uint32_t random = 1;
  const auto next = [&random] { return float((random = random * 1664525 + 1013904223) >> 8) * 0x1p-24f; };
  for (Box& item : items) {
    const vec3 p(next(), next(), next());
    item.add(p);
    item.add(p + 0.01f * vec3(next(), next(), next()));
  }
  const size_t before = heap_now;
  start_heap();
  for (auto _ : state) benchmark::DoNotOptimize(build_volume_clusters(items));
  report(state, items.size(), before);
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Clusters and Embree's build of the same mesh by turns, so that a busy machine slows both: the best of
/// each. The time shown is that of the clusters.
void bench_against_embree(benchmark::State& state) {
  const Source source = make(state.range(0), state.range(1));
  const TriangleMesh mesh = weld(source.positions, source.indices);
  double clusters = 1e30, embree = 1e30;
  for (auto _ : state) {
    TriangleMesh copy = mesh;
    auto begin = std::chrono::steady_clock::now();
    const FaceClusterTree tree = build_face_clusters(std::move(copy));
    benchmark::DoNotOptimize(build_volume_clusters(items_of(tree)));
    const double seconds = seconds_since(begin);
    state.SetIterationTime(seconds);
    clusters = std::min(clusters, seconds);
    begin = std::chrono::steady_clock::now();
    const RayCaster caster(mesh.positions, mesh.triangles);
    embree = std::min(embree, seconds_since(begin));
    state.counters["embree_B/tri"] = double(caster.memory_bytes()) / double(mesh.triangles.size());
  }
  state.SetItemsProcessed(state.iterations() * int64_t(mesh.triangles.size()));
  state.counters["best_tri/s"] = double(mesh.triangles.size()) / clusters;
  state.counters["x_embree"] = clusters / embree;
}

void shapes_and_sizes(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"shape", "triangles"})->Unit(benchmark::kMillisecond);
  for (int64_t shape = 0; shape < 3; ++shape)
    for (const int64_t triangles : {62000, 250000, 500000, 2000000}) bench->Args({shape, triangles});
}

BENCHMARK(bench_weld)->Apply(shapes_and_sizes)->UseRealTime();
BENCHMARK(bench_twins)->Apply(shapes_and_sizes)->UseRealTime();
BENCHMARK(bench_face_clusters)->Apply(shapes_and_sizes)->UseRealTime();
BENCHMARK(bench_preprocess)->Apply(shapes_and_sizes)->UseRealTime();
BENCHMARK(bench_against_embree)->Apply(shapes_and_sizes)->UseManualTime();
BENCHMARK(bench_volume_clusters)
    ->Arg(1000)
    ->Arg(100000)
    ->Arg(500000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace goldthread

BENCHMARK_MAIN();
