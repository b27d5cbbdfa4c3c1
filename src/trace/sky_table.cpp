#include "trace/sky_table.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "math/colour.h"

namespace goldthread {
namespace {

// A place in running sums of shares: which, and how far within it, 0..1.
struct Place {
  size_t index = 0;
  double within = 0;
};

Place find_place(std::span<const double> sums, double share) {
  const auto above = std::upper_bound(sums.begin() + 1, sums.end() - 1, share);
  const auto index = static_cast<size_t>(above - sums.begin()) - 1;
  const double size = sums[index + 1] - sums[index];
  return {index, size > 0 ? std::clamp((share - sums[index]) / size, 0.0, 1.0) : 0.5};
}

// Turns sums into shares of the last; returns that.
double to_shares(std::span<double> sums) {
  const double total = sums.back();
  for (double& sum : sums) sum = total > 0 ? sum / total : 0;
  sums.back() = 1;
  return total;
}

}  // namespace

SkyTable::SkyTable(const Sky& sky) : grid_(grid_of(sky)) {
  rows_.resize(grid_.height + size_t{1});
  columns_.resize(row_start(grid_.height));
  for (size_t row = 0; row < grid_.height; ++row) {
    const std::span<double> sums(&columns_[row_start(row)], grid_.width + size_t{1});
    const auto solid_angle = static_cast<double>(grid_.piece(0, static_cast<uint32_t>(row)).solid_angle());
    for (size_t column = 0; column < grid_.width; ++column)
      sums[column + 1] =
          sums[column] + solid_angle * static_cast<double>(luminance(grid_.nits[row * grid_.width + column]));
    rows_[row + 1] = rows_[row] + to_shares(sums);
  }
  total_ = to_shares(rows_);
}

SkyDirection SkyTable::sample(double u, double v) const {
  const Place row = find_place(rows_, v);
  const Place column = find_place({&columns_[row_start(row.index)], grid_.width + size_t{1}}, u);
  const SkyPiece piece = grid_.piece(static_cast<uint32_t>(column.index), static_cast<uint32_t>(row.index));
  const double azimuth =
      static_cast<double>(piece.azimuth) + (column.within - 0.5) * static_cast<double>(piece.azimuth_size);
  // Even over the sphere is even in the sine of elevation.
  const double elevation = static_cast<double>(piece.elevation),
               half = static_cast<double>(piece.elevation_size) / 2;
  const double low = std::sin(elevation - half), high = std::sin(elevation + half);
  const double sine = high + row.within * (low - high);
  const double level = std::sqrt(std::max(0.0, 1 - sine * sine));
  SkyDirection out;
  out.direction = vec3(dvec3(level * std::sin(azimuth), sine, -level * std::cos(azimuth)));
  const float nits = luminance(grid_.nits[row.index * grid_.width + column.index]);
  out.density = static_cast<float>(static_cast<double>(nits) / total_);
  return out;
}

float SkyTable::density(const vec3& direction) const {
  const float nits = luminance(grid_.nits[grid_.index_towards(direction)]);
  return static_cast<float>(static_cast<double>(nits) / total_);
}

}  // namespace goldthread
