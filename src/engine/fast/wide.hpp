/// @file
/// Plain loops for the widest vectors of the processor that runs them.
#pragma once

#include <cstddef>

/// @cond
// flatten: a call of work(k) for every k would cost more than what it does. A build can define it to leave
// out an instruction set (docs/performance.md).
#if defined(DPDREF_WIDE)
#elif defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define DPDREF_WIDE __attribute__((flatten, target_clones("avx512f", "avx2", "default")))
#else
#define DPDREF_WIDE
#endif
#if defined(__clang__)  // looks for itself whether the columns overlap
#define DPDREF_INDEPENDENT
#else
#define DPDREF_INDEPENDENT _Pragma("GCC ivdep")
#endif
/// @endcond

namespace dpd {

/// Calls work(k) for k = 0 .. count-1; no call may need what another has written. Compiled once for each of
/// three instruction sets, of which the program chooses one when it starts: all do the same operations on
/// every k, so all give the same bits. Static, because g++ 14 breaks down over clones of a function that
/// several files share.
template <class Work>
DPDREF_WIDE static void wide_loop(std::size_t count, Work work) {
    DPDREF_INDEPENDENT
    for (std::size_t k = 0; k < count; ++k) work(k);
}

/// The same for calls that must come one after the other.
template <class Work>
DPDREF_WIDE static void ordered_loop(std::size_t begin, std::size_t end, Work work) {
    for (std::size_t k = begin; k < end; ++k) work(k);
}

}  // namespace dpd
