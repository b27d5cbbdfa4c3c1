// Deterministic parallel loops over oneTBB. Bodies write only to their own index, so that the result does not
// depend on how many threads there are. All of goldthread's loops go through here, where the thread sanitizer
// learns what oneTBB, which it cannot look into, promises about their order.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <cstddef>

#if defined(__SANITIZE_THREAD__)  // g++'s name
#include <sanitizer/tsan_interface.h>
#define GOLDTHREAD_TSAN(call) __tsan_##call
#else
#define GOLDTHREAD_TSAN(call) static_cast<void>(0)
#endif

namespace goldthread {

/// What comes before a loop is seen by all its bodies, and what they do is seen after it. Of each other
/// bodies see nothing, so that a race between two is reported even where one happened to end before the other
/// began.
class LoopOrder {
 public:
  LoopOrder() { GOLDTHREAD_TSAN(release(&begin_)); }
  ~LoopOrder() { GOLDTHREAD_TSAN(acquire(&end_)); }
  LoopOrder(const LoopOrder&) = delete;
  LoopOrder& operator=(const LoopOrder&) = delete;

  template <typename Body>
  void run(const Body& body) {
    GOLDTHREAD_TSAN(acquire(&begin_));
    body();
    GOLDTHREAD_TSAN(release(&end_));
  }

 private:
  alignas(8) [[maybe_unused]] char begin_ = 0;
  alignas(8) [[maybe_unused]] char end_ = 0;
};

/// Calls body(begin, end) for ranges that make up [0, count), in no order, on all threads. `grain` is the
/// least work a task.
template <typename Body>
void parallel_ranges(size_t count, const Body& body, size_t grain = 1) {
  LoopOrder order;
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, count, grain),
      [&](const tbb::blocked_range<size_t>& range) { order.run([&] { body(range.begin(), range.end()); }); });
}

/// Calls body(i) for every i in [0, count), in no order, on all threads. `grain` is the least work a task.
template <typename Body>
void parallel_for(size_t count, const Body& body, size_t grain = 1) {
  parallel_ranges(
      count,
      [&](size_t begin, size_t end) {
        for (size_t i = begin; i != end; ++i) body(i);
      },
      grain);
}

/// Calls all bodies, in no order, on all threads.
template <typename... Bodies>
void parallel_invoke(const Bodies&... bodies) {
  LoopOrder order;
  tbb::parallel_invoke([&] { order.run(bodies); }...);
}

}  // namespace goldthread
