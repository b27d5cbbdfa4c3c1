#include "represent/atlas/page.h"

#include <algorithm>
#include <bit>

namespace goldthread {
namespace {

/// The longest run of `value` bits of a row.
uint32_t longest_run(const uint64_t* row, uint32_t width, bool value) {
  uint32_t longest = 0, run = 0;
  for (uint32_t x = 0; x < width;) {
    const uint64_t bits = (value ? row[x / 64] : ~row[x / 64]) >> (x % 64);
    const uint32_t left = std::min(64 - x % 64, width - x);
    const uint32_t ones = std::min(static_cast<uint32_t>(std::countr_one(bits)), left);
    run += ones;
    longest = std::max(longest, run);
    x += ones;
    if (ones == left) continue;
    run = 0;
    const uint64_t rest = bits >> ones;
    x += std::min(rest == 0 ? left - ones : static_cast<uint32_t>(std::countr_zero(rest)), left - ones);
  }
  return longest;
}

/// How many bits of a row are set in one run that ends with bit `last`.
uint32_t run_down_from(const uint64_t* row, uint32_t last) {
  uint32_t run = 0;
  for (uint32_t word = last / 64, top = last % 64;; --word, top = 63) {
    const auto ones = static_cast<uint32_t>(std::countl_one(row[word] << (63 - top)));
    run += std::min(ones, top + 1);
    if (ones < top + 1 || word == 0) return run;
  }
}

/// How many bits of a row of `words` are set in one run that begins with bit `first`.
uint32_t run_up_from(const uint64_t* row, uint32_t words, uint32_t first) {
  uint32_t run = 0;
  for (uint32_t word = first / 64, low = first % 64; word < words; ++word, low = 0) {
    const auto ones = static_cast<uint32_t>(std::countr_one(row[word] >> low));
    run += std::min(ones, 64 - low);
    if (ones < 64 - low) return run;
  }
  return run;
}

constexpr uint32_t kNone = 0xffffffffu;

/// The last set bit of a row within first to last, both included, or kNone.
uint32_t last_set(const uint64_t* row, uint32_t first, uint32_t last) {
  for (uint32_t word = last / 64;; --word) {
    uint64_t bits = row[word];
    if (word == last / 64) bits &= ~uint64_t{0} >> (63 - last % 64);
    if (word == first / 64) bits &= ~uint64_t{0} << (first % 64);
    if (bits != 0) return 64 * word + 63 - static_cast<uint32_t>(std::countl_zero(bits));
    if (word == first / 64) return kNone;
  }
}

/// What is asked of a row of a mask again and again.
struct MaskRow {
  const uint64_t* bits = nullptr;
  uint32_t words = 0, widest = 0;  ///< the latter of its longest run
  uint32_t first = 0, last = 0;    ///< set bits
  bool one_run = false;            ///< all between these are set
};

MaskRow row_of(const Mask& mask, uint32_t y) {
  MaskRow row{mask.row(y), mask.words(), longest_run(mask.row(y), mask.width(), true), 0, 0, false};
  if (row.widest == 0) return row;
  row.last = last_set(row.bits, 0, mask.width() - 1);
  while ((row.bits[row.first / 64] >> (row.first % 64) & 1) == 0) ++row.first;
  row.one_run = row.widest == row.last - row.first + 1;
  return row;
}

/// 0 where a row of a mask, moved by x, meets nothing of a page's row; else by how much it must move on
/// before it can be free of what it met.
uint32_t way_past(const MaskRow& mask, const uint64_t* page, uint32_t page_words, uint32_t x) {
  if (mask.widest == 0) return 0;
  if (mask.one_run) {
    const uint32_t met = last_set(page, x + mask.first, x + mask.last);
    return met == kNone ? 0 : met + run_up_from(page, page_words, met) - (x + mask.first);
  }
  const uint32_t first = x / 64, shift = x % 64;
  for (uint32_t word = 0; word < mask.words; ++word) {
    uint64_t under = page[first + word] >> shift;
    if (shift != 0 && first + word + 1 < page_words) under |= page[first + word + 1] << (64 - shift);
    const uint64_t met = mask.bits[word] & under;
    if (met != 0)
      return run_down_from(mask.bits, 64 * word + 63 - static_cast<uint32_t>(std::countl_zero(met)));
  }
  return 0;
}

}  // namespace

Page::Page(uint32_t size, uint32_t padding)
    : padding_(padding), texels_(size + 2 * padding, size + 2 * padding) {
  longest_gap_.assign(texels_.height(), texels_.width());
}

std::optional<PagePlace> Page::find(const Mask& blocked, PagePlace from) const {
  if (blocked.width() > texels_.width() || blocked.height() > texels_.height()) return std::nullopt;
  std::vector<MaskRow> rows;
  for (uint32_t row = 0; row < blocked.height(); ++row) rows.push_back(row_of(blocked, row));
  const auto may_hold = [&](uint32_t y) {
    for (uint32_t row = 0; row < rows.size(); ++row)
      if (longest_gap_[y + row] < rows[row].widest) return false;
    return true;
  };
  const uint32_t last_x = texels_.width() - blocked.width(), last_y = texels_.height() - blocked.height();
  uint32_t likely = 0;  // the row that met something last: it will again
  for (uint32_t y = from.y; y <= last_y; ++y) {
    if (!may_hold(y)) continue;
    for (uint32_t x = y == from.y ? from.x : 0; x <= last_x;) {
      uint32_t step = way_past(rows[likely], texels_.row(y + likely), texels_.words(), x);
      for (uint32_t row = 0; step == 0 && row < rows.size(); ++row) {
        step = way_past(rows[row], texels_.row(y + row), texels_.words(), x);
        if (step != 0) likely = row;
      }
      if (step == 0) return PagePlace{y, x};
      x += step;
    }
  }
  return std::nullopt;
}

void Page::take(const Mask& touched, PagePlace place) {
  const uint32_t left = place.x + padding_, first = left / 64, shift = left % 64;
  for (uint32_t y = 0; y < touched.height(); ++y) {
    const uint32_t to = place.y + padding_ + y;
    uint64_t* out = texels_.row(to);
    for (uint32_t word = 0; word < touched.words(); ++word) {
      const uint64_t bits = touched.row(y)[word];
      out[first + word] |= bits << shift;
      if (shift != 0 && (bits >> (64 - shift)) != 0) out[first + word + 1] |= bits >> (64 - shift);
    }
    longest_gap_[to] = longest_run(out, texels_.width(), false);
  }
  taken_ += touched.count();
}

}  // namespace goldthread
