#include "represent/atlas/grid_image.h"

#include "mesh/min_rectangle.h"

namespace goldthread {
namespace {

constexpr int kGridBits = 23;

/// The power of two of which `extent` is at most 2^kGridBits. Sides of sound triangles are between about
/// 1e-23 and 1e20 (their areas are floats), so that this is a float and so are its multiples.
double step_for(double extent) {
  int exponent = 0;
  std::frexp(extent, &exponent);  // extent <= 2^exponent
  return std::ldexp(1.0, exponent - kGridBits);
}

/// Unit direction of the longer side of the image's least rectangle.
dvec2 long_side(const PlaneImage& image, const dvec2& low, double extent) {
  std::vector<vec2> points(image.size());
  for (size_t i = 0; i < points.size(); ++i) points[i] = vec2((image[i] - low) / extent);
  return normalize(dvec2(min_rectangle(points).u));
}

struct Extent {
  dvec2 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
  explicit Extent(const PlaneImage& image) {
    for (const dvec2& p : image) low = glm::min(low, p), high = glm::max(high, p);
  }
  double longer() const { return std::max(high.x - low.x, high.y - low.y); }
};

}  // namespace

vec2 GridImage::coordinates(size_t corner) const {
  return {float(points[corner].x * step), float(points[corner].y * step)};
}

PlaneImage GridImage::plane_image() const {
  PlaneImage image(points.size());
  for (size_t i = 0; i < image.size(); ++i) image[i] = step * dvec2(points[i]);
  return image;
}

GridImage lay_on_grid(const PlaneImage& image) {
  const Extent before(image);
  const dvec2 u = long_side(image, before.low, before.longer()), v(-u.y, u.x);
  PlaneImage turned(image.size());
  for (size_t i = 0; i < image.size(); ++i) {
    const dvec2 p = image[i] - before.low;
    turned[i] = {dot(u, p), dot(v, p)};
  }
  const Extent after(turned);
  GridImage grid{std::vector<GridPoint>(image.size()), step_for(after.longer())};
  for (size_t i = 0; i < image.size(); ++i)
    grid.points[i] = GridPoint(glm::round((turned[i] - after.low) / grid.step));
  return grid;
}

GridImage lay_on_grid(const dvec3& a, const dvec3& b, const dvec3& c) {
  const dvec3 corners[3] = {a, b, c};
  int from = 0;  // of the longest side
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    const double side = length(corners[(k + 1) % 3] - corners[k]);
    if (side > longest) longest = side, from = k;
  }
  const dvec3 side = corners[(from + 1) % 3] - corners[from], other = corners[(from + 2) % 3] - corners[from];
  const double step = step_for(longest);
  GridImage grid{std::vector<GridPoint>(3), step};
  grid.points[size_t(from)] = {0, 0};
  grid.points[size_t(from + 1) % 3] = {int(std::round(longest / step)), 0};
  const double along = dot(side, other) / longest, height = length(cross(side, other)) / longest;
  grid.points[size_t(from + 2) % 3] = {int(std::round(along / step)),
                                       std::max(1, int(std::round(height / step)))};
  return grid;
}

bool all_positive(std::span<const UVec3> faces, const GridImage& image) {
  return std::all_of(faces.begin(), faces.end(), [&](const UVec3& f) {
    return turn(image.points[f.x], image.points[f.y], image.points[f.z]) > 0;
  });
}

}  // namespace goldthread
