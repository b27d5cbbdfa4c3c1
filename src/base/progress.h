// How a long stage tells where it is and learns that it should stop.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string_view>

namespace goldthread {

/// A flag that anyone may raise, from any thread or a signal handler, and that every long loop reads.
class CancelToken {
 public:
  void cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const { return cancelled_.load(std::memory_order_relaxed); }

 private:
  std::atomic<bool> cancelled_{false};
};

}  // namespace goldthread
