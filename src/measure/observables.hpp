/// @file
/// The table of observables: what a scene can ask to be measured at every sample, by name.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>
#include <tuple>

#include "simulation.hpp"
#include "stress.hpp"
#include "sums.hpp"

namespace dpd {

/// A simulation when it is sampled. What several observables need is found once.
template <int d>
class Instant {
public:
    /// Of a simulation as it is.
    explicit Instant(Simulation<d>& sampled) : simulation(sampled) {}
    Simulation<d>& simulation;  ///< that is sampled

    /// How many there are, walls included.
    double particles() const { return double(simulation.particles.size()); }
    /// kT of the peculiar velocities.
    double kinetic_temperature() const {
        return dpd::kinetic_temperature(simulation.particles, simulation.box);
    }
    /// Of the kinetic temperature and of the virial of the conservative and of further forces; (N - 1) kT
    /// counts the degrees of freedom that momentum leaves.
    double pressure(double further_virial) {
        return ((particles() - 1.0) * kinetic_temperature() + (potential().virial + further_virial) / d) /
               simulation.box.volume();
    }
    /// Sums over the pairs of the scene's potential; zero without one.
    PotentialSums const& potential() {
        if (!potential_)
            potential_ = simulation.potential_sums ? simulation.potential_sums(simulation) : PotentialSums{};
        return *potential_;
    }

private:
    std::optional<PotentialSums> potential_;
};

/// What becomes of a series when a run is analyzed.
enum class Analysis {
    mean,     ///< its mean, under the name of the series
    largest,  ///< its largest value, as "largest_NAME"
    joint,    ///< a quantity made of several series: `analyze`
};

/// One series of numbers, one per sample; `value(Instant<d>&)` finds it.
template <class Value>
struct Series {
    std::string_view observable;  ///< which has to be asked for
    std::string_view name;        ///< of the series
    bool needs_potential;         ///< is not there in a scene without one
    Analysis analysis;            ///< what becomes of it
    Value value;                  ///< finds it
};
template <class Value>
Series(std::string_view, std::string_view, bool, Analysis, Value) -> Series<Value>;

/// An observable is the series that are listed under its name.
// [observables]
inline constexpr std::tuple series_table{
    Series{"kinetic_temperature", "kinetic_temperature", false, Analysis::mean,
           [](auto& now) { return now.kinetic_temperature(); }},
    Series{"momentum", "momentum", false, Analysis::largest,
           [](auto& now) {
               return std::sqrt(sum_of_squares(total_momentum(now.simulation.particles, now.simulation.box)));
           }},
    Series{"potential_energy", "potential_energy", false, Analysis::mean,
           [](auto& now) { return now.potential().energy / now.particles(); }},
    Series{"pressure", "pressure", false, Analysis::mean, [](auto& now) { return now.pressure(0.0); }},
    // noise has mean zero at the positions at which it is drawn, and is left out
    Series{"lammps_pressure", "lammps_pressure", false, Analysis::mean,
           [](auto& now) { return now.pressure(now.simulation.stage_stress.friction_virial); }},
    Series{"configurational_temperature", "force_squared", false, Analysis::joint,
           [](auto& now) { return now.potential().force_squared / now.particles(); }},
    Series{"configurational_temperature", "laplacian", false, Analysis::joint,
           [](auto& now) { return now.potential().laplacian / now.particles(); }},
    // a stage that streams in substeps has measured what it did in the step before
    Series{"stress", "kinetic_stress", false, Analysis::joint,
           [](auto& now) {
               auto const& s = now.simulation;
               return s.stage_stress.streamed ? s.stage_stress.kinetic
                                              : kinetic_stress(s.particles, s.box, s.time_step);
           }},
    Series{"stress", "collision_stress", false, Analysis::joint,
           [](auto& now) {
               auto& s = now.simulation;
               return s.stage_stress.rescaling + s.stage_stress.collision +
                      (s.pairs_of_step() ? collision_stress(s.pairs(), s.particles.mass, s.box, s.time_step)
                                         : 0.0);
           }},
    Series{"stress", "potential_stress", true, Analysis::joint,
           [](auto& now) { return now.simulation.stage_stress.potential; }},
    Series{"friction_stress", "friction_stress", false, Analysis::joint, [](auto& now) {
               return now.simulation.stage_stress.rescaling + now.simulation.stage_stress.friction;
           }}};
// [observables]

/// Calls `visit(series)` for every row of the table.
template <class Visit>
constexpr void for_each_series(Visit&& visit) {
    std::apply([&](auto const&... series) { (visit(series), ...); }, series_table);
}

constexpr bool is_observable(std::string_view name) {
    bool found = false;
    for_each_series([&](auto const& series) { found |= series.observable == name; });
    return found;
}

/// The name of an observable; one that is none does not compile.
struct ObservableName {
    std::string_view text;  ///< the name
    /// Of the table's; another does not compile.
    consteval ObservableName(char const* name) : text(name) {
        if (!is_observable(text)) throw "no observable of that name";
    }
};

}  // namespace dpd
