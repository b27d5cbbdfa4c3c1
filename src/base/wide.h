// Loops over plain arrays whose iterations the compiler works out several at a time.
#pragma once

/// Before a function whose loops are worth eight lanes, or sixteen: it is compiled for processors that have
/// them, too, and the one that fits is chosen when the program starts. No number depends on which, since each
/// lane does what a single number would have done, and nothing is contracted (-ffp-contract=off).
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_THREAD__)
#define GOLDTHREAD_WIDE_CLONES __attribute__((target_clones("default", "avx2", "arch=x86-64-v4")))
#else
#define GOLDTHREAD_WIDE_CLONES
#endif
