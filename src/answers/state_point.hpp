/// @file
/// A state point of a file of reference answers (docs/answers.md), its units and its name.
#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

namespace dpd {

/// Length, mass and energy in which parameters and quantities are counted; time is length
/// (mass/energy)^(1/2).
struct Units {
    double length = 1.0;  ///< cutoff
    double mass = 1.0;    ///< of a particle
    double energy = 1.0;  ///< kT

    double time() const { return length * std::sqrt(mass / energy); }  ///< that follows
    bool operator==(Units const&) const = default;
};

/// The unit of a parameter by its name (docs/answers.md) in d dimensions; 1 for what has none.
double parameter_unit(std::string_view key, Units const& of, int d);

/// A state point's own: cutoff, mass and kT. Without a repulsion of DPD's the cutoff is not what its lengths
/// are measured in, and 1 counts.
Units units_of(nlohmann::ordered_json const& parameters);

/// A state point's parameters in those units.
nlohmann::ordered_json parameters_in(nlohmann::ordered_json const& parameters, Units const& units);

/// A state point in those units: parameters, quantities with their closed forms, curves. In units that are
/// not its own the quantities that only dpdref derives are left out. Its scenes stay as they were run.
nlohmann::ordered_json state_in(nlohmann::ordered_json const& state, Units const& units);

/// What a name is made of, in the order of naming_cells.
inline constexpr std::array<char const*, 7> naming_columns{"d",      "n",          "a",   "friction",
                                                           "weight", "integrator", "step"};

/// What distinguishes a state point from others, in units of cutoff, mass and kT.
std::array<std::string, naming_columns.size()> naming_cells(nlohmann::ordered_json const& parameters);

}  // namespace dpd
