// Small deterministic sequences: integer hashes and the R2 and R4 low-discrepancy sequences (Roberts 2018).
#pragma once
#include <cstdint>

namespace goldthread {

/// A well mixed hash of one or two words (the finaliser of Murmur3, applied twice).
inline uint32_t hash(uint32_t a, uint32_t b = 0) {
  uint32_t h = a * 0x9e3779b9u + b * 0x85ebca6bu + 0x27d4eb2fu;
  h ^= h >> 16;
  h *= 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  h ^= h >> 16;
  h += b;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 12;
  return h;
}

/// A hash as a number in [0, 1).
inline float unit_float(uint32_t h) {
  return static_cast<float>(h >> 8) * (1.0f / 16777216.0f);
}

/// Point i of Roberts' R2 sequence, shifted by a Cranley-Patterson rotation derived from `seed`. Fixed-point,
/// so that no precision is lost however large i is.
struct UnitSquarePoint {
  float u, v;
};
inline UnitSquarePoint r2_point(uint32_t i, uint32_t seed) {
  return {unit_float((i + 1) * 0xc13fa9a9u + hash(seed, 1)),
          unit_float((i + 1) * 0x91e10da5u + hash(seed, 2))};
}

/// The same in four dimensions, for two points that must not follow each other.
struct TwoSquarePoints {
  UnitSquarePoint first, second;
};
inline TwoSquarePoints r4_point(uint32_t i, uint32_t seed) {
  return {
      {unit_float((i + 1) * 0xdb4f0b91u + hash(seed, 1)), unit_float((i + 1) * 0xbbe05633u + hash(seed, 2))},
      {unit_float((i + 1) * 0xa0f2ec76u + hash(seed, 3)), unit_float((i + 1) * 0x89e18285u + hash(seed, 4))}};
}

}  // namespace goldthread
