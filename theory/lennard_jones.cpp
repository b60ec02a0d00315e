// The Lennard-Jones fluid behind PK2006; theory/PK2006.md.

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "integrals.hpp"
#include "rows.hpp"

namespace dpd::theory {
namespace {

/// (sigma/r)^6.
double inverse_sixth(LennardJones const& lj, double r) {
    double const square_ratio = square(lj.sigma / r);
    return square_ratio * square_ratio * square_ratio;
}
double full_energy(LennardJones const& lj, double r) {
    double const s6 = inverse_sixth(lj, r);
    return 4.0 * lj.epsilon * s6 * (s6 - 1.0);
}
double full_force(LennardJones const& lj, double r) {
    double const s6 = inverse_sixth(lj, r);
    return 24.0 * lj.epsilon * s6 * (2.0 * s6 - 1.0) / r;
}

/// Whether r is inside the cut-off, after a check of the arguments.
bool inside(LennardJones const& lj, double r) {
    require_positive({{"epsilon", lj.epsilon}, {"sigma", lj.sigma}, {"r", r}});
    if (!(lj.rc > 0.0)) throw std::invalid_argument("rc must be positive");
    return r < lj.rc;
}

/// 8 pi epsilon sigma^3/3 and (sigma/rc)^3, which the corrections for the cut-off share.
struct TailFactors {
    double scale, s3;
};
// [tail factors]
TailFactors tail_factors(LennardJones const& lj, double n) {
    require_positive({{"epsilon", lj.epsilon}, {"sigma", lj.sigma}, {"rc", lj.rc}, {"n", n}});
    double const sigma3 = lj.sigma * lj.sigma * lj.sigma;
    return {8.0 * std::numbers::pi / 3.0 * lj.epsilon * sigma3, sigma3 / (lj.rc * lj.rc * lj.rc)};
}
// [tail factors]

/// The equation of state of Kolafa & Nezbeda 1994: hard spheres of a diameter that depends on the
/// temperature, a term that makes the second virial coefficient right, and a fitted polynomial.
namespace kolafa_nezbeda {

/// factor T^(half_power/2) n^density_power
struct Term {
    int half_power, density_power;
    double factor;
};

constexpr double gamma = 1.92907278;

constexpr std::array<Term, 4> diameter_terms{
    {{-2, 0, 0.011117524}, {-1, 0, -0.076383859}, {0, 0, 1.080142248}, {1, 0, 0.000693129}}};
constexpr double diameter_logarithm = -0.063920968;

/// Second virial coefficient less that of the hard spheres.
constexpr std::array<Term, 7> virial_terms{{{-7, 0, -0.58544978},
                                            {-6, 0, 0.43102052},
                                            {-5, 0, 0.87361369},
                                            {-4, 0, -4.13749995},
                                            {-3, 0, 2.90616279},
                                            {-2, 0, -7.02181962},
                                            {0, 0, 0.02459877}}};

/// Helmholtz energy per particle.
constexpr std::array<Term, 19> polynomial{{{0, 2, 2.01546797},
                                           {0, 3, -28.17881636},
                                           {0, 4, 28.28313847},
                                           {0, 5, -10.42402873},
                                           {-1, 2, -19.58371655},
                                           {-1, 3, 75.62340289},
                                           {-1, 4, -120.70586598},
                                           {-1, 5, 93.92740328},
                                           {-1, 6, -27.37737354},
                                           {-2, 2, 29.34470520},
                                           {-2, 3, -112.35356937},
                                           {-2, 4, 170.64908980},
                                           {-2, 5, -123.06669187},
                                           {-2, 6, 34.42288969},
                                           {-4, 2, -13.37031968},
                                           {-4, 3, 65.38059570},
                                           {-4, 4, -115.09233113},
                                           {-4, 5, 88.91973082},
                                           {-4, 6, -25.62099890}}};

/// A sum of powers of T and T times its derivative.
struct Value {
    double value = 0.0, T_derivative = 0.0;
};
template <std::size_t size>
Value sum_of_powers(std::array<Term, size> const& terms, double kT) {
    Value sum;
    for (auto const& term : terms) {
        double const part = term.factor * std::pow(kT, 0.5 * term.half_power);
        sum.value += part;
        sum.T_derivative += 0.5 * term.half_power * part;
    }
    return sum;
}

Value diameter(double kT) {
    auto sum = sum_of_powers(diameter_terms, kT);
    sum.value += diameter_logarithm * std::log(kT);
    sum.T_derivative += diameter_logarithm;
    return sum;
}

/// Packing fraction of the hard spheres, after a check of the arguments.
double packing(double n, double kT) {
    require_positive({{"n", n}, {"kT", kT}});
    double const d = diameter(kT).value;
    double const eta = std::numbers::pi / 6.0 * n * d * d * d;
    if (!(d > 0.0 && eta < 1.0))
        throw std::domain_error("no fluid: the packing fraction of the hard spheres is outside (0, 1)");
    return eta;
}

/// p/(n kT) of the hard spheres, and its derivative with respect to eta.
double hard_spheres(double eta) {
    double const free = 1.0 - eta;
    return (1.0 + eta * (1.0 + eta * (1.0 - 2.0 / 3.0 * eta * (1.0 + eta)))) / (free * free * free);
}
double hard_spheres_slope(double eta) {
    double const free = 1.0 - eta;
    return (1.0 + eta * (2.0 - eta * (2.0 + 8.0 / 3.0 * eta))) / (free * free * free) +
           3.0 * hard_spheres(eta) / free;
}

}  // namespace kolafa_nezbeda

}  // namespace

double lennard_jones_energy(LennardJones const& lj, double r) {
    if (!inside(lj, r)) return 0.0;
    double energy = full_energy(lj, r);
    if (!std::isfinite(lj.rc) || lj.truncation == Truncation::none) return energy;
    energy -= full_energy(lj, lj.rc);
    if (lj.truncation == Truncation::linear_force) energy += (r - lj.rc) * full_force(lj, lj.rc);
    return energy;
}

double lennard_jones_force(LennardJones const& lj, double r) {
    if (!inside(lj, r)) return 0.0;
    double const force = full_force(lj, r);
    bool const shifted = std::isfinite(lj.rc) && lj.truncation == Truncation::linear_force;
    return shifted ? force - full_force(lj, lj.rc) : force;
}

double lennard_jones_curvature(LennardJones const& lj, double r) {
    if (!inside(lj, r)) return 0.0;
    double const s6 = inverse_sixth(lj, r);
    return 24.0 * lj.epsilon * s6 * (26.0 * s6 - 7.0) / square(r);
}

// [tails]
double lennard_jones_tail_energy(LennardJones const& lj, double n) {
    auto const [scale, s3] = tail_factors(lj, n);
    return scale * n * s3 * (square(s3) / 3.0 - 1.0);
}

double lennard_jones_tail_pressure(LennardJones const& lj, double n) {
    auto const [scale, s3] = tail_factors(lj, n);
    return 2.0 * scale * square(n) * s3 * (2.0 / 3.0 * square(s3) - 1.0);
}

double lennard_jones_jump_pressure(LennardJones const& lj, double n) {
    auto const [scale, s3] = tail_factors(lj, n);
    return scale * square(n) * s3 * (square(s3) - 1.0);
}
// [tails]

// [equation of state]
double lennard_jones_pressure(double n, double kT) {
    using namespace kolafa_nezbeda;
    double sum = n * kT * hard_spheres(packing(n, kT));
    double const n2 = square(n);
    sum += kT * sum_of_powers(virial_terms, kT).value * n2 * (1.0 - 2.0 * gamma * n2) * std::exp(-gamma * n2);
    for (auto const& [half_power, k, factor] : polynomial)
        sum += k * factor * std::pow(kT, 0.5 * half_power) * std::pow(n, k + 1);
    return sum;
}
// [equation of state]

double lennard_jones_internal_energy(double n, double kT) {
    using namespace kolafa_nezbeda;
    // a - T da/dT = -T^2 d(a/T)/dT for each part of the Helmholtz energy a
    auto const d = diameter(kT);
    double sum = -3.0 * kT * (hard_spheres(packing(n, kT)) - 1.0) * d.T_derivative / d.value;
    sum -= kT * sum_of_powers(virial_terms, kT).T_derivative * n * std::exp(-gamma * square(n));
    for (auto const& [half_power, k, factor] : polynomial)
        sum += (1.0 - 0.5 * half_power) * factor * std::pow(kT, 0.5 * half_power) * std::pow(n, k);
    return sum;
}

double lennard_jones_inverse_compressibility(double n, double kT) {
    using namespace kolafa_nezbeda;
    double const eta = packing(n, kT), n2 = square(n);
    double sum = hard_spheres(eta) + eta * hard_spheres_slope(eta);
    sum += 2.0 * n * sum_of_powers(virial_terms, kT).value * std::exp(-gamma * n2) *
           (1.0 - gamma * n2 * (5.0 - 2.0 * gamma * n2));
    for (auto const& [half_power, k, factor] : polynomial)
        sum += k * (k + 1) * factor * std::pow(kT, 0.5 * half_power - 1.0) * std::pow(n, k);
    return sum;
}

// --- the rows of the registry ------------------------------------------------------------------------------

namespace {

// A pair, and the corrections for its cut-off.
std::vector<ClosedForm> pair_rows() {
    // atoms have no use for the cutoff 1 of the DPD forms
    Defaults const cutoff_required{{"rc", std::nullopt}};
    return {
        {"lj-energy",
         "Lennard-Jones",
         "pair",
         "energy of a pair, no cut-off",
         "4 (r^-12 - r^-6)",
         {"r"},
         {},
         [](Arguments const& a) { return lennard_jones_energy({}, a["r"]); }},
        {"lj-force",
         "Lennard-Jones",
         "pair",
         "force of a pair, no cut-off",
         "24 (2 r^-13 - r^-7)",
         {"r"},
         {},
         [](Arguments const& a) { return lennard_jones_force({}, a["r"]); }},
        {"lj-tail-energy",
         "Lennard-Jones",
         "tail",
         "energy per particle from beyond rc",
         "(8 pi/3) n (rc^-9/3 - rc^-3)",
         {"n", "rc"},
         {"m", "kT"},
         [](Arguments const& a) { return lennard_jones_tail_energy({.rc = a["rc"]}, a["n"]); },
         cutoff_required},
        {"lj-tail-pressure",
         "Lennard-Jones",
         "tail",
         "pressure from beyond rc",
         "(16 pi/3) n^2 (2 rc^-9/3 - rc^-3)",
         {"n", "rc"},
         {"m", "kT"},
         [](Arguments const& a) { return lennard_jones_tail_pressure({.rc = a["rc"]}, a["n"]); },
         cutoff_required},
        {"lj-jump-pressure",
         "Lennard-Jones",
         "tail",
         "pressure of the jump of the energy at rc",
         "(8 pi/3) n^2 (rc^-9 - rc^-3)",
         {"n", "rc"},
         {"m", "kT"},
         [](Arguments const& a) { return lennard_jones_jump_pressure({.rc = a["rc"]}, a["n"]); },
         cutoff_required},
    };
}

// The equation of state.
std::vector<ClosedForm> equation_of_state_rows() {
    return {
        {"lj-pressure",
         "Kolafa & Nezbeda 1994",
         "equation of state",
         "pressure of the Lennard-Jones fluid",
         "fit",
         {"n", "kT"},
         {"m"},
         [](Arguments const& a) { return lennard_jones_pressure(a["n"], a["kT"]); }},
        {"lj-internal-energy",
         "Kolafa & Nezbeda 1994",
         "equation of state",
         "its potential energy per particle",
         "fit",
         {"n", "kT"},
         {"m"},
         [](Arguments const& a) { return lennard_jones_internal_energy(a["n"], a["kT"]); }},
        {"lj-kappa",
         "Kolafa & Nezbeda 1994",
         "equation of state",
         "its (1/kT) dp/dn",
         "fit",
         {"n", "kT"},
         {"m"},
         [](Arguments const& a) { return lennard_jones_inverse_compressibility(a["n"], a["kT"]); }},
    };
}

}  // namespace

std::vector<ClosedForm> lennard_jones_rows() { return joined({pair_rows(), equation_of_state_rows()}); }

}  // namespace dpd::theory
