/// @file
/// Elementary functions with the same bits everywhere. Those of C libraries differ in the last digit, even
/// between processors of one kind; here are only exactly rounded operations, in an order that is written
/// down. Whatever a result of a run depends on is computed with these.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace dpd {

/// x^n for an integer n >= 0, by repeated multiplication.
constexpr double power(double x, int n) {
    double result = 1.0;
    for (; n > 0; --n) result *= x;
    return result;
}

/// ln u, u > 0, to 3 units in the last place: e ln 2 + 2 artanh((m-1)/(m+1)), where u = 2^e m with m between
/// sqrt(1/2) and sqrt(2).
inline double logarithm(double u) {
    int e;
    double m = std::frexp(u, &e);
    if (m < 0.5 * std::numbers::sqrt2) m *= 2.0, e -= 1;
    double const s = (m - 1.0) / (m + 1.0);
    double series = 1.0 / 19.0;  // 1 + s^2/3 + s^4/5 + ...
    for (double k = 17.0; k > 0.0; k -= 2.0) series = series * (s * s) + 1.0 / k;
    return e * std::numbers::ln2 + (s + s) * series;
}

/// ln 2 in two parts; a product of the higher one with an integer below 2^20 is exact.
inline constexpr double ln2_high = 0x1.62e42feep-1, ln2_low = 0x1.a39ef35793c76p-33;

/// 1 - e^-y for y >= 0, to 3 units in the last place, without a branch: e^-y = 2^-n e^-r with |r| <= ln(2)/2
/// and 1 - e^-r = r(1 - r/2 (1 - r/3 (...))).
inline double one_minus_exponential(double y) {
    constexpr double integer = 0x1.8p52;  // a sum with it has an integer in its last bits
    double const z = y < 64.0 ? y : 64.0;
    double const shifted = z * std::numbers::log2e + integer, n = shifted - integer;
    double const r = (z - n * ln2_high) - n * ln2_low;
    double series = 1.0;
    for (int k = 14; k > 1; --k) series = 1.0 - series * r * (1.0 / k);
    // 2^-n, from the exponent's bits
    double const scale =
        std::bit_cast<double>((std::uint64_t{1023} << 52) - (std::bit_cast<std::uint64_t>(shifted) << 52));
    return (1.0 - scale) + scale * (r * series);
}

/// e^x for |x| < 700, to 3 units in the last place.
inline double exponential(double x) {
    double const n = std::round(x * std::numbers::log2e);
    double const r = (x - n * ln2_high) - n * ln2_low;
    double series = 1.0;  // e^r = 1 + r(1 + r/2 (1 + r/3 (...)))
    for (int k = 14; k > 0; --k) series = 1.0 + series * r * (1.0 / k);
    return std::ldexp(series, static_cast<int>(n));
}

/// x^p for x > 0 and any real p; 0 for x = 0, p > 0.
inline double power(double x, double p) { return x > 0.0 ? exponential(p * logarithm(x)) : 0.0; }

/// The cube root of x >= 0: exact where it is a number of few digits.
inline double cube_root(double x) {
    if (!(x > 0.0)) return x;
    double root = power(x, 1.0 / 3.0);
    for (int step = 0; step < 2; ++step) root -= (root * root * root - x) / (3.0 * root * root);  // Newton
    return root;
}

/// x^(1/d) for d = 2 and 3.
inline double nth_root(double x, int d) { return d == 2 ? std::sqrt(x) : cube_root(x); }

/// The coefficients of sin(2 pi u) = u (c[0] + c[1] u^2 + ...), Taylor's series.
inline constexpr auto sine_of_turn_series = [] {
    constexpr double turn = 2.0 * std::numbers::pi;
    std::array<double, 11> c{turn};
    for (std::size_t k = 1; k < c.size(); ++k)
        c[k] = c[k - 1] * (-(turn * turn) / double(2 * k * (2 * k + 1)));
    return c;
}();

/// sin(2 pi u) for |u| <= 1/4, to 3 units in the last place.
inline double sine_of_turn(double u) {
    double series = 0.0;
    for (std::size_t k = sine_of_turn_series.size(); k-- > 0;)
        series = series * (u * u) + sine_of_turn_series[k];
    return u * series;
}

/// cos(2 pi u): the sine of what u, less its whole turns, lacks of a quarter.
inline double cosine_of_turn(double u) { return sine_of_turn(0.25 - std::abs(u - std::round(u))); }

}  // namespace dpd
