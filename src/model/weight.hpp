/// @file
/// Radial weight functions of the friction, w(r) as a function of x = r/cutoff on [0, 1).
#pragma once

#include <array>
#include <cmath>
#include <optional>
#include <string_view>

namespace dpd {

/// Weight of the friction, 1 at contact (up to the constant one, which does not fall) and 0 for x >= 1.
enum class Weight {
    constant,   ///< 1                (Lowe; NG2007 eq. 6)
    linear,     ///< 1 - x            (NG2007 eq. 2)
    quadratic,  ///< (1 - x)^2        (Groot & Warren; PK2006 sect. I)
    parabolic,  ///< 1 - x^2          (candidate for MY1997, whose weight is not printed)
    root,       ///< (1 - x)^(1/2)    (candidate for MY1997)
};

struct NamedWeight {
    std::string_view name;
    Weight weight;
};

inline constexpr std::array<NamedWeight, 5> weights{{{"constant", Weight::constant},
                                                     {"linear", Weight::linear},
                                                     {"quadratic", Weight::quadratic},
                                                     {"parabolic", Weight::parabolic},
                                                     {"root", Weight::root}}};

/// "constant, linear, quadratic, parabolic, root", for messages.
inline constexpr std::string_view weight_names = "constant, linear, quadratic, parabolic, root";

/// The weight of that name, or nothing.
constexpr std::optional<Weight> weight_from_name(std::string_view name) {
    for (auto const& candidate : weights)
        if (candidate.name == name) return candidate.weight;
    return std::nullopt;
}

constexpr std::string_view name_of(Weight weight) {
    for (auto const& candidate : weights)
        if (candidate.weight == weight) return candidate.name;
    return "";
}

/// w(x), x = r/cutoff in [0, 1); the caller has cut off x >= 1.
template <Weight weight>
inline double weight_at(double x) {
    if constexpr (weight == Weight::constant) return 1.0;
    if constexpr (weight == Weight::linear) return 1.0 - x;
    if constexpr (weight == Weight::quadratic) return (1.0 - x) * (1.0 - x);
    if constexpr (weight == Weight::parabolic) return 1.0 - x * x;
    if constexpr (weight == Weight::root) return std::sqrt(1.0 - x);
}

/// Calls `f.operator()<weight>()`, so that an inner loop is compiled once per weight.
template <class F>
decltype(auto) with_weight(Weight weight, F&& f) {
    switch (weight) {
        case Weight::constant:
            return f.template operator()<Weight::constant>();
        case Weight::linear:
            return f.template operator()<Weight::linear>();
        case Weight::quadratic:
            return f.template operator()<Weight::quadratic>();
        case Weight::parabolic:
            return f.template operator()<Weight::parabolic>();
        default:
            return f.template operator()<Weight::root>();
    }
}

/// w(x) for a weight chosen at run time; 0 for x >= 1.
inline double weight_at(Weight weight, double x) {
    if (x >= 1.0) return 0.0;
    return with_weight(weight, [x]<Weight w>() { return weight_at<w>(x); });
}

}  // namespace dpd
