/// @file
/// Radial weight functions of the friction, w(r) as a function of x = r/cutoff on [0, 1).
#pragma once

#include <cmath>
#include <string_view>

#include "names.hpp"

namespace dpd {

/// Weight of the friction, 1 at contact (up to the constant one, which does not fall) and 0 for x >= 1.
enum class Weight {
    constant,   ///< 1                (Lowe; NG2007 eq. 6)
    linear,     ///< 1 - x            (NG2007 eq. 2)
    quadratic,  ///< (1 - x)^2        (Groot & Warren; PK2006 sect. I)
    parabolic,  ///< 1 - x^2          (candidate for MY1997, whose weight is not printed)
    root,       ///< (1 - x)^(1/2)    (candidate for MY1997)
};

/// What a weight is called, and w(x) for x in [0, 1).
struct WeightFormula {
    std::string_view name;   ///< as a scene has it
    double (*at)(double x);  ///< the weight at x = r/cutoff
};

// [weights]
constexpr WeightFormula formula_of(Weight weight) {
    switch (weight) {
        case Weight::constant:
            return {"constant", [](double) { return 1.0; }};
        case Weight::linear:
            return {"linear", [](double x) { return 1.0 - x; }};
        case Weight::quadratic:
            return {"quadratic", [](double x) { return (1.0 - x) * (1.0 - x); }};
        case Weight::parabolic:
            return {"parabolic", [](double x) { return 1.0 - x * x; }};
        case Weight::root:
            return {"root", [](double x) { return std::sqrt(1.0 - x); }};
    }
    return {};
}
// [weights]

constexpr std::string_view name_of(Weight weight) { return formula_of(weight).name; }

/// w(x) for x in [0, 1); the caller has cut off x >= 1.
template <Weight weight>
inline double weight_at(double x) {
    constexpr auto at = formula_of(weight).at;
    return at(x);
}

/// w(x) for a weight chosen at run time; 0 for x >= 1.
inline double weight_at(Weight weight, double x) {
    return x < 1.0 ? with_value(weight, [x]<Weight w>() { return weight_at<w>(x); }) : 0.0;
}

}  // namespace dpd
