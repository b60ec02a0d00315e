/// @file
/// The potentials of conservative pair forces.
#pragma once

#include <variant>

#include "state.hpp"
#include "sums.hpp"
#include "toml_reader.hpp"

namespace dpd {

/// Soft repulsion, U = (strength/2)(1 - r/cutoff)^2. @eq{NG2007,3} with strength = a kT; the force of Groot &
/// Warren, a(1 - r/cutoff), has strength = a cutoff.
// [soft]
struct Soft {
    double strength = 0.0;  ///< energy
    double cutoff = 1.0;    ///< range, length
    /// U at a distance below the cutoff.
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
    double epsilon = 1.0;  ///< depth, energy
    double sigma = 1.0;    ///< where it is zero, length
    double cutoff = 2.5;   ///< where the force is truncated, length
    bool shifted = false;  ///< whether the energy is zero at the cutoff
    /// U at a distance below the cutoff.
    double energy(double r) const { return plain_energy(r) - (shifted ? plain_energy(cutoff) : 0.0); }
    /// -dU/dr
    double force(double r) const {
        double const s6 = sixth_power(r);
        return 24.0 * epsilon * s6 * (2.0 * s6 - 1.0) / r;
    }
    /// d2U/dr2
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

/// -dU/dr of a potential chosen at run time; 0 from its cutoff on.
inline double force_at(AnyPotential const& potential, double r) {
    return std::visit([r](auto const& u) { return r < u.cutoff ? u.force(r) : 0.0; }, potential);
}

inline double cutoff_of(AnyPotential const& potential) {
    return std::visit([](auto const& p) { return p.cutoff; }, potential);
}

/// Reads the potential of a stage, a table `soft` or `lennard_jones`. With `coarse_grained` the strength of
/// the soft one and its cutoff, 1, follow from the scene, @eq{PK2006,3}.
inline AnyPotential read_potential(TomlReader& stage, bool coarse_grained) {
    if (stage.has("soft") == stage.has("lennard_jones"))
        stage.fail("soft", "give either a table soft or a table lennard_jones");
    if (auto table = stage.table("soft")) {
        Soft soft;
        soft.cutoff = table->number("cutoff", 1.0, positive);
        if (coarse_grained && (table->has("strength") || soft.cutoff != 1.0))
            table->fail("strength", "and cutoff follow from coarse_graining; allowed: one of them");
        if (!coarse_grained) soft.strength = table->number("strength", std::nullopt, non_negative);
        table->finish();
        return soft;
    }
    auto table = stage.required_table("lennard_jones");
    LennardJones lj;
    lj.epsilon = table.number("epsilon", 1.0, positive);
    lj.sigma = table.number("sigma", 1.0, positive);
    lj.cutoff = table.number("cutoff", 2.5 * lj.sigma, positive);
    lj.shifted = table.boolean("shifted", false);
    table.finish();
    return lj;
}

/// Factor on the conservative force of a pair: the walls' own particles do not interact.
template <int d>
double wall_factor(State<d> const& state, std::uint32_t i, std::uint32_t j) {
    bool const wall_i = state.particles.frozen(i), wall_j = state.particles.frozen(j);
    return wall_i && wall_j ? 0.0 : wall_i || wall_j ? state.wall_strength : 1.0;
}

/// What does not move feels no force.
template <int d>
void forget_wall_forces(State<d> const& state, Field<d>& force) {
    for (Eigen::Index p = 0; p < force.rows(); ++p)
        if (state.particles.frozen(p)) force.row(p).setZero();
}

/// Sums over the pairs of a conservative force, which gives each particle the force of its row. The Laplacian
/// counts every pair twice, once for each partner.
// [potential sums]
template <int d, class Potential>
PotentialSums potential_sums(PairList<d> const& pairs, Field<d> const& force, Potential const& potential) {
    PotentialSums sums;
    sums.force_squared = sum_of_squares(force);
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
