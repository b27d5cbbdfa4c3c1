#include "trace/irradiance_estimate.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "base/check.h"
#include "base/parallel.h"
#include "math/colour.h"

namespace goldthread {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSliceSeconds = 0.2;  ///< of work between two looks at the clock

double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

uint64_t rounded_up(uint64_t samples) {
  return (samples + kBatches - 1) / kBatches * kBatches;
}

double luminance_of(const dvec3& c) {
  return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
}

/// The next number of samples a point, above `now`, after which the error is looked at: 64, 96, 128, 192, ...
/// The places are fixed, so that where an estimate ends does not depend on the speed of the machine.
uint64_t next_look(uint64_t now) {
  uint64_t look = 4 * kBatches;
  while (look <= now) look = (look & (look - 1)) == 0 ? look / 2 * 3 : look / 3 * 4;
  return look;
}

/// Samples that are traced together, each added to the sum that it is for.
class Samples {
 public:
  Samples(const PathTracer& tracer, PathCost& count) : tracer_(tracer), count_(count) {}

  bool full() const { return size_ == PathTracer::kBundle; }
  void add(const Receiver& receiver, PathSeed seed, dvec3& sum) {
    starts_[size_] = {receiver.origin, receiver.normal, seed, receiver.surface};
    sums_[size_++] = &sum;
  }
  void trace() {
    tracer_.irradiance({starts_.data(), size_}, {lux_.data(), size_}, count_);
    for (size_t i = 0; i < size_; ++i) *sums_[i] += dvec3(lux_[i]);
    size_ = 0;
  }

 private:
  const PathTracer& tracer_;
  PathCost& count_;
  size_t size_ = 0;
  std::array<PathStart, PathTracer::kBundle> starts_;
  std::array<dvec3*, PathTracer::kBundle> sums_{};
  std::array<vec3, PathTracer::kBundle> lux_;
};

}  // namespace

IrradianceValue evaluate(const IrradianceSums& sums) {
  IrradianceValue value;
  if (sums.samples == 0) return value;
  const double each = static_cast<double>(sums.samples) / kBatches;
  for (const dvec3& batch : sums.batches) value.mean += batch / (each * kBatches);
  dvec3 squares(0);
  for (const dvec3& batch : sums.batches) {
    const dvec3 off = batch / each - value.mean;
    squares += off * off;
  }
  value.standard_error = glm::sqrt(squares / static_cast<double>(kBatches * (kBatches - 1)));
  return value;
}

double luminance_standard_error(const IrradianceSums& sums) {
  if (sums.samples == 0) return 0;
  const double mean = luminance_of(evaluate(sums).mean);
  double squares = 0;
  const double each = static_cast<double>(sums.samples) / kBatches;
  for (const dvec3& batch : sums.batches) {
    const double off = luminance_of(batch) / each - mean;
    squares += off * off;
  }
  return std::sqrt(squares / (kBatches * (kBatches - 1)));
}

double mean_relative_error(const std::vector<IrradianceSums>& points) {
  double sum = 0, lit = 0;
  for (const IrradianceSums& point : points) {
    const double mean = luminance_of(evaluate(point).mean);
    if (!(mean > 0)) continue;
    sum += luminance_standard_error(point) / mean;
    lit += 1;
  }
  return lit > 0 ? sum / lit : 0;
}

IrradianceEstimate::IrradianceEstimate(const PathTracer& tracer, std::vector<Receiver> receivers,
                                       uint64_t seed, std::vector<IrradianceSums> sums)
    : tracer_(tracer),
      receivers_(std::move(receivers)),
      sums_(std::move(sums)),
      seed_(hash(static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32))) {
  sums_.resize(receivers_.size());
}

/// What one round is to reach.
struct IrradianceEstimate::Round {
  uint64_t samples;  ///< that every point has at its end
  Clock::time_point start;
};

uint64_t IrradianceEstimate::least_samples() const {
  uint64_t least = std::numeric_limits<uint64_t>::max();
  for (const IrradianceSums& s : sums_) least = std::min(least, s.samples);
  return least;
}

StopReason IrradianceEstimate::run(const StopRules& rules, const CancelToken& cancel) {
  const auto start = Clock::now();
  const uint64_t wanted =
      rules.samples > 0 ? rounded_up(rules.samples) : std::numeric_limits<uint64_t>::max();
  while (true) {
    const uint64_t least = least_samples();
    progress_.error = mean_relative_error(sums_);
    const bool looked_at = least >= 4 * kBatches && next_look(least - 1) == least;
    if (rules.target_error > 0 && looked_at && progress_.error <= rules.target_error)
      return StopReason::kTargetError;
    if (least >= wanted) return StopReason::kSamples;
    const double share_of_samples =
        rules.samples > 0 ? static_cast<double>(least) / static_cast<double>(wanted) : 0;
    progress_.share = std::max(share_of_samples, since(start) / rules.time_limit);
    const uint64_t affordable =
        static_cast<uint64_t>(paths_per_second_ * kSliceSeconds) / std::max<size_t>(1, sums_.size());
    const uint64_t step = std::max<uint64_t>(1, affordable / kBatches) * kBatches;
    const Round round{std::min({wanted, least + step, next_look(least)}), start};
    if (!trace_round(round, rules.time_limit, cancel))
      return cancel.cancelled() ? StopReason::kCancelled : StopReason::kTimeLimit;
  }
}

bool IrradianceEstimate::trace_round(const Round& round, double deadline_seconds, const CancelToken& cancel) {
  for (size_t first = 0; first < sums_.size();) {
    const uint64_t each = round.samples - std::min(round.samples - kBatches, sums_[first].samples);
    const auto affordable = static_cast<size_t>(paths_per_second_ * kSliceSeconds) / each;
    const size_t last = std::min(sums_.size(), first + std::max<size_t>(1, affordable));
    const auto begin = Clock::now();
    const uint64_t rays_before = rays_.rays;
    const auto stop = [&] { return cancel.cancelled() || since(round.start) > deadline_seconds; };
    uint64_t paths = 0;
    for (size_t p = first; p < last; ++p) paths += round.samples - std::min(round.samples, sums_[p].samples);
    if (!trace_slice(round, first, last, stop)) return false;
    if (paths > 0) paths_per_second_ = static_cast<double>(paths) / std::max(1e-6, since(begin));
    progress_.rays += rays_.rays - rays_before;
    first = last;
  }
  return true;
}

// A sequence of a point is an item: so that few points keep all threads busy, too. Its samples add up in
// their order, whatever else goes in the same bundle. A slice that is interrupted is forgotten, for a point's
// batches must have the same number of samples.
bool IrradianceEstimate::trace_slice(const Round& round, size_t first, size_t last,
                                     const std::function<bool()>& stop) {
  const size_t count = (last - first) * kBatches;
  std::vector<dvec3> sums(count);
  std::vector<uint64_t> wanted(count);
  for (size_t item = 0; item < count; ++item) {
    const IrradianceSums& point = sums_[first + item / kBatches];
    sums[item] = point.batches[item % kBatches];
    wanted[item] = (round.samples - std::min(round.samples, point.samples)) / kBatches;
  }
  const uint64_t most = *std::max_element(wanted.begin(), wanted.end());
  const size_t together = std::max<size_t>(1, PathTracer::kBundle / std::max<uint64_t>(1, most));
  const size_t groups = (count + together - 1) / together;
  std::vector<PathCost> rays(groups);
  std::atomic<bool> stopped{false};
  parallel_for(groups, [&](size_t group) {
    Samples samples(tracer_, rays[group]);
    const auto go_on = [&] {
      if (stopped || stop()) {
        stopped = true;
        return false;
      }
      samples.trace();
      return true;
    };
    for (size_t item = group * together; item < std::min(count, (group + 1) * together); ++item) {
      const size_t p = first + item / kBatches, batch = item % kBatches;
      const uint32_t seed = hash(hash(seed_, static_cast<uint32_t>(p)), static_cast<uint32_t>(batch));
      const uint64_t begin = sums_[p].samples / kBatches;
      for (uint64_t i = begin; i < begin + wanted[item]; ++i) {
        if (samples.full() && !go_on()) return;
        samples.add(receivers_[p], {static_cast<uint32_t>(i), seed}, sums[item]);
      }
    }
    go_on();
  });
  for (const PathCost& more : rays) rays_ += more;
  if (stopped) return false;
  for (size_t item = 0; item < count; ++item)
    sums_[first + item / kBatches].batches[item % kBatches] = sums[item];
  for (size_t p = first; p < last; ++p) sums_[p].samples = std::max(sums_[p].samples, round.samples);
  return true;
}

}  // namespace goldthread
