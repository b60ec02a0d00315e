/// @file
/// The list of pairs that a search leaves to the stages, and they to the recorder.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace dpd {

/// One pair of a list: its rows, the unit vector e from j to i, its distance, and whether it goes across the
/// upper Lees-Edwards boundary.
template <int d>
struct Pair {
    std::uint32_t i;               ///< row of one particle
    std::uint32_t j;               ///< row of the other
    Eigen::Array<double, 1, d> e;  ///< unit vector from j to i
    double r;                      ///< distance
    bool crossing;                 ///< across the sheared boundary
};

/// Pairs closer than the cutoff, each once. The pairs `crossing` go across the upper Lees-Edwards boundary:
/// their j stands for an image that moves at +image_speed along x. Arrays may be longer than `count`.
template <int d>
struct PairList {
    double cutoff = 1.0;                      ///< length
    std::size_t count = 0;                    ///< of pairs
    std::vector<std::uint32_t> crossing;      ///< which ones, ascending; empty without shear
    std::size_t coincident = 0;               ///< pairs at r = 0: no direction, so no interaction
    std::vector<std::uint32_t> i;             ///< row of one particle of each pair
    std::vector<std::uint32_t> j;             ///< row of the other
    std::array<std::vector<double>, d> unit;  ///< (r_i - r_j)/r
    std::vector<double> distance;             ///< r, in (0, cutoff)
    std::vector<double> impulse;              ///< change of i's velocity along `unit` in the last pair update
    bool updated = false;                     ///< there was one

    /// Leaves no pair; the memory stays.
    void clear() {
        count = coincident = 0;
        updated = false;
        crossing.clear();
    }
    /// Makes the arrays at least so long.
    void grow_to(std::size_t size);

    /// Adds a pair, without an impulse.
    void append(Pair<d> const& pair) {
        grow_to(count + 1);
        i[count] = pair.i;
        j[count] = pair.j;
        for (std::size_t axis = 0; axis < d; ++axis) unit[axis][count] = pair.e[Eigen::Index(axis)];
        distance[count] = pair.r;
        impulse[count] = 0.0;
        if (pair.crossing) crossing.push_back(static_cast<std::uint32_t>(count));
        ++count;
    }

    /// The k-th pair.
    Pair<d> pair(std::size_t k) const {
        Pair<d> result{i[k], j[k], {}, distance[k], std::binary_search(crossing.begin(), crossing.end(), k)};
        for (std::size_t axis = 0; axis < d; ++axis) result.e[Eigen::Index(axis)] = unit[axis][k];
        return result;
    }

    /// Bytes held by the arrays.
    std::size_t bytes() const;
};

extern template struct PairList<2>;
extern template struct PairList<3>;

}  // namespace dpd
