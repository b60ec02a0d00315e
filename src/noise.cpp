// Highway compiles the first part of this file once for every instruction set and picks one at run time.
// The lanes do nothing but exactly rounded operations (+ - * / sqrt, never fused: -ffp-contract=off), so
// that a variate has the same bits on every machine, alone or in a batch.
#include "noise.hpp"

#include <Random123/philox.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "noise.cpp"
#include <hwy/foreach_target.h>
//
#include <hwy/highway.h>

#ifndef DPDREF_NOISE_COUNTER
#define DPDREF_NOISE_COUNTER
namespace dpd {
// The last word of a counter; the first three are the pair and the lower half of the step.
inline std::uint32_t upper_word(NoiseKey key) {
    return static_cast<std::uint32_t>(key.step >> 32) | std::uint32_t{key.sweep} << 16 |
           std::uint32_t{key.stream} << 24;
}
}  // namespace dpd
#endif

HWY_BEFORE_NAMESPACE();
namespace dpd::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

template <class D>
using Lanes = hn::Vec<D>;
template <class D>
using BitLanes = hn::Vec<hn::RebindToUnsigned<D>>;

// c[0] + c[1] x + c[2] x^2 + ...
template <class D, std::size_t terms>
HWY_INLINE Lanes<D> polynomial(D d, std::array<double, terms> const& c, Lanes<D> x) {
    auto sum = hn::Set(d, c[terms - 1]);
    for (std::size_t k = terms - 1; k-- > 0;) sum = hn::Add(hn::Mul(sum, x), hn::Set(d, c[k]));
    return sum;
}

// ln u for 2^-52 <= u <= 1, to 3 units in the last place: u = 2^e m with m in [sqrt(1/2), sqrt(2)), and
// ln m = 2 artanh s = 2s (1 + s^2/3 + s^4/5 + ...) with s = (m-1)/(m+1), |s| < 0.172; the series is cut
// where its terms fall below 2^-55.
template <class D>
HWY_INLINE Lanes<D> logarithm(D d, Lanes<D> u) {
    hn::RebindToUnsigned<D> const bits;
    static constexpr std::array<double, 10> artanh{1.0,      1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,
                                                   1.0 / 11, 1.0 / 13, 1.0 / 15, 1.0 / 17, 1.0 / 19};
    auto const one = hn::BitCast(bits, hn::Set(d, 1.0));
    auto const root_half = hn::BitCast(bits, hn::Set(d, 0.5 * std::numbers::sqrt2));
    auto const shifted = hn::Add(hn::BitCast(bits, u), hn::Sub(one, root_half));
    auto const fraction = hn::And(shifted, hn::Set(bits, (std::uint64_t{1} << 52) - 1));
    auto const m = hn::BitCast(d, hn::Add(fraction, root_half));
    // the biased exponent, an integer, becomes a double as the fraction of 2^52
    auto const biased = hn::Or(hn::ShiftRight<52>(shifted), hn::BitCast(bits, hn::Set(d, 0x1p52)));
    auto const e = hn::Sub(hn::BitCast(d, biased), hn::Set(d, 0x1p52 + 1023.0));

    auto const s = hn::Div(hn::Sub(m, hn::Set(d, 1.0)), hn::Add(m, hn::Set(d, 1.0)));
    auto const log_m = hn::Mul(hn::Add(s, s), polynomial(d, artanh, hn::Mul(s, s)));
    return hn::Add(hn::Mul(e, hn::Set(d, std::numbers::ln2)), log_m);
}

// sin(2 pi u) for |u| <= 1/4 by Taylor's series; the first term left out is below 1.3e-18, rounding below
// 5e-16.
template <class D>
HWY_INLINE Lanes<D> sine_of_turn(D d, Lanes<D> u) {
    static constexpr auto taylor = [] {
        std::array<double, 11> c{};
        long double term = 2.0L * std::numbers::pi_v<long double>;
        for (std::size_t k = 0; k < c.size(); ++k) {
            c[k] = static_cast<double>(term);
            auto const n = static_cast<long double>(2 * k + 2);
            term *= -4.0L * std::numbers::pi_v<long double> * std::numbers::pi_v<long double> / (n * (n + 1));
        }
        return c;
    }();
    return hn::Mul(u, polynomial(d, taylor, hn::Mul(u, u)));
}

// Lanes in [1, 2) whose 52 fraction bits are the upper ones of (high, low).
template <class D>
HWY_INLINE Lanes<D> one_to_two(D d, BitLanes<D> high, BitLanes<D> low) {
    hn::RebindToUnsigned<D> const bits;
    auto const low_half = hn::And(low, hn::Set(bits, 0xffffffffu));
    auto const fraction = hn::ShiftRight<12>(hn::Or(hn::ShiftLeft<32>(high), low_half));
    return hn::BitCast(d, hn::Or(fraction, hn::BitCast(bits, hn::Set(d, 1.0))));
}

// Box & Muller's first variate from 128 random bits, in the lower halves of the lanes of x; the second is not
// used, since each pair has its own counter. |variate| <= 8.5.
template <class D>
HWY_INLINE Lanes<D> box_muller(D d, std::array<BitLanes<D>, 4> const& x) {
    auto const radius = hn::Sub(hn::Set(d, 2.0), one_to_two(d, x[0], x[1]));  // in (0, 1]
    auto const turn = hn::Sub(one_to_two(d, x[2], x[3]), hn::Set(d, 1.5));    // in [-1/2, 1/2)
    auto const quarter = hn::Sub(hn::Set(d, 0.25), hn::Abs(turn));            // cos(2 pi turn) is its sine
    return hn::Mul(hn::Sqrt(hn::Mul(hn::Set(d, -2.0), logarithm(d, radius))), sine_of_turn(d, quarter));
}

// Products of the lower halves of the lanes.
template <class B>
HWY_INLINE hn::Vec<B> multiply_words([[maybe_unused]] B bits, hn::Vec<B> a, hn::Vec<B> b) {
#if HWY_TARGET == HWY_SCALAR
    return hn::Mul(hn::And(a, hn::Set(bits, 0xffffffffu)), b);
#else
    hn::Repartition<std::uint32_t, B> const words;
    return hn::MulEven(hn::BitCast(words, a), hn::BitCast(words, b));
#endif
}

// Philox4x32-10 (Salmon et al. 2011), bit for bit as in Random123; 32-bit words in the lower halves of the
// lanes, whatever the upper halves hold. Several counters at once: each waits for its own previous round.
template <class B, std::size_t streams>
HWY_INLINE void philox(B bits, std::array<std::array<hn::Vec<B>, 4>, streams>& counters, std::uint64_t seed) {
    auto const multiplier0 = hn::Set(bits, std::uint64_t{PHILOX_M4x32_0});
    auto const multiplier1 = hn::Set(bits, std::uint64_t{PHILOX_M4x32_1});
    auto key0 = static_cast<std::uint32_t>(seed), key1 = static_cast<std::uint32_t>(seed >> 32);
    for (int round = 0; round < PHILOX4x32_DEFAULT_ROUNDS; ++round) {
        for (auto& x : counters) {
            auto const product0 = multiply_words(bits, x[0], multiplier0);
            auto const product1 = multiply_words(bits, x[2], multiplier1);
            x[0] = hn::Xor3(hn::ShiftRight<32>(product1), x[1], hn::Set(bits, std::uint64_t{key0}));
            x[1] = product1;
            x[2] = hn::Xor3(hn::ShiftRight<32>(product0), x[3], hn::Set(bits, std::uint64_t{key1}));
            x[3] = product0;
        }
        key0 += PHILOX_W32_0;
        key1 += PHILOX_W32_1;
    }
}

// out[k] = variate(d, random bits of the pair {id[i[k]], id[j[k]]})
template <class Variate>
HWY_INLINE void draw(NoiseKey key, std::uint32_t const* i, std::uint32_t const* j, std::uint32_t const* id,
                     double* out, std::size_t count, Variate variate_of) {
    hn::ScalableTag<double> const d;
    hn::RebindToUnsigned<decltype(d)> const bits;
    constexpr std::size_t width = hn::MaxLanes(d), block = 128;
    auto const step = hn::Set(bits, key.step & 0xffffffffu);
    auto const stream = hn::Set(bits, std::uint64_t{upper_word(key)});
    alignas(64) std::array<std::uint64_t, block> first, second;
    alignas(64) std::array<double, block> variate;
    for (std::size_t begin = 0; begin < count; begin += block) {
        std::size_t const size = std::min(block, count - begin);
        for (std::size_t k = 0; k < size; ++k) {
            std::uint32_t const a = id[i[begin + k]], b = id[j[begin + k]];
            first[k] = std::min(a, b);
            second[k] = std::max(a, b);
        }
        double* const target = size == block ? out + begin : variate.data();
        for (std::size_t k = 0; k < size; k += 2 * width) {
            auto const counter = [&](std::size_t at) {
                return std::array{hn::Load(bits, &first[at]), hn::Load(bits, &second[at]), step, stream};
            };
            std::array x{counter(k), counter(k + width)};
            philox(bits, x, key.seed);
            hn::StoreU(variate_of(d, x[0]), d, target + k);
            hn::StoreU(variate_of(d, x[1]), d, target + k + width);
        }
        if (size < block) std::copy_n(variate.begin(), size, out + begin);
    }
}

void normals(NoiseKey key, std::uint32_t const* i, std::uint32_t const* j, std::uint32_t const* id,
             double* out, std::size_t count) {
    draw(key, i, j, id, out, count, [](auto d, auto const& x) HWY_ATTR { return box_muller(d, x); });
}

void uniforms(NoiseKey key, std::uint32_t const* i, std::uint32_t const* j, std::uint32_t const* id,
              double* out, std::size_t count) {
    draw(key, i, j, id, out, count,
         [](auto d, auto const& x) HWY_ATTR { return hn::Sub(one_to_two(d, x[0], x[1]), hn::Set(d, 1.0)); });
}

// The same for the bits of one variate.
double normal_from(std::array<std::uint32_t, 4> const& random) {
    hn::CappedTag<double, 1> const d;
    hn::RebindToUnsigned<decltype(d)> const bits;
    auto const word = [&](std::size_t w) { return hn::Set(bits, std::uint64_t{random[w]}); };
    return hn::GetLane(box_muller(d, {word(0), word(1), word(2), word(3)}));
}

}  // namespace dpd::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace dpd {
namespace {

HWY_EXPORT(normals);
HWY_EXPORT(uniforms);

std::array<std::uint32_t, 4> random_bits(NoiseKey key, std::uint32_t a, std::uint32_t b) {
    r123::Philox4x32::ctr_type const counter{{a, b, static_cast<std::uint32_t>(key.step), upper_word(key)}};
    r123::Philox4x32::key_type const seed{
        {static_cast<std::uint32_t>(key.seed), static_cast<std::uint32_t>(key.seed >> 32)}};
    auto const bits = r123::Philox4x32{}(counter, seed);
    return {bits.v[0], bits.v[1], bits.v[2], bits.v[3]};
}

}  // namespace

double normal(NoiseKey key, std::uint32_t a, std::uint32_t b) {
    return HWY_STATIC_DISPATCH(normal_from)(random_bits(key, a, b));
}

double uniform(NoiseKey key, std::uint32_t a, std::uint32_t b) {
    auto const bits = random_bits(key, a, b);
    return static_cast<double>((std::uint64_t{bits[0]} << 32 | bits[1]) >> 12) * 0x1p-52;
}

void pair_normals(NoiseKey key, std::span<std::uint32_t const> i, std::span<std::uint32_t const> j,
                  std::uint32_t const* id, std::span<double> out) {
    HWY_DYNAMIC_DISPATCH(normals)(key, i.data(), j.data(), id, out.data(), out.size());
}

void pair_uniforms(NoiseKey key, std::span<std::uint32_t const> i, std::span<std::uint32_t const> j,
                   std::uint32_t const* id, std::span<double> out) {
    HWY_DYNAMIC_DISPATCH(uniforms)(key, i.data(), j.data(), id, out.data(), out.size());
}

}  // namespace dpd
#endif  // HWY_ONCE
