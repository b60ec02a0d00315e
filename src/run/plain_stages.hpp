/// @file
/// The stages that a scene names, done by the plain engine.
#pragma once

#include "simulation.hpp"

namespace dpd {

template <int d>
Stage<d> plain_stage(AnyStage const& stage);

/// Lets the plain engine find the pairs as in an earlier step, from which a checkpoint was left.
template <int d>
void find_pairs_plainly(Simulation<d>& simulation, std::uint64_t of_step);

/// The plain engine's sums over the pairs of a potential.
template <int d>
PotentialSums plain_potential_sums(Simulation<d>& simulation, AnyPotential const& potential);

}  // namespace dpd
