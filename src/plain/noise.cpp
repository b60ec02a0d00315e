/// @file
/// The noise of the plain engine.
#include <Random123/philox.h>

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

// Box & Muller: sqrt(-2 ln u) cos(2 pi w); the cosine is the sine of what w lacks of a quarter turn.
double normal_noise(NoiseKey key, std::uint32_t i, std::uint32_t j) {
    auto const [one, two] = random_numbers(key, std::min(i, j), std::max(i, j));
    return std::sqrt(-2.0 * logarithm(1.0 - one)) * sine_of_turn(0.25 - std::abs(two - 0.5));
}

double uniform_noise(NoiseKey key, std::uint32_t a, std::uint32_t b) { return random_numbers(key, a, b)[0]; }

}  // namespace dpd::plain
