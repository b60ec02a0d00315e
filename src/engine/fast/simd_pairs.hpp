/// @file
/// The two inner loops of the pair search, compiled for every instruction set and chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace dpd::simd {

/// Lanes of the widest vector: how far a kernel may read and write beyond its last entry.
inline constexpr std::size_t widest = 16;

/// Particles by cell: positions in single precision, and rows in the state.
template <int d>
struct Sorted {
    std::array<float const*, d> position;  ///< axis by axis
    std::uint32_t const* row;              ///< in the state
};

/// Entries that follow each other in memory, as seen in an image displaced by `shift` along x and y.
struct Range {
    std::size_t begin;           ///< its first entry
    std::size_t end;             ///< one past its last
    std::array<float, 2> shift;  ///< of the image, length
};

/// Entries that may pair: each of the home cells' own with all of the ranges; in the first one, which
/// begins with them, from its successor on. Without partners in its own row the first range is empty.
struct Candidates {
    std::size_t home_begin;       ///< first entry of the home cells
    std::size_t home_end;         ///< one past their last
    std::size_t range_count;      ///< how many of `ranges` there are
    std::array<Range, 5> ranges;  ///< where partners may be
};

/// Rows of the candidates closer than the limit, to i and j; returns how many. Up to `widest` more entries
/// are overwritten.
std::size_t find_near(Sorted<2> const&, std::span<Candidates const>, float limit_squared, std::uint32_t* i,
                      std::uint32_t* j);
std::size_t find_near(Sorted<3> const&, std::span<Candidates const>, float limit_squared, std::uint32_t* i,
                      std::uint32_t* j);

/// Which image of j a pair means: r_i - r_j - shift, taken to the nearest image in a period (infinite: none).
template <int d>
struct Geometry {
    std::array<double, d> shift;   ///< of the image, length
    std::array<double, d> period;  ///< sides; infinite: no image is looked for
    double cutoff_squared;         ///< length^2
};

/// Columns of `count` pairs; up to `widest` more entries are overwritten.
template <int d>
struct PairColumns {
    std::size_t count;            ///< of pairs
    std::array<double*, d> unit;  ///< comes as r_i - r_j
    double* distance;             ///< r
};

/// Turns separations into unit vectors and distances. Returns how many of the pairs are none: at or beyond
/// the cutoff (distance infinite), or at r = 0 (distance 0).
std::size_t normalize(Geometry<2> const&, PairColumns<2> const&);
std::size_t normalize(Geometry<3> const&, PairColumns<3> const&);

}  // namespace dpd::simd
