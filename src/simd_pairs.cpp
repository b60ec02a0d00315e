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

// For every byte, the positions of its set bits, the lowest first.
using SetBits = std::array<std::array<std::uint8_t, 8>, 256>;
[[maybe_unused]] constexpr SetBits set_bits = [] {
    SetBits table{};
    for (std::size_t byte = 0; byte < 256; ++byte)
        for (std::uint8_t bit = 0, count = 0; bit < 8; ++bit)
            if (byte >> bit & 1) table[byte][count++] = bit;
    return table;
}();

template <int d>
HWY_INLINE std::size_t near_lanes(Sorted<d> const& position, Candidates const& candidates, std::uint32_t* i,
                                  std::uint32_t* j) {
    hn::ScalableTag<double> const lanes;
    hn::Rebind<std::uint32_t, decltype(lanes)> const entries;
    hn::Rebind<std::uint8_t, decltype(lanes)> const bytes;
    std::size_t const width = hn::Lanes(lanes);
    auto const limit = hn::Set(lanes, candidates.cutoff_squared);
    std::size_t count = 0;
    for (std::size_t h = candidates.home.begin; h < candidates.home.end; ++h) {
        hn::Vec<decltype(lanes)> origin[d];
        for (int axis = 0; axis < d; ++axis) origin[axis] = hn::Set(lanes, position[axis][h]);
        auto const home = hn::Set(entries, static_cast<std::uint32_t>(h));
        std::size_t begin = h + 1;
        for (Range const& range : candidates.ranges) {
            if (&range != candidates.ranges.data()) begin = range.begin;
            for (std::size_t q = begin; q < range.end; q += width) {
                auto squared = hn::Zero(lanes);
                for (int axis = 0; axis < d; ++axis) {
                    auto const s = hn::Sub(origin[axis], hn::LoadU(lanes, position[axis] + q));
                    squared = hn::Add(squared, hn::Mul(s, s));
                }
                auto const near = hn::And(hn::Lt(squared, limit), hn::FirstN(lanes, range.end - q));
                std::array<std::uint8_t, 8> mask{};
                hn::StoreMaskBits(lanes, near, mask.data());
                auto const which = hn::PromoteTo(entries, hn::LoadU(bytes, set_bits[mask[0]].data()));
                // whole vectors are written; the next result begins where the valid lanes end
                hn::StoreU(home, entries, i + count);
                hn::StoreU(hn::Add(which, hn::Set(entries, static_cast<std::uint32_t>(q))), entries,
                           j + count);
                count += hn::CountTrue(lanes, near);
            }
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

std::size_t find_near_2(Sorted<2> const& sorted, Candidates const& candidates, std::uint32_t* i,
                        std::uint32_t* j) {
    return near_lanes<2>(sorted, candidates, i, j);
}
std::size_t find_near_3(Sorted<3> const& sorted, Candidates const& candidates, std::uint32_t* i,
                        std::uint32_t* j) {
    return near_lanes<3>(sorted, candidates, i, j);
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

std::size_t find_near(Sorted<2> const& sorted, Candidates const& candidates, std::uint32_t* i,
                      std::uint32_t* j) {
    return HWY_DYNAMIC_DISPATCH(find_near_2)(sorted, candidates, i, j);
}
std::size_t find_near(Sorted<3> const& sorted, Candidates const& candidates, std::uint32_t* i,
                      std::uint32_t* j) {
    return HWY_DYNAMIC_DISPATCH(find_near_3)(sorted, candidates, i, j);
}
std::size_t normalize(Geometry<2> const& geometry, PairColumns<2> const& pairs) {
    return HWY_DYNAMIC_DISPATCH(normalize_2)(geometry, pairs);
}
std::size_t normalize(Geometry<3> const& geometry, PairColumns<3> const& pairs) {
    return HWY_DYNAMIC_DISPATCH(normalize_3)(geometry, pairs);
}

}  // namespace dpd::simd
#endif  // HWY_ONCE
