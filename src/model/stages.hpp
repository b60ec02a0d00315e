/// @file
/// The stages that a time step is made of: what each does and whose equation it is, its parameters and how a
/// scene gives them, and what others must know of it. A scene lists the ones it wants, in order. What they do
/// to the particles stands in plain/, to be read, and in engine/, to be fast.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "potential.hpp"
#include "scheme.hpp"
#include "toml_reader.hpp"
#include "weight.hpp"

namespace dpd {

/// How far a stage takes the particles.
enum class Moves {
    none,
    half,   ///< half a time step
    whole,  ///< a time step
    anew,   ///< to places that have nothing to do with the present ones
};

/// Whether a stage leaves the impulses of friction and noise with the pairs, for the collision stress.
enum class Impulses { none, left };

/// Whether a stage knows frozen particles, of which walls are made.
enum class Walls { unknown, known };

/// What others must know of a kind of stage.
struct StageKind {
    std::string_view name;    ///< in a scene's list of stages, and of the table that holds its parameters
    char const* least;        ///< what that table must hold, in words; none: it has no parameters
    Moves moves;              ///< how far it moves particles
    Impulses impulses;        ///< what pairs are left with
    Walls walls;              ///< whether it knows frozen particles
    std::string_view lammps;  ///< what LAMMPS calls it; empty: LAMMPS has nothing like it
};

/// What of a scene the parameters of its stages may depend on.
struct StageSetting {
    std::vector<double> length;   ///< sides of the box
    double volume = 1.0;          ///< of the fluid
    double particles = 0.0;       ///< of the fluid
    double mass = 1.0;            ///< of a particle
    double time_step = 0.0;       ///< time
    bool coarse_grained = false;  ///< the strength of the soft repulsion follows, @eq{PK2006,3}
    bool force_mapped = false;    ///< and so does the acceleration of the body force
};

/// The closed forms' parameters, by the names of the command line.
using TheoryArguments = std::map<std::string, std::string>;

/// A number as the command line has it.
inline std::string argument(double value) { return fmt::format("{}", value); }

/// The weight that a table names, with `exponent` beside it where that is `power`. InputError as for scenes.
inline Weight read_weight(TomlReader& table, std::optional<std::string> fallback) {
    static_assert(largest_exponent == 100.0);
    static constexpr Allowed exponents{[](double x) { return x >= 0.0 && x <= largest_exponent; },
                                       "a number from 0 to 100"};
    auto const kind = table.choice<Weight::Kind>("weight", std::move(fallback));
    return kind == Weight::power ? power_weight(table.number("exponent", std::nullopt, exponents)) : kind;
}

/// Adds a weight by the names that the closed forms have for it.
inline void set_weight_arguments(TheoryArguments& arguments, Weight weight) {
    arguments["weight"] = name_of(weight.kind);
    if (weight.kind == Weight::power) arguments["exponent"] = argument(weight.exponent);
}

/// What every stage says of itself beside its `kind`, here of one that has no parameters and acts on no
/// pairs.
struct WithoutParameters {
    /// Takes the stage's parameters from its table in a scene. InputError as for scenes.
    void read(TomlReader&, StageSetting const&) {}
    /// Cutoff of the pairs that it needs, length; 0: none.
    double range() const { return 0.0; }
    /// kT to which it drives the particles, energy; 0: it has none.
    double temperature() const { return 0.0; }
    /// Adds its parameters by the names that the closed forms have for them.
    void set_arguments(TheoryArguments&, StageSetting const&) const {}
};

/// Free streaming, r += v dt, and the return to the primary box. @eq{MY1997,1}
struct Drift : WithoutParameters {
    static constexpr StageKind kind{"drift",        nullptr,        Moves::whole,
                                    Impulses::none, Walls::unknown, "fix nve"};
};

/// Free streaming for half a step: A/2 of splitting integrators.
struct HalfDrift : WithoutParameters {
    static constexpr StageKind kind{"half_drift", nullptr, Moves::half, Impulses::none, Walls::unknown, ""};
};

/// Redraws every position uniformly at random and keeps the peculiar velocities. Not physics: in place of
/// memory it enforces molecular chaos, the assumption behind NG2007 eqs. 8, 9, 17 and MY1997 eq. 22. What
/// differs between a run with and without this stage is the effect of correlations, and nothing else.
struct Scatter : WithoutParameters {
    static constexpr StageKind kind{"scatter", nullptr, Moves::anew, Impulses::none, Walls::unknown, ""};
};

/// Measures what the scene asks for.
struct Sample : WithoutParameters {
    static constexpr StageKind kind{"sample", nullptr, Moves::none, Impulses::none, Walls::known, "thermo"};
};

/// Pair after pair, friction and noise of one step: S1 and its relatives. @eq{NG2007,4} @eq{NG2007,5}
struct Shardlow {
    static constexpr StageKind kind{"shardlow",     "at least friction", Moves::none,
                                    Impulses::left, Walls::unknown,      "fix shardlow"};
    double friction = 1.0;             ///< gamma: the friction is gamma*weight(r/cutoff), mass per time
    Weight weight = Weight::linear;    ///< of the friction
    Scheme scheme = Scheme::shardlow;  ///< that gives A
    double cutoff = 1.0;               ///< range, length
    double kT = 1.0;                   ///< energy

    void read(TomlReader& table, StageSetting const& setting) {
        friction = table.number("friction", std::nullopt, non_negative);
        cutoff = table.number("cutoff", 1.0, positive);
        kT = table.number("kT", 1.0, non_negative);
        weight = read_weight(table, "linear");
        scheme = table.choice<Scheme>("scheme", "shardlow");
        if (scheme == Scheme::linear && friction * setting.time_step > setting.mass)
            table.fail("friction", fmt::format("{} times the step is above the mass; allowed with scheme "
                                               "\"linear\": at most {}",
                                               friction, setting.mass / setting.time_step));
    }
    double range() const { return cutoff; }
    double temperature() const { return kT; }
    void set_arguments(TheoryArguments& arguments, StageSetting const&) const {
        arguments["gamma"] = argument(friction);
        arguments["rc"] = argument(cutoff);
        arguments["kT"] = argument(kT);
        set_weight_arguments(arguments, weight);
        arguments["scheme"] = name_of(scheme);
    }
};

/// Lowe-Andersen: a pair draws a new relative velocity along its line, A = 1/2, with probability rate*dt.
/// @eq{NG2007,6} Above one per step: as many whole sweeps over all pairs as rate*dt has ones, then one in
/// which each pair is updated with the probability that remains.
struct Lowe {
    static constexpr StageKind kind{"lowe", "at least rate", Moves::none, Impulses::left, Walls::unknown, ""};
    static constexpr double most_sweeps = 100.0;  ///< over the pairs in one step
    double rate = 1.0;                            ///< Gamma: updates of a pair per time
    double cutoff = 1.0;                          ///< range, length
    double kT = 1.0;                              ///< energy

    void read(TomlReader& table, StageSetting const& setting) {
        rate = table.number("rate", std::nullopt, non_negative);
        cutoff = table.number("cutoff", 1.0, positive);
        kT = table.number("kT", 1.0, non_negative);
        if (rate * setting.time_step > most_sweeps)
            table.fail("rate", fmt::format("{} is {:g} updates of a pair per step; allowed: at most {:g}",
                                           rate, rate * setting.time_step, most_sweeps));
    }
    double range() const { return cutoff; }
    double temperature() const { return kT; }
    void set_arguments(TheoryArguments& arguments, StageSetting const&) const {
        arguments["Gamma"] = argument(rate);
        arguments["rc"] = argument(cutoff);
        arguments["kT"] = argument(kT);
    }
};

/// kT at which friction gamma and noise sigma balance as dt -> 0; zero without friction. @eq{MY1997,8}
inline double balanced_temperature(double gamma, double sigma) {
    return gamma > 0.0 ? sigma * sigma / (2.0 * gamma) : 0.0;
}

/// Euler impulses of friction and noise, all from the velocities at the start of the step; they wait in
/// `momentum_change` for the kick. @eq{MY1997,2}
struct EulerImpulses {
    static constexpr StageKind kind{
        "euler", "at least gamma and sigma", Moves::none, Impulses::left, Walls::unknown, ""};
    double gamma = 1.0;                        ///< strength of the friction, mass per time
    double sigma = 1.0;                        ///< strength of the noise, momentum per time^(1/2)
    Weight weight = Weight::linear;            ///< w_D
    std::optional<Weight> random_weight = {};  ///< w_R; none: w_R^2 = w_D, so that noise balances friction as
                                               ///< dt -> 0
    double cutoff = 1.0;                       ///< range, length

    void read(TomlReader& table, StageSetting const&) {
        gamma = table.number("gamma", std::nullopt, non_negative);
        sigma = table.number("sigma", std::nullopt, non_negative);
        cutoff = table.number("cutoff", 1.0, positive);
        weight = read_weight(table, "linear");
        if (!table.has("random_weight")) return;
        random_weight = table.choice<Weight::Kind>("random_weight", std::nullopt);
        if (random_weight->kind == Weight::power)
            table.fail("random_weight",
                       "'power' has no exponent of its own; allowed: a weight without one, or "
                       "none, for the root of `weight`");
    }
    double range() const { return cutoff; }
    double temperature() const { return balanced_temperature(gamma, sigma); }
    void set_arguments(TheoryArguments& arguments, StageSetting const& setting) const {
        // what eq. 22 calls n is, for N particles, (N-1)(N-2)/V^2 over (N-1)/V: theory/MY1997.md
        arguments["n"] = argument((setting.particles - 2.0) / setting.volume);
        arguments["gamma"] = argument(gamma);
        arguments["sigma"] = argument(sigma);
        arguments["rc"] = argument(cutoff);
        set_weight_arguments(arguments, weight);
        if (random_weight) arguments["random_weight"] = name_of(random_weight->kind);
    }
};

/// Adds the waiting impulses to the velocities. [euler, drift, kick] moves with the old momentum, as MY1997
/// eqs. 1 and 2 are printed; [euler, kick, drift] moves with the new one.
struct Kick : WithoutParameters {
    static constexpr StageKind kind{"kick", nullptr, Moves::none, Impulses::none, Walls::unknown, ""};
};

/// What a potential is among the closed forms' parameters.
inline void set_potential_arguments(TheoryArguments& arguments, AnyPotential const& potential) {
    if (auto const* const soft = std::get_if<Soft>(&potential))
        arguments["a"] = argument(soft->strength / soft->cutoff);
}

/// The Euler impulses of a conservative force, F dt, added to what waits for the kick: with EulerImpulses
/// before it, all forces of MY1997 eq. 2 from the state at the start of the step. @eq{MY1997,2}
struct ForceImpulses {
    static constexpr StageKind kind{"force", "a potential", Moves::none, Impulses::none, Walls::unknown, ""};
    AnyPotential potential = {};  ///< whose force it takes

    void read(TomlReader& table, StageSetting const& setting) {
        potential = read_potential(table, setting.coarse_grained);
    }
    double range() const { return cutoff_of(potential); }
    double temperature() const { return 0.0; }
    void set_arguments(TheoryArguments& arguments, StageSetting const&) const {
        set_potential_arguments(arguments, potential);
    }
};

/// v += F dt/(2m) of a conservative force: B/2 of splitting integrators. [half_kick, drift, half_kick] is
/// Verlet; [half_drift, half_kick, shardlow, half_kick, half_drift] with the exponential scheme is ABOBA
/// (X. Shang, SIAM J. Sci. Comput. 43 (2021) A1929).
struct HalfKick {
    static constexpr StageKind kind{"half_kick",    "a potential",  Moves::none,
                                    Impulses::none, Walls::unknown, ""};
    AnyPotential potential = {};  ///< whose force it takes

    void read(TomlReader& table, StageSetting const& setting) {
        potential = read_potential(table, setting.coarse_grained);
    }
    double range() const { return cutoff_of(potential); }
    double temperature() const { return 0.0; }
    void set_arguments(TheoryArguments& arguments, StageSetting const&) const {
        set_potential_arguments(arguments, potential);
    }
};

/// Velocity-Verlet with a conservative force, in `substeps` inner steps: the multiple time steps of NG2007,
/// whose thermostat acts once per (outer) step. Leaves the forces at the new positions for the next step.
struct Verlet {
    static constexpr StageKind kind{"verlet",       "at least a potential", Moves::whole,
                                    Impulses::none, Walls::unknown,         "fix nve"};
    AnyPotential potential = {};  ///< whose force it takes
    std::uint64_t substeps = 1;   ///< inner steps of the force in a step

    void read(TomlReader& table, StageSetting const& setting) {
        substeps = table.integer("substeps", 1, positive_integer);
        potential = read_potential(table, setting.coarse_grained);
    }
    double range() const { return cutoff_of(potential); }
    double temperature() const { return 0.0; }
    void set_arguments(TheoryArguments& arguments, StageSetting const&) const {
        set_potential_arguments(arguments, potential);
    }
};

/// DPD with all forces at once, by the modified velocity-Verlet of Groot & Warren (1997): friction sees the
/// velocities predicted for the end of the step, v + lambda dt F/m. PK2006 sect. III, lambda = 1/2, which is
/// plain velocity-Verlet. With `friction_again` the friction is found once more from the final velocities,
/// for the next half kick: DPD-VV (G. Besold et al., Phys. Rev. E 62 (2000) R7611).
struct ModifiedVerlet {
    static constexpr StageKind kind{"modified_verlet", "at least gamma, sigma and a potential",
                                    Moves::whole,      Impulses::none,
                                    Walls::known,      "pair dpd, fix nve"};
    AnyPotential potential = {};        ///< whose force it takes
    double gamma = 4.5;                 ///< strength of the friction, mass per time
    double sigma = 3.0;                 ///< strength of the noise, momentum per time^(1/2)
    Weight weight = Weight::quadratic;  ///< omega_D; omega_R is its root
    double cutoff = 1.0;                ///< of friction and noise
    double lambda = 0.5;                ///< share of the step for which velocities are predicted
    bool friction_again = false;        ///< friction found once more from the final velocities: DPD-VV

    void read(TomlReader& table, StageSetting const& setting) {
        gamma = table.number("gamma", std::nullopt, non_negative);
        sigma = table.number("sigma", std::nullopt, non_negative);
        cutoff = table.number("cutoff", 1.0, positive);
        weight = read_weight(table, "quadratic");
        lambda = table.number("lambda", 0.5, non_negative);
        friction_again = table.boolean("friction_again", false);
        potential = read_potential(table, setting.coarse_grained);
    }
    double range() const { return std::max(cutoff, cutoff_of(potential)); }
    double temperature() const { return balanced_temperature(gamma, sigma); }
    void set_arguments(TheoryArguments& arguments, StageSetting const&) const {
        arguments["gamma"] = argument(gamma);
        arguments["sigma"] = argument(sigma);
        arguments["rc"] = argument(cutoff);
        arguments["kT"] = argument(temperature());
        set_weight_arguments(arguments, weight);
        set_potential_arguments(arguments, potential);
    }
};

/// Which cells share a scaling factor.
enum class Rescaling {
    global,       ///< all
    layers,       ///< those of one layer across y
    monte_carlo,  ///< none: each cell tries a random one (Hecht, Harting, Ihle & Herrmann 2005)
};

constexpr std::string_view name_of(Rescaling mode) {
    switch (mode) {
        case Rescaling::global:
            return "global";
        case Rescaling::layers:
            return "layers";
        case Rescaling::monte_carlo:
            return "monte_carlo";
    }
    return "";
}

/// Velocity rescaling relative to the local flow, on a lattice of randomly shifted cells: a thermostat that
/// conserves momentum and sees no pairs. NG2007, "Other Thermostats"; derivations in theory/NG2007.md. Scales
/// the velocities u relative to the mean of a cell so that sum m u^2 = d (N - N_c) kT over the cells that
/// share a factor, which hold N particles in N_c occupied cells. Where N = N_c nothing is relative and
/// nothing scaled. `monte_carlo` instead accepts or rejects a random factor per cell such that the canonical
/// distribution is stationary.
struct Rescale {
    static constexpr StageKind kind{"rescale", "", Moves::none, Impulses::none, Walls::unknown, ""};
    Rescaling mode = Rescaling::global;  ///< cells that share a factor
    double kT = 1.0;                     ///< energy
    double cell = 1.0;                   ///< side of a cell; divides the sides of the box
    std::uint64_t thickness = 1;         ///< of a layer, in cells
    double amplitude = 0.3;              ///< c: factors of `monte_carlo` lie in [1/(1+c), 1+c]

    void read(TomlReader& table, StageSetting const& setting) {
        mode = table.choice<Rescaling>("mode", "global");
        kT = table.number("kT", 1.0, positive);
        cell = table.number("cell", 1.0, positive);
        thickness = table.integer("thickness", 1, positive_integer);
        amplitude = table.number("amplitude", 0.3, positive);
        for (double const side : setting.length) {
            double const cells = side / cell;
            if (std::abs(cells - std::round(cells)) > 1e-9 * cells || cells < 0.5 || cells > 1e6)
                table.fail("cell", fmt::format("{} does not divide the box side {}; allowed: a side over a "
                                               "whole number",
                                               cell, side));
        }
    }
    double range() const { return 0.0; }
    double temperature() const { return kT; }
    void set_arguments(TheoryArguments& arguments, StageSetting const&) const {
        arguments["kT"] = argument(kT);
    }
};

// [body force]
/// Accelerates along x: by `acceleration` everywhere, or by its opposite in the upper half of the box, which
/// makes two opposite Poiseuille flows without walls.
struct BodyForce {
    static constexpr StageKind kind{
        "body_force", "at least acceleration", Moves::none, Impulses::none, Walls::known, ""};
    double acceleration = 0.0;  ///< length per time^2
    bool opposed = false;       ///< its opposite in the upper half of the box

    void read(TomlReader& table, StageSetting const& setting) {
        if (setting.force_mapped && table.has("acceleration"))
            table.fail("acceleration", "follows from coarse_graining.force; allowed: one of them");
        if (!setting.force_mapped) acceleration = table.number("acceleration", std::nullopt, any_number);
        opposed = table.boolean("opposed", false);
    }
    double range() const { return 0.0; }
    double temperature() const { return 0.0; }
    void set_arguments(TheoryArguments&, StageSetting const&) const {}
};
// [body force]

/// The table of stages: whatever a scene can name. Both engines must know how each acts, or they do not
/// compile.
// [stages]
using AnyStage = std::variant<Shardlow, Lowe, EulerImpulses, ForceImpulses, Kick, HalfKick, Drift, HalfDrift,
                              Verlet, ModifiedVerlet, Rescale, BodyForce, Scatter, Sample>;
// [stages]

inline StageKind const& kind_of(AnyStage const& stage) {
    return std::visit([](auto const& s) -> StageKind const& { return s.kind; }, stage);
}

/// The conservative force that a stage knows; none for most.
inline AnyPotential const* potential_of(AnyStage const& stage) {
    return std::visit(
        []<class S>(S const& s) -> AnyPotential const* {
            if constexpr (requires { s.potential; }) return &s.potential;
            return nullptr;
        },
        stage);
}

/// One stage of every kind, in the order of the table.
inline std::vector<AnyStage> all_stages() {
    return []<class... Stages>(std::type_identity<std::variant<Stages...>>) {
        return std::vector<AnyStage>{Stages{}...};
    }(std::type_identity<AnyStage>{});
}

}  // namespace dpd
