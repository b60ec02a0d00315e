/// @file
/// The two inner loops of the pair search, compiled for every instruction set and chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace dpd::simd {

/// Lanes of the widest vector: how far a kernel may read and write beyond its last entry.
inline constexpr std::size_t widest = 16;

/// Particles by cell: positions in single precision, and rows in the state.
template <int d>
struct Sorted {
    std::array<float const*, d> position;
    std::uint32_t const* row;
};

/// Entries that follow each other in memory, as seen in an image displaced by `shift` along x and y.
struct Range {
    std::size_t begin, end;
    std::array<float, 2> shift;
};

/// Entries that may pair: each of a cell's own, the first range's up to `home_end`, with the rest of the
/// first range from its successor on, and with all of the other ranges.
struct Candidates {
    std::size_t home_end;
    std::size_t range_count;
    std::array<Range, 5> ranges;
};

/// Room for the candidates of one cell, and `widest` more.
template <int d>
struct Scratch {
    std::array<std::vector<float>, d> position;
    std::vector<std::uint32_t> row;
};

/// Rows of the candidates closer than the limit, to i and j; returns how many.
std::size_t find_near(Sorted<2> const&, std::span<Candidates const>, float limit_squared, Scratch<2>&,
                      std::uint32_t* i, std::uint32_t* j);
std::size_t find_near(Sorted<3> const&, std::span<Candidates const>, float limit_squared, Scratch<3>&,
                      std::uint32_t* i, std::uint32_t* j);

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
