#include "files/light_map_encode.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"

namespace goldthread {
namespace {

/// The brightest value that is kept: all above it becomes it. `values` ascending. An error of e at value v
/// counts as e^2 / (v + mean), between what a meter and what an eye makes of it: a few texels beside a lamp
/// may be far too dark before all others show steps. Up to w kept, rounding costs (w / 255)^2 / 6 each before
/// that weight (a twelfth of a step's square, and as much again at most for choosing up or down by a
/// pattern). All sums follow from running sums, so every value is tried.
float best_white(const std::vector<float>& values) {
  const size_t count = values.size();
  if (count == 0 || values.back() <= 0) return 1;
  double mean = 0, weights = 0;
  for (const float value : values) mean += static_cast<double>(value) / static_cast<double>(count);
  const auto weight = [&](double value) { return 1 / (value + mean); };
  for (const float value : values) weights += weight(static_cast<double>(value));
  const double rounding = weights / (6 * 255.0 * 255.0);
  double clipped = 0, clipped_light = 0, clipped_squares = 0;  // of weight, and times value and its square
  double best = 0;
  float white = values.back();
  for (size_t i = count; i-- > 0 && values[i] > 0;) {
    const auto w = static_cast<double>(values[i]);
    const double cost = rounding * w * w + clipped_squares - 2 * w * clipped_light + w * w * clipped;
    if (i + 1 == count || cost < best) {
      best = cost;
      white = values[i];
    }
    clipped += weight(w);
    clipped_light += w * weight(w);
    clipped_squares += w * w * weight(w);
  }
  return white;
}

/// Bayer's 4 by 4 pattern: thresholds that neighbouring texels share no two of.
float threshold(uint32_t x, uint32_t y) {
  constexpr std::array<uint8_t, 16> kOrder = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
  return (static_cast<float>(kOrder[4 * (y % 4) + x % 4]) + 0.5f) / 16;
}

}  // namespace

EncodedPage encode_page(const AtlasPage& page) {
  const std::vector<vec3>& pixels = page.irradiance.pixels;
  std::vector<float> values;
  for (size_t i = 0; i < pixels.size(); ++i)
    if (page.covered[i])
      for (int c = 0; c < 3; ++c) values.push_back(std::isfinite(pixels[i][c]) ? pixels[i][c] : 0.0f);
  std::sort(values.begin(), values.end());
  EncodedPage encoded;
  encoded.intensity = best_white(values);
  encoded.rgb.resize(pixels.size() * 3);
  parallel_for(page.irradiance.height, [&](size_t row) {
    for (size_t x = 0; x < page.irradiance.width; ++x) {
      const size_t i = row * page.irradiance.width + x;
      const float up = threshold(static_cast<uint32_t>(x), static_cast<uint32_t>(row));
      for (int c = 0; c < 3; ++c) {
        const float share = pixels[i][c] / encoded.intensity;  // NaN and less than 0 become 0
        const float steps = share > 0 ? std::min(share, 1.0f) * 255 : 0.0f;
        const float whole = std::floor(steps);
        encoded.rgb[3 * i + static_cast<size_t>(c)] =
            static_cast<uint8_t>(whole + (steps - whole > up ? 1.0f : 0.0f));
      }
    }
  });
  double squares = 0;
  for (size_t i = 0; i < pixels.size(); ++i) {
    if (!page.covered[i]) continue;
    bool clipped = false;
    for (int c = 0; c < 3; ++c) {
      const float shown = static_cast<float>(encoded.rgb[3 * i + static_cast<size_t>(c)]) / 255;
      const auto off = static_cast<double>(shown * encoded.intensity - pixels[i][c]);
      if (std::isfinite(off)) squares += off * off;
      clipped = clipped || pixels[i][c] > encoded.intensity;
    }
    encoded.clipped += clipped;
  }
  if (!values.empty()) encoded.error = std::sqrt(squares / static_cast<double>(values.size()));
  return encoded;
}

}  // namespace goldthread
