// Long work on a thread of its own, so that the one that asked for it can tell how far it is and hear that it
// should stop.
#pragma once
#include <chrono>
#include <future>

#include "base/progress.h"
#include "goldthread/bake.h"

namespace goldthread {

using Clock = std::chrono::steady_clock;

inline double since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Runs `work(cancel)`, and while it lasts raises `cancel` as soon as `should_stop()` says so, and calls
/// `tell()` twice a second. Both are called from this thread. Throws what `work` throws.
template <typename Work, typename ShouldStop, typename Tell>
void run_watched(const Work& work, const ShouldStop& should_stop, const Tell& tell) {
  CancelToken cancel;
  std::future<void> done = std::async(std::launch::async, [&] { work(cancel); });
  auto told = Clock::now();
  while (done.wait_for(std::chrono::milliseconds(3)) != std::future_status::ready) {
    if (should_stop()) cancel.cancel();
    if (since(told) < 0.5) continue;
    told = Clock::now();
    tell();
  }
  done.get();
}

}  // namespace goldthread
