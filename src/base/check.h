// Broken invariants stop the program and print both values. For bugs only: bad input gets an Error.
#pragma once
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

namespace goldthread::detail {
template <typename A, typename B>
[[noreturn]] void check_failed(const char* expression, const A& a, const B& b, const char* file, int line) {
  fmt::print(stderr, "{}:{}: broken invariant {} ({} against {})\n", file, line, expression, a, b);
  std::abort();
}
}  // namespace goldthread::detail

#define GOLDTHREAD_CHECK_OP(op, a, b)                                                              \
  do {                                                                                             \
    const auto& check_a = (a);                                                                     \
    const auto& check_b = (b);                                                                     \
    if (!(check_a op check_b))                                                                     \
      ::goldthread::detail::check_failed(#a " " #op " " #b, check_a, check_b, __FILE__, __LINE__); \
  } while (false)
#define GOLDTHREAD_CHECK_EQ(a, b) GOLDTHREAD_CHECK_OP(==, a, b)
#define GOLDTHREAD_CHECK_LT(a, b) GOLDTHREAD_CHECK_OP(<, a, b)
#define GOLDTHREAD_CHECK_LE(a, b) GOLDTHREAD_CHECK_OP(<=, a, b)
