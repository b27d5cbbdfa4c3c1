#include "represent/atlas/mask.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace goldthread {
namespace {

/// By this much rounding to floats may move a corner on a page, at most: on the largest, whose texels floats
/// know to 1/1024, several times over.
constexpr double kDoubt = 1.0 / 128;

/// The x that a triangle has between two heights; first > second where it has none there.
dvec2 range_between(const dvec2 (&corners)[3], double low, double high) {
  dvec2 range(INFINITY, -INFINITY);
  const auto take = [&](double x) { range = {std::min(range.x, x), std::max(range.y, x)}; };
  for (int k = 0; k < 3; ++k) {
    const dvec2 &a = corners[k], &b = corners[(k + 1) % 3];
    if (a.y >= low && a.y <= high) take(a.x);
    for (const double at : {low, high})
      if ((a.y < at) != (b.y < at)) take(a.x + (b.x - a.x) * ((at - a.y) / (b.y - a.y)));
  }
  return range;
}

void rasterise(const dvec2 (&corners)[3], Mask& mask) {
  const auto [low, high] = std::minmax({corners[0].y, corners[1].y, corners[2].y});
  const auto first = static_cast<int64_t>(std::floor(low - kDoubt));
  const auto last = static_cast<int64_t>(std::floor(high + kDoubt));
  for (int64_t y = std::max<int64_t>(first, 0); y <= std::min<int64_t>(last, mask.height() - 1); ++y) {
    const dvec2 range =
        range_between(corners, static_cast<double>(y) - kDoubt, static_cast<double>(y) + 1 + kDoubt);
    if (range.x > range.y) continue;
    const double most = mask.width() - 1;
    mask.set_run(static_cast<uint32_t>(y),
                 static_cast<uint32_t>(std::clamp(std::floor(range.x - kDoubt), 0.0, most)),
                 static_cast<uint32_t>(std::clamp(std::floor(range.y + kDoubt), 0.0, most)));
  }
}

}  // namespace

void Mask::set_run(uint32_t y, uint32_t first, uint32_t last) {
  uint64_t* bits = row(y);
  const uint64_t from = ~uint64_t{0} << (first % 64), to = ~uint64_t{0} >> (63 - last % 64);
  if (first / 64 == last / 64) {
    bits[first / 64] |= from & to;
    return;
  }
  bits[first / 64] |= from;
  for (uint32_t word = first / 64 + 1; word < last / 64; ++word) bits[word] = ~uint64_t{0};
  bits[last / 64] |= to;
}

uint64_t Mask::count() const {
  uint64_t sum = 0;
  for (const uint64_t word : bits_) sum += static_cast<uint64_t>(std::popcount(word));
  return sum;
}

Mask Mask::turned() const {
  Mask result(height_, width_);
  for (uint32_t y = 0; y < height_; ++y)
    for (uint32_t word = 0; word < words_; ++word)
      for (uint64_t bits = row(y)[word]; bits != 0; bits &= bits - 1)
        result.set(height_ - 1 - y, 64 * word + static_cast<uint32_t>(std::countr_zero(bits)));
  return result;
}

Mask Mask::dilated(uint32_t by) const {
  Mask wide(width_ + 2 * by, height_ + 2 * by);
  // Sideways: each row by 0 to 2 * by texels along, as powers of two of what is there already.
  for (uint32_t y = 0; y < height_; ++y) {
    uint64_t* out = wide.row(y + by);
    std::copy_n(row(y), words_, out);
    for (uint32_t done = 0; done < 2 * by;) {
      const uint32_t shift = std::min(done + 1, 2 * by - done);
      for (uint32_t word = wide.words(); word-- > 0;) {
        uint64_t moved = 0;
        if (word >= shift / 64) moved = out[word - shift / 64] << (shift % 64);
        if (shift % 64 != 0 && word > shift / 64) moved |= out[word - shift / 64 - 1] >> (64 - shift % 64);
        out[word] |= moved;
      }
      done += shift;
    }
  }
  if (by == 0) return wide;
  Mask tall(wide.width(), wide.height());
  for (uint32_t y = 0; y < tall.height(); ++y)
    for (uint32_t from = y > by ? y - by : 0; from <= std::min(y + by, tall.height() - 1); ++from)
      for (uint32_t word = 0; word < tall.words(); ++word) tall.row(y)[word] |= wide.row(from)[word];
  return tall;
}

std::optional<ChartMask> mask_of(const PackChart& chart, float texels_per_metre, uint32_t most) {
  const Placement still;
  dvec2 low(INFINITY), high(-INFINITY);
  for (const UVec3& face : chart.faces)
    for (int k = 0; k < 3; ++k) {
      const dvec2 at(place(chart, still, texels_per_metre, chart.coordinates[face[k]]));
      low = glm::min(low, at);
      high = glm::max(high, at);
    }
  if (chart.faces.empty()) low = high = dvec2(0);
  const dvec2 size = glm::ceil(high - low + 4 * kDoubt);
  if (!(size.x <= most && size.y <= most)) return std::nullopt;
  ChartMask result{Mask(static_cast<uint32_t>(size.x), static_cast<uint32_t>(size.y)),
                   vec2((size - (low + high)) / 2.0)};
  for (const UVec3& face : chart.faces) {
    dvec2 corners[3];
    for (int k = 0; k < 3; ++k)
      corners[k] =
          dvec2(place(chart, still, texels_per_metre, chart.coordinates[face[k]])) + dvec2(result.offset);
    rasterise(corners, result.touched);
  }
  return result;
}

}  // namespace goldthread
