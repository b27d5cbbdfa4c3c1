#include "trace/reference_image.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/parallel.h"
#include "math/colour.h"
#include "trace/lens.h"
#include "trace/preview.h"

namespace goldthread {
namespace {

using Clock = std::chrono::steady_clock;

/// One pixel: its samples' sum, and sum and squares of its passes' mean luminance.
struct Pixel {
  dvec3 sum{0};
  double luminance = 0, squares = 0;
  uint32_t passes = 0;

  void add(const dvec3& pass_mean) {
    const auto brightness = static_cast<double>(goldthread::luminance(vec3(pass_mean)));
    sum += pass_mean;
    luminance += brightness;
    squares += brightness * brightness;
    ++passes;
  }
  /// Standard error over mean.
  double relative_error() const {
    const double mean = luminance / passes, variance = squares / passes - mean * mean;
    return std::sqrt(std::max(0.0, variance) / (passes - 1)) / mean;
  }
};

struct Painter {
  const PathTracer& tracer;
  const Lens& lens;
  vec2 size;
  uint32_t seed;

  /// The mean of one pass' samples of a pixel.
  dvec3 sample(uint32_t x, uint32_t y, uint32_t pixel, uint32_t pass, RayCount& count) const {
    const uint32_t pass_seed = hash(hash(seed, pixel), pass);
    dvec3 sum(0);
    for (uint32_t i = 0; i < kBatches; ++i) {
      count.timed = (pixel + i + pass) % kBatches == 0;
      PathSampler sampler(i, pass_seed);
      const SobolPoint p = sampler.next();
      const vec2 inside(static_cast<float>(unit_double(p.u)), static_cast<float>(unit_double(p.v)));
      const Ray ray = lens.ray((vec2(static_cast<float>(x), static_cast<float>(y)) + inside) / size);
      sum += dvec3(tracer.radiance(ray, sampler, count));
    }
    return sum / static_cast<double>(kBatches);
  }
};

double mean_error(const std::vector<Pixel>& pixels) {
  double sum = 0, lit = 0;
  for (const Pixel& pixel : pixels) {
    if (pixel.passes < 2 || !(pixel.luminance > 0)) continue;
    sum += pixel.relative_error();
    lit += 1;
  }
  return lit > 0 ? sum / lit : 0;
}

void finish(const std::vector<Pixel>& pixels, ReferenceImage& result) {
  uint32_t least = std::numeric_limits<uint32_t>::max(), most = 0;
  result.image.pixels.resize(pixels.size());
  for (size_t i = 0; i < pixels.size(); ++i) {
    least = std::min(least, pixels[i].passes);
    most = std::max(most, pixels[i].passes);
    if (pixels[i].passes > 0) result.image.pixels[i] = vec3(pixels[i].sum / double(pixels[i].passes));
  }
  result.least_samples = least * kBatches;
  result.most_samples = most * kBatches;
  result.relative_error = mean_error(pixels);
}

}  // namespace

ReferenceImage trace_reference_image(const PathTracer& tracer, const ReferenceImageOptions& options,
                                     const CancelToken& cancel, EstimateProgress& progress) {
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const Scene& scene = tracer.scene().scene();
  const Camera camera = scene.cameras.empty() ? frame_camera(scene) : scene.cameras.front();
  ReferenceImage result;
  FloatImage& image = result.image;
  image.width = static_cast<uint32_t>(std::max(1, options.width));
  image.height = picture_height(options.height, image.width, camera);
  const Lens lens(camera, image.width, image.height);
  const Painter painter{tracer, lens, vec2(float(image.width), float(image.height)),
                        hash(static_cast<uint32_t>(options.seed), static_cast<uint32_t>(options.seed >> 32))};
  std::vector<Pixel> pixels(size_t{image.width} * image.height);
  std::vector<RayCount> rays(image.height);
  const uint64_t passes = (options.stop.samples + kBatches - 1) / kBatches;
  std::atomic<bool> stopped{false};
  for (uint32_t pass = 0; !stopped; ++pass) {
    progress.error = mean_error(pixels);
    const double share = passes > 0 ? static_cast<double>(pass) / static_cast<double>(passes) : 0;
    progress.share = std::max(share, elapsed() / options.stop.time_limit);
    if (options.stop.target_error > 0 && pass >= 4 && progress.error <= options.stop.target_error) {
      result.stop_reason = StopReason::kTargetError;
      break;
    }
    if (passes > 0 && pass >= passes) break;
    parallel_for(image.height, [&](size_t y) {
      RayCount row;
      for (uint32_t x = 0; x < image.width && !stopped; ++x) {
        if (cancel.cancelled() || elapsed() > options.stop.time_limit) {
          stopped = true;
          break;
        }
        const auto pixel = static_cast<uint32_t>(y * image.width + x);
        pixels[pixel].add(painter.sample(x, static_cast<uint32_t>(y), pixel, pass, row));
      }
      rays[y] += row;
      progress.rays.fetch_add(row.rays, std::memory_order_relaxed);
    });
  }
  if (stopped) result.stop_reason = cancel.cancelled() ? StopReason::kCancelled : StopReason::kTimeLimit;
  for (const RayCount& more : rays) result.rays += more;
  finish(pixels, result);
  return result;
}

}  // namespace goldthread
