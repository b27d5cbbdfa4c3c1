// A piece's image on a grid so fine that it is not seen and so coarse that floats hold it: what is asked of
// it there is answered without rounding.
#pragma once
#include <vector>

#include "represent/atlas/flatten.h"

namespace goldthread {

using GridPoint = glm::ivec2;

/// Twice the area of a, b, c: positive when they turn left. Exact for coordinates below 2^30.
inline int64_t turn(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return (int64_t(b.x) - a.x) * (int64_t(c.y) - a.y) - (int64_t(b.y) - a.y) * (int64_t(c.x) - a.x);
}

/// A corner lies at points[i] * step. Points are within 0 to 2^23 and `step` is a power of two, so that
/// floats hold this product as it is.
struct GridImage {
  std::vector<GridPoint> points;
  double step = 1;

  vec2 coordinates(size_t corner) const;
  PlaneImage plane_image() const;
};

/// Turns the image so that its least rectangle lies along the axes, wider than high, and rounds it. `image`
/// must be finite and not be all in one place.
GridImage lay_on_grid(const PlaneImage& image);

/// A triangle by its sides' lengths, its longest side along x. One that is lower than the grid is made a step
/// high, so that its area is positive as that of every other.
GridImage lay_on_grid(const dvec3& a, const dvec3& b, const dvec3& c);

/// Whether every face turns left.
bool all_positive(std::span<const UVec3> faces, const GridImage& image);

/// Whether the piece's boundary loops neither cross nor touch themselves or each other, and only one of them
/// goes round its inside (the others are holes). With all faces positive, each point of the plane is then
/// covered as often as the loops go round it: once or not at all.
bool boundary_is_simple(const Piece& piece, const GridImage& image);

}  // namespace goldthread
