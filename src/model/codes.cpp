// The codes and papers, one function each; docs/conventions.md has the sources.

#include <fmt/format.h>

#include <cmath>

#include "conventions.hpp"
#include "errors.hpp"
#include "given.hpp"

namespace dpd {

std::optional<double> exponent(Weight weight) {
    switch (weight.kind) {
        case Weight::constant:
            return 0.0;
        case Weight::root:
            return 0.5;
        case Weight::linear:
            return 1.0;
        case Weight::quadratic:
            return 2.0;
        case Weight::power:
            return weight.exponent;
        default:
            return std::nullopt;
    }
}

double noise(DpdFluid const& fluid) { return std::sqrt(2.0 * fluid.gamma * fluid.kT); }

namespace {

/// The parameter `name` is the exponent of w_D over `factor`.
void read_exponent(Given const& given, DpdFluid& fluid, std::string_view name, double factor) {
    double const p = given.number(name) * factor;
    if (p > largest_exponent) given.refuse(name, fmt::format("0 to {}", largest_exponent / factor));
    fluid.weight = power_weight(p);
}

std::string number_text(double value) { return fmt::format("{}", value); }

void write_exponent(DpdFluid const& fluid, Assignments& others, std::string_view name, double factor) {
    auto const p = exponent(fluid.weight);
    if (!p)
        throw InputError(
            fmt::format("weight {}: no power of 1-r/rc; allowed: constant, linear, quadratic, root, power",
                        name_of(fluid.weight.kind)));
    others.emplace_back(name, number_text(*p / factor));
}

/// The weight as dpdref has it.
void write_weight(DpdFluid const& fluid, Assignments& others) {
    others.emplace_back("weight", name_of(fluid.weight.kind));
    if (fluid.weight.kind == Weight::power)
        others.emplace_back("exponent", number_text(fluid.weight.exponent));
}

[[noreturn]] void refuse_weight(DpdFluid const& fluid, std::string_view instead) {
    throw InputError(fmt::format("weight {}: {}", name_of(fluid.weight.kind), instead));
}

void nothing_to_read(Given const&, DpdFluid&) {}

void only_quadratic(DpdFluid& fluid, Assignments&) {
    if (fluid.weight != Weight::quadratic)
        refuse_weight(fluid, "this code has (1-r/rc)^2 alone; allowed: quadratic");
}

void only_lammps_dpd(DpdFluid& fluid, Assignments&) {
    auto const p = exponent(fluid.weight);
    if (p != 2.0)
        refuse_weight(fluid,
                      p ? fmt::format("pair dpd has (1-r/rc)^2 alone; use lammps-dpd-ext, ws={}", *p / 2)
                        : "no LAMMPS pair style has it; allowed: quadratic");
}

/// Two of gamma, sigma and kT; the third follows.
void read_pivkin(Given const& given, DpdFluid& fluid) {
    if (given.has("gamma") + given.has("sigma") + given.has("kT") < 2)
        throw InputError(fmt::format("{}: needs two of gamma, sigma, kT", given.code()));
    if (!given.has("sigma")) return;
    double const sigma2 = std::pow(given.number("sigma"), 2);
    if (!given.has("gamma")) fluid.gamma = sigma2 / (2.0 * fluid.kT);
    if (!given.has("kT")) {
        if (fluid.gamma == 0.0) given.refuse("gamma", "a number > 0, or kT");
        fluid.kT = sigma2 / (2.0 * fluid.gamma);
    }
    // papers print few digits, but these three exactly
    if (std::abs(sigma2 - 2.0 * fluid.gamma * fluid.kT) > 1e-9 * sigma2)
        throw InputError(fmt::format("{}: sigma^2 is not 2 gamma kT; give two of them", given.code()));
}

/// Units of NG2007: length rc, mass m, energy kT; time rc (m/kT)^(1/2).
double noguchi_time(DpdFluid const& fluid) { return fluid.rc * std::sqrt(fluid.m / fluid.kT); }

Code dpdref() {
    return {"dpdref",
            "dpdref's own; as FROM with the stages shardlow, verlet",
            Mover::s1,
            {{Key::gamma, "gamma", "F_D = -gamma w_D (e.v), mass/time", "", true},
             {Key::other, "weight", "w_D of r/rc", "quadratic"},
             {Key::other, "exponent", "of weight power, w_D = (1 - r/rc)^exponent", "-", true},
             {Key::rc, "rc", "cutoff, length", "1"},
             {Key::kT, "kT", "energy", "1"},
             {Key::a, "a", "F_C = a (1 - r/rc), force", "0", true},
             {Key::m, "m", "mass", "1"},
             {Key::dt, "dt", "time step", "-"}},
            [](Given const& given, DpdFluid& fluid) { fluid.weight = given.weight("weight"); },
            [](DpdFluid& fluid, Assignments& others) { write_weight(fluid, others); }};
}

Code lammps_dpd() {
    return {"lammps-dpd",
            "LAMMPS pair_style dpd with fix nve, units lj",
            Mover::velocity_verlet,
            {{Key::kT, "T", "temperature; kT = T in units lj"},
             {Key::a, "A", "F_C = A w, force", "0", true},
             {Key::gamma, "gamma", "F_D = -gamma w^2 (e.v), w = 1 - r/cutoff; mass/time", "", true},
             {Key::rc, "cutoff", "length", "1"},
             {Key::m, "mass", "of each atom", "1"},
             {Key::dt, "timestep", "time", "-"}},
            nothing_to_read,
            only_lammps_dpd};
}

Code lammps_dpd_tstat() {
    return {"lammps-dpd-tstat",
            "LAMMPS pair_style dpd/tstat: the same without repulsion",
            Mover::velocity_verlet,
            {{Key::kT, "T", "temperature; kT = T in units lj"},
             {Key::gamma, "gamma", "F_D = -gamma w^2 (e.v), w = 1 - r/cutoff; mass/time", "", true},
             {Key::rc, "cutoff", "length", "1"},
             {Key::m, "mass", "of each atom", "1"},
             {Key::dt, "timestep", "time", "-"}},
            nothing_to_read,
            only_lammps_dpd};
}

Code lammps_dpd_ext() {
    return {"lammps-dpd-ext",
            "LAMMPS pair_style dpd/ext with fix nve, units lj",
            Mover::velocity_verlet,
            {{Key::kT, "T", "temperature; kT = T in units lj"},
             {Key::a, "A", "F_C = A (1 - r/cutoff), force", "0", true},
             {Key::gamma, "gamma", "F_D = -gamma w^2 (e.v), mass/time", "", true},
             {Key::other, "gammaT", "friction across the line of centres; 0 alone", "0", true},
             {Key::other, "ws", "w = (1 - r/cutoff)^ws, half the exponent of w_D", "", true},
             {Key::rc, "cutoff", "length", "1"},
             {Key::m, "mass", "of each atom", "1"},
             {Key::dt, "timestep", "time", "-"}},
            [](Given const& given, DpdFluid& fluid) {
                if (given.number("gammaT") != 0.0)
                    given.refuse("gammaT", "0; friction along the line of centres alone");
                read_exponent(given, fluid, "ws", 2.0);
            },
            [](DpdFluid& fluid, Assignments& others) {
                write_exponent(fluid, others, "ws", 2.0);
                others.emplace_back("gammaT", "0");
            }};
}

Code lammps_dpd_fdt() {
    return {"lammps-dpd-fdt",
            "LAMMPS pair_style dpd/fdt with fix shardlow and fix nve, units lj",
            Mover::s1,
            {{Key::kT, "T", "temperature; kT = T in units lj"},
             {Key::a, "A", "F_C = A w, force", "0", true},
             {Key::other, "sigma", "noise; gamma = sigma^2/(2 kT)", "", true},
             {Key::rc, "cutoff", "length; w = 1 - r/cutoff, w_D = w^2", "1"},
             {Key::m, "mass", "of each atom", "1"},
             {Key::dt, "timestep", "time", "-"}},
            [](Given const& given, DpdFluid& fluid) {
                fluid.gamma = std::pow(given.number("sigma"), 2) / (2.0 * fluid.kT);
            },
            [](DpdFluid& fluid, Assignments& others) {
                only_quadratic(fluid, others);
                others.emplace_back("sigma", number_text(noise(fluid)));
            }};
}

Code espresso() {
    return {"espresso",
            "ESPResSo: thermostat.set_dpd, dpd and hat interactions",
            Mover::velocity_verlet,
            {{Key::kT, "kT", "energy"},
             {Key::gamma, "gamma", "F_D = -gamma w^2 (e.v), mass/time", "", true},
             {Key::other, "weight_function", "0: w = 1; 1: w = 1 - (r/r_cut)^k", "", true},
             {Key::other, "k", "exponent, with weight_function 1; 1 alone", "1"},
             {Key::rc, "r_cut", "length, also of hat", "1"},
             {Key::other, "trans_gamma", "friction across the line of centres; 0 alone", "0", true},
             {Key::a, "F_max", "of hat: F_C = F_max (1 - r/r_cut), force", "0", true},
             {Key::m, "mass", "of each particle", "1"},
             {Key::dt, "time_step", "time", "-"}},
            [](Given const& given, DpdFluid& fluid) {
                if (given.number("trans_gamma") != 0.0)
                    given.refuse("trans_gamma", "0; friction along the line of centres alone");
                double const function = given.number("weight_function");
                if (function != 0.0 && function != 1.0) given.refuse("weight_function", "0, 1");
                if (function == 1.0 && given.number("k") != 1.0)
                    given.refuse("k", "1; dpdref has no w_D = (1-x^k)^2 with another k");
                fluid.weight = function == 0.0 ? Weight::constant : Weight::quadratic;
            },
            [](DpdFluid& fluid, Assignments& others) {
                if (fluid.weight != Weight::constant && fluid.weight != Weight::quadratic)
                    refuse_weight(fluid,
                                  "ESPResSo has w_D = 1 and (1-(r/rc)^k)^2; allowed: constant, quadratic");
                bool const constant = fluid.weight == Weight::constant;
                others.emplace_back("weight_function", constant ? "0" : "1");
                if (!constant) others.emplace_back("k", "1");
            }};
}

Code hoomd_dpd() {
    return {"hoomd-dpd",
            "HOOMD-blue md.pair.DPD with ConstantVolume",
            Mover::velocity_verlet,
            {{Key::kT, "kT", "energy"},
             {Key::a, "A", "F_C = A w, force", "0", true},
             {Key::gamma, "gamma", "F_D = -gamma w^2 (e.v), w = 1 - r/r_cut; mass/time"},
             {Key::rc, "r_cut", "length", "1"},
             {Key::m, "mass", "of each particle", "1"},
             {Key::dt, "dt", "time", "-"}},
            nothing_to_read,
            [](DpdFluid& fluid, Assignments&) {
                auto const p = exponent(fluid.weight);
                if (p != 2.0)
                    refuse_weight(
                        fluid,
                        p ? fmt::format("md.pair.DPD has (1-r/rc)^2 alone; use hoomd-azplugins, s={}", *p)
                          : "no pair force of HOOMD-blue has it; allowed: quadratic");
                if (fluid.gamma == 0.0)
                    throw InputError("gamma: md.pair.DPD refuses 0; use its DPDConservative");
            }};
}

Code hoomd_azplugins() {
    return {"hoomd-azplugins",
            "azplugins pair.DPDGeneralWeight for HOOMD-blue",
            Mover::velocity_verlet,
            {{Key::kT, "kT", "energy"},
             {Key::a, "A", "F_C = A (1 - r/r_cut), force", "0", true},
             {Key::gamma, "gamma", "F_D = -gamma w (e.v), mass/time", "", true},
             {Key::other, "s", "w = (1 - r/r_cut)^s, the exponent of w_D", "", true},
             {Key::rc, "r_cut", "length", "1"},
             {Key::m, "mass", "of each particle", "1"},
             {Key::dt, "dt", "time", "-"}},
            [](Given const& given, DpdFluid& fluid) { read_exponent(given, fluid, "s", 1.0); },
            [](DpdFluid& fluid, Assignments& others) { write_exponent(fluid, others, "s", 1.0); }};
}

Code openmm() {
    return {"openmm",
            "OpenMM 8.3 DPDIntegrator; nm, ps, dalton, kJ/mol",
            Mover::middle,
            {{Key::kT, "temperature", "K"},
             {Key::gamma, "friction", "a rate, 1/ps: gamma/mass; w_D = (1 - r/cutoff)^2", "", true},
             {Key::rc, "cutoff", "nm", "1"},
             {Key::m, "mass", "dalton"},
             {Key::a, "A", "kJ/mol/nm, of a CustomNonbondedForce 0.5*A*cutoff*(1-r/cutoff)^2", "0", true},
             {Key::dt, "stepSize", "ps", "-"}},
            [](Given const&, DpdFluid& fluid) {
                fluid.kT *= gas_constant;
                fluid.gamma *= fluid.m;
            },
            [](DpdFluid& fluid, Assignments& others) {
                only_quadratic(fluid, others);
                fluid.kT /= gas_constant;
                fluid.gamma /= fluid.m;
            }};
}

Code mirheo() {
    return {"mirheo",
            "Mirheo: Pairwise of kind DPD with VelocityVerlet",
            Mover::leapfrog,
            {{Key::a, "a", "F_C = a (1 - r/rc), force", "0", true},
             {Key::gamma, "gamma", "F_D = -gamma w^2 (e.v), mass/time", "", true},
             {Key::kT, "kBT", "energy"},
             {Key::other, "power", "w = (1 - r/rc)^power, half the exponent of w_D", "", true},
             {Key::rc, "rc", "length", "1"},
             {Key::m, "mass", "of each particle of the ParticleVector", "1"},
             {Key::dt, "dt", "time", "-"}},
            [](Given const& given, DpdFluid& fluid) { read_exponent(given, fluid, "power", 2.0); },
            [](DpdFluid& fluid, Assignments& others) { write_exponent(fluid, others, "power", 2.0); }};
}

Code uammd() {
    return {"uammd",
            "UAMMD: Potential::DPD with VerletNVE",
            Mover::velocity_verlet,
            {{Key::kT, "temperature", "kT, energy"},
             {Key::a, "A", "F_C = A w, force", "0", true},
             {Key::gamma, "gamma", "F_D = -gamma w^2 (e.v), w = 1 - r/cutOff; mass/time", "", true},
             {Key::rc, "cutOff", "length", "1"},
             {Key::m, "mass", "of each particle", "1"},
             {Key::dt, "dt", "time", "-"}},
            nothing_to_read,
            only_quadratic};
}

Code molly() {
    return {"molly",
            "Molly.jl: DPDInteraction with DPDVelocityVerlet",
            Mover::velocity_verlet,
            {{Key::a, "a", "F_C = a w, force", "25", true},
             {Key::gamma, "γ", "F_D = -γ w^2 (e.v), w = 1 - r/r_c; mass/time", "4.5"},
             {Key::other, "σ", "of w, momentum/time^(1/2); kT is σ^2/(2γ)", "3"},
             {Key::rc, "r_c", "length", "1"},
             {Key::m, "mass", "of each atom", "1"},
             {Key::dt, "dt", "time, of the interaction and of the simulator", "-"},
             {Key::other, "λ", "of the simulator: velocities predicted for λ dt", "0.65", true}},
            [](Given const& given, DpdFluid& fluid) {
                fluid.kT = std::pow(given.number("σ"), 2) / (2.0 * fluid.gamma);
                fluid.lambda = given.number("λ");
            },
            [](DpdFluid& fluid, Assignments& others) {
                only_quadratic(fluid, others);
                if (fluid.gamma == 0.0) throw InputError("γ: here kT is σ^2/(2γ); allowed: a number > 0");
                others.emplace_back("σ", number_text(noise(fluid)));
                others.emplace_back("λ", number_text(fluid.lambda));
            }};
}

Code galamost() {
    return {"galamost",
            "GALAMOST and PYGAMD's cu_gala: DPDForce with DPDGWVV",
            Mover::velocity_verlet,
            {{Key::a, "alpha", "F_C = alpha (1 - r/r_cut), force", "0", true},
             {Key::other, "sigma", "noise; gamma = sigma^2/(2 T), of (1 - r/r_cut)^2", "", true},
             {Key::kT, "T", "kT, energy", "1"},
             {Key::rc, "r_cut", "length", "1"},
             {Key::m, "mass", "of each particle", "1"},
             {Key::dt, "dt", "time", "-"},
             {Key::other, "lambda", "of DPDGWVV: velocities predicted for lambda dt", "0.65", true}},
            [](Given const& given, DpdFluid& fluid) {
                fluid.gamma = std::pow(given.number("sigma"), 2) / (2.0 * fluid.kT);
                fluid.lambda = given.number("lambda");
            },
            [](DpdFluid& fluid, Assignments& others) {
                only_quadratic(fluid, others);
                others.emplace_back("sigma", number_text(noise(fluid)));
                others.emplace_back("lambda", number_text(fluid.lambda));
            }};
}

Code pygamd() {
    return {
        "pygamd",
        "PYGAMD in Python: force.dpd with integration.gwvv; kT is 1, lambda 0.65",
        Mover::velocity_verlet,
        {{Key::a, "alpha", "F_C = alpha (1 - r/rcut), force", "0", true},
         {Key::other, "sigma", "noise; gamma = sigma^2/2, of (1 - r/rcut)^2", "", true},
         {Key::rc, "rcut", "length", "1"},
         {Key::m, "mass", "of each particle", "1"},
         {Key::dt, "dt", "time", "-"}},
        [](Given const& given, DpdFluid& fluid) {
            fluid.gamma = std::pow(given.number("sigma"), 2) / 2.0;
            fluid.lambda = 0.65;
        },
        [](DpdFluid& fluid, Assignments& others) {
            only_quadratic(fluid, others);
            if (fluid.kT != 1.0)
                throw InputError(fmt::format("kT: {} is not pygamd's; allowed: 1, or galamost", fluid.kT));
            others.emplace_back("sigma", number_text(noise(fluid)));
        }};
}

Code dl_meso() {
    return {"dl_meso",
            "DL_MESO_DPD, ensemble nvt mdvv",
            Mover::velocity_verlet,
            {{Key::kT, "temperature", "kT, energy"},
             {Key::a, "A", "F_C = A (1 - r/rc), force", "0", true},
             {Key::rc, "rc", "length", "1"},
             {Key::gamma, "gamma", "F_D = -gamma w_D (e.v), w_D = (1 - r/rc)^2; mass/time", "", true},
             {Key::m, "mass", "of each bead", "1"},
             {Key::dt, "timestep", "time", "-"}},
            nothing_to_read,
            only_quadratic};
}

Code gromacs() {
    return {"gromacs",
            "impulsive friction of Goga et al. 2012, proposed for GROMACS (feature 1885), along the line of "
            "centres",
            Mover::exponential,
            {{Key::other, "f", "share of the relative velocity that a step removes at contact, 0 to 1"},
             {Key::other, "direction", "parallel (isotropic friction is not in dpdref)", "parallel"},
             {Key::other, "weight", "of the friction, as dpdref's", "constant"},
             {Key::other, "exponent", "of weight power", "-", true},
             {Key::rc, "rc", "length", "1"},
             {Key::kT, "kT", "energy"},
             {Key::m, "mass", "of each particle", "1"},
             {Key::dt, "dt", "time"}},
            [](Given const& given, DpdFluid& fluid) {
                if (given.text("direction") != "parallel")
                    given.refuse("direction", "parallel; dpdref's friction acts along the line of centres");
                double const f = given.number("f");
                if (f >= 1.0) given.refuse("f", "a number > 0 and < 1");
                fluid.weight = given.weight("weight");
                fluid.gamma = -fluid.m * std::log1p(-f) / (2.0 * *fluid.dt);
            },
            [](DpdFluid& fluid, Assignments& others) {
                if (!fluid.dt) throw InputError("gromacs: the friction of a step needs the time step");
                if (fluid.gamma == 0.0) throw InputError("gamma: f would be 0; allowed: a number > 0");
                others.emplace_back("f", number_text(-std::expm1(-2.0 * fluid.gamma * *fluid.dt / fluid.m)));
                write_weight(fluid, others);
            }};
}

Code marsh_yeomans() {
    return {"MY1997",
            "Marsh & Yeomans 1997, eqs. 1, 2",
            Mover::euler,
            {{Key::gamma, "gamma", "of w_D, mass/time"},
             {Key::other, "sigma", "of w_R, momentum/time^(1/2); kT of small steps is sigma^2/(2 gamma)"},
             {Key::other, "weight", "w_D; w_R^2 = w_D", "linear"},
             {Key::other, "exponent", "of weight power", "-", true},
             {Key::rc, "rc", "length", "1"},
             {Key::m, "m", "mass", "1"},
             {Key::dt, "dt", "time", "-"}},
            [](Given const& given, DpdFluid& fluid) {
                fluid.weight = given.weight("weight");
                fluid.kT = std::pow(given.number("sigma"), 2) / (2.0 * fluid.gamma);
            },
            [](DpdFluid& fluid, Assignments& others) {
                if (fluid.gamma == 0.0)
                    throw InputError("gamma: MY1997 needs friction; allowed: a number > 0");
                others.emplace_back("sigma", number_text(noise(fluid)));
                write_weight(fluid, others);
            }};
}

Code noguchi_gompper() {
    return {"NG2007",
            "Noguchi & Gompper 2007, starred quantities; m, kT, rc are the units",
            Mover::s1,
            {{Key::gamma, "gamma", "gamma* = gamma rc/(m kT)^(1/2); F_D = -gamma w (e.v)", "", true},
             {Key::other, "weight", "w of eq. 2 linear, of eq. 6 constant", "linear"},
             {Key::a, "a", "U = (a kT/2) (1 - r/rc)^2", "0", true},
             {Key::dt, "dt", "dt* = dt (kT/m)^(1/2)/rc", "-"},
             {Key::m, "m", "unit of mass", "1"},
             {Key::kT, "kT", "unit of energy", "1"},
             {Key::rc, "rc", "unit of length", "1"}},
            [](Given const& given, DpdFluid& fluid) {
                if (given.text("weight") != "linear" && given.text("weight") != "constant")
                    given.refuse("weight", "linear, constant");
                fluid.weight = given.weight("weight");
                fluid.gamma *= fluid.m / noguchi_time(fluid);
                fluid.a *= fluid.kT / fluid.rc;
                if (fluid.dt) *fluid.dt *= noguchi_time(fluid);
            },
            [](DpdFluid& fluid, Assignments& others) {
                if (fluid.weight != Weight::linear && fluid.weight != Weight::constant)
                    refuse_weight(fluid, "NG2007 has eqs. 2 and 6; allowed: linear, constant");
                fluid.gamma /= fluid.m / noguchi_time(fluid);
                fluid.a /= fluid.kT / fluid.rc;
                if (fluid.dt) *fluid.dt /= noguchi_time(fluid);
                write_weight(fluid, others);
            }};
}

Code pivkin_karniadakis() {
    return {"PK2006",
            "Pivkin & Karniadakis 2006, after Groot & Warren 1997; two of gamma, sigma, kT",
            Mover::velocity_verlet,
            {{Key::gamma, "gamma", "F_D = -gamma w_D (e.v), w_D = (1 - r/rc)^2; mass/time", "-", true},
             {Key::other, "sigma", "sigma_R, momentum/time^(1/2); sigma^2 = 2 gamma kT", "-", true},
             {Key::kT, "kT", "energy", "-"},
             {Key::a, "a", "F_C = a (1 - r/rc), force", "0", true},
             {Key::rc, "rc", "length", "1"},
             {Key::m, "m", "mass", "1"},
             {Key::dt, "dt", "time", "-"}},
            read_pivkin,
            [](DpdFluid& fluid, Assignments& others) {
                only_quadratic(fluid, others);
                others.emplace_back("sigma", number_text(noise(fluid)));
            }};
}

}  // namespace

std::span<Code const> codes() {
    static std::vector<Code> const all{dpdref(),
                                       lammps_dpd(),
                                       lammps_dpd_tstat(),
                                       lammps_dpd_ext(),
                                       lammps_dpd_fdt(),
                                       espresso(),
                                       hoomd_dpd(),
                                       hoomd_azplugins(),
                                       openmm(),
                                       mirheo(),
                                       uammd(),
                                       molly(),
                                       galamost(),
                                       pygamd(),
                                       dl_meso(),
                                       gromacs(),
                                       marsh_yeomans(),
                                       noguchi_gompper(),
                                       pivkin_karniadakis()};
    return all;
}

}  // namespace dpd
