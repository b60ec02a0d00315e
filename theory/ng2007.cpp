// Noguchi & Gompper 2007: transport coefficients under pairwise thermostats; derived in theory/NG2007.md.

#include <cmath>
#include <stdexcept>

#include "elementary.hpp"
#include "integrals.hpp"
#include "rows.hpp"

namespace dpd::theory {
namespace {

/// 1/(1 - exp(-rate)) - 1/2, the sum over steps of a correlation that each step multiplies by exp(-rate), the
/// first step counting half. Written with expm1 so that a small step loses no digits.
// [correlation sum]
double correlation_sum(double rate) { return -1.0 / std::expm1(-rate) - 0.5; }
// [correlation sum]

/// w(r).
auto friction_of_distance(Gas const& gas, Shardlow const& thermostat) {
    return [=](double r) { return thermostat.gamma * weight_at(thermostat.weight, r / gas.rc); };
}

/// A(r), NG2007 eq. 5, after a check of what it depends on.
auto A_of_distance(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"m", gas.m}, {"gamma", thermostat.gamma}, {"dt", dt}});
    // no weight exceeds 1
    if (thermostat.scheme == Scheme::linear && thermostat.gamma * dt / gas.m > 1.0)
        throw std::domain_error("the linear scheme needs gamma dt/m <= 1: beyond, no noise keeps kT");
    auto const w = friction_of_distance(gas, thermostat);
    return [=, scheme = thermostat.scheme, m = gas.m](double r) { return update_a(scheme, w(r) * dt / m); };
}

/// What one pair at A takes away from <v_x v_y> (1 - s_ij averaged over directions) ...
// [pair loss]
double stress_loss(int d, double A) { return 2.0 * A / d - 4.0 * A * A / (d * (d + 2)); }
/// ... and from <v(t).v(0)>.
double velocity_loss(int d, double A) { return A / d; }
// [pair loss]

/// A of Lowe-Andersen: the relative velocity is replaced, 1 - 2A = 0.
constexpr double lowe_A = 0.5;

double sphere_volume(Gas const& gas) { return unit_sphere_surface(gas.d) / gas.d * power(gas.rc, gas.d); }

/// -ln s of one step.
// [stress decay]
double stress_decay(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return gas.n * volume_integral(gas.d, gas.rc, [&](double r) { return stress_loss(gas.d, A(r)); });
}
// [stress decay]
double stress_decay(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"n", gas.n}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}, {"dt", dt}});
    return gas.n * thermostat.Gamma * dt * sphere_volume(gas) * stress_loss(gas.d, lowe_A);
}

/// -ln of the velocity correlation over one step.
// [velocity decay]
double velocity_decay(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return gas.n * volume_integral(gas.d, gas.rc, [&](double r) { return velocity_loss(gas.d, A(r)); });
}
// [velocity decay]
double velocity_decay(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"n", gas.n}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}, {"dt", dt}});
    return gas.n * thermostat.Gamma * dt * sphere_volume(gas) * velocity_loss(gas.d, lowe_A);
}

/// eta_pot/phi_pot of NG2007 eq. 16.
// [friction as potential]
double viscosity_per_relaxation_rate(Gas const& gas, Soft const& potential, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"a", potential.a}});
    // a kT/rc, the factor that all forces have in common, cancels
    auto const f = [rc = gas.rc](double r) { return 1.0 - r / rc; };
    double const force = integral_over_pairs(gas, g, f);
    if (!(force > 0.0)) throw std::domain_error("no potential viscosity: g(r) has no pair within the range");
    double const force_r2 = integral_over_pairs(gas, g, [&](double r) { return f(r) * r * r; });
    return gas.n * gas.m * force_r2 / (2.0 * (gas.d + 2) * force);
}
// [friction as potential]

}  // namespace

double stress_retention(Gas const& gas, Shardlow const& thermostat, double dt) {
    return std::exp(-stress_decay(gas, thermostat, dt));
}
double stress_retention(Gas const& gas, Lowe const& thermostat, double dt) {
    return std::exp(-stress_decay(gas, thermostat, dt));
}

// [kinetic viscosity]
double kinetic_viscosity(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.n * gas.kT * dt * correlation_sum(stress_decay(gas, thermostat, dt));
}
// [kinetic viscosity]
double kinetic_viscosity(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.n * gas.kT * dt * correlation_sum(stress_decay(gas, thermostat, dt));
}

// [kinetic limit]
double kinetic_viscosity_limit(Gas const& gas, Shardlow const& thermostat) {
    require_positive({{"m", gas.m}, {"kT", gas.kT}, {"gamma", thermostat.gamma}});
    return gas.d * gas.m * gas.kT /
           (2.0 * thermostat.gamma * integral_of_weight(gas.d, gas.rc, thermostat.weight));
}
// [kinetic limit]
double kinetic_viscosity_limit(Gas const& gas, Lowe const& thermostat) {
    require_positive({{"kT", gas.kT}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}});
    return gas.kT / (thermostat.Gamma * sphere_volume(gas) * stress_loss(gas.d, lowe_A));
}

// [collision viscosity]
double collision_viscosity(Gas const& gas, Shardlow const& thermostat, double dt, PairDistribution const& g) {
    require_positive({{"n", gas.n}});
    auto const A = A_of_distance(gas, thermostat, dt);
    return square(gas.n) * gas.m / (2.0 * dt * gas.d * (gas.d + 2)) *
           integral_over_pairs(gas, g, [&](double r) { return A(r) * r * r; });
}
// [collision viscosity]
double collision_viscosity(Gas const& gas, Lowe const& thermostat) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}});
    double const integral_of_r2 = unit_sphere_surface(gas.d) * power(gas.rc, gas.d + 2) / (gas.d + 2);
    return square(gas.n) * gas.m * thermostat.Gamma * lowe_A / (2.0 * gas.d * (gas.d + 2)) * integral_of_r2;
}

double collision_viscosity_limit(Gas const& gas, Shardlow const& thermostat) {
    require_positive({{"n", gas.n}, {"gamma", thermostat.gamma}});
    return square(gas.n) * thermostat.gamma / (2.0 * gas.d * (gas.d + 2)) *
           integral_of_weight_r2(gas.d, gas.rc, thermostat.weight);
}

double velocity_retention(Gas const& gas, Shardlow const& thermostat, double dt) {
    return std::exp(-velocity_decay(gas, thermostat, dt));
}
double velocity_retention(Gas const& gas, Lowe const& thermostat, double dt) {
    return std::exp(-velocity_decay(gas, thermostat, dt));
}

// [correlation]
double velocity_autocorrelation(Gas const& gas, Shardlow const& thermostat, double dt, double t) {
    require_positive({{"kT", gas.kT}});
    if (!(t >= 0.0) || !std::isfinite(t)) throw std::invalid_argument("t must be finite and not negative");
    return gas.kT / gas.m * std::exp(-velocity_decay(gas, thermostat, dt) * t / dt);
}
// [correlation]

// [diffusion]
double diffusion_constant(Gas const& gas, Shardlow const& thermostat, double dt) {
    require_positive({{"kT", gas.kT}});
    return gas.kT * dt / gas.m * correlation_sum(velocity_decay(gas, thermostat, dt));
}
// [diffusion]
double diffusion_constant(Gas const& gas, Lowe const& thermostat, double dt) {
    require_positive({{"m", gas.m}, {"kT", gas.kT}});
    return gas.kT * dt / gas.m * correlation_sum(velocity_decay(gas, thermostat, dt));
}

double diffusion_constant_limit(Gas const& gas, Shardlow const& thermostat) {
    require_positive({{"n", gas.n}, {"kT", gas.kT}, {"gamma", thermostat.gamma}});
    return gas.d * gas.kT / (gas.n * thermostat.gamma * integral_of_weight(gas.d, gas.rc, thermostat.weight));
}
double diffusion_constant_limit(Gas const& gas, Lowe const& thermostat) {
    require_positive(
        {{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}, {"rc", gas.rc}, {"Gamma", thermostat.Gamma}});
    return gas.kT / (gas.m * gas.n * thermostat.Gamma * sphere_volume(gas) * velocity_loss(gas.d, lowe_A));
}

// [schmidt]
double schmidt_number(Gas const& gas, Shardlow const& thermostat, double dt) {
    double const eta = kinetic_viscosity(gas, thermostat, dt) + collision_viscosity(gas, thermostat, dt);
    return eta / (gas.n * gas.m * diffusion_constant(gas, thermostat, dt));
}
// [schmidt]
double schmidt_number(Gas const& gas, Lowe const& thermostat, double dt) {
    double const eta = kinetic_viscosity(gas, thermostat, dt) + collision_viscosity(gas, thermostat);
    return eta / (gas.n * gas.m * diffusion_constant(gas, thermostat, dt));
}

// [relaxation rate]
double relaxation_rate(Gas const& gas, Shardlow const& thermostat, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"gamma", thermostat.gamma}});
    return gas.n / (gas.d * gas.m) * integral_over_pairs(gas, g, friction_of_distance(gas, thermostat));
}
// [relaxation rate]

// [two rates]
double kinetic_viscosity(double n, double kT, double phi_pot, double phi_dpd) {
    require_positive({{"n", n}, {"kT", kT}});
    require_finite({{"phi_pot", phi_pot}, {"phi_dpd", phi_dpd}});
    double const rate = phi_pot + phi_dpd;
    if (!(rate > 0.0)) throw std::domain_error("no kinetic viscosity: phi_pot + phi_dpd is not positive");
    return n * kT / (2.0 * rate);
}
// [two rates]

double potential_viscosity(Gas const& gas, Soft const& potential, double phi_pot, PairDistribution const& g) {
    require_finite({{"phi_pot", phi_pot}});
    return phi_pot * viscosity_per_relaxation_rate(gas, potential, g);
}

double potential_relaxation_rate(Gas const& gas, Soft const& potential, double eta_pot,
                                 PairDistribution const& g) {
    require_finite({{"eta_pot", eta_pot}});
    return eta_pot / viscosity_per_relaxation_rate(gas, potential, g);
}

// --- the rows of the registry ------------------------------------------------------------------------------

namespace {

Shardlow shardlow(Arguments const& a) {
    return {.gamma = a["gamma"], .weight = a.weight(), .scheme = a.scheme()};
}
Lowe lowe(Arguments const& a) { return {.Gamma = a["Gamma"]}; }

// Viscosity of the ideal gas.
std::vector<ClosedForm> viscosity_rows() {
    return {
        {"ng8",
         "NG2007",
         "8",
         "kinetic viscosity",
         "n kT dt (1/(1 - s) - 1/2)",
         {"d", "n", "m", "kT", "gamma", "rc", "dt", "weight", "exponent", "scheme"},
         {},
         [](Arguments const& a) {
             return kinetic_viscosity(gas(a, a["n"], a["m"], a["kT"]), shardlow(a), a["dt"]);
         }},
        {"ng9",
         "NG2007",
         "9",
         "s, factor on <v_x v_y> per step",
         "exp(n [-2A/d + 4A^2/(d(d+2))])",
         {"d", "n", "m", "gamma", "rc", "dt", "weight", "exponent", "scheme"},
         {"kT"},
         [](Arguments const& a) {
             return stress_retention(gas(a, a["n"], a["m"], unused), shardlow(a), a["dt"]);
         }},
        {"ng10",
         "NG2007",
         "10",
         "kinetic viscosity for dt -> 0",
         "d m kT/(2 [w])",
         {"d", "m", "kT", "gamma", "rc", "weight", "exponent"},
         {"n", "dt", "scheme"},
         [](Arguments const& a) {
             return kinetic_viscosity_limit(gas(a, unused, a["m"], a["kT"]), shardlow(a));
         }},
        {"ng12",
         "NG2007",
         "12",
         "collision viscosity",
         "m n^2/(2 d (d+2) dt) [A r^2], with shardlow n^2/(2 d (d+2)) [w r^2/(1 + w dt/m)]",
         {"d", "n", "m", "gamma", "rc", "dt", "weight", "exponent", "scheme"},
         {"kT"},
         [](Arguments const& a) {
             return collision_viscosity(gas(a, a["n"], a["m"], unused), shardlow(a), a["dt"]);
         }},
        {"ng12-limit",
         "NG2007",
         "12",
         "collision viscosity for dt -> 0",
         "n^2/(2 d (d+2)) [w r^2]",
         {"d", "n", "gamma", "rc", "weight", "exponent"},
         {"m", "kT", "dt", "scheme"},
         [](Arguments const& a) {
             return collision_viscosity_limit(gas(a, a["n"], unused, unused), shardlow(a));
         }},
    };
}

// Its self-diffusion.
std::vector<ClosedForm> diffusion_rows() {
    return {
        {"ng17",
         "NG2007",
         "17",
         "self-diffusion constant",
         "(kT dt/m) (1/(1 - exp(-n [A]/d)) - 1/2)",
         {"d", "n", "m", "kT", "gamma", "rc", "dt", "weight", "exponent", "scheme"},
         {},
         [](Arguments const& a) {
             return diffusion_constant(gas(a, a["n"], a["m"], a["kT"]), shardlow(a), a["dt"]);
         }},
        {"ng17-limit",
         "NG2007",
         "17",
         "self-diffusion constant for dt -> 0",
         "d kT/(n [w])",
         {"d", "n", "kT", "gamma", "rc", "weight", "exponent"},
         {"m", "dt", "scheme"},
         [](Arguments const& a) {
             return diffusion_constant_limit(gas(a, a["n"], unused, a["kT"]), shardlow(a));
         }},
    };
}

// The same for Lowe-Andersen.
std::vector<ClosedForm> lowe_rows() {
    return {
        {"ng8-lowe",
         "NG2007",
         "8",
         "kinetic viscosity, Lowe-Andersen",
         "n kT dt (1/(1 - s) - 1/2)",
         {"d", "n", "kT", "Gamma", "rc", "dt"},
         {"m"},
         [](Arguments const& a) {
             return kinetic_viscosity(gas(a, a["n"], unused, a["kT"]), lowe(a), a["dt"]);
         }},
        {"ng9-lowe",
         "NG2007",
         "9",
         "s, factor on <v_x v_y> per step, Lowe-Andersen",
         "exp(-pi b n rc^d Gamma dt), b = 3/8 (d=2) or 16/45 (d=3)",
         {"d", "n", "Gamma", "rc", "dt"},
         {"m", "kT"},
         [](Arguments const& a) {
             return stress_retention(gas(a, a["n"], unused, unused), lowe(a), a["dt"]);
         }},
        {"ng12-lowe",
         "NG2007",
         "12",
         "collision viscosity, Lowe-Andersen",
         "pi m n^2 Gamma rc^4/64 (d=2) or pi m n^2 Gamma rc^5/75 (d=3)",
         {"d", "n", "m", "Gamma", "rc"},
         {"kT", "dt"},
         [](Arguments const& a) { return collision_viscosity(gas(a, a["n"], a["m"], unused), lowe(a)); }},
        {"ng17-lowe",
         "NG2007",
         "17",
         "self-diffusion constant, Lowe-Andersen",
         "(kT dt/m) (1/(1 - exp(-n V_d rc^d Gamma dt/(2d))) - 1/2)",
         {"d", "n", "m", "kT", "Gamma", "rc", "dt"},
         {},
         [](Arguments const& a) {
             return diffusion_constant(gas(a, a["n"], a["m"], a["kT"]), lowe(a), a["dt"]);
         }},
    };
}

// With a soft potential; the Schmidt number.
std::vector<ClosedForm> potential_rows() {
    return {
        {"ng14",
         "NG2007",
         "14",
         "kinetic viscosity from two relaxation rates",
         "n kT/(2 (phi_pot + phi_dpd))",
         {"n", "kT", "phi_pot", "phi_dpd"},
         {"d", "m"},
         [](Arguments const& a) { return kinetic_viscosity(a["n"], a["kT"], a["phi_pot"], a["phi_dpd"]); }},
        {"ng16",
         "NG2007",
         "16",
         "potential viscosity of the soft potential with g = 1",
         "n m phi_pot [|f| r^2]/(2 (d+2) [|f|]), f = a kT/rc (1 - r/rc)",
         {"d", "n", "m", "phi_pot", "rc"},
         {"a", "kT"},
         [](Arguments const& a) {
             return potential_viscosity(gas(a, a["n"], a["m"], unused), {.a = unused}, a["phi_pot"]);
         }},
        {"ng-phi",
         "NG2007",
         "13, below",
         "phi_DPD, relaxation rate of a velocity for dt -> 0 with g = 1",
         "n [w]/(d m)",
         {"d", "n", "m", "gamma", "rc", "weight", "exponent"},
         {"kT", "dt", "scheme"},
         [](Arguments const& a) { return relaxation_rate(gas(a, a["n"], a["m"], unused), shardlow(a)); }},
        {"ng-schmidt",
         "NG2007",
         "8, 12, 17",
         "Schmidt number of the ideal gas",
         "(eta_kin + eta_col)/(n m D)",
         {"d", "n", "m", "kT", "gamma", "rc", "dt", "weight", "exponent", "scheme"},
         {},
         [](Arguments const& a) {
             return schmidt_number(gas(a, a["n"], a["m"], a["kT"]), shardlow(a), a["dt"]);
         }},
    };
}

}  // namespace

std::vector<ClosedForm> ng2007_rows() {
    return joined({viscosity_rows(), diffusion_rows(), lowe_rows(), potential_rows()});
}

}  // namespace dpd::theory
