// A solver on a thread of its own: pause, cancel, look, without ever making it wait.
#pragma once
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>

#include "base/progress.h"
#include "scene/lighting.h"
#include "solve/hierarchical/solver.h"

namespace goldthread {

/// What a running solve looks like from outside.
struct SolveProgress {
  double share = 0;  ///< 0..1
  double epsilon = 0;
  double error_estimate = 0;
  uint64_t rays = 0;
  uint64_t links = 0;
  uint64_t elements = 0;
};

/// Runs a solver to its end. All members may be called from any one other thread.
class SolveSession {
 public:
  explicit SolveSession(HierarchicalSolver& solver);  ///< borrowed
  ~SolveSession();                                    ///< cancels and waits
  SolveSession(const SolveSession&) = delete;
  SolveSession& operator=(const SolveSession&) = delete;

  void start();
  void pause();  ///< takes effect within a wave of refinement; returns at once
  void resume();
  void cancel();  ///< the solver sweeps what it has and stops
  /// Waits until the solve has ended or `milliseconds` have passed; returns whether it has ended.
  bool wait(int milliseconds);

  SolveProgress progress() const;
  /// The newest picture of the light, immutable; null before the first. Never blocks for longer than a
  /// pointer's copy.
  std::shared_ptr<const Lighting> snapshot() const;
  /// Asks for a newer one; it is published between two waves of refinement. The first is published unasked.
  void request_snapshot() { wanted_.store(true, std::memory_order_relaxed); }
  /// Called on the solver's thread between waves, to watch memory and the like; returning true cancels.
  std::function<bool()> watch;

 private:
  void run();
  void breathe(bool picture_due);
  void publish();

  HierarchicalSolver& solver_;
  CancelToken cancel_;
  std::thread thread_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool paused_ = false, finished_ = false;
  std::atomic<bool> wanted_{false};
  SolveProgress progress_;
  std::shared_ptr<const Lighting> snapshot_;
  uint32_t revision_ = 0;
};

}  // namespace goldthread
