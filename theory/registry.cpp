#include "registry.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <stdexcept>

namespace dpd::theory {
namespace {

constexpr std::string_view scheme_names = "shardlow, exponential, linear";
constexpr std::string_view zero_or_more = ">= 0";
constexpr std::string_view random_weight_names = "matched, constant, linear, quadratic, parabolic, root";

constexpr std::array<Parameter, 35> all_parameters{{
    {"d", "dimension of space", "3", "2 or 3"},
    {"n", "number density", std::nullopt, "> 0"},
    {"m", "mass of a particle", "1", "> 0"},
    {"kT", "temperature, k_B T", "1", "> 0"},
    {"gamma", "strength of the friction (its value where the weight is 1)", std::nullopt, "> 0"},
    {"sigma", "strength of the noise", std::nullopt, "> 0"},
    {"rc", "cutoff radius", "1", "> 0"},
    {"dt", "time step", std::nullopt, "> 0"},
    {"Gamma", "Lowe-Andersen rate, updates of a pair per unit time", std::nullopt, "> 0"},
    {"L", "side of the periodic cube or square; width of the channel", std::nullopt, "> 0"},
    {"eta", "shear viscosity", std::nullopt, "> 0"},
    {"D", "self-diffusion constant", std::nullopt, "> 0"},
    {"t", "time", std::nullopt, "> 0"},
    {"phi_pot", "relaxation rate of a velocity by the potential", std::nullopt, zero_or_more},
    {"phi_dpd", "relaxation rate of a velocity by the thermostat", std::nullopt, zero_or_more},
    {"a", "strength of the soft potential, its force at r = 0 (in ng16: in units of kT/rc)", std::nullopt,
     "> 0"},
    {"Nm", "atoms per DPD particle", std::nullopt, "> 0"},
    {"alpha", "constant of Groot and Warren's equation of state", "0.101", "> 0"},
    {"inverse_compressibility", "(1/kT) dp/dn of the atoms", "15.36", "> 0"},
    {"n_md", "number density of the atoms, 1/sigma^3", "0.8", "> 0"},
    {"eta_md", "viscosity of the atoms, m/(sigma tau)", "1.97", "> 0"},
    {"L_md", "side of the domain, sigma", "34.2", "> 0"},
    {"force_md", "body force on an atom, m sigma/tau^2", "0.0085", "> 0"},
    {"force", "body force on a particle", std::nullopt, "> 0"},
    {"u_max", "velocity at the centre of the channel", std::nullopt, "> 0"},
    {"index", "exponent of the shear rate in the stress", std::nullopt, "> 0"},
    {"z", "distance from the wall", std::nullopt, zero_or_more},
    {"msd", "mean-square displacement", std::nullopt, "> 0"},
    {"neighbours", "mean number of particles in the shell around a particle", std::nullopt, "> 0"},
    {"r_min", "inner radius of the shell", std::nullopt, zero_or_more},
    {"r_max", "outer radius of the shell", std::nullopt, "> 0"},
    {"r", "distance of a pair", std::nullopt, "> 0"},
    {"weight", "weight function of the friction", "linear", weight_names},
    {"random_weight", "weight function of the noise; matched: its square is the weight of the friction",
     "matched", random_weight_names},
    {"scheme", "update of a pair: its A as a function of w dt/m", "shardlow", scheme_names},
}};

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

std::string joined(std::span<std::string_view const> names) {
    std::string line;
    for (auto name : names) line += (line.empty() ? "" : " ") + std::string(name);
    return line;
}

[[noreturn]] void refuse(Parameter const& parameter, std::string_view text) {
    throw std::invalid_argument("parameter " + quoted(parameter.name) + " is " + quoted(text) +
                                "; allowed: " + std::string(parameter.allowed));
}

/// A finite number that takes up the whole text.
std::optional<double> number_from(std::string_view text) {
    double value = 0.0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

Parameter const* find_parameter(std::string_view name) {
    auto const found = std::ranges::find(all_parameters, name, &Parameter::name);
    return found == all_parameters.end() ? nullptr : &*found;
}

ExplicitDpd explicit_dpd(Arguments const& a, double n, double sigma) {
    return {.d = a.d(),
            .n = n,
            .m = a["m"],
            .gamma = a["gamma"],
            .sigma = sigma,
            .rc = a["rc"],
            .weight = a.weight(),
            .random_weight = a.random_weight()};
}

Shardlow shardlow(Arguments const& a) {
    return {.gamma = a["gamma"], .weight = a.weight(), .scheme = a.scheme()};
}
Lowe lowe(Arguments const& a) { return {.Gamma = a["Gamma"]}; }

/// A quantity of the gas that the equation does not use may be any positive number.
constexpr double unused = 1.0;

Gas gas(Arguments const& a, double n, double m, double kT) {
    return {.d = a.d(), .n = n, .m = m, .kT = kT, .rc = a["rc"]};
}

CoarseGraining densities(Arguments const& a) { return {.Nm = a["Nm"], .n = a["n"], .n_md = a["n_md"]}; }
CoarseGraining viscous_fluid(Arguments const& a) {
    auto map = densities(a);
    map.eta_md = a["eta_md"];
    return map;
}

/// The fluid of Groot & Warren, three-dimensional.
Gas liquid(Arguments const& a, double m) { return {.n = a["n"], .m = m, .kT = a["kT"], .rc = a["rc"]}; }

using Defaults = std::vector<std::pair<std::string_view, std::optional<std::string_view>>>;

std::vector<ClosedForm> const& all_forms() {
    Defaults const dpd_density{{"n", "3"}};
    // atoms have no use for the cutoff 1 of the DPD forms
    Defaults const cutoff_required{{"rc", std::nullopt}};
    static std::vector<ClosedForm> const forms{
        {"my22",
         "MY1997",
         "22",
         "temperature kT of explicit DPD at finite step",
         "A3/(m (A1 (2 - A1 n dt) - A2 dt))",
         {"d", "n", "m", "gamma", "sigma", "rc", "dt", "weight", "random_weight"},
         {},
         [](Arguments const& a) {
             return temperature_at_finite_step(explicit_dpd(a, a["n"], a["sigma"]), a["dt"]);
         }},
        {"my22-frozen",
         "MY1997",
         "22, frozen",
         "kT of explicit DPD if neighbours never change",
         "A3/(2 m A1) (1 + n A1 dt/2)",
         {"d", "n", "m", "gamma", "sigma", "rc", "dt", "weight"},
         {},
         [](Arguments const& a) {
             return temperature_with_frozen_neighbours(explicit_dpd(a, a["n"], a["sigma"]), a["dt"]);
         }},
        {"my23-A1",
         "MY1997",
         "23",
         "A1, decay rate of a momentum per density",
         "gamma [w_D]/(m d)",
         {"d", "m", "gamma", "rc", "weight"},
         {"n", "sigma", "dt", "random_weight"},
         [](Arguments const& a) { return A1(explicit_dpd(a, unused, unused)); }},
        {"my23-A2",
         "MY1997",
         "23",
         "A2, second-order term of a single partner",
         "2 gamma^2 [w_D^2]/(m^2 d)",
         {"d", "m", "gamma", "rc", "weight"},
         {"n", "sigma", "dt", "random_weight"},
         [](Arguments const& a) { return A2(explicit_dpd(a, unused, unused)); }},
        {"my23-A3",
         "MY1997",
         "23",
         "A3, momentum fed in by the noise",
         "sigma^2 [w_R^2]/d",
         {"d", "sigma", "rc", "weight", "random_weight"},
         {"n", "m", "gamma", "dt"},
         [](Arguments const& a) {
             return A3({.d = a.d(),
                        .sigma = a["sigma"],
                        .rc = a["rc"],
                        .weight = a.weight(),
                        .random_weight = a.random_weight()});
         }},
        {"my25",
         "MY1997",
         "25",
         "critical step of explicit DPD",
         "2 A1/(n A1^2 + A2)",
         {"d", "n", "m", "gamma", "rc", "weight"},
         {"sigma", "random_weight"},
         [](Arguments const& a) { return critical_step(explicit_dpd(a, a["n"], unused)); }},
        {"my26",
         "MY1997",
         "26",
         "critical density of explicit DPD",
         "(2 A1 - A2 dt)/(A1^2 dt)",
         {"d", "m", "gamma", "rc", "dt", "weight"},
         {"sigma", "random_weight"},
         [](Arguments const& a) { return critical_density(explicit_dpd(a, unused, unused), a["dt"]); }},
        {"ng8",
         "NG2007",
         "8",
         "kinetic viscosity",
         "n kT dt (1/(1 - s) - 1/2)",
         {"d", "n", "m", "kT", "gamma", "rc", "dt", "weight", "scheme"},
         {},
         [](Arguments const& a) {
             return kinetic_viscosity(gas(a, a["n"], a["m"], a["kT"]), shardlow(a), a["dt"]);
         }},
        {"ng9",
         "NG2007",
         "9",
         "s, factor on <v_x v_y> per step",
         "exp(n [-2A/d + 4A^2/(d(d+2))])",
         {"d", "n", "m", "gamma", "rc", "dt", "weight", "scheme"},
         {"kT"},
         [](Arguments const& a) {
             return stress_retention(gas(a, a["n"], a["m"], unused), shardlow(a), a["dt"]);
         }},
        {"ng10",
         "NG2007",
         "10",
         "kinetic viscosity for dt -> 0",
         "d m kT/(2 [w])",
         {"d", "m", "kT", "gamma", "rc", "weight"},
         {"n", "dt", "scheme"},
         [](Arguments const& a) {
             return kinetic_viscosity_limit(gas(a, unused, a["m"], a["kT"]), shardlow(a));
         }},
        {"ng12",
         "NG2007",
         "12",
         "collision viscosity",
         "m n^2/(2 d (d+2) dt) [A r^2], with shardlow n^2/(2 d (d+2)) [w r^2/(1 + w dt/m)]",
         {"d", "n", "m", "gamma", "rc", "dt", "weight", "scheme"},
         {"kT"},
         [](Arguments const& a) {
             return collision_viscosity(gas(a, a["n"], a["m"], unused), shardlow(a), a["dt"]);
         }},
        {"ng12-limit",
         "NG2007",
         "12",
         "collision viscosity for dt -> 0",
         "n^2/(2 d (d+2)) [w r^2]",
         {"d", "n", "gamma", "rc", "weight"},
         {"m", "kT", "dt", "scheme"},
         [](Arguments const& a) {
             return collision_viscosity_limit(gas(a, a["n"], unused, unused), shardlow(a));
         }},
        {"ng17",
         "NG2007",
         "17",
         "self-diffusion constant",
         "(kT dt/m) (1/(1 - exp(-n [A]/d)) - 1/2)",
         {"d", "n", "m", "kT", "gamma", "rc", "dt", "weight", "scheme"},
         {},
         [](Arguments const& a) {
             return diffusion_constant(gas(a, a["n"], a["m"], a["kT"]), shardlow(a), a["dt"]);
         }},
        {"ng17-limit",
         "NG2007",
         "17",
         "self-diffusion constant for dt -> 0",
         "d kT/(n [w])",
         {"d", "n", "kT", "gamma", "rc", "weight"},
         {"m", "dt", "scheme"},
         [](Arguments const& a) {
             return diffusion_constant_limit(gas(a, a["n"], unused, a["kT"]), shardlow(a));
         }},
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
         {"d", "n", "m", "gamma", "rc", "weight"},
         {"kT", "dt", "scheme"},
         [](Arguments const& a) { return relaxation_rate(gas(a, a["n"], a["m"], unused), shardlow(a)); }},
        {"ng-schmidt",
         "NG2007",
         "8, 12, 17",
         "Schmidt number of the ideal gas",
         "(eta_kin + eta_col)/(n m D)",
         {"d", "n", "m", "kT", "gamma", "rc", "dt", "weight", "scheme"},
         {},
         [](Arguments const& a) {
             return schmidt_number(gas(a, a["n"], a["m"], a["kT"]), shardlow(a), a["dt"]);
         }},
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
        {"harmonic-limit",
         "ours",
         "docs/stability.md",
         "largest step for the soft repulsion in random phases",
         "2/max over k of sqrt(n k^2 U_k/m)",
         {"d", "n", "m", "rc", "a"},
         {"kT"},
         [](Arguments const& a) { return harmonic_limit(gas(a, a["n"], a["m"], unused), a["a"]); }},
    };
    return forms;
}

}  // namespace

std::span<Parameter const> parameters() { return all_parameters; }

std::span<ClosedForm const> closed_forms() { return all_forms(); }

ClosedForm const* find(std::string_view id) {
    auto const found = std::ranges::find(all_forms(), id, &ClosedForm::id);
    return found == all_forms().end() ? nullptr : &*found;
}

std::optional<std::string_view> ClosedForm::default_text(Parameter const& parameter) const {
    auto const own = std::ranges::find(defaults, parameter.name, [](auto const& pair) { return pair.first; });
    return own == defaults.end() ? parameter.default_text : own->second;
}

Arguments::Arguments(ClosedForm const& form, std::span<std::pair<std::string, std::string> const> given) {
    auto const has = [](auto const& names, std::string_view name) {
        return std::ranges::find(names, name) != names.end();
    };
    std::vector<std::string_view> seen;
    for (auto const& [name, text] : given) {
        if (!has(form.parameters, name) && !has(form.without_effect, name))
            throw std::invalid_argument(std::string(form.id) + " has no parameter " + quoted(name) +
                                        " (given as " + quoted(text) +
                                        "); allowed: " + joined(form.parameters));
        if (has(seen, name))
            throw std::invalid_argument("parameter " + quoted(name) + " is given twice, the second time as " +
                                        quoted(text) + "; allowed: once");
        seen.push_back(name);
        set(*find_parameter(name), text);
    }
    for (auto name : form.parameters) {
        auto const& parameter = *find_parameter(name);
        if (has(seen, name)) continue;
        auto const text = form.default_text(parameter);
        if (!text)
            throw std::invalid_argument(std::string(form.id) + " needs parameter " + quoted(name) + " (" +
                                        std::string(parameter.meaning) +
                                        "), which was not given; allowed: " + std::string(parameter.allowed));
        set(parameter, *text);
    }
}

void Arguments::set(Parameter const& parameter, std::string_view text) {
    if (parameter.name == "weight" || parameter.name == "random_weight") {
        auto const weight = weight_from_name(text);
        bool const matched = parameter.name == "random_weight" && text == "matched";
        if (!weight && !matched) refuse(parameter, text);
        if (parameter.name == "weight")
            weight_ = *weight;
        else
            random_weight_ = weight;
        return;
    }
    if (parameter.name == "scheme") {
        auto const scheme = scheme_from_name(text);
        if (!scheme) refuse(parameter, text);
        scheme_ = *scheme;
        return;
    }
    auto const value = number_from(text);
    if (!value || *value < 0.0 || (*value == 0.0 && parameter.allowed != zero_or_more))
        refuse(parameter, text);
    if (parameter.name == "d" && *value != 2.0 && *value != 3.0) refuse(parameter, text);
    numbers_[parameter.name] = *value;
}

double Arguments::operator[](std::string_view name) const {
    auto const found = numbers_.find(name);
    if (found != numbers_.end()) return found->second;
    auto const* parameter = find_parameter(name);
    if (parameter == nullptr || !parameter->default_text)
        throw std::logic_error("closed form reads undeclared parameter " + quoted(name));
    return *number_from(*parameter->default_text);
}

double evaluate(std::string_view id, std::span<std::pair<std::string, std::string> const> given) {
    auto const* form = find(id);
    if (form == nullptr) {
        std::vector<std::string_view> ids;
        for (auto const& known : closed_forms()) ids.push_back(known.id);
        throw std::invalid_argument("no closed form " + quoted(id) + "; allowed: " + joined(ids));
    }
    double const value = form->value(Arguments(*form, given));
    if (!std::isfinite(value))
        throw std::domain_error(std::string(id) +
                                " is not finite there: a parameter is too large or too small");
    return value;
}

}  // namespace dpd::theory
