/// @file
/// Counter-based noise: a pure function of (seed, step, stream, who), so that no loop order changes it.
#pragma once

#include <cstdint>
#include <span>

#include "noise_key.hpp"

namespace dpd {

/// Standard normal of the ordered pair (a, b).
double normal(NoiseKey key, std::uint32_t a, std::uint32_t b);

/// Uniform in [0, 1) of the ordered pair (a, b), independent of `normal` of another stream.
double uniform(NoiseKey key, std::uint32_t a, std::uint32_t b);

/// out[k] = normal of the unordered pair {id[i[k]], id[j[k]]}; all spans of i, j, out have one length.
void pair_normals(NoiseKey key, std::span<std::uint32_t const> i, std::span<std::uint32_t const> j,
                  std::uint32_t const* id, std::span<double> out);

/// The same with a uniform of [0, 1).
void pair_uniforms(NoiseKey key, std::span<std::uint32_t const> i, std::span<std::uint32_t const> j,
                   std::uint32_t const* id, std::span<double> out);

}  // namespace dpd
