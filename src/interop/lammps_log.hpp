/// @file
/// What a LAMMPS log says of its fluid, held against a reference. docs/compare.md.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "compare.hpp"

namespace dpd {

/// What a log says otherwise than the reference, and the factors from its units to the reference's; NaN where
/// the log does not tell.
struct LogCheck {
    std::vector<std::string> differences;  ///< as "timestep 0.02 (reference: 0.04)"
    std::vector<std::string> notes;        ///< for the reader: another unit, what the log does not say
    double temperature = 1.0;              ///< to an energy, kT
    double energy = 1.0;                   ///< energy
    double pressure = 1.0;                 ///< energy/length^d
    double shear_rate = 0.0;               ///< of fix deform, 1/time of the reference; 0 without
    bool flow_is_heat = false;             ///< whether the thermo table's temperature counts that flow
};

/// What the step of `pair dpd` with `fix nve` is called.
constexpr std::string_view step_of_pair_dpd = "modified velocity-Verlet";

/// What a fact of a fluid is called among the parameters of a state point (docs/answers.md).
std::string_view parameter_of(std::string_view fact);

/// The facts of a scene's fluid, by name, in its units: kT, mass, cutoff, a (force at contact), gamma,
/// timestep, density, and the exponent of w_D; and what its step is called.
void describe_fluid(Reference& reference, Scene const& scene);

/// Reads the commands of a log (nothing is said of other outputs). In units `real` and `metal` the
/// reference's energy, length and mass are taken from kT, the cutoff and the mass of the log; in units `lj`,
/// too, if the fluid is then the reference's.
LogCheck check_log(CodeOutput const& output, Reference const& reference);

}  // namespace dpd
