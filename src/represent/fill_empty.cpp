#include "represent/fill_empty.h"

#include <algorithm>

#include "base/parallel.h"

namespace goldthread {
namespace {

/// A page at one level of detail; `weight` says how sure a texel's value is, 0 not at all and 1 wholly.
struct Level {
  uint32_t width = 0, height = 0;
  std::vector<vec3> value;
  std::vector<float> weight;

  size_t at(uint32_t x, uint32_t y) const { return size_t{y} * width + x; }
};

/// One ring: texels without a value beside such as have one.
std::vector<uint8_t> grow(FloatImage& page, const std::vector<uint8_t>& known) {
  std::vector<uint8_t> grown = known;
  parallel_for(page.height, [&](size_t row) {
    const auto y = static_cast<int64_t>(row);
    for (int64_t x = 0; x < page.width; ++x) {
      const size_t here = row * page.width + static_cast<size_t>(x);
      if (known[here]) continue;
      vec3 sum(0);
      float count = 0;
      for (int64_t v = std::max<int64_t>(0, y - 1); v <= std::min<int64_t>(page.height - 1, y + 1); ++v)
        for (int64_t u = std::max<int64_t>(0, x - 1); u <= std::min<int64_t>(page.width - 1, x + 1); ++u) {
          const size_t there = static_cast<size_t>(v) * page.width + static_cast<size_t>(u);
          if (!known[there]) continue;
          sum += page.pixels[there];
          ++count;
        }
      if (count == 0) continue;
      page.pixels[here] = sum / count;
      grown[here] = 1;
    }
  });
  return grown;
}

/// Half the size, rounded up: means weighted by how sure they are. A coarse texel is wholly sure once a
/// quarter of it is.
Level pull(const Level& fine) {
  Level coarse;
  coarse.width = (fine.width + 1) / 2;
  coarse.height = (fine.height + 1) / 2;
  coarse.value.resize(size_t{coarse.width} * coarse.height, vec3(0));
  coarse.weight.resize(coarse.value.size(), 0);
  parallel_for(coarse.height, [&](size_t row) {
    const auto y = static_cast<uint32_t>(row);
    for (uint32_t x = 0; x < coarse.width; ++x) {
      vec3 sum(0);
      float weight = 0;
      for (uint32_t v = 2 * y; v < std::min(2 * y + 2, fine.height); ++v)
        for (uint32_t u = 2 * x; u < std::min(2 * x + 2, fine.width); ++u) {
          sum += fine.weight[fine.at(u, v)] * fine.value[fine.at(u, v)];
          weight += fine.weight[fine.at(u, v)];
        }
      if (weight > 0) coarse.value[coarse.at(x, y)] = sum / weight;
      coarse.weight[coarse.at(x, y)] = std::min(1.0f, weight);
    }
  });
  return coarse;
}

/// Where the fine level is not sure, what the coarse one says there, bilinearly.
void push(const Level& coarse, Level& fine) {
  parallel_for(fine.height, [&](size_t row) {
    const auto y = static_cast<uint32_t>(row);
    const uint32_t y0 = y / 2;
    const uint32_t y1 = y % 2 ? std::min(y0 + 1, coarse.height - 1) : (y0 > 0 ? y0 - 1 : 0);
    for (uint32_t x = 0; x < fine.width; ++x) {
      float& weight = fine.weight[fine.at(x, y)];
      if (weight >= 1) continue;
      const uint32_t x0 = x / 2;
      const uint32_t x1 = x % 2 ? std::min(x0 + 1, coarse.width - 1) : (x0 > 0 ? x0 - 1 : 0);
      const vec3 smooth = 0.5625f * coarse.value[coarse.at(x0, y0)] +
                          0.1875f * (coarse.value[coarse.at(x1, y0)] + coarse.value[coarse.at(x0, y1)]) +
                          0.0625f * coarse.value[coarse.at(x1, y1)];
      vec3& value = fine.value[fine.at(x, y)];
      value = weight * value + (1 - weight) * smooth;
      weight = 1;
    }
  });
}

}  // namespace

void fill_empty(FloatImage& page, const std::vector<uint8_t>& covered, uint32_t rings) {
  if (std::find(covered.begin(), covered.end(), uint8_t{1}) == covered.end()) {
    std::fill(page.pixels.begin(), page.pixels.end(), vec3(0));
    return;
  }
  std::vector<uint8_t> known = covered;
  for (uint32_t ring = 0; ring < rings; ++ring) known = grow(page, known);
  std::vector<Level> levels(1);
  levels[0] = {page.width, page.height, std::move(page.pixels), {known.begin(), known.end()}};
  while (levels.back().width > 1 || levels.back().height > 1) levels.push_back(pull(levels.back()));
  for (size_t level = levels.size() - 1; level > 0; --level) push(levels[level], levels[level - 1]);
  page.pixels = std::move(levels[0].value);
}

}  // namespace goldthread
