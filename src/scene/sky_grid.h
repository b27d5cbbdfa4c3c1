// A sky cut up by latitude and longitude, for those who have to know where it is bright.
#pragma once
#include <cstdint>
#include <vector>

#include "math/vec.h"
#include "scene/sky.h"

namespace goldthread {

/// A rectangle of directions. Azimuth 0 is -Z, a right angle +X.
struct SkyPiece {
  float azimuth = 0, elevation = 0;            ///< radians, of its middle
  float azimuth_size = 0, elevation_size = 0;  ///< radians

  vec3 direction() const;     ///< unit, of its middle
  float solid_angle() const;  ///< steradians
};

/// Mean luminances over pieces of equal angles. Of a map, its pixels or blocks of them.
struct SkyGrid {
  uint32_t width = 0, height = 0;
  float first_azimuth = 0;  ///< radians: where column 0 begins; azimuths grow with columns
  std::vector<vec3> nits;   ///< rows from the zenith, width * height

  SkyPiece piece(uint32_t column, uint32_t row) const;
  /// Which of `nits` a direction that is not zero lies in.
  size_t index_towards(const vec3& direction) const;
};

/// Maps are averaged where they are wider than kMostColumns, with every pixel where their width is a
/// multiple; models are asked kModelColumns times around, at the middle of each piece.
SkyGrid grid_of(const Sky& sky);

constexpr uint32_t kMostColumns = 2048, kModelColumns = 512;

}  // namespace goldthread
