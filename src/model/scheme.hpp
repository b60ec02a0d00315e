/// @file
/// The generalized Lowe family: pair updates v_i += {-A v_ij.e + B xi} e that keep the Maxwell distribution
/// at any time step. A member is its A; B follows. @eq{NG2007,4}
#pragma once

#include <cmath>
#include <string_view>

#include "elementary.hpp"
#include "names.hpp"

namespace dpd {

/// A as a function of a = w(r) dt/m, w the friction.
enum class Scheme {
    shardlow,     ///< A = a/(1+a): S1, half a step explicit and half a step implicit (NG2007 eq. 5)
    exponential,  ///< A = (1 - exp(-2a))/2: the pair's Langevin equation solved exactly (Peters 2004, scheme
                  ///< II)
    linear,  ///< A = a: one explicit step with the noise that mends it; needs a <= 1 (Peters 2004, scheme I)
};

/// What a scheme is called, and its A for a >= 0.
struct SchemeFormula {
    std::string_view name;         ///< as a scene has it
    double (*update_a)(double a);  ///< A of a pair update, from a = w dt/m
};

// [update a]
constexpr SchemeFormula formula_of(Scheme scheme) {
    switch (scheme) {
        case Scheme::shardlow:
            return {"shardlow", [](double a) { return a / (1.0 + a); }};
        case Scheme::exponential:
            return {"exponential", [](double a) { return 0.5 * one_minus_exponential(2.0 * a); }};
        case Scheme::linear:
            return {"linear", [](double a) { return a; }};
    }
    return {};
}
// [update a]

constexpr std::string_view name_of(Scheme scheme) { return formula_of(scheme).name; }

/// A of a pair, a = w(r) dt/m >= 0.
template <Scheme scheme>
inline double update_a(double a) {
    constexpr auto formula = formula_of(scheme).update_a;
    return formula(a);
}

/// A for a scheme chosen at run time.
inline double update_a(Scheme scheme, double a) {
    return with_value(scheme, [a]<Scheme s>() { return update_a<s>(a); });
}

/// B = sqrt(A(1-A)/m), which keeps kT at any step and mass. NG2007, below eq. 5; the B printed in eq. 5 lacks
/// the factor 1/sqrt(m).
// [update b]
inline double update_b(double a, double mass) { return std::sqrt(a * (1.0 - a) / mass); }
// [update b]

}  // namespace dpd
