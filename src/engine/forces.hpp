/// @file
/// Conservative forces, and what else is summed over the pairs at one set of positions.
#pragma once

#include "pair_loop.hpp"
#include "potential.hpp"
#include "simulation.hpp"

namespace dpd {

/// Adds the conservative forces at the present positions to `field`, one row per particle. Returns the sum
/// over pairs of f e_x y_ij where a stress is wanted, else zero.
template <int d, class Potential>
double add_forces(Simulation<d>& simulation, Potential const& potential, Field<d>& field) {
    auto& pairs = simulation.pairs();
    PairView<d> const view(pairs);
    double* const force = field.data();
    double virial = 0.0;
    bool const walls = simulation.particles.has_walls();
    std::array<double, block_size> f;
    for_each_block(pairs, [&](PairBlock block) {
        wide_loop(block.size(), [=, f = f.data(), r = view.distance + block.begin](std::size_t k) {
            f[k] = r[k] < potential.cutoff ? potential.force(r[k]) : 0.0;
        });
        if (walls)
            for (std::size_t k = 0; k < block.size(); ++k)
                f[k] *= wall_factor(simulation, view.i[block.begin + k], view.j[block.begin + k]);
        ordered_loop(block.begin, block.end, [=, f = f.data()](std::size_t k) {
            auto const [i, j, e] = PairRows<d>(view, k);
            double const f_k = f[k - block.begin];
            // [pair force]
            for (int axis = 0; axis < d; ++axis) {
                force[i + axis] += f_k * e[axis];
                force[j + axis] -= f_k * e[axis];
            }
            // [pair force]
        });
        if (simulation.stage_stress.wanted) virial += sum_of_arms(view, block, f.data());
    });
    if (walls) forget_wall_forces(simulation, field);
    simulation.counters.potential_evaluations += pairs.count;
    return virial;
}

/// The conservative forces at the present positions, computed once for each set of positions.
template <int d, class Potential>
Field<d> const& forces(Simulation<d>& simulation, Potential const& potential) {
    if (simulation.forces_valid()) return simulation.force;
    simulation.pairs();  // may sort the particles
    simulation.force.setZero(simulation.particles.size(), d);
    simulation.pair_virials = {.potential = add_forces(simulation, potential, simulation.force)};
    simulation.forces_found();
    return simulation.force;
}

/// The same for a potential chosen at run time.
template <int d>
Field<d> const& forces(Simulation<d>& simulation, AnyPotential const& potential) {
    return std::visit([&](auto const& p) -> Field<d> const& { return forces(simulation, p); }, potential);
}

/// The sums over the pairs of the potential at the present positions.
template <int d, class Potential>
PotentialSums potential_sums(Simulation<d>& simulation, Potential const& potential) {
    auto const& pairs = simulation.pairs();
    Field<d> force = Field<d>::Zero(simulation.particles.size(), d);
    add_forces(simulation, potential, force);
    return potential_sums(pairs, force, potential);
}

}  // namespace dpd
