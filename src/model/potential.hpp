/// @file
/// Conservative pair forces: the potentials, and what is summed over the pairs at one set of positions.
#pragma once

#include <variant>

#include "pair_loop.hpp"
#include "simulation.hpp"

namespace dpd {

/// Soft repulsion, U = (strength/2)(1 - r/cutoff)^2. @eq{NG2007,3} with strength = a kT; the force of Groot &
/// Warren, a(1 - r/cutoff), has strength = a cutoff.
// [soft]
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
// [soft]

/// Lennard-Jones, U = 4 epsilon ((sigma/r)^12 - (sigma/r)^6) below the cutoff, the force truncated there.
/// With `shifted` U is zero at the cutoff, which changes energies alone.
// [lennard jones]
struct LennardJones {
    double epsilon = 1.0;
    double sigma = 1.0;
    double cutoff = 2.5;
    bool shifted = false;
    double energy(double r) const { return plain_energy(r) - (shifted ? plain_energy(cutoff) : 0.0); }
    double force(double r) const {
        double const s6 = sixth_power(r);
        return 24.0 * epsilon * s6 * (2.0 * s6 - 1.0) / r;
    }
    double curvature(double r) const {
        double const s6 = sixth_power(r);
        return 24.0 * epsilon * s6 * (26.0 * s6 - 7.0) / (r * r);
    }

private:
    double sixth_power(double r) const {
        double const x2 = sigma * sigma / (r * r);
        return x2 * x2 * x2;
    }
    double plain_energy(double r) const {
        double const s6 = sixth_power(r);
        return 4.0 * epsilon * s6 * (s6 - 1.0);
    }
};
// [lennard jones]

/// What a scene may name.
using AnyPotential = std::variant<Soft, LennardJones>;

/// Factor on the conservative force of a pair: the walls' own particles do not interact.
template <int d>
double wall_factor(Simulation<d> const& simulation, std::uint32_t i, std::uint32_t j) {
    bool const wall_i = simulation.particles.frozen(i), wall_j = simulation.particles.frozen(j);
    return wall_i && wall_j ? 0.0 : wall_i || wall_j ? simulation.wall_strength : 1.0;
}

/// What does not move feels no force.
template <int d>
void forget_wall_forces(Simulation<d> const& simulation, Field<d>& force) {
    for (Eigen::Index p = 0; p < force.rows(); ++p)
        if (simulation.particles.frozen(p)) force.row(p).setZero();
}

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

/// The Laplacian counts every pair twice, once for each partner.
// [potential sums]
template <int d, class Potential>
PotentialSums potential_sums(Simulation<d>& simulation, Potential const& potential) {
    PotentialSums sums;
    auto const& pairs = simulation.pairs();
    Field<d> force = Field<d>::Zero(simulation.particles.size(), d);
    add_forces(simulation, potential, force);
    sums.force_squared = force.square().sum();
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
// [potential sums]

}  // namespace dpd
