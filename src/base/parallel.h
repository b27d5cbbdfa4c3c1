// Deterministic parallel loops over oneTBB. Bodies write only to their own index, so that the result does not
// depend on how many threads there are.
#pragma once
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstddef>

namespace goldthread {

/// Calls body(i) for every i in [0, count), in no order, on all threads. `grain` is the least work a task.
template <typename Body>
void parallel_for(size_t count, const Body& body, size_t grain = 1) {
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, grain),
                    [&](const tbb::blocked_range<size_t>& range) {
                      for (size_t i = range.begin(); i != range.end(); ++i) body(i);
                    });
}

}  // namespace goldthread
