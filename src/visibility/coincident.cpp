#include "visibility/coincident.h"

#include <algorithm>
#include <array>
#include <mutex>

#include "base/parallel.h"
#include "mesh/triangle_mesh.h"

namespace goldthread {
namespace {

// Cosine of the angle up to which planes count as one.
constexpr float kSamePlane = 0.999f;

// Weights of corners 1 and 2 at points that lie well inside: on an edge, all neighbours would be near.
constexpr vec2 kCentre(0.33f, 0.34f);
constexpr std::array<vec2, 9> kPlaces{vec2(0.15f, 0.17f), vec2(0.68f, 0.16f), vec2(0.16f, 0.69f),
                                      vec2(0.43f, 0.44f), vec2(0.11f, 0.45f), vec2(0.44f, 0.12f),
                                      vec2(0.04f, 0.05f), vec2(0.91f, 0.04f), vec2(0.05f, 0.91f)};

using Pair = std::pair<uint32_t, uint32_t>;

struct Soup {
  std::span<const vec3> positions;
  std::span<const UVec3> triangles;
  const RayCaster& caster;

  vec3 normal(uint32_t t) const {
    const UVec3& c = triangles[t];
    return normalize_or(area_vector(positions[c.x], positions[c.y], positions[c.z]), vec3(0));
  }
  void look_at(uint32_t own, vec2 weights, std::vector<Pair>& found) const {
    const UVec3& c = triangles[own];
    const vec3 p = (1 - weights.x - weights.y) * positions[c.x] + weights.x * positions[c.y] +
                   weights.y * positions[c.z];
    caster.near(p, caster.epsilon(), [&](uint32_t other) {
      const UVec3& o = triangles[other];
      if (other == own ||
          !lies_on_triangle(p, positions[o.x], positions[o.y], positions[o.z], caster.epsilon()))
        return;
      if (std::abs(dot(normal(own), normal(other))) > kSamePlane) found.push_back(std::minmax(own, other));
    });
  }
};

template <typename T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// All that `look(i, found)` finds for i in [0, count), sorted, each once.
template <typename Look>
std::vector<Pair> collect(size_t count, const Look& look) {
  constexpr size_t kBlock = 4096;
  std::vector<Pair> pairs;
  std::mutex lock;
  parallel_for((count + kBlock - 1) / kBlock, [&](size_t block) {
    std::vector<Pair> found;
    for (size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) look(i, found);
    if (found.empty()) return;
    const std::lock_guard guard(lock);
    pairs.insert(pairs.end(), found.begin(), found.end());
  });
  sort_unique(pairs);
  return pairs;
}

}  // namespace

std::vector<std::pair<uint32_t, uint32_t>> find_coincident(std::span<const vec3> positions,
                                                           std::span<const UVec3> triangles,
                                                           const RayCaster& caster) {
  const Soup soup{positions, triangles, caster};
  std::vector<Pair> pairs = collect(triangles.size(), [&](size_t i, std::vector<Pair>& found) {
    soup.look_at(static_cast<uint32_t>(i), kCentre, found);
  });
  // Those that have something in common with one may have so with more.
  std::vector<uint32_t> concerned;
  for (const auto& [a, b] : pairs) concerned.insert(concerned.end(), {a, b});
  sort_unique(concerned);
  std::vector<Pair> more = collect(concerned.size(), [&](size_t i, std::vector<Pair>& found) {
    for (const vec2& w : kPlaces) soup.look_at(concerned[i], w, found);
  });
  pairs.insert(pairs.end(), more.begin(), more.end());
  sort_unique(pairs);
  return pairs;
}

}  // namespace goldthread
