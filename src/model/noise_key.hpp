/// @file
/// What noise is a function of: the key that stages are given.
#pragma once

#include <cstdint>

namespace dpd {

/// Which noise: `stream` separates the stages of one step that draw (their place in the stage list), `sweep`
/// the draws of one stage.
struct NoiseKey {
    std::uint64_t seed = 0;   ///< of the simulation
    std::uint64_t step = 0;   ///< below 2^48
    std::uint8_t stream = 0;  ///< of the stage that draws
    std::uint8_t sweep = 0;   ///< of a stage that visits pairs several times a step
};

/// Streams outside any stage list.
inline constexpr std::uint8_t stream_positions = 254;
inline constexpr std::uint8_t stream_velocities = 255;  ///< of the initial velocities

}  // namespace dpd
