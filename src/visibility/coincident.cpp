#include "visibility/coincident.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>

#include "base/parallel.h"
#include "base/rng.h"
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

// Mostly one, or one a side.
std::vector<uint32_t> unbeaten(std::span<const uint32_t> triangles, const PlaceClaims& claims) {
  std::vector<uint32_t> owners;
  for (const uint32_t t : triangles) {
    const auto beats_t = [&](uint32_t other) { return claims.beats(other, t); };
    if (std::any_of(owners.begin(), owners.end(), beats_t)) continue;
    std::erase_if(owners, [&](uint32_t other) { return claims.beats(t, other); });
    owners.push_back(t);
  }
  return owners;
}

struct Soup {
  std::span<const vec3> positions;
  std::span<const UVec3> triangles;
  const RayCaster& caster;
  const PlaceClaims& claims;
  std::vector<uint8_t> stands;  ///< whether a triangle contends, and not only behind copies of itself

  vec3 normal(uint32_t t) const {
    const UVec3& c = triangles[t];
    return normalize_or(area_vector(positions[c.x], positions[c.y], positions[c.z]), vec3(0));
  }
  /// The contenders at a point of `own`, itself first.
  std::vector<uint32_t> at_place(uint32_t own, vec2 weights) const {
    const UVec3& c = triangles[own];
    const vec3 p = (1 - weights.x - weights.y) * positions[c.x] + weights.x * positions[c.y] +
                   weights.y * positions[c.z];
    std::vector<uint32_t> here{own};
    caster.near(p, caster.epsilon(), [&](uint32_t other) {
      const UVec3& o = triangles[other];
      if (other != own && stands[other] != 0 &&
          lies_on_triangle(p, positions[o.x], positions[o.y], positions[o.z], caster.epsilon()) &&
          std::abs(dot(normal(own), normal(other))) > kSamePlane)
        here.push_back(other);
    });
    return here;
  }
  void look_at(uint32_t own, vec2 weights, std::vector<Pair>& found) const {
    if (stands[own] == 0) return;
    const std::vector<uint32_t> here = at_place(own, weights);
    if (here.size() == 1) return;
    const std::vector<uint32_t> owners = unbeaten(here, claims);
    const bool own_owns = std::find(owners.begin(), owners.end(), own) != owners.end();
    for (const uint32_t t : own_owns ? here : owners) {
      if (own_owns && claims.beats(own, t)) found.emplace_back(t, own);
      if (!own_owns && claims.beats(t, own)) found.emplace_back(own, t);
    }
  }
};

template <typename T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// All that `look(i, found)` finds for i in [0, count), sorted, each once.
template <typename Look>
std::vector<Pair> collect(size_t count, const CancelToken& cancel, const Look& look) {
  constexpr size_t kBlock = 4096;
  std::vector<Pair> pairs;
  std::mutex lock;
  parallel_for((count + kBlock - 1) / kBlock, [&](size_t block) {
    std::vector<Pair> found;
    for (size_t i = block * kBlock; i < std::min(count, (block + 1) * kBlock); ++i) {
      if (cancel.cancelled()) break;
      look(i, found);
    }
    if (found.empty()) return;
    sort_unique(found);
    const std::lock_guard guard(lock);
    pairs.insert(pairs.end(), found.begin(), found.end());
  });
  sort_unique(pairs);
  return pairs;
}

// The corners' bits in an order that does not depend on which of them comes first or which way they run.
std::array<uint32_t, 9> bits_of(std::span<const vec3> positions, const UVec3& triangle) {
  std::array<std::array<uint32_t, 3>, 3> corners;
  for (int k = 0; k < 3; ++k)
    for (int axis = 0; axis < 3; ++axis)  // -0 is 0
      corners[size_t(k)][size_t(axis)] = std::bit_cast<uint32_t>(positions[triangle[k]][axis] + 0.0f);
  std::sort(corners.begin(), corners.end());
  return std::bit_cast<std::array<uint32_t, 9>>(corners);
}

// Triangles with the same corners, settled among themselves: only those that nothing beats go on to stand.
// Else every copy would have to look at every other.
std::vector<Pair> settle_copies(Soup& soup, const CancelToken& cancel) {
  std::vector<std::pair<uint32_t, uint32_t>> keys(soup.triangles.size());
  parallel_for(
      keys.size(),
      [&](size_t t) {
        uint32_t key = 0;
        for (const uint32_t bits : bits_of(soup.positions, soup.triangles[t])) key = hash(key, bits);
        keys[t] = {key, static_cast<uint32_t>(t)};
      },
      4096);
  std::sort(keys.begin(), keys.end());
  std::vector<Pair> pairs;
  std::vector<uint32_t> copies;
  for (size_t i = 0; i < keys.size() && !cancel.cancelled();) {
    const uint32_t key = keys[i].first;
    const auto bits = bits_of(soup.positions, soup.triangles[keys[i].second]);
    // What has the same key by chance goes on to stand for itself.
    for (copies.clear(); i < keys.size() && keys[i].first == key; ++i) {
      const uint32_t t = keys[i].second;
      if (soup.stands[t] != 0 && bits_of(soup.positions, soup.triangles[t]) == bits) copies.push_back(t);
    }
    if (copies.size() < 2) continue;
    const std::vector<uint32_t> owners = unbeaten(copies, soup.claims);
    for (const uint32_t t : copies)
      for (const uint32_t owner : owners)
        if (soup.claims.beats(owner, t)) {
          pairs.emplace_back(t, owner);
          soup.stands[t] = 0;
        }
  }
  return pairs;
}

}  // namespace

std::vector<std::pair<uint32_t, uint32_t>> find_coincident(std::span<const vec3> positions,
                                                           std::span<const UVec3> triangles,
                                                           const RayCaster& caster, const PlaceClaims& claims,
                                                           const CancelToken& cancel) {
  Soup soup{positions, triangles, caster, claims, std::vector<uint8_t>(triangles.size())};
  parallel_for(
      triangles.size(), [&](size_t t) { soup.stands[t] = claims.contends(static_cast<uint32_t>(t)) ? 1 : 0; },
      4096);
  const std::vector<Pair> copies = settle_copies(soup, cancel);
  std::vector<Pair> pairs = collect(triangles.size(), cancel, [&](size_t i, std::vector<Pair>& found) {
    soup.look_at(static_cast<uint32_t>(i), kCentre, found);
  });
  // Those that have something in common with one may have so with more.
  std::vector<uint32_t> concerned;
  for (const auto& [a, b] : pairs) concerned.insert(concerned.end(), {a, b});
  sort_unique(concerned);
  std::vector<Pair> more = collect(concerned.size(), cancel, [&](size_t i, std::vector<Pair>& found) {
    for (const vec2& w : kPlaces) soup.look_at(concerned[i], w, found);
  });
  pairs.insert(pairs.end(), more.begin(), more.end());
  pairs.insert(pairs.end(), copies.begin(), copies.end());
  sort_unique(pairs);
  return pairs;
}

}  // namespace goldthread
