/// @file
/// The generalized Lowe family: pair updates v_i += {-A v_ij.e + B xi} e that keep the Maxwell distribution
/// at any time step. A member is its A; B follows. @eq{NG2007,4}
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace dpd {

/// A as a function of a = w(r) dt/m, w the friction.
enum class Scheme {
    shardlow,     ///< A = a/(1+a): S1, half a step explicit and half a step implicit (NG2007 eq. 5)
    exponential,  ///< A = (1 - exp(-2a))/2: the pair's Langevin equation solved exactly (Peters 2004, scheme
                  ///< II)
    linear,  ///< A = a: one explicit step with the noise that mends it; needs a <= 1 (Peters 2004, scheme I)
};

struct NamedScheme {
    std::string_view name;
    Scheme scheme;
};

inline constexpr std::array<NamedScheme, 3> schemes{
    {{"shardlow", Scheme::shardlow}, {"exponential", Scheme::exponential}, {"linear", Scheme::linear}}};

/// The scheme of that name, or nothing.
constexpr std::optional<Scheme> scheme_from_name(std::string_view name) {
    for (auto const& candidate : schemes)
        if (candidate.name == name) return candidate.scheme;
    return std::nullopt;
}

constexpr std::string_view name_of(Scheme scheme) {
    for (auto const& candidate : schemes)
        if (candidate.scheme == scheme) return candidate.name;
    return "";
}

/// A of a pair, a = w(r) dt/m >= 0.
// [update a]
template <Scheme scheme>
inline double update_a(double a) {
    if constexpr (scheme == Scheme::shardlow) return a / (1.0 + a);
    if constexpr (scheme == Scheme::exponential) return -0.5 * std::expm1(-2.0 * a);
    if constexpr (scheme == Scheme::linear) return a;
}
// [update a]

/// Calls `f.operator()<scheme>()`, so that an inner loop is compiled once per scheme.
template <class F>
decltype(auto) with_scheme(Scheme scheme, F&& f) {
    switch (scheme) {
        case Scheme::shardlow:
            return f.template operator()<Scheme::shardlow>();
        case Scheme::exponential:
            return f.template operator()<Scheme::exponential>();
        default:
            return f.template operator()<Scheme::linear>();
    }
}

/// A for a scheme chosen at run time.
inline double update_a(Scheme scheme, double a) {
    return with_scheme(scheme, [a]<Scheme s>() { return update_a<s>(a); });
}

/// B = sqrt(A(1-A)/m), which keeps kT at any step and mass. NG2007, below eq. 5; the B printed in eq. 5 lacks
/// the factor 1/sqrt(m).
// [update b]
inline double update_b(double a, double mass) { return std::sqrt(a * (1.0 - a) / mass); }
// [update b]

}  // namespace dpd
