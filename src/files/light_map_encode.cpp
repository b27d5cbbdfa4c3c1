#include "files/light_map_encode.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "math/colour.h"

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

/// One channel as bytes, in steps of white / 255, by error diffusion (Floyd and Steinberg 1976), every other
/// row from right to left: what rounding takes from a texel its neighbours get, so that means over a few
/// texels are right and no pattern shows. NaN and what is below 0 become 0.
void diffuse(const FloatImage& page, int channel, float white, std::vector<uint8_t>& rgb) {
  const auto width = static_cast<int64_t>(page.width);
  // Of this row and the next, with a texel more on either side.
  std::vector<float> owed(page.width + 2, 0.0f), next(page.width + 2, 0.0f);
  for (uint32_t y = 0; y < page.height; ++y) {
    const int64_t along = y % 2 == 0 ? 1 : -1;
    for (int64_t i = 0, x = along > 0 ? 0 : width - 1; i < width; ++i, x += along) {
      const size_t texel = size_t{y} * page.width + static_cast<size_t>(x);
      const float share = page.pixels[texel][channel] / white;
      const float exact = share > 0 ? std::min(share, 1.0f) * 255 : 0.0f;
      const auto at = static_cast<size_t>(x + 1);
      const float wanted = exact + owed[at];
      const float shown = std::clamp(std::round(wanted), 0.0f, 255.0f);
      rgb[3 * texel + static_cast<size_t>(channel)] = static_cast<uint8_t>(shown);
      // What is black or white stays so: nothing can be owed to it or by it.
      const float error = exact > 0 && exact < 255 ? std::clamp(wanted - shown, -0.5f, 0.5f) : 0.0f;
      owed[static_cast<size_t>(x + 1 + along)] += error * 7 / 16;
      next[static_cast<size_t>(x + 1 - along)] += error * 3 / 16;
      next[at] += error * 5 / 16;
      next[static_cast<size_t>(x + 1 + along)] += error / 16;
    }
    owed.swap(next);
    std::fill(next.begin(), next.end(), 0.0f);
  }
}

}  // namespace

BakedPage encode_baked_page(const FloatImage& nits, const std::vector<float>& alpha, float exposure) {
  BakedPage page;
  page.rgba.resize(nits.pixels.size() * 4);
  parallel_for(
      nits.pixels.size(),
      [&](size_t i) {
        for (int c = 0; c < 4; ++c) {
          const float value = c < 3 ? linear_to_srgb(exposure * nits.pixels[i][c]) : alpha[i];
          page.rgba[4 * i + static_cast<size_t>(c)] =
              value > 0 ? static_cast<uint8_t>(std::lround(255 * std::min(value, 1.0f))) : uint8_t{0};
        }
      },
      4096);
  return page;
}

EncodedPage encode_grey_page(const AtlasPage& page) {
  AtlasPage grey = page;
  for (vec3& light : grey.irradiance.pixels) light = vec3(luminance(light));
  return encode_page(grey);
}

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
  for (int c = 0; c < 3; ++c) diffuse(page.irradiance, c, encoded.intensity, encoded.rgb);
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
