// Largest steps of the soft repulsion; derived in docs/stability.md.

#include <boost/math/special_functions/bessel.hpp>
#include <boost/math/special_functions/sinc.hpp>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <numbers>

#include "integrals.hpp"
#include "rows.hpp"

namespace dpd::theory {

// [random phase]
double random_phase_frequency(Gas const& gas, double a, double k) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"rc", gas.rc}, {"a", a}, {"k", k}});
    double const q = k * gas.rc;
    // U_k in units of a rc^(d+1); the average of a plane wave over directions is J_0 or sin(x)/x
    double const transform = volume_integral(gas.d, 1.0, [&](double x) {
        double const wave = gas.d == 2 ? boost::math::cyl_bessel_j(0, q * x) : boost::math::sinc_pi(q * x);
        return 0.5 * square(1.0 - x) * wave;
    });
    return std::sqrt(gas.n * std::pow(gas.rc, gas.d - 1) * a / gas.m * square(q) * transform);
}

double harmonic_limit(Gas const& gas, double a) {
    constexpr double lowest = 1.0, highest = 12.0, spacing = 0.5;  // in k rc; the maximum is near 4
    constexpr int bits = 30;
    auto const minus_frequency = [&](double q) { return -random_phase_frequency(gas, a, q / gas.rc); };
    double at = lowest;
    for (double q = lowest; q <= highest; q += spacing)
        if (minus_frequency(q) < minus_frequency(at)) at = q;
    return -2.0 /
           boost::math::tools::brent_find_minima(minus_frequency, at - spacing, at + spacing, bits).second;
}
// [random phase]

// --- the rows of the registry ------------------------------------------------------------------------------

std::vector<ClosedForm> harmonic_rows() {
    return {
        {"harmonic-limit",
         "ours",
         "docs/stability.md",
         "largest step for the soft repulsion in random phases",
         "2/max over k of sqrt(n k^2 U_k/m)",
         {"d", "n", "m", "rc", "a"},
         {"kT"},
         [](Arguments const& a) { return harmonic_limit(gas(a, a["n"], a["m"], unused), a["a"]); }},
    };
}

}  // namespace dpd::theory
