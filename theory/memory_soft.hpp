/// @file
/// Collision viscosity with memory where particles repel each other softly. Derived in theory/memory.md, last
/// part. No parameter is fitted.
///
/// Throws as closed_forms.hpp does.
#pragma once

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "closed_forms.hpp"
#include "registry.hpp"

namespace dpd::theory {

/// A measured pair distribution, distances ascending (bin by bin). Empty: exp(-U/kT), right at low density.
struct PairTable {
    std::vector<double> r;  ///< length
    std::vector<double> g;  ///< as often as in an ideal gas: 1
};

/// From a CSV file as `dpdref run --csv` writes it, lines `radial_distribution,r,g,...`. Throws
/// std::invalid_argument on a file without such lines.
PairTable pair_table(std::string const& file);

/// A viscosity as a sum, in energy times time per length^d.
struct SoftCollisionViscosity {
    double at_once = 0.0;     ///< @eq{NG2007,12} for dt -> 0 with the pair distribution
    double pair = 0.0;        ///< friction stress that a partner remembers
    double collective = 0.0;  ///< friction stress that the fluid around takes over
    double kinetic = 0.0;     ///< kinetic stress makes pairs part
    double waves = 0.0;       ///< the same through the fluid around
    double potential = 0.0;   ///< pairs pressed together by the flow part again
    double closure = 0.0;     ///< by how much two ways to treat the force of the partner differ, half of it
    double error = 0.0;       ///< estimated numerical error
    /// The sum.
    double value() const { return at_once + pair + collective + kinetic + waves + potential; }
};

/// Collision viscosity of the fluid with S1 and a soft potential in continuous time. `box` as in memory.hpp.
/// Where the potential vanishes, the sum without `waves` is the collision viscosity of transport_with_memory.
/// Takes ten seconds to a minute, longest in thin media. Throws std::domain_error where the friction has no
/// self-consistent value.
SoftCollisionViscosity collision_viscosity_with_memory(Gas const& gas, Shardlow const& thermostat,
                                                       Soft const& potential, PairTable const& measured = {},
                                                       double box = std::numeric_limits<double>::infinity());

/// The same for the parameters of the closed form memory-collision-soft, the sum first and then its parts.
std::vector<std::pair<std::string_view, double>> soft_parts(Arguments const& a, PairTable const& measured);

}  // namespace dpd::theory
