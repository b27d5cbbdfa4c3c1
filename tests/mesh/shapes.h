// Meshes that are easy to reason about.
#pragma once
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "mesh/triangle_mesh.h"

namespace goldthread::shapes {

struct Soup {
  std::vector<vec3> positions;
  std::vector<uint32_t> indices;

  void triangle(uint32_t a, uint32_t b, uint32_t c) { indices.insert(indices.end(), {a, b, c}); }
  void quad(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    triangle(a, b, c);
    triangle(a, c, d);
  }
  TriangleMesh weld() const { return goldthread::weld(positions, indices); }
};

/// n by n quads over [0,1]^2, z by `height(x, y)`.
template <typename Height>
Soup grid(uint32_t n, const Height& height) {
  Soup soup;
  for (uint32_t j = 0; j <= n; ++j)
    for (uint32_t i = 0; i <= n; ++i) {
      const float x = float(i) / float(n), y = float(j) / float(n);
      soup.positions.push_back({x, y, height(x, y)});
    }
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i;
      soup.quad(a, a + 1, a + n + 2, a + n + 1);
    }
  return soup;
}
inline Soup flat_grid(uint32_t n) {
  return grid(n, [](float, float) { return 0.0f; });
}
inline Soup wavy_grid(uint32_t n) {
  return grid(n, [](float x, float y) { return 0.1f * std::sin(9 * x) * std::cos(7 * y); });
}

/// The unit cube, outward, each face n by n quads with its own vertices, as an exporter would write it.
inline Soup cube(uint32_t n = 1) {
  Soup soup;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
    const bool far = face % 2;
    const uint32_t base = uint32_t(soup.positions.size());
    for (uint32_t j = 0; j <= n; ++j)
      for (uint32_t i = 0; i <= n; ++i) {
        vec3 p(0);
        p[axis] = far ? 1.0f : 0.0f;
        p[u] = float(i) / float(n);
        p[v] = float(j) / float(n);
        soup.positions.push_back(p);
      }
    for (uint32_t j = 0; j < n; ++j)
      for (uint32_t i = 0; i < n; ++i) {
        const uint32_t a = base + j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
        far ? soup.quad(a, b, c, d) : soup.quad(a, d, c, b);
      }
  }
  return soup;
}

/// Latitude and longitude, poles closed by triangles.
inline Soup sphere(uint32_t rings) {
  Soup soup;
  const uint32_t around = 2 * rings;
  for (uint32_t j = 0; j <= rings; ++j)
    for (uint32_t i = 0; i < around; ++i) {
      const float theta = kPi * float(j) / float(rings), phi = 2 * kPi * float(i) / float(around);
      const float s = j == 0 || j == rings ? 0 : std::sin(theta);
      soup.positions.push_back({s * std::cos(phi), s * std::sin(phi), std::cos(theta)});
    }
  for (uint32_t j = 0; j < rings; ++j)
    for (uint32_t i = 0; i < around; ++i) {
      const uint32_t next = (i + 1) % around;
      soup.quad(j * around + i, (j + 1) * around + i, (j + 1) * around + next, j * around + next);
    }
  return soup;
}

/// A ribbon of n triangles along x.
inline Soup strip(uint32_t n) {
  Soup soup;
  for (uint32_t i = 0; i < n + 2; ++i) soup.positions.push_back({float(i / 2), float(i % 2), 0});
  for (uint32_t i = 0; i < n; ++i) i % 2 ? soup.triangle(i + 1, i, i + 2) : soup.triangle(i, i + 1, i + 2);
  return soup;
}

/// n triangles round one vertex.
inline Soup fan(uint32_t n) {
  Soup soup;
  soup.positions.push_back(vec3(0));
  for (uint32_t i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * i / n;
    soup.positions.push_back({float(1000 * std::cos(angle)), float(1000 * std::sin(angle)), 0});
  }
  for (uint32_t i = 0; i < n; ++i) soup.triangle(0, i + 1, (i + 1) % n + 1);
  return soup;
}

/// A flat n by n grid, every other quad of which carries a tall pyramid: a plate that ends up with n^2 / 4
/// neighbours.
inline Soup spiked_plate(uint32_t n) {
  Soup soup = flat_grid(n);
  soup.indices.clear();
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      if (i % 2 == 0 || j % 2 == 0) {
        soup.quad(a, b, c, d);
        continue;
      }
      const uint32_t tip = uint32_t(soup.positions.size());
      soup.positions.push_back(0.5f * (soup.positions[a] + soup.positions[c]) + vec3(0, 0, 0.3f));
      soup.triangle(a, b, tip);
      soup.triangle(b, c, tip);
      soup.triangle(c, d, tip);
      soup.triangle(d, a, tip);
    }
  return soup;
}

/// A band of n quads with half a twist: no consistent winding exists.
inline Soup moebius(uint32_t n) {
  Soup soup;
  for (uint32_t i = 0; i < n; ++i) {
    const float angle = 2 * kPi * float(i) / float(n);
    const vec3 out(std::cos(angle), std::sin(angle), 0);
    const vec3 across = std::cos(angle / 2) * out + vec3(0, 0, std::sin(angle / 2));
    soup.positions.push_back(out - 0.3f * across);
    soup.positions.push_back(out + 0.3f * across);
  }
  for (uint32_t i = 0; i + 1 < n; ++i) soup.quad(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2);
  soup.quad(2 * n - 2, 2 * n - 1, 0, 1);
  return soup;
}

/// Any triangles at all: shared corners, duplicates, degenerates and numbers that are none.
inline Soup random_soup(uint32_t seed, uint32_t triangles, uint32_t vertices) {
  std::mt19937 random(seed);
  Soup soup;
  const float specials[] = {std::nanf(""), INFINITY, -0.0f, 0.0f, 1e-30f, 1e30f};
  for (uint32_t i = 0; i < vertices; ++i) {
    vec3 p;
    for (int k = 0; k < 3; ++k)
      p[k] = random() % 64 == 0 ? specials[random() % 6] : float(random() % 8) * 0.37f - 1;
    soup.positions.push_back(p);
  }
  for (uint32_t i = 0; i < triangles; ++i) {
    soup.triangle(uint32_t(random() % vertices), uint32_t(random() % vertices),
                  uint32_t(random() % vertices));
    if (random() % 8 == 0) {
      const size_t n = soup.indices.size();
      soup.triangle(soup.indices[n - 3], soup.indices[n - 1], soup.indices[n - 2]);
    }
  }
  return soup;
}

}  // namespace goldthread::shapes
