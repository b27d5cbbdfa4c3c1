#include "mesh/texel_raster.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace goldthread {
namespace {

constexpr uint32_t kNobody = 0xffffffffu, kMostTexels = 1u << 20;

/// Twice the area of a, b, p, positive where these run counter-clockwise in (u, v). Rounded the same for both
/// directions of an edge, so that no centre falls between two neighbours or to both.
double edge_side(const dvec2& a, const dvec2& b, const dvec2& p) {
  if (b.x < a.x || (b.x == a.x && b.y < a.y)) return -edge_side(b, a, p);
  return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Of an edge's two directions one: the triangle that runs along it so owns the centres that lie on it.
bool owns(const dvec2& along) {
  return along.y > 0 || (along.y == 0 && along.x < 0);
}

/// One triangle in units of texels.
struct Footprint {
  std::array<dvec2, 3> corners;
  double area = 0;  ///< twice, signed

  /// Whether it holds p, and where.
  bool holds(const dvec2& p, vec2& weights) const {
    const double turn = area > 0 ? 1 : -1;
    std::array<double, 3> sides{};  // sides[k] lies across from corner k
    for (size_t k = 0; k < 3; ++k) {
      const dvec2 &from = corners[(k + 1) % 3], &to = corners[(k + 2) % 3];
      sides[k] = turn * edge_side(from, to, p);
      if (sides[k] < 0 || (sides[k] == 0 && !owns(turn * (to - from)))) return false;
    }
    weights = vec2(sides[1] / std::abs(area), sides[2] / std::abs(area));
    return true;
  }
};

/// Texels first to last, whose centres lie within `from` to `to`; none where last < first.
struct Range {
  int64_t first = 0, last = -1;
};
Range centres_within(double from, double to, uint32_t count) {
  const double most = static_cast<double>(count);
  return {static_cast<int64_t>(std::ceil(std::clamp(from, 0.0, most) - 0.5)),
          std::min(static_cast<int64_t>(std::floor(std::clamp(to, 0.0, most) - 0.5)),
                   static_cast<int64_t>(count) - 1)};
}

/// What the triangles have laid claim to so far, by texel.
struct Canvas {
  uint32_t width, height;
  std::vector<uint32_t> owner;
  std::vector<vec2> weights;

  /// Takes what is free of the triangle's texels; false where some were taken.
  bool draw(const Footprint& shape, uint32_t triangle) {
    const auto& [a, b, c] = shape.corners;
    const Range rows = centres_within(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}), height);
    const Range columns = centres_within(std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), width);
    bool all = true;
    for (int64_t y = rows.first; y <= rows.last; ++y)
      for (int64_t x = columns.first; x <= columns.last; ++x) {
        vec2 at;
        if (!shape.holds(dvec2(x, y) + 0.5, at)) continue;
        const size_t texel = static_cast<size_t>(y) * width + static_cast<size_t>(x);
        const bool free = owner[texel] == kNobody;
        all = all && free;
        if (!free) continue;
        owner[texel] = triangle;
        weights[texel] = at;
      }
    return all;
  }
};

}  // namespace

TexelRaster rasterise_texels(std::span<const std::array<vec2, 3>> triangles, uint32_t width,
                             uint32_t height) {
  for (const uint32_t side : {width, height}) {
    GOLDTHREAD_CHECK_LT(0u, side);
    GOLDTHREAD_CHECK_LE(side, kMostTexels);
  }
  const size_t count = size_t{width} * height;
  Canvas canvas{width, height, std::vector<uint32_t>(count, kNobody), std::vector<vec2>(count)};
  TexelRaster raster;
  const dvec2 size(width, height);
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    Footprint shape;
    bool outside = false;
    for (size_t k = 0; k < 3; ++k) {
      const dvec2 corner = dvec2(triangles[t][k]) * size;
      shape.corners[k] = corner;
      outside = outside || std::min(corner.x, corner.y) < -0.5 || corner.x > size.x + 0.5 ||
                corner.y > size.y + 0.5;
    }
    shape.area = edge_side(shape.corners[0], shape.corners[1], shape.corners[2]);
    if (!std::isfinite(shape.area) || shape.area == 0) {
      ++raster.without_area;
      continue;
    }
    raster.outside += outside;
    raster.overlapping += !canvas.draw(shape, t);
  }
  for (size_t i = 0; i < count; ++i)
    if (canvas.owner[i] != kNobody)
      raster.texels.push_back({static_cast<uint32_t>(i % width), static_cast<uint32_t>(i / width),
                               canvas.owner[i], canvas.weights[i]});
  return raster;
}

}  // namespace goldthread
