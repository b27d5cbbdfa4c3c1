#include "visibility/direction_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"

namespace goldthread {
namespace {

constexpr double kPiDouble = 3.14159265358979323846;

double row_edge(const GridFace& face, uint32_t row) {
  return std::min(double(row), face.height);
}

// The crossing of column line i and row line j.
dvec3 crossing(const GridFace& face, uint32_t i, uint32_t j) {
  return face.corner + double(i) * face.across + row_edge(face, j) * face.down;
}

bool is_half(const GridFace& face, uint32_t column, uint32_t row) {
  return face.triangular && column + row + 1 == face.columns;
}

// One edge's term of Lambert's contour sum for a receiver of normal +z: Theta * Gamma.z / (2 pi).
double edge_term(const dvec3& from, const dvec3& to) {
  const dvec3 normal = glm::cross(from, to);
  const double sine = glm::length(normal);
  return normal.z * std::atan2(sine, glm::dot(from, to)) / (2 * kPiDouble * sine);
}

// Form factors of all cells of a face, along rows. Neighbours share the terms of their edges, so that each is
// computed once and the cells' rounding errors cancel in their sum.
std::vector<double> integrate_cells(const GridFace& face) {
  std::vector<double> factors, above(face.columns);
  for (uint32_t i = 0; i < face.columns; ++i)
    above[i] = edge_term(crossing(face, i, 0), crossing(face, i + 1, 0));
  // Which way round the edges run, as the receiver sees them, depends on the face's axes.
  const double sign = glm::dot(glm::cross(face.across, face.down), face.corner) > 0 ? 1 : -1;
  for (uint32_t j = 0; j < face.rows; ++j) {
    double left = edge_term(crossing(face, 0, j), crossing(face, 0, j + 1));
    for (uint32_t i = 0; i < face.columns_in(j); ++i) {
      const dvec3 upper = crossing(face, i + 1, j), lower = crossing(face, i, j + 1);
      if (is_half(face, i, j)) {
        factors.push_back(sign * (above[i] + edge_term(upper, lower) - left));
        continue;
      }
      const dvec3 last = crossing(face, i + 1, j + 1);
      const double right = edge_term(upper, last), below = edge_term(lower, last);
      factors.push_back(sign * (above[i] + right - below - left));
      above[i] = below;
      left = right;
    }
  }
  return factors;
}

// 1 - 4/pi s atan(s), s = w / sqrt(1 + w^2), is what a square of half width w, 1 away, leaves (Howell, A
// Catalog of Radiation Heat Transfer Configuration Factors, B-3, four times). Written without the difference,
// which is all rounding for wide planes.
double outside_square(double half_width) {
  const double hypotenuse = std::hypot(1.0, half_width), s = half_width / hypotenuse;
  const double rest = 1 / (hypotenuse * hypotenuse * (1 + s));  // 1 - s
  return rest + 4 / kPiDouble * s * std::atan(rest / (1 + s));
}

}  // namespace

uint32_t GridFace::cell(uint32_t column, uint32_t row) const {
  return first + column + (triangular ? row * columns - row * (row - 1) / 2 : row * columns);
}

DirectionGrid::DirectionGrid(uint32_t resolution, std::vector<GridFace> faces, double missing)
    : faces_(std::move(faces)), missing_(missing) {
  GOLDTHREAD_CHECK_LE(1u, resolution);
  GOLDTHREAD_CHECK_LE(resolution, kMaxResolution);
  size_t cells = 0;
  for (const GridFace& face : faces_)
    for (uint32_t j = 0; j < face.rows; ++j) cells += face.columns_in(j);
  places_.reserve(cells);
  directions_.reserve(cells);
  delta_form_factors_.reserve(cells);
  neighbours_.assign(cells, {kNone, kNone, kNone, kNone});
  std::vector<double> factors;
  for (size_t f = 0; f < faces_.size(); ++f) {
    GridFace& face = faces_[f];
    face.first = size();
    // Faces of one height are each other, turned about the normal: a hemicube's top is twice its sides'.
    if (f == 0 || face.height != faces_[f - 1].height) factors = integrate_cells(face);
    add_cells(face, static_cast<uint16_t>(f), factors);
  }
}

void DirectionGrid::add_cells(const GridFace& face, uint16_t index, const std::vector<double>& factors) {
  delta_form_factors_.insert(delta_form_factors_.end(), factors.begin(), factors.end());
  for (uint32_t j = 0; j < face.rows; ++j)
    for (uint32_t i = 0; i < face.columns_in(j); ++i) {
      const auto cell = static_cast<uint32_t>(places_.size());
      places_.push_back({index, static_cast<uint16_t>(i), static_cast<uint16_t>(j)});
      const double middle = is_half(face, i, j) ? 1.0 / 3 : 0.5;
      directions_.emplace_back(glm::normalize(point(cell, middle, middle)));
      if (i > 0) link(cell, face.cell(i - 1, j));
      if (j > 0) link(cell, face.cell(i, j - 1));
    }
}

void DirectionGrid::link(uint32_t a, uint32_t b) {
  *std::find(neighbours_[a].begin(), neighbours_[a].end(), kNone) = b;
  *std::find(neighbours_[b].begin(), neighbours_[b].end(), kNone) = a;
}

DirectionGrid DirectionGrid::hemicube(uint32_t resolution) {
  const uint32_t n = resolution;
  const double side = 2.0 / n;
  std::vector<GridFace> faces{{{-1, -1, 1}, {side, 0, 0}, {0, side, 0}, n, n, double(n)}};
  // The sides follow each other round the cube, each from its upper edge down.
  const std::array<dvec3, 4> outwards{dvec3(1, 0, 0), dvec3(0, 1, 0), dvec3(-1, 0, 0), dvec3(0, -1, 0)};
  const dvec3 up(0, 0, 1);
  for (size_t s = 0; s < 4; ++s) {
    const dvec3 along = outwards[(s + 1) % 4];
    faces.push_back({outwards[s] - along + up, side * along, -side * up, n, (n + 1) / 2, 0.5 * n});
  }
  DirectionGrid grid(n, std::move(faces), 0);
  const std::vector<GridFace>& f = grid.faces_;
  for (uint32_t i = 0; i < n; ++i) {
    grid.link(f[1].cell(i, 0), f[0].cell(n - 1, i));
    grid.link(f[2].cell(i, 0), f[0].cell(n - 1 - i, n - 1));
    grid.link(f[3].cell(i, 0), f[0].cell(0, n - 1 - i));
    grid.link(f[4].cell(i, 0), f[0].cell(i, 0));
  }
  for (size_t s = 0; s < 4; ++s)
    for (uint32_t j = 0; j < f[1].rows; ++j)
      grid.link(f[1 + s].cell(n - 1, j), f[1 + (s + 1) % 4].cell(0, j));
  return grid;
}

DirectionGrid DirectionGrid::cubic_tetrahedron(uint32_t resolution) {
  const uint32_t n = resolution;
  const double level = std::sqrt(2.0 / 3), rise = std::sqrt(1.0 / 3), half_root = std::sqrt(0.75);
  const std::array<dvec3, 3> axes{dvec3(level, 0, rise), dvec3(-0.5 * level, half_root * level, rise),
                                  dvec3(-0.5 * level, -half_root * level, rise)};
  const dvec3 apex = axes[0] + axes[1] + axes[2];
  const double side = 3.0 / n;
  std::vector<GridFace> faces;
  for (size_t k = 0; k < 3; ++k)
    faces.push_back({apex, -side * axes[(k + 1) % 3], -side * axes[(k + 2) % 3], n, n, double(n), true});
  DirectionGrid grid(n, std::move(faces), 0);
  const std::vector<GridFace>& f = grid.faces_;
  for (size_t k = 0; k < 3; ++k)
    for (uint32_t i = 0; i < n; ++i) grid.link(f[k].cell(i, 0), f[(k + 2) % 3].cell(0, i));
  return grid;
}

DirectionGrid DirectionGrid::single_plane(uint32_t resolution, double half_width) {
  GOLDTHREAD_CHECK_LT(0.0, half_width);
  const uint32_t n = resolution;
  const double side = 2 * half_width / n;
  std::vector<GridFace> faces{{{-half_width, -half_width, 1}, {side, 0, 0}, {0, side, 0}, n, n, double(n)}};
  return {n, std::move(faces), outside_square(half_width)};
}

dvec3 DirectionGrid::point(uint32_t cell, double u, double v) const {
  const Place& place = places_[cell];
  const GridFace& face = faces_[place.face];
  if (is_half(face, place.column, place.row) && u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const double top = row_edge(face, place.row), bottom = row_edge(face, place.row + 1u);
  return face.corner + (place.column + u) * face.across + (top + v * (bottom - top)) * face.down;
}

size_t DirectionGrid::corners(uint32_t cell, std::array<dvec3, 4>& out) const {
  const Place& place = places_[cell];
  const GridFace& face = faces_[place.face];
  const uint32_t i = place.column, j = place.row;
  out = {crossing(face, i, j), crossing(face, i + 1, j), crossing(face, i + 1, j + 1),
         crossing(face, i, j + 1)};
  if (!is_half(face, i, j)) return 4;
  out[2] = out[3];
  return 3;
}

}  // namespace goldthread
