/// @file
/// Integrals over the range of a pair, and the checks that all closed forms share.
#pragma once

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <stdexcept>
#include <string>

#include "closed_forms.hpp"
#include "elementary.hpp"

namespace dpd::theory {

/// An argument, for messages.
struct Quantity {
    char const* name;  ///< as the user calls it
    double value;      ///< that is checked
};

/// std::invalid_argument, naming the quantity, unless each is positive and finite.
void require_positive(std::initializer_list<Quantity> quantities);

/// std::invalid_argument, naming the quantity, unless each is finite.
void require_finite(std::initializer_list<Quantity> quantities);

inline double square(double x) { return x * x; }

/// [w], [w^2] and [w r^2] of a weight of height 1 and range rc.
double integral_of_weight(int d, double rc, Weight weight);
double integral_of_squared_weight(int d, double rc, Weight weight);
double integral_of_weight_r2(int d, double rc, Weight weight);

/// [f g], the integral of f weighted with the pair distribution.
template <class F>
double integral_over_pairs(Gas const& gas, PairDistribution const& g, F const& f) {
    if (!g) return volume_integral(gas.d, gas.rc, f);
    require_positive({{"rc", gas.rc}});
    using Gauss = boost::math::quadrature::gauss<double, 7>;  // holds the nodes >= 0 only
    constexpr int parts = 1000;
    double sum = 0.0;
    auto const add = [&](double x, double share) {
        double const r = gas.rc * x, at_r = g(r);
        if (!(at_r >= 0.0) || !std::isfinite(at_r))
            throw std::invalid_argument("g(r) must be finite and not negative, also at r = " +
                                        std::to_string(r));
        sum += share * power(x, gas.d - 1) * f(r) * at_r;
    };
    for (int part = 0; part < parts; ++part) {
        double const centre = part + 0.5;
        add(centre / parts, Gauss::weights()[0]);
        for (std::size_t k = 1; k < Gauss::abscissa().size(); ++k)
            for (double sign : {-1.0, 1.0})
                add((centre + 0.5 * sign * Gauss::abscissa()[k]) / parts, Gauss::weights()[k]);
    }
    return unit_sphere_surface(gas.d) * power(gas.rc, gas.d) * sum / (2.0 * parts);
}

}  // namespace dpd::theory
