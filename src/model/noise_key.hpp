/// @file
/// What noise is a function of: the key that stages are given.
#pragma once

#include <cstdint>

namespace dpd {

/// Which noise: `stream` separates the stages of one step that draw (their place in the stage list), `sweep`
/// the draws of one stage.
struct NoiseKey {
    std::uint64_t seed = 0;
    std::uint64_t step = 0;  ///< below 2^48
    std::uint8_t stream = 0;
    std::uint8_t sweep = 0;
};

/// Streams outside any stage list.
inline constexpr std::uint8_t stream_positions = 254;
inline constexpr std::uint8_t stream_velocities = 255;

}  // namespace dpd
