// Lock-free union-find (Anderson and Woll 1991, simplified): a root always hangs below a lower triangle
// number, so the final root of every component is its first triangle, whatever the order of the unions.
#include "mesh/components.h"

#include <atomic>

#include "base/parallel.h"
#include "mesh/dual_graph.h"

namespace goldthread {
namespace {

constexpr size_t kGrain = 16384;

using Parents = std::vector<uint32_t>;

uint32_t find_root(Parents& parents, uint32_t t) {
  for (;;) {
    std::atomic_ref parent(parents[t]);
    const uint32_t p = parent.load(std::memory_order_relaxed);
    if (p == t) return t;
    const uint32_t grand = std::atomic_ref(parents[p]).load(std::memory_order_relaxed);
    if (grand != p) {  // path halving; losing the race only loses the shortcut
      uint32_t expected = p;
      parent.compare_exchange_weak(expected, grand, std::memory_order_relaxed);
    }
    t = grand;
  }
}

void unite(Parents& parents, uint32_t a, uint32_t b) {
  for (;;) {
    a = find_root(parents, a);
    b = find_root(parents, b);
    if (a == b) return;
    if (a < b) std::swap(a, b);
    uint32_t expected = a;
    if (std::atomic_ref(parents[a]).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
  }
}

}  // namespace

Components find_components(std::span<const uint32_t> twins) {
  const size_t triangles = twins.size() / 3;
  Components components;
  Parents& parents = components.of_triangle;
  parents.resize(triangles);
  for (size_t t = 0; t < triangles; ++t) parents[t] = uint32_t(t);
  parallel_for(
      twins.size(),
      [&](size_t h) {
        if (twins[h] != kNoTwin && twins[h] > h) unite(parents, uint32_t(h / 3), twins[h] / 3);
      },
      kGrain);
  // Roots precede their members, so that one ascending pass can replace parents by numbers: a parent that was
  // already passed holds its component's number.
  for (size_t t = 0; t < triangles; ++t)
    parents[t] = parents[t] == t ? components.count++ : parents[parents[t]];
  return components;
}

}  // namespace goldthread
