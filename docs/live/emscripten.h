/// @file
/// What emscripten 3.1 (Debian 12) lacks; included before everything else when the live pages' program is
/// compiled, and never natively.
#pragma once

#include <algorithm>
#include <bit>
#include <cfenv>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <numbers>
#include <string>

// Random123 refuses processors on which its authors have not tried it; RISC-V is one without special
// instructions.
#define __riscv 1
#define R123_USE_ASM_GNU 0
#define R123_USE_SSE 0
#include <Random123/philox.h>
#undef __riscv

// libc++ has it in double precision; the noise's coefficients are rounded from more digits.
template <>
inline constexpr long double std::numbers::pi_v<long double> = 3.141592653589793238462643383279502884L;

// WebAssembly keeps no flags of what overflowed; there a closed form may be a zero that natively is refused.
#ifndef FE_OVERFLOW
#define FE_OVERFLOW 0
#define FE_UNDERFLOW 0
#endif

// The bits of a number as another type, which libc++ has from its version 14 on; emscripten's is older.
#ifndef __cpp_lib_bit_cast
namespace std {
template <class To, class From>
constexpr To bit_cast(From const& from) noexcept {
  return __builtin_bit_cast(To, from);
}
}  // namespace std
#endif

// A number from text, which libc++ 14 has for integers only.
#if _LIBCPP_VERSION < 20000
namespace std {
inline from_chars_result from_chars(char const* first, char const* last, double& value) {
    string const text(first, last);  // ends with a zero, which strtod needs
    if (text.empty() || !(text[0] == '-' || text[0] == '.' || (text[0] >= '0' && text[0] <= '9')))
        return {first, errc::invalid_argument};
    char* end = nullptr;
    double const read = strtod(text.c_str(), &end);
    if (end == text.c_str()) return {first, errc::invalid_argument};
    value = read;
    return {first + (end - text.c_str()), errc()};
}
}  // namespace std
#endif

// The algorithms on ranges that libc++ 14 does not have yet.
#if _LIBCPP_VERSION < 15000
namespace std::ranges {

template <class Range, class Predicate>
auto find_if(Range&& range, Predicate predicate) {
    return std::find_if(std::begin(range), std::end(range), predicate);
}

template <class Range, class Value, class Projection = std::identity>
auto find(Range&& range, Value const& value, Projection projection = {}) {
    return std::find_if(std::begin(range), std::end(range),
                        [&](auto const& element) { return std::invoke(projection, element) == value; });
}

template <class Range, class Compare = std::less<>, class Projection = std::identity>
auto max_element(Range&& range, Compare compare = {}, Projection projection = {}) {
    return std::max_element(std::begin(range), std::end(range), [&](auto const& a, auto const& b) {
        return compare(std::invoke(projection, a), std::invoke(projection, b));
    });
}

}  // namespace std::ranges
#endif
