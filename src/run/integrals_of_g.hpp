/// @file
/// What theory makes of a measured radial distribution function.
#pragma once

#include <vector>

#include "analysis.hpp"

namespace dpd {

/// Adds the relaxation rate of friction, the collision viscosity, and the potential viscosity that goes with
/// a relaxation rate of one. @eq{NG2007,12} @eq{NG2007,14} @eq{NG2007,16}
void add_integrals_of_g(Scene const& scene, std::vector<Record> const& records, AddQuantity const& add);

}  // namespace dpd
