// Charts side by side on square pages (thesis 5.2.4).
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/progress.h"
#include "math/vec.h"

namespace goldthread {

/// What is to be placed: a borrowed chart and how many metres a unit of its coordinates is.
struct PackChart {
  std::span<const UVec3> faces;
  std::span<const vec2> coordinates;
  float scale = 1;
};

struct PackOptions {
  uint32_t page_size = 1024;   ///< texels, both sides
  uint32_t pages = 1;          ///< at most
  uint32_t padding = 2;        ///< texels that stay free between two charts
  float texels_per_metre = 0;  ///< lowered until all fits; 0: the most that fits
};

/// A chart's corner c lies at turned(c * scale * texels_per_metre) + offset, in texels of its page from the
/// corner of texel (0, 0); turned() by quarter turns counter-clockwise.
struct Placement {
  uint32_t page = 0;
  uint32_t quarter_turns = 0;  ///< 0 to 3
  vec2 offset{0};
};

struct Packing {
  std::vector<Placement> placements;  ///< one a chart
  uint32_t pages = 0;                 ///< that were needed
  float texels_per_metre = 0;         ///< the one density of all charts
  double use = 0;                     ///< share of all pages' texels that charts touch, padding not counted
};

/// Where corner c of `chart` lies, texels. Worked out in one way everywhere.
vec2 place(const PackChart& chart, const Placement& placement, float texels_per_metre, const vec2& c);

/// Places every chart so that between texels that two charts of one page touch (that hold a point of a
/// triangle, edges included) at least `padding` texels, sideways, up and across, are touched by neither, and
/// none lies beyond the page. Larger charts first; all four turns are tried. Nothing when not even the
/// lowest sensible density fits (a texel or so a chart), or when cancelled. The same for any number of
/// threads.
std::optional<Packing> pack(std::span<const PackChart> charts, const PackOptions& options,
                            const CancelToken& cancel);

}  // namespace goldthread
