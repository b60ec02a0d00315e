/// @file
/// Stress from the state of the particles and the impulses of the pairs.
#pragma once

#include <cstddef>
#include <span>

#include "box.hpp"
#include "pair_list.hpp"
#include "particles.hpp"

namespace dpd {

/// The pairs' parts of a stress are summed in blocks of this many.
inline constexpr std::size_t block_size = 256;

/// The sum of one number for each pair: first within the blocks, then over them. The order decides the last
/// digits.
double sum_in_blocks(std::span<double const> values);

/// f e_x y_ij: minus this over the volume is the stress of what acts on a pair along e.
template <int d>
double moment(Pair<d> const& pair, double f) {
    return f * pair.e[0] * pair.e[1] * pair.r;
}

/// Contribution of one drift to the kinetic stress sigma_xy: minus the momentum that the particles carry
/// through planes of constant y, averaged over all planes, per area and time. A particle that moves from y to
/// y + v_y dt passes planes whose flow is, on average, that at mid-drift, so its peculiar velocity counts
/// there: sigma = -(m/V) sum v_y (u_x - shear_rate v_y dt/2), with u_x at the start of the drift. Equals the
/// integral @eq{NG2007,7} without an assumption on P(v).
template <int d>
double kinetic_stress(Particles<d> const& particles, Box<d> const& box, double time_step);

/// Contribution of the last pair thermostat to sigma_xy (none: 0): minus the momentum that pairs exchange
/// through planes of constant y, averaged over all planes: -(m/(V dt)) sum_pairs impulse e_x y_ij.
/// @eq{NG2007,11}
template <int d>
double collision_stress(PairList<d> const& pairs, double mass, Box<d> const& box, double time_step);

}  // namespace dpd
