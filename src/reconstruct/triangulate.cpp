#include "reconstruct/triangulate.h"

#include <algorithm>

namespace goldthread {
namespace {

// The smallest angle's measure of a triangle: area over the longest side's square; 0 for a sliver.
float quality(const vec3& a, const vec3& b, const vec3& c) {
  const float longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
  return longest > 0 ? length(cross(b - a, c - a)) / longest : 0.0f;
}

// Swaps the diagonal of two triangles that share one when that raises the smaller quality. Returns whether
// any did.
bool flip_once(std::span<const vec3> p, std::vector<UVec3>& triangles, size_t first) {
  bool flipped = false;
  for (size_t i = first; i < triangles.size(); ++i) {
    for (size_t j = i + 1; j < triangles.size(); ++j) {
      for (int k = 0; k < 3; ++k) {
        UVec3 &s = triangles[i], &t = triangles[j];
        const uint32_t a = s[k], b = s[(k + 1) % 3], c = s[(k + 2) % 3];
        int opposite = -1;
        for (int m = 0; m < 3; ++m)
          if (t[m] == b && t[(m + 1) % 3] == a) opposite = (m + 2) % 3;
        if (opposite < 0) continue;
        const uint32_t d = t[opposite];
        const float now = std::min(quality(p[a], p[b], p[c]), quality(p[b], p[a], p[d]));
        const float then = std::min(quality(p[a], p[d], p[c]), quality(p[d], p[b], p[c]));
        if (then <= now * 1.0001f + 1e-7f) continue;
        s = {a, d, c};
        t = {d, b, c};
        flipped = true;
      }
    }
  }
  return flipped;
}

}  // namespace

void triangulate_face(std::span<const vec3> loop, std::vector<UVec3>& triangles) {
  const size_t first = triangles.size();
  std::vector<uint32_t> rest(loop.size());
  for (uint32_t i = 0; i < rest.size(); ++i) rest[i] = i;
  // Ears by best shape: a collinear corner is never an ear, but becomes the end of one.
  while (rest.size() > 3) {
    size_t best = 0;
    float most = -1;
    for (size_t i = 0; i < rest.size(); ++i) {
      const uint32_t a = rest[(i + rest.size() - 1) % rest.size()], b = rest[i],
                     c = rest[(i + 1) % rest.size()];
      const float q = quality(loop[a], loop[b], loop[c]);
      if (q > most) {
        most = q;
        best = i;
      }
    }
    triangles.push_back(
        {rest[(best + rest.size() - 1) % rest.size()], rest[best], rest[(best + 1) % rest.size()]});
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(best));
  }
  triangles.push_back({rest[0], rest[1], rest[2]});
  // Each flip raises a quality, so this ends; the bound is for rounding.
  for (size_t round = 0; round < 2 * loop.size() && flip_once(loop, triangles, first); ++round) {
  }
}

}  // namespace goldthread
