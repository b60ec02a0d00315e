/// @file
/// Plane Poiseuille flow: what the profiles across a channel say about its fluid. PK2006 sect. IV.
#pragma once

#include <vector>

#include "analysis.hpp"

namespace dpd {

/// Adds viscosity, slip, density and deviation from theory of a flow between walls, or of two opposed flows;
/// nothing without a flow.
void add_channel(Scene const& scene, std::vector<Record> const& records, AddQuantity const& add);

/// The velocity between the walls of a channel, block by block; opposed flows are laid over each other. In
/// the atoms' units (sigma, sigma/tau) where the scene says what an atom is.
Curve channel_profile(Scene const& scene, Curve const& velocity);

}  // namespace dpd
