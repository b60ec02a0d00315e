/// @file
/// The memory that a scene's run will need, known before it is taken.
#pragma once

#include "scene.hpp"
#include "toml_reader.hpp"

namespace dpd {

/// Bytes; the least of what the machine has and the process or its control group may take.
double memory_at_hand();

/// Bytes for a lag of a correlation: its time, and two sums per block.
inline constexpr double bytes_per_lag = 8.0 + 2.0 * 8.0 * double(curve_blocks);

/// InputError, with the key and the bytes of the largest part, if the run needs more memory than the machine
/// has or than the process or its control group may take: particles and their pairs, cells of the search,
/// time origins and lags, samples.
void check_size(Scene const& scene, TomlReader& root);

}  // namespace dpd
