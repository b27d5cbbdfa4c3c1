// Welding by partitioned hashing: things are dealt into buckets by the high bits of their hash, and each
// bucket finds its duplicates alone, in index order. So the lowest index of equal positions (and of equal
// triangles) always stands for all of them, whatever the number of threads.
#include <bit>
#include <cstring>

#include "base/parallel.h"
#include "mesh/triangle_mesh.h"

namespace goldthread {
namespace {

constexpr uint32_t kNone = 0xffffffffu;
constexpr size_t kBlock = 32768;  ///< positions or triangles a task
constexpr uint32_t kBucketBits = 8, kBuckets = 1u << kBucketBits;

struct PositionBits {
  uint32_t x, y, z;
  bool operator==(const PositionBits&) const = default;
};

PositionBits bits_of(const vec3& p) {
  // Adding +0 turns -0 into +0 and changes nothing else.
  return {std::bit_cast<uint32_t>(p.x + 0.0f), std::bit_cast<uint32_t>(p.y + 0.0f),
          std::bit_cast<uint32_t>(p.z + 0.0f)};
}

uint32_t hash_of(const PositionBits& b) {
  uint64_t h = (uint64_t(b.x) << 32 | b.y) * 0x9e3779b97f4a7c15ull;
  h = (h ^ (h >> 29) ^ b.z) * 0xbf58476d1ce4e5b9ull;
  h = (h ^ (h >> 32)) * 0x94d049bb133111ebull;
  return uint32_t(h >> 32);
}

/// A triangle's corners turned so that the lowest comes first: the winding stays.
UVec3 turned(const UVec3& t) {
  if (t.x <= t.y && t.x <= t.z) return t;
  return t.y <= t.z ? UVec3(t.y, t.z, t.x) : UVec3(t.z, t.x, t.y);
}

size_t block_count(size_t n) {
  return (n + kBlock - 1) / kBlock;
}

/// Calls body(block, begin, end) over blocks of [0, n).
template <typename Body>
void for_blocks(size_t n, const Body& body) {
  parallel_for(block_count(n),
               [&](size_t block) { body(block, block * kBlock, std::min(n, (block + 1) * kBlock)); });
}

/// Index numbers dealt into buckets by hash, ascending within each.
struct Buckets {
  std::vector<uint32_t> begin;  ///< kBuckets + 1
  std::vector<uint32_t> members;
};

/// `hash(i)` is the hash of thing i.
template <typename Hash>
Buckets deal(size_t count, const Hash& hash) {
  const size_t blocks = block_count(count);
  std::vector<std::array<uint32_t, kBuckets>> place(blocks);
  const auto bucket_of = [&](size_t i) { return hash(i) >> (32 - kBucketBits); };
  for_blocks(count, [&](size_t block, size_t first, size_t last) {
    place[block].fill(0);
    for (size_t i = first; i < last; ++i) ++place[block][bucket_of(i)];
  });
  Buckets buckets{std::vector<uint32_t>(kBuckets + 1), std::vector<uint32_t>(count)};
  uint32_t total = 0;
  for (uint32_t b = 0; b < kBuckets; ++b) {
    buckets.begin[b] = total;
    for (auto& counts : place) total += std::exchange(counts[b], total);
  }
  buckets.begin[kBuckets] = total;
  for_blocks(count, [&](size_t block, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i) buckets.members[place[block][bucket_of(i)]++] = uint32_t(i);
  });
  return buckets;
}

/// The lowest index of what equals each of `count` things; `key(i)` has ==, and `hash` is of a key.
template <typename Key, typename Hash>
std::vector<uint32_t> find_equal(size_t count, const Key& key, const Hash& hash) {
  std::vector<uint32_t> first_equal(count);
  const Buckets buckets = deal(count, [&](size_t i) { return hash(key(i)); });
  parallel_for(kBuckets, [&](size_t b) {
    const std::span<const uint32_t> members =
        std::span(buckets.members).subspan(buckets.begin[b], buckets.begin[b + 1] - buckets.begin[b]);
    if (members.empty()) return;
    // Open addressing over one bucket.
    const size_t capacity = std::bit_ceil(members.size() * 2);
    std::vector<uint32_t> table(capacity, kNone);
    for (const uint32_t i : members) {
      const auto own = key(i);
      size_t slot = hash(own) & (capacity - 1);
      while (table[slot] != kNone && !(key(table[slot]) == own)) slot = (slot + 1) & (capacity - 1);
      if (table[slot] == kNone) table[slot] = i;
      first_equal[i] = table[slot];
    }
  });
  return first_equal;
}

enum class Soundness : uint8_t { kSound, kNotFinite, kDegenerate };

/// A triangle lower than the rounding of its own coordinates has no normal worth the name: it counts as a
/// line.
Soundness judge(const vec3& a, const vec3& b, const vec3& c) {
  if (!is_finite(a) || !is_finite(b) || !is_finite(c)) return Soundness::kNotFinite;
  const dvec3 u = dvec3(b) - dvec3(a), v = dvec3(c) - dvec3(a);
  const double longest = std::sqrt(std::max({dot(u, u), dot(v, v), dot(u - v, u - v)}));
  const vec3 magnitude = glm::max(glm::abs(a), glm::max(glm::abs(b), glm::abs(c)));
  const double rounding = 0x1p-23 * double(std::max({magnitude.x, magnitude.y, magnitude.z}));
  if (!(length(cross(u, v)) > rounding * longest)) return Soundness::kDegenerate;
  const vec3 area = area_vector(a, b, c);
  if (!is_finite(area)) return Soundness::kNotFinite;  // so large that its area overflows
  return area == vec3(0) ? Soundness::kDegenerate : Soundness::kSound;
}

std::vector<Soundness> judge_all(std::span<const vec3> positions, std::span<const uint32_t> indices,
                                 std::span<const uint32_t> first_equal) {
  std::vector<Soundness> result(indices.size() / 3);
  for_blocks(result.size(), [&](size_t, size_t first, size_t last) {
    for (size_t t = first; t < last; ++t) {
      const uint32_t i = first_equal[indices[3 * t]], j = first_equal[indices[3 * t + 1]],
                     k = first_equal[indices[3 * t + 2]];
      result[t] = judge(positions[i], positions[j], positions[k]);
    }
  });
  return result;
}

/// Copies the sound triangles, still over source positions' lowest equal index.
void keep_sound(TriangleMesh& mesh, std::span<const uint32_t> indices, std::span<const uint32_t> first_equal,
                std::span<const Soundness> soundness) {
  std::vector<size_t> place(block_count(soundness.size()));
  for_blocks(soundness.size(), [&](size_t block, size_t first, size_t last) {
    place[block] = size_t(std::count(soundness.begin() + ptrdiff_t(first),
                                     soundness.begin() + ptrdiff_t(last), Soundness::kSound));
  });
  size_t total = 0;
  for (size_t& p : place) total += std::exchange(p, total);
  mesh.triangles.resize(total);
  mesh.source_triangles.resize(total);
  for_blocks(soundness.size(), [&](size_t block, size_t first, size_t last) {
    size_t out = place[block];
    for (size_t t = first; t < last; ++t) {
      if (soundness[t] != Soundness::kSound) continue;
      for (int k = 0; k < 3; ++k) mesh.triangles[out][k] = first_equal[indices[3 * t + size_t(k)]];
      mesh.source_triangles[out++] = uint32_t(t);
    }
  });
}

/// Leaves out triangles that repeat an earlier one, corners and winding: real files hold whole walls twice,
/// and each copy would take the light that only one can get.
void drop_duplicates(TriangleMesh& mesh) {
  const std::vector<uint32_t> first = find_equal(
      mesh.triangles.size(), [&](size_t i) { return turned(mesh.triangles[i]); },
      [](const UVec3& t) {
        return hash_of(PositionBits{t.x, t.y, t.z});
      });
  std::vector<uint32_t> number(mesh.triangles.size());
  size_t kept = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const UVec3 corners = mesh.triangles[t];
    const uint32_t source = mesh.source_triangles[t];
    if (first[t] != t) {
      const uint32_t twin = number[first[t]];
      uint32_t turn = 0;
      while (mesh.triangles[twin][turn] != corners.x) ++turn;
      mesh.duplicates.push_back({source, twin, turn});
      continue;
    }
    number[t] = uint32_t(kept);
    mesh.triangles[kept] = corners;
    mesh.source_triangles[kept++] = source;
  }
  mesh.triangles.resize(kept);
  mesh.source_triangles.resize(kept);
  mesh.skipped.duplicate = mesh.duplicates.size();
}

/// Keeps the positions that triangles use, in their source order, and renumbers.
void keep_used_positions(TriangleMesh& mesh, std::span<const vec3> positions) {
  std::vector<uint32_t> number(positions.size(), 0);
  for (const UVec3& t : mesh.triangles) number[t.x] = number[t.y] = number[t.z] = 1;
  uint32_t total = 0;
  for (uint32_t& n : number) total += std::exchange(n, n ? total : kNone) != 0;
  mesh.positions.resize(total);
  for_blocks(positions.size(), [&](size_t, size_t first, size_t last) {
    for (size_t i = first; i < last; ++i)
      if (number[i] != kNone) mesh.positions[number[i]] = positions[i] + 0.0f;
  });
  for_blocks(mesh.triangles.size(), [&](size_t, size_t first, size_t last) {
    for (size_t t = first; t < last; ++t)
      for (int k = 0; k < 3; ++k) mesh.triangles[t][k] = number[mesh.triangles[t][k]];
  });
}

}  // namespace

TriangleMesh weld(std::span<const vec3> positions, std::span<const uint32_t> indices) {
  TriangleMesh mesh;
  const std::vector<uint32_t> first_equal = find_equal(
      positions.size(), [&](size_t i) { return bits_of(positions[i]); }, hash_of);
  const std::vector<Soundness> soundness = judge_all(positions, indices, first_equal);
  mesh.skipped.not_finite = uint64_t(std::count(soundness.begin(), soundness.end(), Soundness::kNotFinite));
  mesh.skipped.degenerate = uint64_t(std::count(soundness.begin(), soundness.end(), Soundness::kDegenerate));
  keep_sound(mesh, indices, first_equal, soundness);
  drop_duplicates(mesh);
  keep_used_positions(mesh, positions);
  return mesh;
}

}  // namespace goldthread
