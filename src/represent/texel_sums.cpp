#include "represent/texel_sums.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace goldthread {
namespace {

/// A convex polygon on the page: a triangle cut by at most four lines.
struct Piece {
  std::array<dvec2, 8> corners;
  size_t count = 0;

  void add(const dvec2& corner) { corners[count++] = corner; }
};

/// What lies at or above `at` of an axis (`sign` 1), or at or below (-1).
Piece cut(const Piece& piece, int axis, double at, double sign) {
  Piece kept;
  for (size_t i = 0; i < piece.count; ++i) {
    const dvec2 &from = piece.corners[i], &to = piece.corners[(i + 1) % piece.count];
    const double before = sign * (from[axis] - at), after = sign * (to[axis] - at);
    if (before >= 0) kept.add(from);
    if ((before > 0 && after < 0) || (before < 0 && after > 0)) {
      dvec2 crossing = from + (to - from) * (before / (before - after));
      crossing[axis] = at;
      kept.add(crossing);
    }
  }
  return kept;
}

double cross2(const dvec2& a, const dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

/// Signed area and centroid.
double measure(const Piece& piece, dvec2& centroid) {
  double twice = 0;
  dvec2 sum(0);
  const dvec2 origin = piece.corners[0];
  for (size_t i = 1; i + 1 < piece.count; ++i) {
    const dvec2 a = piece.corners[i] - origin, b = piece.corners[i + 1] - origin;
    const double part = cross2(a, b);
    twice += part;
    sum += part * (a + b);
  }
  if (twice != 0) centroid = origin + sum / (3 * twice);
  return twice / 2;
}

/// One triangle, ready to be summed up.
class Source {
 public:
  explicit Source(const ValueTriangle& triangle) : values_(triangle.values) {
    for (const vec2& corner : triangle.corners) whole_.add(dvec2(corner));
    u_ = whole_.corners[1] - whole_.corners[0];
    v_ = whole_.corners[2] - whole_.corners[0];
    twice_area_ = cross2(u_, v_);
  }

  const Piece& whole() const { return whole_; }
  bool has_area() const { return std::isfinite(twice_area_) && twice_area_ != 0; }

  /// Least and most of an axis.
  dvec2 range(int axis) const {
    const dvec2 &a = whole_.corners[0], &b = whole_.corners[1], &c = whole_.corners[2];
    return {std::min({a[axis], b[axis], c[axis]}), std::max({a[axis], b[axis], c[axis]})};
  }

  /// Kept within the triangle: in a needle rounding alone may leave it far behind.
  dvec3 value_at(const dvec2& p) const {
    const dvec2 w = p - whole_.corners[0];
    double second = std::clamp(cross2(w, v_) / twice_area_, 0.0, 1.0);
    double third = std::clamp(cross2(u_, w) / twice_area_, 0.0, 1.0);
    const double excess = std::max(1.0, second + third);
    second /= excess;
    third /= excess;
    return (1 - second - third) * dvec3(values_[0]) + second * dvec3(values_[1]) + third * dvec3(values_[2]);
  }

 private:
  std::array<vec3, 3> values_;
  Piece whole_;
  dvec2 u_{0}, v_{0};
  double twice_area_ = 0;
};

/// Texels [first, last] that a range of an axis reaches into, none where last < first.
struct Span {
  int64_t first = 0, last = -1;
};
Span texels_within(const dvec2& range, int64_t least, int64_t most) {
  const double low = std::max(range.x, static_cast<double>(least));
  const double high = std::min(range.y, static_cast<double>(most));
  if (!(low <= high)) return {};
  return {static_cast<int64_t>(std::floor(low)), std::min(static_cast<int64_t>(std::floor(high)), most - 1)};
}

void add_row(const Source& source, const Piece& slab, int64_t row, TexelSums& sums) {
  if (slab.count < 3) return;
  dvec2 range(slab.corners[0].x);
  for (size_t i = 1; i < slab.count; ++i)
    range = {std::min(range.x, slab.corners[i].x), std::max(range.y, slab.corners[i].x)};
  const Span columns = texels_within(range, 0, sums.width);
  Piece rest = slab;
  for (int64_t column = columns.first; column <= columns.last && rest.count >= 3; ++column) {
    const auto left = static_cast<double>(column);
    Piece here = rest;
    if (column == columns.first) here = rest = cut(rest, 0, left, 1);
    if (column < columns.last || range.y > left + 1) {
      here = cut(rest, 0, left + 1, -1);
      rest = cut(rest, 0, left + 1, 1);
    }
    if (here.count < 3) continue;
    dvec2 centroid(0);
    const double area = std::abs(measure(here, centroid));
    if (area == 0) continue;
    const size_t texel = static_cast<size_t>(row) * sums.width + static_cast<size_t>(column);
    sums.area[texel] += area;
    sums.value[texel] += area * source.value_at(centroid);
  }
}

/// Adds what of a triangle lies in rows [first, end).
void add_triangle(const ValueTriangle& triangle, int64_t first, int64_t end, TexelSums& sums) {
  const Source source(triangle);
  if (!source.has_area()) return;
  const dvec2 range = source.range(1);
  const Span rows = texels_within(range, first, end);
  if (rows.last < rows.first) return;
  Piece rest = cut(source.whole(), 1, static_cast<double>(rows.first), 1);
  for (int64_t row = rows.first; row <= rows.last && rest.count >= 3; ++row) {
    const double top = static_cast<double>(row) + 1;
    if (range.y <= top) {
      add_row(source, rest, row, sums);
      break;
    }
    add_row(source, cut(rest, 1, top, -1), row, sums);
    rest = cut(rest, 1, top, 1);
  }
}

/// Rows that one task sums up, triangle after triangle in their order, so that threads leave no trace.
constexpr uint32_t kBandRows = 16;

}  // namespace

TexelSums sum_texels(std::span<const ValueTriangle> triangles, uint32_t width, uint32_t height) {
  TexelSums sums{width, height, {}, {}};
  sums.area.assign(size_t{width} * height, 0);
  sums.value.assign(size_t{width} * height, dvec3(0));
  const size_t bands = (height + kBandRows - 1) / kBandRows;
  std::vector<std::vector<uint32_t>> members(bands);
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t].corners;
    const dvec2 range(std::min({a.y, b.y, c.y}), std::max({a.y, b.y, c.y}));
    const Span rows = texels_within(range, 0, height);
    for (int64_t band = rows.first / kBandRows; band <= rows.last / kBandRows && rows.first <= rows.last;
         ++band)
      members[static_cast<size_t>(band)].push_back(t);
  }
  parallel_for(bands, [&](size_t band) {
    const auto first = static_cast<int64_t>(band * kBandRows);
    const int64_t end = std::min<int64_t>(first + kBandRows, height);
    for (const uint32_t t : members[band]) add_triangle(triangles[t], first, end, sums);
  });
  return sums;
}

}  // namespace goldthread
