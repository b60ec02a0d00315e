/// @file
/// Friction and step of an ideal S1 gas for a wanted viscosity, diffusion constant or Schmidt number, from
/// the theory with memory (memory.hpp, docs/tune.md).
#pragma once

#include <optional>

#include "memory.hpp"

namespace dpd::theory {

/// What the fluid shall have: two of the three coefficients, or one and the step. Units as in
/// closed_forms.hpp.
struct Wanted {
    std::optional<double> viscosity = std::nullopt;           ///< kinetic and collision viscosity
    std::optional<double> diffusion_constant = std::nullopt;  ///< D
    std::optional<double> schmidt_number = std::nullopt;      ///< viscosity/(n m D)
    std::optional<double> dt = std::nullopt;                  ///< the step
};

/// The fluid that was found.
struct Tuned {
    double gamma = 0.0;             ///< friction, mass per time
    double dt = 0.0;                ///< step, time
    TransportWithMemory transport;  ///< what it then has

    /// Kinetic and collision part.
    double viscosity() const {
        return transport.kinetic_viscosity.value() + transport.collision_viscosity.value();
    }
    /// Viscosity over n m D.
    double schmidt_number(Gas const& gas) const {
        return viscosity() / (gas.n * gas.m * transport.diffusion_constant.value());
    }
};

/// A friction, and without `dt` a step between 0.01 and 1 rc (m/kT)^(1/2), at which the theory gives what is
/// wanted within 0.2 %. Of two frictions with the same viscosity it is the larger, where the fluid is more
/// like a liquid. Takes up to some ten states, without `dt` some twenty, a second each. Throws
/// std::invalid_argument unless what is wanted is positive and two numbers, and std::domain_error, with what
/// can be had, where there is no such fluid.
Tuned tune(Gas const& gas, Wanted const& wanted, Weight weight = Weight::linear,
           Scheme scheme = Scheme::shardlow, double box = std::numeric_limits<double>::infinity());

}  // namespace dpd::theory
