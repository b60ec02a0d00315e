/// @file
/// What the codes and papers of the field mean by their parameters, and the way from one to another.
/// docs/conventions.md has the table with sources.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "weight.hpp"

namespace dpd {

/// Gas constant, kJ/(mol K), exact since 2019: kT of a code that counts energy in kJ/mol.
inline constexpr double gas_constant = 8.31446261815324e-3;

/// A DPD fluid of one species as dpdref means it: on i act, along the unit vector e from j to i,
/// F_C = a (1 - r/rc), F_D = -gamma w_D(r/rc) e.(v_i - v_j), and noise sigma w_R with w_R^2 = w_D and
/// sigma^2 = 2 gamma kT.
struct DpdFluid {
    double gamma = 0.0;                 ///< friction, mass/time
    Weight weight = Weight::quadratic;  ///< w_D
    double rc = 1.0;                    ///< cutoff of all three, length
    double kT = 1.0;                    ///< energy
    double m = 1.0;                     ///< mass of each particle
    double a = 0.0;                     ///< repulsion at contact, force; the energy there is a rc/2
    std::optional<double> dt = {};      ///< time step, if known
    double lambda = 0.5;  ///< share of the step for which a mover that predicts velocities does it
};

/// p of w_D = (1 - x)^p, whatever the weight is called; nothing for the parabolic one, which is no power of
/// it.
std::optional<double> exponent(Weight weight);

/// Strength of the noise, sigma = (2 gamma kT)^(1/2), momentum/time^(1/2).
double noise(DpdFluid const& fluid);

using Assignments = std::vector<std::pair<std::string, std::string>>;

/// How a code moves particles, as far as its forces' convention depends on it.
enum class Mover {
    velocity_verlet,  ///< friction from predicted velocities, with lambda 1/2 those at half step: stage
                      ///< `modified_verlet`
    s1,               ///< pair after pair, then the potential: `shardlow`, `verlet`
    exponential,      ///< the same with the pair's Langevin equation solved exactly
    middle,           ///< kick, half drift, exponential, half drift (OpenMM's LFMiddle)
    euler,            ///< MY1997: from the state before, moves with the old momentum
    leapfrog,         ///< the same, moves with the new one: `euler`, `force`, `kick`, `drift`
};

/// One parameter of a code.
struct Key {
    /// Which member of DpdFluid it holds, in the code's units and meaning.
    enum Role { gamma, rc, kT, m, a, dt, other };
    Role role;                       ///< the member of DpdFluid
    std::string_view name;           ///< as the code calls it
    std::string_view meaning;        ///< for messages, with its unit
    std::string_view fallback = "";  ///< empty: required; "-": may be missing
    bool may_be_zero = false;        ///< a number: >= 0 rather than > 0
};

class Given;

/// A code or a paper.
struct Code {
    std::string_view name;   ///< on the command line
    std::string_view title;  ///< in pages and messages
    Mover mover;             ///< what a step of it does
    std::vector<Key> keys;   ///< its parameters, in the order of its manual
    /// What the roles do not say: changes of unit and meaning, the weight.
    void (*read)(Given const&, DpdFluid&);
    /// The way back, adding parameters without a role; refuses what the code cannot have.
    void (*write)(DpdFluid&, Assignments&);
};

std::span<Code const> codes();

/// The code of that name; InputError lists all.
Code const& find_code(std::string_view name);

/// The fluid that a code's parameters describe. InputError: unknown, missing or bad ones, and what dpdref
/// does not have (friction across the line of centres, other weights).
DpdFluid read_fluid(Code const& code, Assignments const& given);

/// The parameters with which a code has this fluid, numbers as the shortest text that reads back the same.
/// InputError: what the code cannot have, by name, and what can.
Assignments write_fluid(Code const& code, DpdFluid fluid);

/// The part of a scene (TOML) that says the same: stages, friction, repulsion, mass, kT and time step. Its
/// keys are dotted, so that lines before and after it can be what is left to say: box, number of particles,
/// duration.
std::string scene_fragment(DpdFluid const& fluid, Mover mover);

/// What that part lacks of a scene that runs, as comments: box, number of particles, duration, and the time
/// step if it is not known. They are not the fluid's, so that the values are an example.
std::string rest_of_scene(DpdFluid const& fluid);

}  // namespace dpd
