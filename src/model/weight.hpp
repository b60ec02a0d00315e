/// @file
/// Radial weight functions of the friction, w(r) as a function of x = r/cutoff on [0, 1).
#pragma once

#include <cmath>
#include <compare>
#include <string_view>

#include "elementary.hpp"
#include "names.hpp"

namespace dpd {

/// Weight of the friction, 1 at contact (up to the constant one, which does not fall) and 0 for x >= 1.
struct Weight {
    /// The formulas.
    enum Kind : int {
        constant,   ///< 1                (Lowe; NG2007 eq. 6)
        linear,     ///< 1 - x            (NG2007 eq. 2)
        quadratic,  ///< (1 - x)^2        (Groot & Warren; PK2006 sect. I)
        parabolic,  ///< 1 - x^2          (candidate for MY1997, whose weight is not printed)
        root,       ///< (1 - x)^(1/2)    (candidate for MY1997)
        power,      ///< (1 - x)^exponent (Fan et al. 2006; LAMMPS dpd/ext, azplugins, Mirheo)
    };
    Kind kind = linear;     ///< which of them
    double exponent = 0.0;  ///< of `power`; 0 for the others

    /// One that needs no exponent, by its name alone.
    constexpr Weight(Kind kind_ = linear, double exponent_ = 0.0) : kind(kind_), exponent(exponent_) {}

    /// Equal: the same formula with the same exponent. The order has no meaning; maps need one.
    friend constexpr auto operator<=>(Weight const&, Weight const&) = default;
};

/// What a weight is called, and w(x) for x in [0, 1).
struct WeightFormula {
    std::string_view name;                    ///< as a scene has it
    double (*at)(double x, double exponent);  ///< the weight at x = r/cutoff
};

// [weights]
constexpr WeightFormula formula_of(Weight::Kind kind) {
    switch (kind) {
        case Weight::constant:
            return {"constant", [](double, double) { return 1.0; }};
        case Weight::linear:
            return {"linear", [](double x, double) { return 1.0 - x; }};
        case Weight::quadratic:
            return {"quadratic", [](double x, double) { return (1.0 - x) * (1.0 - x); }};
        case Weight::parabolic:
            return {"parabolic", [](double x, double) { return 1.0 - x * x; }};
        case Weight::root:
            return {"root", [](double x, double) { return std::sqrt(1.0 - x); }};
        case Weight::power:
            return {"power", [](double x, double exponent) { return power(1.0 - x, exponent); }};
    }
    return {};
}
// [weights]

constexpr std::string_view name_of(Weight::Kind kind) { return formula_of(kind).name; }

/// w(x) for x in [0, 1); the caller has cut off x >= 1. The exponent is for `power` alone.
template <Weight::Kind kind>
inline double weight_at(double x, double exponent) {
    constexpr auto at = formula_of(kind).at;
    return at(x, exponent);
}

/// w(x) for a weight chosen at run time; 0 for x >= 1.
inline double weight_at(Weight weight, double x) {
    if (!(x < 1.0)) return 0.0;
    return with_value(weight.kind, [&]<Weight::Kind kind>() { return weight_at<kind>(x, weight.exponent); });
}

/// The largest exponent of `power`. With it the weight is below 1e-15 beyond a third of the cutoff.
inline constexpr double largest_exponent = 100.0;

/// (1 - x)^exponent: the weight that has a name of its own, to the last bit, for 0, 1/2, 1 and 2.
constexpr Weight power_weight(double exponent) {
    if (exponent == 0.0) return Weight::constant;
    if (exponent == 0.5) return Weight::root;
    if (exponent == 1.0) return Weight::linear;
    if (exponent == 2.0) return Weight::quadratic;
    return {Weight::power, exponent};
}

}  // namespace dpd
