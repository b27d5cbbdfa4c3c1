// Large pages for what is read at random: an address far from the last one costs less to translate.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace goldthread {

/// `count` zeros in new memory, for which the system is asked for large pages. It may not have any: then
/// pages are what they always are.
template <typename T>
std::vector<T> zeros_in_huge_pages(size_t count) {
  std::vector<T> zeros;
  zeros.reserve(count);  // memory nobody has touched yet: pages are still to be chosen
#if defined(__linux__) && defined(MADV_HUGEPAGE)
  constexpr uintptr_t kHugePage = uintptr_t{1} << 21;
  const auto begin = reinterpret_cast<uintptr_t>(zeros.data());
  const uintptr_t first = (begin + kHugePage - 1) / kHugePage * kHugePage;
  const uintptr_t last = (begin + count * sizeof(T)) / kHugePage * kHugePage;
  if (first < last) static_cast<void>(madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE));
#endif
  zeros.resize(count);
  return zeros;
}

}  // namespace goldthread
