/// @file
/// The noise of the plain engine.
#include <Random123/philox.h>

#include <numbers>

#include "plain.hpp"

namespace dpd::plain {

// 128 random bits by Philox4x32-10 (Salmon et al. 2011), as two numbers in [0, 1) of 52 bits each.
static std::array<double, 2> random_numbers(NoiseKey key, std::uint32_t a, std::uint32_t b) {
    auto const word = [](std::uint64_t x) { return std::uint32_t(x); };
    auto const upper =
        word(key.step >> 32) | std::uint32_t{key.sweep} << 16 | std::uint32_t{key.stream} << 24;
    r123::Philox4x32::ctr_type const counter{{a, b, word(key.step), upper}};
    auto const x = r123::Philox4x32{}(counter, {{word(key.seed), word(key.seed >> 32)}});
    auto const number = [](std::uint64_t high, std::uint32_t low) {
        return double((high << 32 | low) >> 12);
    };
    return {number(x[0], x[1]) * 0x1p-52, number(x[2], x[3]) * 0x1p-52};
}

// ln u = e ln 2 + 2 artanh((m-1)/(m+1)), u = 2^e m with m between sqrt(1/2) and sqrt(2).
static double logarithm(double u) {
    int e;
    double m = std::frexp(u, &e);
    if (m < 0.5 * std::numbers::sqrt2) m *= 2.0, e -= 1;
    double const s = (m - 1.0) / (m + 1.0);
    double series = 1.0 / 19.0;  // 1 + s^2/3 + s^4/5 + ...
    for (double k = 17.0; k > 0.0; k -= 2.0) series = series * (s * s) + 1.0 / k;
    return e * std::numbers::ln2 + (s + s) * series;
}

// sin(2 pi u) for |u| <= 1/4 by Taylor's series of eleven terms.
static double sine_of_turn(double u) {
    long double const turn = 2.0L * std::numbers::pi_v<long double>;
    std::array<long double, 11> c{turn};
    for (std::size_t k = 1; k < 11; ++k) c[k] = c[k - 1] * (-turn * turn / (2.0L * k * (2.0L * k + 1.0L)));
    double series = 0.0;
    for (std::size_t k = 11; k-- > 0;) series = series * (u * u) + double(c[k]);
    return u * series;
}

// Box & Muller: sqrt(-2 ln u) cos(2 pi w); the cosine is the sine of what w lacks of a quarter turn. The
// series are ours because those of C libraries differ in the last bit.
double normal_noise(NoiseKey key, std::uint32_t i, std::uint32_t j) {
    auto const [one, two] = random_numbers(key, std::min(i, j), std::max(i, j));
    return std::sqrt(-2.0 * logarithm(1.0 - one)) * sine_of_turn(0.25 - std::abs(two - 0.5));
}

double uniform_noise(NoiseKey key, std::uint32_t a, std::uint32_t b) { return random_numbers(key, a, b)[0]; }

}  // namespace dpd::plain
