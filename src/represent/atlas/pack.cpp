#include "represent/atlas/pack.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/check.h"
#include "base/parallel.h"
#include "represent/atlas/mask.h"
#include "represent/atlas/page.h"

namespace goldthread {
namespace {

/// Charts of about one size: what has no place before a spot for one of them has none for the others, nearly.
uint32_t size_class(const Mask& blocked) {
  const auto step = [](uint32_t length) {
    if (length <= 16) return length;
    const auto octave = static_cast<uint32_t>(std::bit_width(length)) - 1;
    return 8 * octave + (length >> (octave - 3)) % 8;
  };
  return 256 * step(blocked.width()) + step(blocked.height());
}

/// A page with, by class, where the last chart of it came to lie: the search for the next begins there.
struct OpenPage {
  Page page;
  std::unordered_map<uint32_t, PagePlace> begin;
};

struct Candidate {
  uint32_t page = 0, turns = 0;
  PagePlace place;
  uint32_t middle = 0;  ///< twice the row of its middle
};

/// One try at one density.
class Attempt {
 public:
  Attempt(std::span<const PackChart> charts, const PackOptions& options, float density)
      : charts_(charts), options_(options), density_(density) {}

  std::optional<Packing> run(const CancelToken& cancel) {
    if (!rasterise()) return std::nullopt;
    Packing packing;
    packing.texels_per_metre = density_;
    packing.placements.resize(charts_.size());
    for (const uint32_t chart : by_size()) {
      if (cancel.cancelled() || !put(chart, packing.placements[chart])) return std::nullopt;
      masks_[chart].touched = Mask();  // done with
    }
    packing.pages = static_cast<uint32_t>(pages_.size());
    uint64_t taken = 0;
    for (const OpenPage& open : pages_) taken += open.page.taken();
    const double all = static_cast<double>(options_.page_size) * options_.page_size * packing.pages;
    packing.use = packing.pages > 0 ? static_cast<double>(taken) / all : 0.0;
    return packing;
  }

 private:
  bool rasterise() {
    masks_.resize(charts_.size());
    std::vector<uint8_t> fits(charts_.size(), 1);
    parallel_for(
        charts_.size(),
        [&](size_t i) {
          std::optional<ChartMask> mask = mask_of(charts_[i], density_, options_.page_size);
          fits[i] = mask.has_value();
          if (mask) masks_[i] = *std::move(mask);
        },
        16);
    if (std::find(fits.begin(), fits.end(), uint8_t{0}) != fits.end()) return false;
    uint64_t touched = 0;
    for (const ChartMask& mask : masks_) touched += mask.touched.count();
    return touched <= uint64_t{options_.page_size} * options_.page_size * options_.pages;
  }

  /// Longest outline first: what is long is as hard to place as what is large.
  std::vector<uint32_t> by_size() const {
    std::vector<uint32_t> order(charts_.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto key = [&](uint32_t i) {
      const Mask& mask = masks_[i].touched;
      return std::pair(mask.width() + mask.height(), std::max(mask.width(), mask.height()));
    };
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) > key(b); });
    return order;
  }

  /// Of the four turns the one whose middle lies lowest on the first page that has room.
  bool put(uint32_t chart, Placement& placement) {
    std::array<Mask, 4> touched, blocked;
    const uint32_t turns = masks_[chart].touched.width() == 1 && masks_[chart].touched.height() == 1 ? 1 : 4;
    for (uint32_t t = 0; t < turns; ++t) {
      touched[t] = t == 0 ? std::move(masks_[chart].touched) : touched[t - 1].turned();
      blocked[t] = touched[t].dilated(options_.padding);
    }
    for (uint32_t p = 0; p < options_.pages; ++p) {
      if (p == pages_.size()) pages_.push_back({Page(options_.page_size, options_.padding), {}});
      std::optional<Candidate> best;
      for (uint32_t t = 0; t < turns; ++t) {
        PagePlace& begin = pages_[p].begin[size_class(blocked[t])];
        const std::optional<PagePlace> place = pages_[p].page.find(blocked[t], begin);
        // Nothing of this class fits before that, or at all.
        begin = place.value_or(PagePlace{options_.page_size + 2 * options_.padding, 0});
        if (!place) continue;
        const uint32_t middle = 2 * place->y + touched[t].height();
        if (!best || std::pair(middle, place->x) < std::pair(best->middle, best->place.x))
          best = {p, t, *place, middle};
      }
      if (!best) continue;
      pages_[p].page.take(touched[best->turns], best->place);
      placement = placement_of(chart, *best, touched[0]);
      return true;
    }
    return false;
  }

  /// The mask's first texel is at the place; turning it moved its corner by whole texels.
  Placement placement_of(uint32_t chart, const Candidate& candidate, const Mask& upright) const {
    const auto width = static_cast<float>(upright.width()), height = static_cast<float>(upright.height());
    vec2 offset = masks_[chart].offset;
    for (uint32_t t = 0; t < candidate.turns; ++t)
      offset = vec2((t % 2 == 0 ? height : width) - offset.y, offset.x);
    return {candidate.page, candidate.turns,
            offset + vec2(static_cast<float>(candidate.place.x), static_cast<float>(candidate.place.y))};
  }

  std::span<const PackChart> charts_;
  const PackOptions& options_;
  float density_;
  std::vector<ChartMask> masks_;
  std::vector<OpenPage> pages_;
};

/// The density at which charts, each with half its padding round its box's outline, have the area of all
/// pages: more cannot fit, by and large.
float full_density(std::span<const PackChart> charts, const PackOptions& options) {
  double area = 0, outline = 0;
  for (const PackChart& chart : charts) {
    const auto scale = static_cast<double>(chart.scale);
    dvec2 low(INFINITY), high(-INFINITY);
    for (const UVec3& face : chart.faces) {
      const dvec2 a(chart.coordinates[face.x]), b(chart.coordinates[face.y]), c(chart.coordinates[face.z]);
      area += scale * scale * std::abs((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)) / 2;
      low = glm::min(low, glm::min(a, glm::min(b, c)));
      high = glm::max(high, glm::max(a, glm::max(b, c)));
    }
    if (!chart.faces.empty()) outline += scale * (high.x - low.x + high.y - low.y);
  }
  // area d^2 + outline * margin d + margin^2 * charts = texels; margin: padding, and half a texel that is
  // touched beyond each side.
  const double margin = options.padding + 1.0;
  const double texels = static_cast<double>(options.page_size) * options.page_size * options.pages -
                        margin * margin * static_cast<double>(charts.size());
  if (!(area > 0) || !std::isfinite(area) || texels <= 0) return 0;
  const double b = outline * margin;
  return static_cast<float>((std::sqrt(b * b + 4 * area * texels) - b) / (2 * area));
}

/// Below this every chart is a texel or so, whatever it is.
float least_density(std::span<const PackChart> charts) {
  double longest = 0;
  for (const PackChart& chart : charts)
    for (const vec2& c : chart.coordinates)
      longest = std::max({longest, static_cast<double>(std::abs(c.x * chart.scale)),
                          static_cast<double>(std::abs(c.y * chart.scale))});
  return static_cast<float>(0.25 / std::max(longest, 1e-30));
}

/// Whether the charts' mere number is too much. Each touches a texel, and with the padding's texels to the
/// right of it and above, which no other has, that is a square of its own on a page larger by the padding.
bool too_many(size_t charts, const PackOptions& options) {
  const uint64_t across = (uint64_t{options.page_size} + options.padding) / (uint64_t{options.padding} + 1);
  return charts > across * across * options.pages;
}

constexpr float kCloseEnough = 1.005f;  // finer than that, another try is not worth its time

}  // namespace

vec2 place(const PackChart& chart, const Placement& placement, float texels_per_metre, const vec2& c) {
  vec2 at = c * (chart.scale * texels_per_metre);
  for (uint32_t t = 0; t < placement.quarter_turns; ++t) at = vec2(-at.y, at.x);
  return at + placement.offset;
}

std::optional<Packing> pack(std::span<const PackChart> charts, const PackOptions& options,
                            const CancelToken& cancel) {
  GOLDTHREAD_CHECK_LT(0u, options.page_size);
  GOLDTHREAD_CHECK_LT(0u, options.pages);
  if (charts.empty()) return Packing{};
  if (too_many(charts.size(), options)) return std::nullopt;
  const auto attempt = [&](float density) { return Attempt(charts, options, density).run(cancel); };
  // An attempt that cannot succeed ends when its texels are counted, so the wish itself comes first.
  if (options.texels_per_metre > 0)
    if (std::optional<Packing> asked = attempt(options.texels_per_metre)) return asked;
  const float least = least_density(charts), full = std::max(full_density(charts, options), least);
  // Between what fits (the best so far) and what does not.
  const float most = options.texels_per_metre > 0 ? options.texels_per_metre : INFINITY;
  std::optional<Packing> best;
  float fails = most, density = std::min(full * 0.95f, most), down = 0.95f;
  while (!cancel.cancelled()) {
    std::optional<Packing> found = attempt(density);
    if (found)
      best = std::move(found);
    else
      fails = density;
    if (!best) {
      if (density <= least) return std::nullopt;
      density = std::max(density * down, least);
      down = std::max(0.6f, 0.9f * down);
      continue;
    }
    if (fails <= best->texels_per_metre * kCloseEnough) return best;
    density = std::isinf(fails) ? density * 1.05f : std::sqrt(fails * best->texels_per_metre);
  }
  return std::nullopt;
}

}  // namespace goldthread
