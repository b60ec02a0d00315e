// Highway compiles the first part of this file once for every instruction set (its last resort is one lane
// wide: the plain loop) and picks one at run time. Only exactly rounded operations, never fused
// (-ffp-contract=off): the pairs and their bits are the same on every machine.
#include "simd_pairs.hpp"

#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd_pairs.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace dpd::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Copies the candidates of a cell into one row, each seen in its image; returns how many.
template <int d, class Lanes>
HWY_INLINE std::size_t gather(Lanes lanes, Sorted<d> const& sorted, Candidates const& cell,
                              float* (&position)[d], std::uint32_t* row) {
    hn::RebindToUnsigned<Lanes> const rows;
    std::size_t count = 0;
    for (std::size_t r = 0; r < cell.range_count; ++r) {
        Range const& range = cell.ranges[r];
        std::size_t const size = range.end - range.begin;
        for (std::size_t q = 0; q < size; q += hn::Lanes(lanes)) {
            for (int axis = 0; axis < d; ++axis) {
                auto x = hn::LoadU(lanes, sorted.position[axis] + range.begin + q);
                if (axis < 2) x = hn::Add(x, hn::Set(lanes, range.shift[axis]));
                hn::StoreU(x, lanes, position[axis] + count + q);
            }
            hn::StoreU(hn::LoadU(rows, sorted.row + range.begin + q), rows, row + count + q);
        }
        count += size;
    }
    return count;
}

template <int d>
HWY_INLINE std::size_t near_lanes(Sorted<d> const& sorted, std::span<Candidates const> cells,
                                  float limit_squared, Scratch<d>& scratch, std::uint32_t* i,
                                  std::uint32_t* j) {
    hn::ScalableTag<float> const lanes;
    hn::RebindToUnsigned<decltype(lanes)> const rows;
    std::size_t const width = hn::Lanes(lanes);
    auto const limit = hn::Set(lanes, limit_squared);
    auto const numbers = hn::Iota(rows, 0);
    std::size_t count = 0;
    float* position[d];
    for (int axis = 0; axis < d; ++axis) position[axis] = scratch.position[axis].data();
    for (Candidates const& cell : cells) {
        std::size_t const size = gather<d>(lanes, sorted, cell, position, scratch.row.data());
        std::size_t const begin = cell.ranges[0].begin;
        // with its own cell a particle pairs from its successor on
        bool const own = cell.ranges[0].end > begin;
        for (std::size_t h = begin; h < cell.home_end; ++h) {
            hn::Vec<decltype(lanes)> origin[d];
            for (int axis = 0; axis < d; ++axis) origin[axis] = hn::Set(lanes, sorted.position[axis][h]);
            auto const first = own ? h - begin + 1 : 0;
            auto const from = hn::Set(rows, static_cast<std::uint32_t>(first)),
                       to = hn::Set(rows, static_cast<std::uint32_t>(size));
            std::size_t const found = count;
            for (std::size_t q = first / width * width; q < size; q += width) {
                auto squared = hn::Zero(lanes);
                for (int axis = 0; axis < d; ++axis) {
                    auto const s = hn::Sub(origin[axis], hn::LoadU(lanes, position[axis] + q));
                    squared = hn::Add(squared, hn::Mul(s, s));
                }
                auto const number = hn::Add(numbers, hn::Set(rows, static_cast<std::uint32_t>(q)));
                auto const there = hn::AndNot(hn::Lt(number, from), hn::Lt(number, to));
                auto const near = hn::And(hn::RebindMask(rows, hn::Lt(squared, limit)), there);
                // whole vectors are written; the next result begins where the valid lanes end
                hn::StoreU(hn::Compress(hn::LoadU(rows, scratch.row.data() + q), near), rows, j + count);
                count += hn::CountTrue(rows, near);
            }
            auto const home = hn::Set(rows, sorted.row[h]);
            for (std::size_t k = found; k < count; k += width) hn::StoreU(home, rows, i + k);
        }
    }
    return count;
}

template <int d>
HWY_INLINE std::size_t normalize_lanes(Geometry<d> const& geometry, PairColumns<d> const& pairs) {
    hn::ScalableTag<double> const lanes;
    std::size_t const width = hn::Lanes(lanes);
    auto const limit = hn::Set(lanes, geometry.cutoff_squared);
    std::size_t outside = 0;
    for (std::size_t k = 0; k < pairs.count; k += width) {
        hn::Vec<decltype(lanes)> separation[d];
        auto squared = hn::Zero(lanes);
        for (int axis = 0; axis < d; ++axis) {
            auto const difference = hn::LoadU(lanes, pairs.unit[axis] + k);
            auto const period = hn::Set(lanes, geometry.period[axis]);
            auto const half = hn::Set(lanes, 0.5 * geometry.period[axis]);
            auto const s = hn::Sub(difference, hn::Set(lanes, geometry.shift[axis]));
            auto const turn = hn::IfThenElseZero(hn::Gt(hn::Abs(s), half), hn::CopySign(period, s));
            separation[axis] = hn::Sub(s, turn);
            squared = hn::Add(squared, hn::Mul(separation[axis], separation[axis]));
        }
        auto const beyond = hn::Ge(squared, limit);
        auto const r = hn::IfThenElse(beyond, hn::Set(lanes, std::numeric_limits<double>::infinity()),
                                      hn::Sqrt(squared));
        auto const inverse = hn::Div(hn::Set(lanes, 1.0), r);
        for (int axis = 0; axis < d; ++axis)
            hn::StoreU(hn::Mul(separation[axis], inverse), lanes, pairs.unit[axis] + k);
        hn::StoreU(r, lanes, pairs.distance + k);
        auto const no_pair = hn::Or(beyond, hn::Eq(squared, hn::Zero(lanes)));
        outside += hn::CountTrue(lanes, hn::And(no_pair, hn::FirstN(lanes, pairs.count - k)));
    }
    return outside;
}

std::size_t find_near_2(Sorted<2> const& sorted, std::span<Candidates const> cells, float limit_squared,
                        Scratch<2>& scratch, std::uint32_t* i, std::uint32_t* j) {
    return near_lanes<2>(sorted, cells, limit_squared, scratch, i, j);
}
std::size_t find_near_3(Sorted<3> const& sorted, std::span<Candidates const> cells, float limit_squared,
                        Scratch<3>& scratch, std::uint32_t* i, std::uint32_t* j) {
    return near_lanes<3>(sorted, cells, limit_squared, scratch, i, j);
}
std::size_t normalize_2(Geometry<2> const& geometry, PairColumns<2> const& pairs) {
    return normalize_lanes(geometry, pairs);
}
std::size_t normalize_3(Geometry<3> const& geometry, PairColumns<3> const& pairs) {
    return normalize_lanes(geometry, pairs);
}

}  // namespace dpd::simd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dpd::simd {

HWY_EXPORT(find_near_2);
HWY_EXPORT(find_near_3);
HWY_EXPORT(normalize_2);
HWY_EXPORT(normalize_3);

std::size_t find_near(Sorted<2> const& sorted, std::span<Candidates const> cells, float limit_squared,
                      Scratch<2>& scratch, std::uint32_t* i, std::uint32_t* j) {
    return HWY_DYNAMIC_DISPATCH(find_near_2)(sorted, cells, limit_squared, scratch, i, j);
}
std::size_t find_near(Sorted<3> const& sorted, std::span<Candidates const> cells, float limit_squared,
                      Scratch<3>& scratch, std::uint32_t* i, std::uint32_t* j) {
    return HWY_DYNAMIC_DISPATCH(find_near_3)(sorted, cells, limit_squared, scratch, i, j);
}
std::size_t normalize(Geometry<2> const& geometry, PairColumns<2> const& pairs) {
    return HWY_DYNAMIC_DISPATCH(normalize_2)(geometry, pairs);
}
std::size_t normalize(Geometry<3> const& geometry, PairColumns<3> const& pairs) {
    return HWY_DYNAMIC_DISPATCH(normalize_3)(geometry, pairs);
}

}  // namespace dpd::simd
#endif  // HWY_ONCE
