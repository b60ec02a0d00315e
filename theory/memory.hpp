/// @file
/// Transport of the ideal DPD gas with memory: what Noguchi & Gompper's closed forms leave out because they
/// take every collision for one with a stranger. No parameter is fitted. Derived in theory/memory.md.
///
/// Throws as closed_forms.hpp does.
#pragma once

#include "closed_forms.hpp"

namespace dpd::theory {

/// How the momentum that a particle has lost comes back to it through the fluid around: relative changes
/// of its friction and of the life of the kinetic stress.
struct CollectiveMemory {
    double friction = 0.0;          ///< part of its friction that the fluid gives back
    double own_stress = 0.0;        ///< longer life of its own v_x v_y
    double others_stress = 0.0;     ///< v_x v_y that the others take over, beyond what one partner does
    double collision_stress = 0.0;  ///< what it takes from the collision viscosity, in units of that
    double cross_stress = 0.0;      ///< kinetic stress that the collision stress becomes, in the same; not in
                                    ///< transport_with_memory
};

/// The collective part alone, for a particle of friction zeta (1/time, D = kT/(m zeta)). Uses the gas and the
/// shape of the weight. `box` is the side of a periodic square or cube, or infinity; in two dimensions the
/// integrals diverge with the box, and std::domain_error is thrown without one. A pair distribution weighs
/// the friction; pairs are taken to share what they share of it.
CollectiveMemory collective_memory(Gas const& gas, Weight weight, double zeta, double dt, double box,
                                   PairDistribution const& g = {});

/// A coefficient as a sum, and what the numerics may add to it.
struct CoefficientWithMemory {
    double at_once = 0.0;     ///< without memory: the form of the paper
    double pair = 0.0;        ///< one partner that stays
    double collective = 0.0;  ///< the fluid around
    double cross = 0.0;       ///< kinetic stress that came from collision stress, or the other way
    double error = 0.0;       ///< estimated numerical error
    /// The sum.
    double value() const { return at_once + pair + collective + cross; }
};

/// What momentum and particles are carried by.
struct TransportWithMemory {
    CoefficientWithMemory diffusion_constant;   ///< length^2 per time
    CoefficientWithMemory kinetic_viscosity;    ///< carried by particles that move
    CoefficientWithMemory collision_viscosity;  ///< carried by the thermostat's impulses
};

/// The three coefficients at a step dt, or for dt = 0 in continuous time. Refines until a refinement changes
/// less than the share `wanted` of a coefficient, as long as that takes a few seconds; `error` says how far
/// it came, and theory/memory.md where that is not within 1e-4. Units as in closed_forms.hpp. `box` as above.
/// With Scheme::linear throws std::domain_error for gamma dt/m > 1.
TransportWithMemory transport_with_memory(Gas const& gas, Shardlow const& thermostat, double dt = 0.0,
                                          double box = std::numeric_limits<double>::infinity(),
                                          double wanted = 3e-5);
/// The same for Lowe-Andersen, up to one update of a pair per step: throws std::domain_error for Gamma dt
/// > 1.
TransportWithMemory transport_with_memory(Gas const& gas, Lowe const& thermostat, double dt = 0.0,
                                          double box = std::numeric_limits<double>::infinity(),
                                          double wanted = 3e-5);

/// Temperature of explicit DPD at a finite step with the memory of pairs, @eq{MY1997,22} without molecular
/// chaos; for particles that are kicked, then moved, and matched weights. `error` is numerical, relative
/// about 1e-4. Throws std::domain_error for a random_weight, at and beyond the critical step, and where no
/// temperature balances.
struct TemperatureWithMemory {
    double at_once = 0.0;  ///< eq. 22
    double pair = 0.0;     ///< what partners that stay take from it
    double error = 0.0;    ///< estimated numerical error, energy
    /// The sum.
    double value() const { return at_once + pair; }
};
TemperatureWithMemory temperature_with_memory(ExplicitDpd const& fluid, double dt);

}  // namespace dpd::theory
