/// @file
/// How stages work through the pairs of a list.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

#include "box.hpp"
#include "pairs.hpp"
#include "stress.hpp"
#include "wide.hpp"

namespace dpd {

/// Pairs are worked through in blocks, few enough that what one loop leaves for the next stays in the
/// processor's nearest cache.
struct PairBlock {
    std::size_t begin;  ///< its first pair
    std::size_t end;    ///< one past its last
    /// How many pairs it has.
    std::size_t size() const { return end - begin; }
};

template <int d, class Work>
void for_each_block(PairList<d> const& pairs, Work&& work) {
    for (std::size_t begin = 0; begin < pairs.count; begin += block_size)
        work(PairBlock{begin, std::min(begin + block_size, pairs.count)});
}

/// The columns of a pair list by their addresses, which a loop then keeps in registers.
template <int d>
struct PairView {
    std::uint32_t const* i;             ///< row of one particle of each pair
    std::uint32_t const* j;             ///< row of the other
    std::array<double const*, d> unit;  ///< (r_i - r_j)/r, axis by axis
    double const* distance;             ///< r
    double* impulse;                    ///< change of i's velocity along `unit`
    /// Of a list that does not grow meanwhile.
    explicit PairView(PairList<d>& pairs)
        : i(pairs.i.data()),
          j(pairs.j.data()),
          distance(pairs.distance.data()),
          impulse(pairs.impulse.data()) {
        for (std::size_t axis = 0; axis < d; ++axis) unit[axis] = pairs.unit[axis].data();
    }
};

/// Where the rows of a pair begin in a field, and its direction.
template <int d>
struct PairRows {
    std::size_t i;            ///< place of the first component of one particle
    std::size_t j;            ///< of the other
    std::array<double, d> e;  ///< unit vector from j to i
    /// Of the k-th pair.
    PairRows(PairView<d> const& pairs, std::size_t k)
        : i(d * std::size_t{pairs.i[k]}), j(d * std::size_t{pairs.j[k]}) {
        for (std::size_t axis = 0; axis < d; ++axis) e[axis] = pairs.unit[axis][k];
    }
};

/// The sum of f e_x y_ij over the pairs of a block, f[0] that of its first; minus this over
/// the volume is a stress.
template <int d>
double sum_of_arms(PairView<d> const& view, PairBlock block, double const* f) {
    std::array<double, block_size> moment;
    wide_loop(block.size(), [=, begin = block.begin, moment = moment.data()](std::size_t k) {
        moment[k] = f[k] * view.unit[0][begin + k] * view.unit[1][begin + k] * view.distance[begin + k];
    });
    return sum_in_blocks({moment.data(), block.size()});
}

/// The sum of f r over the pairs of a block, f[0] that of its first.
template <int d>
double sum_of_virials(PairView<d> const& view, PairBlock block, double const* f) {
    std::array<double, block_size> virial;
    for (std::size_t k = 0; k < block.size(); ++k) virial[k] = f[k] * view.distance[block.begin + k];
    return sum_in_blocks({virial.data(), block.size()});
}

/// Calls visit(k, speed) for every pair of the block, one after the other, where `speed` is that of j's image
/// along x: zero, known at compile time, except across a sheared boundary. `visit` should hold what it reads
/// by value: what it holds by reference is loaded again after every store.
template <int d, class Visit>
void for_each_pair(PairList<d> const& pairs, Box<d> const& box, PairBlock block, Visit visit) {
    double const speed = box.image_speed();
    auto crossing = std::lower_bound(pairs.crossing.begin(), pairs.crossing.end(), block.begin);
    for (std::size_t k = block.begin; k < block.end;) {
        std::size_t const stop =
            crossing == pairs.crossing.end() ? block.end : std::min<std::size_t>(*crossing, block.end);
        ordered_loop(k, stop,
                     [visit](std::size_t at) mutable { visit(at, std::integral_constant<int, 0>{}); });
        for (k = stop; k < block.end && crossing != pairs.crossing.end() && *crossing == k; ++crossing)
            visit(k++, speed);
    }
}

}  // namespace dpd
