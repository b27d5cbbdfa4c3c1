#include "scene/sky_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.h"

namespace goldthread {
namespace {

constexpr double kHalfTurn = std::numbers::pi;

// The mean over `count` by `count` even steps in the piece, weighed by solid angle.
vec3 mean_over(const Sky& sky, const SkyPiece& piece, uint32_t count) {
  if (count == 1) return sky.radiance_towards(piece.direction());
  dvec3 sum(0);
  double weights = 0;
  const auto step = 1 / static_cast<float>(count);
  for (uint32_t y = 0; y < count; ++y)
    for (uint32_t x = 0; x < count; ++x) {
      SkyPiece part = piece;
      part.azimuth += piece.azimuth_size * ((static_cast<float>(x) + 0.5f) * step - 0.5f);
      part.elevation -= piece.elevation_size * ((static_cast<float>(y) + 0.5f) * step - 0.5f);
      const auto weight = static_cast<double>(std::cos(part.elevation));
      sum += weight * dvec3(sky.radiance_towards(part.direction()));
      weights += weight;
    }
  return vec3(sum / weights);
}

}  // namespace

vec3 SkyPiece::direction() const {
  const float level = std::cos(elevation);
  return {level * std::sin(azimuth), std::sin(elevation), -level * std::cos(azimuth)};
}

float SkyPiece::solid_angle() const {
  return azimuth_size * 2 * std::cos(elevation) * std::sin(elevation_size / 2);
}

SkyPiece SkyGrid::piece(uint32_t column, uint32_t row) const {
  const double across = 2 * kHalfTurn / width, down = kHalfTurn / height;
  return {static_cast<float>(double{first_azimuth} + (column + 0.5) * across),
          static_cast<float>(kHalfTurn / 2 - (row + 0.5) * down), static_cast<float>(across),
          static_cast<float>(down)};
}

size_t SkyGrid::index_towards(const vec3& d) const {
  const float turn = (std::atan2(d.x, -d.z) - first_azimuth) / static_cast<float>(2 * kHalfTurn);
  const float down = 0.5f - std::atan2(d.y, std::hypot(d.x, d.z)) / static_cast<float>(kHalfTurn);
  const auto within = [](float share, uint32_t size) {
    return std::min(static_cast<uint32_t>(std::max(0.0f, share) * static_cast<float>(size)), size - 1);
  };
  return size_t{within(down, height)} * width + within(turn - std::floor(turn), width);
}

SkyGrid grid_of(const Sky& sky) {
  SkyGrid grid;
  uint32_t samples = 1;
  grid.first_azimuth = static_cast<float>(-kHalfTurn);
  if (sky.map) {
    const FloatImage& picture = sky.map->picture();
    const uint32_t block = (std::max(picture.width, picture.height) + kMostColumns - 1) / kMostColumns;
    grid.width = (picture.width + block - 1) / block;
    grid.height = (picture.height + block - 1) / block;
    const bool fits = grid.width * block == picture.width && grid.height * block == picture.height;
    samples = fits ? block : 2 * block;
    grid.first_azimuth += sky.map->rotation();
  } else {
    grid.width = kModelColumns;
    grid.height = kModelColumns / 2;
  }
  grid.nits.resize(size_t{grid.width} * grid.height);
  parallel_for(
      grid.height,
      [&](size_t row) {
        for (uint32_t column = 0; column < grid.width; ++column)
          grid.nits[row * grid.width + column] =
              mean_over(sky, grid.piece(column, static_cast<uint32_t>(row)), samples);
      },
      8);
  return grid;
}

}  // namespace goldthread
