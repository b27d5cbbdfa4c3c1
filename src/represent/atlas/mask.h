// Sets of texels as bits, 64 to a word.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "represent/atlas/pack.h"

namespace goldthread {

/// width * height texels; rows begin at whole words, and bits beyond the width are 0.
class Mask {
 public:
  Mask() = default;
  Mask(uint32_t width, uint32_t height)
      : width_(width), height_(height), words_((width + 63) / 64), bits_(size_t{words_} * height, 0) {}

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  uint32_t words() const { return words_; }  ///< a row
  const uint64_t* row(uint32_t y) const { return bits_.data() + size_t{y} * words_; }
  uint64_t* row(uint32_t y) { return bits_.data() + size_t{y} * words_; }
  bool at(uint32_t x, uint32_t y) const { return (row(y)[x / 64] >> (x % 64) & 1) != 0; }

  void set(uint32_t x, uint32_t y) { row(y)[x / 64] |= uint64_t{1} << (x % 64); }
  /// Texels first to last of a row, both included.
  void set_run(uint32_t y, uint32_t first, uint32_t last);
  uint64_t count() const;

  /// A quarter turn counter-clockwise, as of points: (x, y) to (-y, x).
  Mask turned() const;
  /// Larger by `by` on all sides: every texel within `by` of a set one, diagonally, too.
  Mask dilated(uint32_t by) const;

 private:
  uint32_t width_ = 0, height_ = 0, words_ = 0;
  std::vector<uint64_t> bits_;
};

/// The texels that a chart touches, and where its coordinates lie among them.
struct ChartMask {
  Mask touched;
  vec2 offset{0};  ///< a corner c lies at c * scale * texels_per_metre + offset
};

/// Rasterises conservatively: a texel is touched if its closed square holds any point of a closed triangle,
/// or one so near that rounding might have moved it there. What is left over of the outermost texels is the
/// same on opposite sides, so that turning the mask is the same as turning the chart. Nothing for a chart
/// whose box is more than `most` texels wide or high, or is not finite.
std::optional<ChartMask> mask_of(const PackChart& chart, float texels_per_metre, uint32_t most);

}  // namespace goldthread
