// The hemisphere over a receiver as cells of solid angle, each of a known form factor: what an item buffer is
// drawn on.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "math/vec.h"

namespace goldthread {

/// One plane of a grid: cells of equal sides, in rows. Positions are relative to the receiver, whose normal
/// is +z; lengths have no unit.
struct GridFace {
  dvec3 corner{0};           ///< where the first cell begins
  dvec3 across{0}, down{0};  ///< sides of a whole cell, to the next column and to the next row
  uint32_t columns = 0, rows = 0;
  double height = 0;        ///< in whole cells: rows, or half a cell less where the horizon cuts the last
  bool triangular = false;  ///< row j has columns - j cells, the last of them cut in half by the horizon
  uint32_t first = 0;       ///< index of the face's first cell

  uint32_t columns_in(uint32_t row) const { return triangular ? columns - row : columns; }
  uint32_t cell(uint32_t column, uint32_t row) const;  ///< index in the grid; cells run along rows
};

/// Cells that fill a receiver's hemisphere, or a part of it, without overlap. A cell's delta form factor is
/// the form factor from the receiver to the whole cell, integrated exactly by Lambert's contour formula in
/// double precision; the papers take the integrand in the cell's centre, which on coarse grids does not sum
/// to one. With p = (x, y, z) on the cell's plane, h that plane's distance and r = |p|, the integrand is
///   dF = z h / (pi r^4) dA.
/// Immutable, and thread safe.
class DirectionGrid {
 public:
  static constexpr uint32_t kNone = 0xffffffffu;
  static constexpr uint32_t kMaxResolution = 4096;

  /// The upper half of a cube: a top of resolution x resolution cells and four sides of half that height
  /// (Cohen and Greenberg 1985). dF is 1/(pi (x^2 + y^2 + 1)^2) dA on top, z/(pi (y^2 + z^2 + 1)^2) dA on the
  /// sides. With an odd resolution the lowest cells of the sides are cut in half by the horizon.
  static DirectionGrid hemicube(uint32_t resolution);

  /// The corner of a cube that points along the normal, down to the horizon: three right-angled triangles
  /// (Beran-Koehn and Pavicic 1991, 1992). In the cube's own axes the normal is (1, 1, 1)/sqrt(3) and the
  /// face x = 1 reaches to y + z = -1: dF = (1 + y + z)/(sqrt(3) pi (1 + y^2 + z^2)^2) dA. `resolution`
  /// counts the cells along a leg; 3/2 resolution (resolution + 1) cells in all, where a hemicube has three
  /// times its resolution squared.
  static DirectionGrid cubic_tetrahedron(uint32_t resolution);

  /// One square of resolution x resolution cells, at height 1, parallel to the receiver, of half width
  /// `half_width` > 0 (Sillion and Puech 1989): sees nothing near the horizon.
  static DirectionGrid single_plane(uint32_t resolution, double half_width);

  uint32_t size() const { return static_cast<uint32_t>(delta_form_factors_.size()); }
  /// Through the middle of each cell; unit.
  std::span<const vec3> directions() const { return directions_; }
  /// Of each cell. With `missing` they sum to one.
  std::span<const double> delta_form_factors() const { return delta_form_factors_; }
  /// Form factor of all directions of the hemisphere that are in no cell, in closed form; 0 for closed
  /// shapes.
  double missing() const { return missing_; }
  /// The cells that share a side with this one, those of other faces too, and kNone for the rest.
  const std::array<uint32_t, 4>& neighbours(uint32_t cell) const { return neighbours_[cell]; }
  std::span<const GridFace> faces() const { return faces_; }

  /// A point of a cell, not unit: (u, v) from the unit square, across and down, to even density over the
  /// cell's plane. The half cells of a triangular face are the unit square folded over.
  dvec3 point(uint32_t cell, double u, double v) const;

  /// The corners of a cell, not unit, in order round it; returns how many, 3 or 4.
  size_t corners(uint32_t cell, std::array<dvec3, 4>& out) const;

 private:
  struct Place {
    uint16_t face, column, row;
  };

  DirectionGrid(uint32_t resolution, std::vector<GridFace> faces, double missing);
  void add_cells(const GridFace& face, uint16_t index, const std::vector<double>& factors);
  void link(uint32_t a, uint32_t b);

  std::vector<GridFace> faces_;
  std::vector<Place> places_;
  std::vector<vec3> directions_;
  std::vector<double> delta_form_factors_;
  std::vector<std::array<uint32_t, 4>> neighbours_;
  double missing_ = 0;
};

}  // namespace goldthread
