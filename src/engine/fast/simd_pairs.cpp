// Highway compiles the first part of this file once for every instruction set (its last resort is one lane
// wide: the plain loop) and picks one at run time. Only exactly rounded operations, never fused
// (-ffp-contract=off): the pairs and their bits are the same on every machine.
#include "simd_pairs.hpp"

#include <algorithm>
#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd_pairs.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#ifndef DPDREF_LANES_IN_MASK
#define DPDREF_LANES_IN_MASK
namespace dpd::simd {
// The lanes that a mask of eight bits names, in order; then lane 0.
inline constexpr auto lanes_in_mask = [] {
    std::array<std::array<std::uint8_t, 8>, 256> lanes{};
    for (std::size_t mask = 0; mask < lanes.size(); ++mask)
        for (std::size_t lane = 0, found = 0; lane < 8; ++lane)
            if (mask >> lane & 1) lanes[mask][found++] = static_cast<std::uint8_t>(lane);
    return lanes;
}();
}  // namespace dpd::simd
#endif

HWY_BEFORE_NAMESPACE();
namespace dpd::simd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// The lanes of `row` named by the mask, moved to the front. Eight lanes by a table of our own: g++ copies
// Highway's to the stack in every call.
template <class Rows>
HWY_INLINE hn::Vec<Rows> to_front(Rows rows, hn::Vec<Rows> row, hn::Mask<Rows> mask) {
    if constexpr (hn::MaxLanes(rows) == 8) {
        std::uint8_t bits = 0;
        hn::StoreMaskBits(rows, mask, &bits);
        hn::Rebind<std::uint8_t, Rows> const bytes;
        auto const from = hn::PromoteTo(rows, hn::LoadU(bytes, lanes_in_mask[bits].data()));
        return hn::TableLookupLanes(row, hn::IndicesFromVec(rows, from));
    } else {
        return hn::Compress(row, mask);
    }
}

// `widest` candidates, in one vector or in several, meet all particles of the home cells before the next ones
// are loaded: so the list is the same for every width, and it changes the first particle often, which lets
// some updates overlap; pairs that share a particle keep their order.
template <int d>
HWY_INLINE std::size_t near_lanes(Sorted<d> const& sorted, std::span<Candidates const> cells,
                                  float limit_squared, std::uint32_t* i, std::uint32_t* j) {
    hn::ScalableTag<float> const lanes;
    hn::RebindToUnsigned<decltype(lanes)> const rows;
    constexpr std::size_t width = hn::MaxLanes(lanes), vectors = widest / width;
    auto const limit = hn::Set(lanes, limit_squared);
    std::size_t count = 0;
    for (Candidates const& cell : cells)
        for (std::size_t r = 0; r < cell.range_count; ++r) {
            Range const& range = cell.ranges[r];
            for (std::size_t q = range.begin; q < range.end; q += widest) {
                hn::Vec<decltype(lanes)> partner[vectors][d];
                for (std::size_t v = 0; v < vectors; ++v)
                    for (int axis = 0; axis < d; ++axis) {
                        partner[v][axis] = hn::LoadU(lanes, sorted.position[axis] + q + v * width);
                        if (axis < 2)
                            partner[v][axis] = hn::Add(partner[v][axis], hn::Set(lanes, range.shift[axis]));
                    }
                // with those of the candidates from `first` on
                auto const meet = [&](std::size_t h, std::size_t first) HWY_ATTR {
                    for (std::size_t v = 0; v < vectors; ++v) {
                        std::size_t const begin = q + v * width;
                        if (begin >= range.end) break;
                        auto squared = hn::Zero(lanes);
                        for (int axis = 0; axis < d; ++axis) {
                            auto const s =
                                hn::Sub(hn::Set(lanes, sorted.position[axis][h]), partner[v][axis]);
                            squared = hn::Add(squared, hn::Mul(s, s));
                        }
                        auto near = hn::And(hn::Lt(squared, limit), hn::FirstN(lanes, range.end - begin));
                        if (first > begin) near = hn::AndNot(hn::FirstN(lanes, first - begin), near);
                        auto const found = hn::RebindMask(rows, near);
                        // whole vectors are written; the next result begins where the valid lanes end
                        hn::StoreU(to_front(rows, hn::LoadU(rows, sorted.row + begin), found), rows,
                                   j + count);
                        hn::StoreU(hn::Set(rows, sorted.row[h]), rows, i + count);
                        count += hn::CountTrue(rows, found);
                    }
                };
                // with its own cells a particle pairs from its successor on
                std::size_t const before =
                    r == 0 ? std::clamp(q, cell.home_begin, cell.home_end) : cell.home_end;
                for (std::size_t h = cell.home_begin; h < before; ++h) meet(h, q);
                for (std::size_t h = before; h < std::min(q + widest, cell.home_end); ++h) meet(h, h + 1);
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
                        std::uint32_t* i, std::uint32_t* j) {
    return near_lanes<2>(sorted, cells, limit_squared, i, j);
}
std::size_t find_near_3(Sorted<3> const& sorted, std::span<Candidates const> cells, float limit_squared,
                        std::uint32_t* i, std::uint32_t* j) {
    return near_lanes<3>(sorted, cells, limit_squared, i, j);
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
                      std::uint32_t* i, std::uint32_t* j) {
    return HWY_DYNAMIC_DISPATCH(find_near_2)(sorted, cells, limit_squared, i, j);
}
std::size_t find_near(Sorted<3> const& sorted, std::span<Candidates const> cells, float limit_squared,
                      std::uint32_t* i, std::uint32_t* j) {
    return HWY_DYNAMIC_DISPATCH(find_near_3)(sorted, cells, limit_squared, i, j);
}
std::size_t normalize(Geometry<2> const& geometry, PairColumns<2> const& pairs) {
    return HWY_DYNAMIC_DISPATCH(normalize_2)(geometry, pairs);
}
std::size_t normalize(Geometry<3> const& geometry, PairColumns<3> const& pairs) {
    return HWY_DYNAMIC_DISPATCH(normalize_3)(geometry, pairs);
}

}  // namespace dpd::simd
#endif  // HWY_ONCE
