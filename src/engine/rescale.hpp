/// @file
/// Velocity rescaling on a lattice of cells.
#pragma once

#include "simulation.hpp"

namespace dpd {

template <int d>
void apply(Rescale const& stage, Simulation<d>& simulation, NoiseKey key);

extern template void apply(Rescale const&, Simulation<2>&, NoiseKey);
extern template void apply(Rescale const&, Simulation<3>&, NoiseKey);

}  // namespace dpd
