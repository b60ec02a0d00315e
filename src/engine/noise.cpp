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

#include "elementary.hpp"

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

// Vectors that are worked on at once: a polynomial or a cipher is a chain, and each waits for its own alone.
inline constexpr std::size_t streams = 4;

// c[0] + c[1] x + c[2] x^2 + ...
template <class D, std::size_t terms, std::size_t n>
HWY_INLINE std::array<Lanes<D>, n> polynomial(D d, std::array<double, terms> const& c,
                                              std::array<Lanes<D>, n> const& x) {
    std::array<Lanes<D>, n> sum;
    for (auto& s : sum) s = hn::Set(d, c[terms - 1]);
    for (std::size_t k = terms - 1; k-- > 0;)
        for (std::size_t v = 0; v < n; ++v) sum[v] = hn::Add(hn::Mul(sum[v], x[v]), hn::Set(d, c[k]));
    return sum;
}

// As the scalar logarithm, for 2^-52 <= u <= 1.
template <class D, std::size_t n>
HWY_INLINE std::array<Lanes<D>, n> logarithm(D d, std::array<Lanes<D>, n> const& u) {
    hn::RebindToUnsigned<D> const bits;
    static constexpr std::array<double, 10> artanh{1.0,      1.0 / 3,  1.0 / 5,  1.0 / 7,  1.0 / 9,
                                                   1.0 / 11, 1.0 / 13, 1.0 / 15, 1.0 / 17, 1.0 / 19};
    auto const one = hn::BitCast(bits, hn::Set(d, 1.0));
    auto const root_half = hn::BitCast(bits, hn::Set(d, 0.5 * std::numbers::sqrt2));
    std::array<Lanes<D>, n> e, s, squared;
    for (std::size_t v = 0; v < n; ++v) {
        auto const shifted = hn::Add(hn::BitCast(bits, u[v]), hn::Sub(one, root_half));
        auto const fraction = hn::And(shifted, hn::Set(bits, (std::uint64_t{1} << 52) - 1));
        auto const m = hn::BitCast(d, hn::Add(fraction, root_half));
        // the biased exponent, an integer, becomes a double as the fraction of 2^52
        auto const biased = hn::Or(hn::ShiftRight<52>(shifted), hn::BitCast(bits, hn::Set(d, 0x1p52)));
        e[v] = hn::Sub(hn::BitCast(d, biased), hn::Set(d, 0x1p52 + 1023.0));
        s[v] = hn::Div(hn::Sub(m, hn::Set(d, 1.0)), hn::Add(m, hn::Set(d, 1.0)));
        squared[v] = hn::Mul(s[v], s[v]);
    }
    auto log = polynomial(d, artanh, squared);
    for (std::size_t v = 0; v < n; ++v)
        log[v] = hn::Add(hn::Mul(e[v], hn::Set(d, std::numbers::ln2)), hn::Mul(hn::Add(s[v], s[v]), log[v]));
    return log;
}

// As the scalar sine_of_turn.
template <class D, std::size_t n>
HWY_INLINE std::array<Lanes<D>, n> sine_of_turn(D d, std::array<Lanes<D>, n> const& u) {
    std::array<Lanes<D>, n> squared;
    for (std::size_t v = 0; v < n; ++v) squared[v] = hn::Mul(u[v], u[v]);
    auto sine = polynomial(d, sine_of_turn_series, squared);
    for (std::size_t v = 0; v < n; ++v) sine[v] = hn::Mul(u[v], sine[v]);
    return sine;
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
template <class D, std::size_t n>
HWY_INLINE std::array<Lanes<D>, n> box_muller(D d, std::array<std::array<BitLanes<D>, 4>, n> const& x) {
    std::array<Lanes<D>, n> radius, quarter;
    for (std::size_t v = 0; v < n; ++v) {
        radius[v] = hn::Sub(hn::Set(d, 2.0), one_to_two(d, x[v][0], x[v][1]));        // in (0, 1]
        auto const turn = hn::Sub(one_to_two(d, x[v][2], x[v][3]), hn::Set(d, 1.5));  // in [-1/2, 1/2)
        quarter[v] = hn::Sub(hn::Set(d, 0.25), hn::Abs(turn));  // cos(2 pi turn) is its sine
    }
    auto const log = logarithm(d, radius);
    auto variate = sine_of_turn(d, quarter);
    for (std::size_t v = 0; v < n; ++v)
        variate[v] = hn::Mul(hn::Sqrt(hn::Mul(hn::Set(d, -2.0), log[v])), variate[v]);
    return variate;
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
// lanes, whatever the upper halves hold.
template <class B, std::size_t n>
HWY_INLINE void philox(B bits, std::array<std::array<hn::Vec<B>, 4>, n>& counters, std::uint64_t seed) {
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

// out[k] = variate of the random bits of the pair {id[i[k]], id[j[k]]}
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
        for (std::size_t k = 0; k < size; k += streams * width) {
            std::array<std::array<BitLanes<decltype(d)>, 4>, streams> x;
            for (std::size_t v = 0; v < streams; ++v)
                x[v] = {hn::Load(bits, &first[k + v * width]), hn::Load(bits, &second[k + v * width]), step,
                        stream};
            philox(bits, x, key.seed);
            auto const variates = variate_of(d, x);
            for (std::size_t v = 0; v < streams; ++v) hn::StoreU(variates[v], d, target + k + v * width);
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
    draw(key, i, j, id, out, count, [](auto d, auto const& x) HWY_ATTR {
        std::array<Lanes<decltype(d)>, streams> uniform;
        for (std::size_t v = 0; v < streams; ++v)
            uniform[v] = hn::Sub(one_to_two(d, x[v][0], x[v][1]), hn::Set(d, 1.0));
        return uniform;
    });
}

// The same for the bits of one variate.
double normal_from(std::array<std::uint32_t, 4> const& random) {
    hn::CappedTag<double, 1> const d;
    hn::RebindToUnsigned<decltype(d)> const bits;
    auto const word = [&](std::size_t w) { return hn::Set(bits, std::uint64_t{random[w]}); };
    std::array<std::array<BitLanes<decltype(d)>, 4>, 1> const bits_of_one{
        {{word(0), word(1), word(2), word(3)}}};
    return hn::GetLane(box_muller(d, bits_of_one)[0]);
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
