// What momentum conservation does to a tagged particle: long-time tails, and the size of the box.

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "integrals.hpp"
#include "rows.hpp"

namespace dpd::theory {

namespace {

/// nu + D, the rate per k^2 at which a tagged particle and a shear wave at k lose each other.
double mode_diffusivity(Gas const& gas, double eta, double D) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"eta", eta}, {"D", D}});
    return eta / (gas.n * gas.m) + D;
}

/// The sum over all integers j but 0 of exp(-s j^2).
double lattice_sum(double s) {
    constexpr double pi = std::numbers::pi;
    constexpr int terms = 6;  // the first left out is exp(-49 pi)
    auto const from_one = [](double rate) {
        double sum = 0.0;
        for (int j = terms; j > 0; --j) sum += 2.0 * std::exp(-rate * j * j);
        return sum;
    };
    // Poisson: the sum over all j equals sqrt(pi/s) times that at pi^2/s
    return s > pi ? from_one(s) : std::sqrt(pi / s) * (1.0 + from_one(pi * pi / s)) - 1.0;
}

}  // namespace

double diffusion_finite_size_correction(double kT, double eta, double L) {
    require_positive({{"kT", kT}, {"eta", eta}, {"L", L}});
    // The Madelung constant of a cubic lattice of point charges in a neutralising background.
    constexpr double cube_constant = 2.837297;
    return cube_constant * kT / (6.0 * std::numbers::pi * eta * L);
}

// [tail]
double velocity_autocorrelation_tail(Gas const& gas, double eta, double D, double t) {
    require_positive({{"t", t}});
    unit_sphere_surface(gas.d);  // checks d
    double const spread = 4.0 * std::numbers::pi * mode_diffusivity(gas, eta, D) * t;
    return (gas.d - 1.0) / gas.d * gas.kT / (gas.n * gas.m) * std::pow(spread, -0.5 * gas.d);
}
// [tail]

double velocity_autocorrelation_tail_in_box(Gas const& gas, double eta, double D, double L, double t) {
    require_positive({{"L", L}, {"t", t}});
    unit_sphere_surface(gas.d);  // checks d
    double const k1 = 2.0 * std::numbers::pi / L;
    // the sum over vectors is a product of sums over components; without the term k = 0 it is (1 + x)^d - 1
    double const modes =
        std::expm1(gas.d * std::log1p(lattice_sum(mode_diffusivity(gas, eta, D) * square(k1) * t)));
    return (gas.d - 1.0) / gas.d * gas.kT / (gas.n * gas.m * std::pow(L, gas.d)) * modes;
}

// --- the rows of the registry ------------------------------------------------------------------------------

std::vector<ClosedForm> hydrodynamics_rows() {
    return {
        {"vacf-tail",
         "Ernst et al. 1970",
         "tail",
         "velocity autocorrelation per component at long times",
         "((d-1)/d) (kT/(n m)) (4 pi (eta/(n m) + D) t)^(-d/2)",
         {"d", "n", "m", "kT", "eta", "D", "t"},
         {},
         [](Arguments const& a) {
             return velocity_autocorrelation_tail(gas(a, a["n"], a["m"], a["kT"]), a["eta"], a["D"], a["t"]);
         }},
        {"vacf-tail-box",
         "Ernst et al. 1970",
         "tail in a box",
         "the same in a periodic cube or square at zero total momentum",
         "((d-1)/d) (kT/(n m L^d)) sum over k != 0 of exp(-(eta/(n m) + D) k^2 t)",
         {"d", "n", "m", "kT", "eta", "D", "L", "t"},
         {},
         [](Arguments const& a) {
             return velocity_autocorrelation_tail_in_box(gas(a, a["n"], a["m"], a["kT"]), a["eta"], a["D"],
                                                         a["L"], a["t"]);
         }},
        {"yeh-hummer",
         "Yeh & Hummer 2004",
         "12",
         "finite-size correction to the self-diffusion constant",
         "2.837297 kT/(6 pi eta L)",
         {"kT", "eta", "L"},
         {"d"},
         [](Arguments const& a) {
             if (a.d() != 3) throw std::domain_error("yeh-hummer holds for d = 3 only");
             return diffusion_finite_size_correction(a["kT"], a["eta"], a["L"]);
         }},
    };
}

}  // namespace dpd::theory
