/// @file
/// The two inner loops of the pair search, compiled for every instruction set and chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dpd::simd {

/// Lanes of the widest vector: how far a kernel may write beyond its last result.
inline constexpr std::size_t widest = 8;

struct Range {
    std::size_t begin, end;
};

/// Positions by cell, readable `widest` entries beyond the end.
template <int d>
using Sorted = std::array<double const*, d>;

/// Entries that may pair: each of `home` with every entry of each range; but with those of the first range,
/// its own, from its successor on.
struct Candidates {
    Range home;
    std::span<Range const> ranges;
    double cutoff_squared;
};

/// Entries of the candidates closer than the cutoff, to i and j; returns how many.
std::size_t find_near(Sorted<2> const&, Candidates const&, std::uint32_t* i, std::uint32_t* j);
std::size_t find_near(Sorted<3> const&, Candidates const&, std::uint32_t* i, std::uint32_t* j);

/// Which image of j a pair means: r_i - r_j - shift, taken to the nearest image in a period (infinite: none).
template <int d>
struct Geometry {
    std::array<double, d> shift, period;
    double cutoff_squared;
};

/// Columns of `count` pairs; up to `widest` more entries are overwritten.
template <int d>
struct PairColumns {
    std::size_t count;
    std::array<double*, d> unit;  ///< comes as r_i - r_j
    double* distance;
};

/// Turns separations into unit vectors and distances. Returns how many of the pairs are none: at or beyond
/// the cutoff (distance infinite), or at r = 0 (distance 0).
std::size_t normalize(Geometry<2> const&, PairColumns<2> const&);
std::size_t normalize(Geometry<3> const&, PairColumns<3> const&);

}  // namespace dpd::simd
