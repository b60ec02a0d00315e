// Pivkin & Karniadakis 2006: coarse graining; derived in theory/PK2006.md.

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "elementary.hpp"
#include "integrals.hpp"
#include "rows.hpp"

namespace dpd::theory {
namespace {

/// F r of the force a (1 - r/rc), integrated over the pairs.
double integral_of_force_times_distance(Gas const& gas, double a, PairDistribution const& g) {
    require_positive({{"a", a}});
    return integral_over_pairs(gas, g, [=, rc = gas.rc](double r) { return a * (1.0 - r / rc) * r; });
}

/// alpha a rc^4 n of Groot & Warren: what the repulsion adds to kT in p/n, and half of what it adds in dp/dn.
double groot_warren_energy(Gas const& gas, double a, double alpha) {
    require_positive({{"n", gas.n}, {"kT", gas.kT}, {"rc", gas.rc}, {"a", a}, {"alpha", alpha}});
    if (gas.d != 3) throw std::domain_error("Groot and Warren's alpha was fitted for d = 3 only");
    return alpha * a * square(square(gas.rc)) * gas.n;
}

void require_inside(double L, double z) {
    require_positive({{"L", L}});
    if (!(z >= 0.0 && z <= L)) throw std::invalid_argument("z must be between 0 and L");
}

}  // namespace

// [units]
double particle_mass(CoarseGraining const& map, double m) {
    require_positive({{"Nm", map.Nm}, {"m", m}});
    return m * map.Nm;
}

double cutoff_radius(CoarseGraining const& map) {
    require_positive({{"Nm", map.Nm}, {"n", map.n}, {"n_md", map.n_md}});
    return cube_root(map.Nm * map.n / map.n_md);
}
// [units]

double length_in_dpd_units(CoarseGraining const& map, double length) {
    require_positive({{"length", length}});
    return length / cutoff_radius(map);
}

// [conservative coefficient]
double conservative_coefficient(CoarseGraining const& map, double kT) {
    require_positive({{"Nm", map.Nm},
                      {"n", map.n},
                      {"inverse_compressibility", map.inverse_compressibility},
                      {"alpha", map.alpha},
                      {"kT", kT}});
    double const excess = map.inverse_compressibility * map.Nm - 1.0;
    if (excess < 0.0)
        throw std::domain_error(
            "no repulsion: the fluid of the atoms is more compressible than an ideal gas of the particles");
    return kT * excess / (2.0 * map.alpha * map.n);
}
// [conservative coefficient]

double atoms_per_particle(CoarseGraining const& map, double a, double kT) {
    require_positive({{"inverse_compressibility", map.inverse_compressibility}});
    return groot_warren_inverse_compressibility({.n = map.n, .kT = kT}, a, map.alpha) /
           map.inverse_compressibility;
}

// [time unit]
double time_unit(CoarseGraining const& map, double eta) {
    require_positive({{"eta", eta}, {"eta_md", map.eta_md}});
    double const rc = cutoff_radius(map);  // checks the densities
    return (eta / map.n) / (map.eta_md / map.n_md) * rc * rc;
}

double force_in_dpd_units(CoarseGraining const& map, double eta, double force) {
    require_positive({{"force", force}});
    // Nm atoms feel it and the unit of mass is Nm atoms: Nm cancels
    return force * square(time_unit(map, eta)) / cutoff_radius(map);
}

double temperature_in_md_units(CoarseGraining const& map, double eta, double kT) {
    require_positive({{"kT", kT}});
    return kT * map.Nm * square(cutoff_radius(map) / time_unit(map, eta));
}
// [time unit]

// [mach number]
double mach_number(CoarseGraining const& map, double eta, double kT, double force, double L) {
    double const u_max = poiseuille_maximum_velocity(map.n, force_in_dpd_units(map, eta, force), eta,
                                                     length_in_dpd_units(map, L));
    double const a = conservative_coefficient(map, kT);
    return u_max / groot_warren_sound_speed({.n = map.n, .kT = kT}, a, map.alpha);
}
// [mach number]

// [speed up]
double speed_up(double Nm) {
    require_positive({{"Nm", Nm}});
    constexpr double soft_potentials = 1000.0;  // PK2006, after Groot & Rabone
    return soft_potentials * std::pow(Nm, 8.0 / 3.0);
}
// [speed up]

// [matched friction]
double matched_friction(double sigma, double kT) {
    require_positive({{"sigma", sigma}, {"kT", kT}});
    return square(sigma) / (2.0 * kT);
}
// [matched friction]

double repulsion_constant(Gas const& gas, PairDistribution const& g) {
    return integral_of_force_times_distance(gas, 1.0, g) / (2.0 * gas.d * power(gas.rc, gas.d + 1));
}

// [pressure]
double virial_pressure(Gas const& gas, double a, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"kT", gas.kT}});
    return gas.n * gas.kT + square(gas.n) / (2.0 * gas.d) * integral_of_force_times_distance(gas, a, g);
}

double virial_sound_speed(Gas const& gas, double a, PairDistribution const& g) {
    require_positive({{"n", gas.n}, {"m", gas.m}, {"kT", gas.kT}});
    return std::sqrt((gas.kT + gas.n / gas.d * integral_of_force_times_distance(gas, a, g)) / gas.m);
}
// [pressure]

double groot_warren_pressure(Gas const& gas, double a, double alpha) {
    return gas.n * (gas.kT + groot_warren_energy(gas, a, alpha));
}

double groot_warren_inverse_compressibility(Gas const& gas, double a, double alpha) {
    return 1.0 + 2.0 * groot_warren_energy(gas, a, alpha) / gas.kT;
}

double groot_warren_sound_speed(Gas const& gas, double a, double alpha) {
    require_positive({{"m", gas.m}});
    return std::sqrt(gas.kT / gas.m * groot_warren_inverse_compressibility(gas, a, alpha));
}

// [displacement]
double diffusion_from_displacement(int d, double msd, double t) {
    require_positive({{"msd", msd}, {"t", t}});
    unit_sphere_surface(d);  // checks d
    return msd / (2.0 * d * t);
}

double pair_distribution_in_shell(int d, double n, double neighbours, double r_min, double r_max) {
    require_positive({{"n", n}, {"neighbours", neighbours}, {"r_max", r_max}});
    if (!(r_min >= 0.0 && r_min < r_max)) throw std::invalid_argument("r_min must be in [0, r_max)");
    return neighbours / (n * unit_sphere_surface(d) / d * (std::pow(r_max, d) - std::pow(r_min, d)));
}
// [displacement]

// [poiseuille]
double poiseuille_velocity(double n, double force, double eta, double L, double z) {
    require_positive({{"n", n}, {"force", force}, {"eta", eta}});
    require_inside(L, z);
    return n * force / (2.0 * eta) * z * (L - z);
}
// [poiseuille]

double poiseuille_maximum_velocity(double n, double force, double eta, double L) {
    return poiseuille_velocity(n, force, eta, L, 0.5 * L);
}

// [power law]
double power_law_velocity(double u_max, double index, double L, double z) {
    require_positive({{"u_max", u_max}, {"index", index}});
    require_inside(L, z);
    return u_max * (1.0 - power(std::abs(1.0 - 2.0 * z / L), 1.0 / index + 1.0));
}
// [power law]

double schmidt_number(double eta, double n, double m, double D) {
    require_positive({{"eta", eta}, {"n", n}, {"m", m}, {"D", D}});
    return eta / (n * m * D);
}

// --- the rows of the registry ------------------------------------------------------------------------------

namespace {

CoarseGraining densities(Arguments const& a) { return {.Nm = a["Nm"], .n = a["n"], .n_md = a["n_md"]}; }
CoarseGraining viscous_fluid(Arguments const& a) {
    auto map = densities(a);
    map.eta_md = a["eta_md"];
    return map;
}

/// The fluid of Groot & Warren, three-dimensional.
Gas liquid(Arguments const& a, double m) { return {.n = a["n"], .m = m, .kT = a["kT"], .rc = a["rc"]}; }

// The units.
std::vector<ClosedForm> unit_rows() {
    Defaults const dpd_density{{"n", "3"}};
    return {
        {"pk1",
         "PK2006",
         "1",
         "mass of a DPD particle",
         "m Nm",
         {"m", "Nm"},
         {},
         [](Arguments const& a) { return particle_mass({.Nm = a["Nm"]}, a["m"]); }},
        {"pk2",
         "PK2006",
         "2",
         "cutoff radius r_c of coarse graining, in sigma",
         "(Nm n/n_md)^(1/3)",
         {"Nm", "n", "n_md"},
         {"m", "kT"},
         [](Arguments const& a) { return cutoff_radius(densities(a)); },
         dpd_density},
        {"pk3",
         "PK2006",
         "3",
         "conservative coefficient a",
         "kT (inverse_compressibility Nm - 1)/(2 alpha n)",
         {"kT", "n", "Nm", "alpha", "inverse_compressibility"},
         {"m"},
         [](Arguments const& a) {
             return conservative_coefficient({.Nm = a["Nm"],
                                              .n = a["n"],
                                              .inverse_compressibility = a["inverse_compressibility"],
                                              .alpha = a["alpha"]},
                                             a["kT"]);
         },
         dpd_density},
        {"pk3-Nm",
         "PK2006",
         "3",
         "atoms per particle at a conservative coefficient",
         "(1 + 2 alpha a n/kT)/inverse_compressibility",
         {"kT", "n", "a", "alpha", "inverse_compressibility"},
         {"m"},
         [](Arguments const& a) {
             return atoms_per_particle(
                 {.n = a["n"], .inverse_compressibility = a["inverse_compressibility"], .alpha = a["alpha"]},
                 a["a"], a["kT"]);
         },
         dpd_density},
        {"pk4",
         "PK2006",
         "4",
         "DPD unit of time, in tau",
         "(eta/n)/(eta_md/n_md) r_c^2",
         {"Nm", "n", "eta", "n_md", "eta_md"},
         {"m", "kT"},
         [](Arguments const& a) { return time_unit(viscous_fluid(a), a["eta"]); },
         dpd_density},
    };
}

// What the paper measures, and the virial with g = 1.
std::vector<ClosedForm> measured_rows() {
    return {
        {"pk5",
         "PK2006",
         "5",
         "diffusion constant from the mean-square displacement",
         "msd/(2 d t)",
         {"d", "t", "msd"},
         {},
         [](Arguments const& a) { return diffusion_from_displacement(a.d(), a["msd"], a["t"]); }},
        {"pk6",
         "PK2006",
         "6",
         "g(r) between r_min and r_max",
         "neighbours/(n volume of the shell)",
         {"d", "n", "neighbours", "r_min", "r_max"},
         {},
         [](Arguments const& a) {
             return pair_distribution_in_shell(a.d(), a["n"], a["neighbours"], a["r_min"], a["r_max"]);
         }},
        {"pk7",
         "PK2006",
         "7",
         "isothermal speed of sound with g = 1",
         "sqrt((kT + (n/d) [F r])/m), F = a (1 - r/rc)",
         {"d", "n", "m", "kT", "rc", "a"},
         {},
         [](Arguments const& a) { return virial_sound_speed(gas(a, a["n"], a["m"], a["kT"]), a["a"]); }},
        {"pk8",
         "PK2006",
         "8",
         "pressure with g = 1",
         "n kT + (n^2/(2 d)) [F r], F = a (1 - r/rc)",
         {"d", "n", "kT", "rc", "a"},
         {"m"},
         [](Arguments const& a) { return virial_pressure(gas(a, a["n"], unused, a["kT"]), a["a"]); }},
    };
}

// The fluid.
std::vector<ClosedForm> fluid_rows() {
    Defaults const dpd_density{{"n", "3"}};
    return {
        {"pk-table1",
         "PK2006",
         "Table I",
         "side L of the domain in units of r_c",
         "L_md/r_c",
         {"Nm", "n", "n_md", "L_md"},
         {"m", "kT"},
         [](Arguments const& a) { return length_in_dpd_units(densities(a), a["L_md"]); },
         dpd_density},
        {"pk-gamma",
         "PK2006",
         "sect. I",
         "friction that keeps kT with the noise",
         "sigma^2/(2 kT)",
         {"kT", "sigma"},
         {"m"},
         [](Arguments const& a) { return matched_friction(a["sigma"], a["kT"]); }},
        {"pk-speedup",
         "PK2006",
         "sect. I",
         "gain over molecular dynamics of water",
         "1000 Nm^(8/3)",
         {"Nm"},
         {},
         [](Arguments const& a) { return speed_up(a["Nm"]); }},
        {"pk-alpha",
         "PK2006",
         "8",
         "Groot and Warren's alpha with g = 1",
         "[(1 - r) r]/(2 d), rc = 1",
         {"d"},
         {"n", "m", "kT", "rc"},
         [](Arguments const& a) { return repulsion_constant({.d = a.d()}); }},
        {"pk-pressure",
         "PK2006",
         "3 and 8",
         "pressure by Groot and Warren",
         "n kT + alpha a rc^4 n^2",
         {"n", "kT", "rc", "a", "alpha"},
         {"m"},
         [](Arguments const& a) { return groot_warren_pressure(liquid(a, unused), a["a"], a["alpha"]); }},
        {"pk-kappa",
         "PK2006",
         "3",
         "(1/kT) dp/dn by Groot and Warren",
         "1 + 2 alpha a rc^4 n/kT",
         {"n", "kT", "rc", "a", "alpha"},
         {"m"},
         [](Arguments const& a) {
             return groot_warren_inverse_compressibility(liquid(a, unused), a["a"], a["alpha"]);
         }},
        {"pk-sound",
         "PK2006",
         "7",
         "isothermal speed of sound by Groot and Warren",
         "sqrt((kT + 2 alpha a rc^4 n)/m)",
         {"n", "m", "kT", "rc", "a", "alpha"},
         {},
         [](Arguments const& a) { return groot_warren_sound_speed(liquid(a, a["m"]), a["a"], a["alpha"]); }},
    };
}

// The channel in both units.
std::vector<ClosedForm> channel_units_rows() {
    Defaults const dpd_density{{"n", "3"}};
    return {
        {"pk-force",
         "PK2006",
         "4",
         "body force on a particle in DPD units",
         "force_md pk4^2/r_c",
         {"Nm", "n", "eta", "n_md", "eta_md", "force_md"},
         {"m", "kT"},
         [](Arguments const& a) { return force_in_dpd_units(viscous_fluid(a), a["eta"], a["force_md"]); },
         dpd_density},
        {"pk-temperature",
         "PK2006",
         "4",
         "kT of the DPD fluid in the atoms' units",
         "kT Nm (r_c/pk4)^2",
         {"Nm", "kT", "n", "eta", "n_md", "eta_md"},
         {"m"},
         [](Arguments const& a) { return temperature_in_md_units(viscous_fluid(a), a["eta"], a["kT"]); },
         dpd_density},
        {"pk-mach",
         "PK2006",
         "7, sect. IV",
         "Mach number of the Poiseuille flow",
         "n_md force_md L_md^2/(8 eta_md) (pk4/r_c)/sqrt(inverse_compressibility Nm kT)",
         {"Nm", "kT", "n", "eta", "n_md", "eta_md", "inverse_compressibility", "L_md", "force_md"},
         {"m"},
         [](Arguments const& a) {
             auto map = viscous_fluid(a);
             map.inverse_compressibility = a["inverse_compressibility"];
             return mach_number(map, a["eta"], a["kT"], a["force_md"], a["L_md"]);
         },
         dpd_density},
    };
}

// The flow in it.
std::vector<ClosedForm> channel_rows() {
    return {
        {"pk-poiseuille",
         "PK2006",
         "sect. IV",
         "velocity of the plane Poiseuille flow",
         "n force/(2 eta) z (L - z)",
         {"n", "force", "eta", "L", "z"},
         {"m", "kT"},
         [](Arguments const& a) {
             return poiseuille_velocity(a["n"], a["force"], a["eta"], a["L"], a["z"]);
         }},
        {"pk-umax",
         "PK2006",
         "sect. IV",
         "its velocity at the centre",
         "n force L^2/(8 eta)",
         {"n", "force", "eta", "L"},
         {"m", "kT"},
         [](Arguments const& a) {
             return poiseuille_maximum_velocity(a["n"], a["force"], a["eta"], a["L"]);
         }},
        {"pk-power-law",
         "PK2006",
         "sect. IV",
         "velocity of a power-law fluid in a channel",
         "u_max (1 - |1 - 2 z/L|^(1/index + 1))",
         {"u_max", "index", "L", "z"},
         {},
         [](Arguments const& a) { return power_law_velocity(a["u_max"], a["index"], a["L"], a["z"]); }},
        {"pk-schmidt",
         "PK2006",
         "sect. VI",
         "Schmidt number",
         "eta/(n m D)",
         {"n", "m", "eta", "D"},
         {"kT"},
         [](Arguments const& a) { return schmidt_number(a["eta"], a["n"], a["m"], a["D"]); }},
    };
}

}  // namespace

std::vector<ClosedForm> pk2006_rows() {
    return joined({unit_rows(), measured_rows(), fluid_rows(), channel_units_rows(), channel_rows()});
}

}  // namespace dpd::theory
