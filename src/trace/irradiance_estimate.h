// Irradiance at many points by path tracing, with standard errors that can be trusted; goes on for as long as
// one likes, and can be laid down and taken up again.
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <vector>

#include "base/progress.h"
#include "trace/path_tracer.h"
#include "trace/receivers.h"

namespace goldthread {

/// A point's samples are dealt out to so many independently scrambled sequences. Each sequence's mean is an
/// independent, unbiased estimate, so that the spread of these means is an honest measure of their mean's
/// error; the spread of samples within a sequence would not be, for those avoid each other (Owen 1997).
constexpr size_t kBatches = 16;

/// What is kept of a point: nothing more is needed to go on.
struct IrradianceSums {
  std::array<dvec3, kBatches> batches{};  ///< sums of samples, lux
  uint64_t samples = 0;                   ///< of all batches together; a multiple of kBatches
};

struct IrradianceValue {
  dvec3 mean{0};            ///< lux
  dvec3 standard_error{0};  ///< of the mean, lux: Student's t with kBatches - 1 degrees of freedom
};
/// Of no samples: zero.
IrradianceValue evaluate(const IrradianceSums& sums);

/// Of the mean's luminance, lux; 0 of no samples.
double luminance_standard_error(const IrradianceSums& sums);

/// Mean over all points that any light has reached of standard error over mean, both as luminance; 0 when
/// there are none.
double mean_relative_error(const std::vector<IrradianceSums>& points);

/// When to stop; whichever comes first.
struct StopRules {
  uint64_t samples = 0;     ///< a point, rounded up to a multiple of kBatches; 0: no end
  double target_error = 0;  ///< mean_relative_error; 0: no end. Looked at after 64, 96, 128, 192, ... samples
  double time_limit = std::numeric_limits<double>::infinity();  ///< seconds
};

enum class StopReason { kSamples, kTargetError, kTimeLimit, kCancelled };

/// Figures that other threads may read while `run` goes on.
struct EstimateProgress {
  std::atomic<uint64_t> rays{0};
  std::atomic<double> share{0};  ///< of the samples or the time asked for, 0..1
  std::atomic<double> error{0};  ///< mean_relative_error
};

/// Samples of many points. Sample i of point p depends on seed, p and i alone: not on threads, rounds or
/// interruptions.
class IrradianceEstimate {
 public:
  /// `sums` are those of an earlier estimate of the same receivers with the same seed, or empty.
  IrradianceEstimate(const PathTracer& tracer, std::vector<Receiver> receivers, uint64_t seed,
                     std::vector<IrradianceSums> sums = {});

  /// Takes samples until a rule or `cancel` says stop, within a quarter of a second. Points may then differ
  /// in their number of samples.
  StopReason run(const StopRules& rules, const CancelToken& cancel);

  const std::vector<Receiver>& receivers() const { return receivers_; }
  const std::vector<IrradianceSums>& sums() const { return sums_; }
  const PathCost& rays() const { return rays_; }
  const EstimateProgress& progress() const { return progress_; }

 private:
  struct Round;
  uint64_t least_samples() const;
  bool trace_round(const Round& round, double deadline_seconds, const CancelToken& cancel);
  bool trace_slice(const Round& round, size_t first, size_t last, const std::function<bool()>& stop);

  const PathTracer& tracer_;
  std::vector<Receiver> receivers_;
  std::vector<IrradianceSums> sums_;
  uint32_t seed_;
  PathCost rays_;
  double paths_per_second_ = 50000;  ///< a guess at first
  EstimateProgress progress_;
};

}  // namespace goldthread
