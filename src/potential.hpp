/// @file
/// Conservative pair forces: the potentials, and what is summed over the pairs at one set of positions.
#pragma once

#include "simulation.hpp"

namespace dpd {

/// Soft repulsion, U = (strength/2)(1 - r/cutoff)^2. @eq{NG2007,3} with strength = a kT; the force of Groot &
/// Warren, a(1 - r/cutoff), has strength = a cutoff.
struct Soft {
    double strength = 0.0;  ///< energy
    double cutoff = 1.0;
    double energy(double r) const {
        double const x = 1.0 - r / cutoff;
        return 0.5 * strength * x * x;
    }
    double force(double r) const { return strength / cutoff * (1.0 - r / cutoff); }  ///< -dU/dr
    double curvature(double) const { return strength / (cutoff * cutoff); }          ///< d2U/dr2
};

/// Forces at the present positions, one row per particle; computed once for each set of positions. With them
/// goes `virial_xy`, sum over pairs of f e_x y_ij, if stresses are wanted.
template <int d, class Potential>
Field<d> const& forces(Simulation<d>& simulation, Potential const& potential) {
    if (simulation.forces_valid()) return simulation.force;
    auto const& pairs = simulation.pairs();
    simulation.force.setZero(simulation.particles.size(), d);
    double* force[d];
    for (int axis = 0; axis < d; ++axis) force[axis] = simulation.force.col(axis).data();
    double virial = 0.0;
    for (std::size_t k = 0; k < pairs.count; ++k) {
        double const r = pairs.distance[k];
        if (r >= potential.cutoff) continue;
        double const f = potential.force(r);
        auto const i = pairs.i[k], j = pairs.j[k];
        for (int axis = 0; axis < d; ++axis) {
            double const component = f * pairs.unit[axis][k];
            force[axis][i] += component;
            force[axis][j] -= component;
        }
        virial += f * pairs.unit[0][k] * pairs.unit[1][k] * r;
    }
    simulation.virial_xy = virial;
    simulation.counters.potential_evaluations += pairs.count;
    simulation.forces_found();
    return simulation.force;
}

/// The Laplacian counts every pair twice, once for each partner.
template <int d, class Potential>
PotentialSums potential_sums(Simulation<d>& simulation, Potential const& potential) {
    PotentialSums sums;
    sums.force_squared = forces(simulation, potential).square().sum();
    auto const& pairs = simulation.pairs();
    for (std::size_t k = 0; k < pairs.count; ++k) {
        double const r = pairs.distance[k];
        if (r >= potential.cutoff) continue;
        double const f = potential.force(r);
        sums.energy += potential.energy(r);
        sums.virial += f * r;
        sums.laplacian += 2.0 * (potential.curvature(r) - (d - 1) * f / r);
    }
    return sums;
}

}  // namespace dpd
