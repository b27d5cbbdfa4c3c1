// Random numbers that are spread more evenly than chance: Sobol's first two dimensions, Owen-scrambled by
// hashing (Owen 1997; Burley, Practical Hash-based Owen Scrambling, 2020), padded to as many dimensions as
// are asked for.
#pragma once
#include <cmath>
#include <cstdint>
#include <span>

#include "base/rng.h"
#include "math/vec.h"

namespace goldthread {

inline uint32_t reverse_bits(uint32_t x) {
  x = __builtin_bswap32(x);
  x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
  x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
  return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// A permutation in which every bit depends on lower ones only (Laine and Karras 2011, with Burley's
/// constants): between two reversals of the bits it is Owen's nested scrambling.
inline uint32_t scramble_upwards(uint32_t x, uint32_t seed) {
  x += seed;
  x ^= x * 0x6c50b47cu;
  x ^= x * 0xb82f1e52u;
  x ^= x * 0xc7afe638u;
  x ^= x * 0x8d22f6e6u;
  return x;
}

/// The index times Sobol's second generator matrix, Pascal's triangle modulo 2, with its bits reversed. By
/// Lucas' theorem binomial(j, i) is odd where i's bits are a subset of j's: bit i is the parity of the
/// index's bits j that contain i, a sum over supersets in five steps.
inline uint32_t pascal_product(uint32_t x) {
  x ^= (x >> 1) & 0x55555555u;
  x ^= (x >> 2) & 0x33333333u;
  x ^= (x >> 4) & 0x0f0f0f0fu;
  x ^= (x >> 8) & 0x00ff00ffu;
  return x ^ ((x >> 16) & 0x0000ffffu);
}

/// Two 32-bit fractions.
struct SobolPoint {
  uint32_t u, v;
};

/// Point `index` of a scrambled (0,2)-sequence: of its first 2^m points each elementary interval of area 2^-m
/// holds one. Each `seed`, itself a hash, is an independent scrambling, the order of points included.
inline SobolPoint sobol_point(uint32_t index, uint32_t seed) {
  const uint32_t second = hash(seed), third = hash(second);
  const uint32_t shuffled = reverse_bits(scramble_upwards(reverse_bits(index), seed));
  return {reverse_bits(scramble_upwards(shuffled, second)),
          reverse_bits(scramble_upwards(pascal_product(shuffled), third))};
}

/// Point `index` of a sequence that chance alone spreads.
inline SobolPoint hashed_point(uint32_t index, uint32_t seed) {
  const uint32_t u = hash(index, seed);
  return {u, hash(u)};
}

/// A fraction as a number in [0, 1).
inline double unit_double(uint32_t fraction) {
  return static_cast<double>(fraction) * 0x1p-32;
}

/// Maps the unit square evenly onto a triangle: weights of its corners 1 and 2.
inline vec2 to_triangle(double u, double v) {
  const float root = std::sqrt(static_cast<float>(u)), share = static_cast<float>(v);
  return {root * (1 - share), root * share};
}

/// Which of all paths: sample `index` of the randomisation `seed`.
struct PathSeed {
  uint32_t index = 0, seed = 0;
};

/// Dimensions beyond this many pairs are plain hashes: so deep in a path there is nothing left to spread
/// evenly.
constexpr uint32_t kSobolPairs = 12;

/// Two of a path's dimensions, of which it has as many pairs as are asked for.
inline SobolPoint path_point(PathSeed path, uint32_t pair) {
  const uint32_t pair_seed = hash(path.seed, pair);
  return pair <= kSobolPairs ? sobol_point(path.index, pair_seed) : hashed_point(path.index, pair_seed);
}

/// `path_point` of many paths at once; `points` is as long as `paths`.
void path_points(std::span<const PathSeed> paths, uint32_t pair, std::span<SobolPoint> points);

}  // namespace goldthread
