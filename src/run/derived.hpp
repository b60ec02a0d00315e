/// @file
/// Numbers that follow from measured ones.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "analysis.hpp"

namespace dpd {

/// Adds f(arguments), arguments by name, unless it is there or one of them is missing; its error from theirs,
/// taken as independent, by finite differences.
void add_function(std::vector<Quantity>& quantities, std::string name,
                  std::vector<std::string> const& arguments,
                  std::function<double(std::vector<double> const&)> const& f);

/// Adds what follows from quantities of several scenes at one state point (viscosity under shear, g(r) and
/// diffusion at rest): `potential_relaxation_rate` by eq. 16, `kinetic_viscosity_by_rates` by eq. 14,
/// `schmidt_number`. @eq{NG2007,14} @eq{NG2007,16}
void derive(Scene const& scene, std::vector<Quantity>& quantities);

/// Adds what follows from the pressures of a scene's fluid `below` and `above` its density, `densities`
/// apart: `pressure_slope` dp/dn, `inverse_compressibility` (1/kT) dp/dn (also per atom) and the isothermal
/// `speed_of_sound` sqrt((dp/dn)/m). @eq{PK2006,3} @eq{PK2006,7}
void derive_from_densities(Scene const& scene, double densities, Estimate const& below, Estimate const& above,
                           std::vector<Quantity>& quantities);

/// Adds what a velocity autocorrelation is compared with at lag t: `exponential_decay`, the exponential of
/// the same integral, and, where viscosity and diffusion are known, `hydrodynamic_tail` in the periodic box.
void derive_at_lag(Scene const& scene, std::vector<Quantity>& quantities, double t);

}  // namespace dpd
