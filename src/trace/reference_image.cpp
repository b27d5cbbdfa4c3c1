#include "trace/reference_image.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/parallel.h"
#include "math/colour.h"
#include "trace/lens.h"
#include "trace/preview.h"

namespace goldthread {
namespace {

using Clock = std::chrono::steady_clock;

/// A picture in the making.
class Painting {
 public:
  Painting(const PathTracer& tracer, const Lens& lens, uint32_t width, uint32_t height, uint64_t seed,
           std::vector<PixelSums> before)
      : tracer_(tracer),
        lens_(lens),
        width_(width),
        height_(height),
        seed_(hash(static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32))),
        pixels_(std::move(before)) {
    pixels_.resize(size_t{width} * height);
  }

  uint32_t least_passes() const {
    uint32_t least = std::numeric_limits<uint32_t>::max();
    for (const PixelSums& pixel : pixels_) least = std::min(least, pixel.passes);
    return least;
  }

  /// One more pass over all pixels that have had `pass` of them, or over as many as it takes until `stop()`.
  /// False when it was stopped.
  template <typename Stop>
  bool add_pass(uint32_t pass, const Stop& stop, EstimateProgress& progress) {
    std::atomic<bool> stopped{false};
    std::vector<PathCost> rows(height_);
    parallel_for(height_, [&](size_t y) {
      for (uint32_t x = 0; x < width_; x += kPixelsTogether) {
        if (stopped || stop()) {
          stopped = true;
          return;
        }
        add_samples(x, std::min(width_, x + kPixelsTogether), static_cast<uint32_t>(y), pass, rows[y]);
      }
      progress.rays.fetch_add(rows[y].rays, std::memory_order_relaxed);
    });
    for (const PathCost& row : rows) rays_ += row;
    return !stopped;
  }

  double relative_error() const;
  void finish(ReferenceImage& result) const;

 private:
  static constexpr uint32_t kPixelsTogether = PathTracer::kBundle / kBatches;

  /// One more pass' samples of the pixels from `begin` to before `end` of row `y`, but for those that are
  /// ahead of `pass`: an earlier run was stopped behind them.
  void add_samples(uint32_t begin, uint32_t end, uint32_t y, uint32_t pass, PathCost& count) {
    std::array<CameraPath, PathTracer::kBundle> paths;
    std::array<vec3, PathTracer::kBundle> nits;
    const vec2 size(static_cast<float>(width_), static_cast<float>(height_));
    size_t filled = 0;
    const auto is_ahead = [&](uint32_t x) { return pixels_[size_t{y} * width_ + x].passes > pass; };
    for (uint32_t x = begin; x < end; ++x) {
      if (is_ahead(x)) continue;
      for (uint32_t i = 0; i < kBatches; ++i) {
        const PathSeed seed{i, hash(hash(seed_, y * width_ + x), pass)};
        const SobolPoint p = path_point(seed, kLensPair);
        const vec2 at(static_cast<float>(x) + static_cast<float>(unit_double(p.u)),
                      static_cast<float>(y) + static_cast<float>(unit_double(p.v)));
        paths[filled++] = {lens_.ray(at / size), seed};
      }
    }
    tracer_.radiance({paths.data(), filled}, {nits.data(), filled}, count);
    size_t read = 0;
    for (uint32_t x = begin; x < end; ++x) {
      if (is_ahead(x)) continue;
      dvec3 sum(0);
      for (uint32_t i = 0; i < kBatches; ++i) sum += dvec3(nits[read++]);
      pixels_[size_t{y} * width_ + x].add(sum / static_cast<double>(kBatches));
    }
  }

  const PathTracer& tracer_;
  const Lens& lens_;
  uint32_t width_, height_, seed_;
  std::vector<PixelSums> pixels_;
  PathCost rays_;
};

double Painting::relative_error() const {
  double sum = 0, lit = 0;
  for (const PixelSums& pixel : pixels_) {
    if (pixel.passes < 2 || !(pixel.luminance > 0)) continue;
    sum += pixel.standard_error() * pixel.passes / pixel.luminance;
    lit += 1;
  }
  return lit > 0 ? sum / lit : 0;
}

void Painting::finish(ReferenceImage& result) const {
  uint32_t least = std::numeric_limits<uint32_t>::max(), most = 0;
  result.image.pixels.resize(pixels_.size());
  for (size_t i = 0; i < pixels_.size(); ++i) {
    const PixelSums& pixel = pixels_[i];
    least = std::min(least, pixel.passes);
    most = std::max(most, pixel.passes);
    result.image.pixels[i] = vec3(pixel.mean());
  }
  result.least_samples = least * kBatches;
  result.most_samples = most * kBatches;
  result.relative_error = relative_error();
  result.rays = rays_;
  result.pixels = pixels_;
}

/// Adds passes until a rule or `cancel` says stop.
StopReason paint(Painting& painting, const StopRules& rules, const CancelToken& cancel,
                 EstimateProgress& progress) {
  constexpr uint32_t kLeastPasses = 4;  // before the spread of passes means anything
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const uint64_t passes = (rules.samples + kBatches - 1) / kBatches;
  for (uint32_t pass = painting.least_passes(); passes == 0 || pass < passes; ++pass) {
    progress.error = painting.relative_error();
    const double share = passes > 0 ? static_cast<double>(pass) / static_cast<double>(passes) : 0;
    progress.share = std::max(share, elapsed() / rules.time_limit);
    if (rules.target_error > 0 && pass >= kLeastPasses && progress.error <= rules.target_error)
      return StopReason::kTargetError;
    const auto stop = [&] { return cancel.cancelled() || elapsed() > rules.time_limit; };
    if (!painting.add_pass(pass, stop, progress))
      return cancel.cancelled() ? StopReason::kCancelled : StopReason::kTimeLimit;
  }
  return StopReason::kSamples;
}

}  // namespace

void PixelSums::add(const dvec3& pass_mean) {
  const auto brightness = static_cast<double>(goldthread::luminance(vec3(pass_mean)));
  sum += pass_mean;
  luminance += brightness;
  squares += brightness * brightness;
  ++passes;
}

double PixelSums::standard_error() const {
  if (passes < 2) return 0;
  const double mean = luminance / passes, variance = squares / passes - mean * mean;
  return std::sqrt(std::max(0.0, variance) / (passes - 1));
}

PixelSums PixelSums::of(const dvec3& mean, double standard_error, uint32_t passes) {
  PixelSums pixel;
  pixel.passes = passes;
  pixel.sum = mean * static_cast<double>(passes);
  const auto brightness = static_cast<double>(goldthread::luminance(vec3(mean)));
  pixel.luminance = brightness * passes;
  const double variance = standard_error * standard_error * (passes > 0 ? passes - 1 : 0);
  pixel.squares = (variance + brightness * brightness) * passes;
  return pixel;
}

ReferenceImage trace_reference_image(const PathTracer& tracer, const ReferenceImageOptions& options,
                                     const CancelToken& cancel, EstimateProgress& progress) {
  const Scene& scene = tracer.scene().scene();
  const Camera camera = first_camera(scene);
  ReferenceImage result;
  FloatImage& image = result.image;
  image.width = static_cast<uint32_t>(std::max(1, options.width));
  image.height = picture_height(options.height, image.width, camera);
  const Lens lens(camera, image.width, image.height);
  Painting painting(tracer, lens, image.width, image.height, options.seed, options.before);
  result.stop_reason = paint(painting, options.stop, cancel, progress);
  painting.finish(result);
  return result;
}

}  // namespace goldthread
