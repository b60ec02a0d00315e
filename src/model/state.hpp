/// @file
/// The state that stages act on, whichever engine they are of.
#pragma once

#include <cstdint>
#include <optional>

#include "box.hpp"
#include "noise_key.hpp"
#include "pair_list.hpp"
#include "particles.hpp"

namespace dpd {

/// What a run did: the proof that a scene pays only for what it names.
struct Counters {
    std::uint64_t steps = 0;                  ///< done
    std::uint64_t searches = 0;               ///< pair searches
    std::uint64_t pairs_found = 0;            ///< pairs within the cutoff, over all searches
    std::uint64_t pair_updates = 0;           ///< pairs visited by thermostats
    std::uint64_t potential_evaluations = 0;  ///< of pairs
    std::uint64_t random_draws = 0;           ///< variates drawn while stepping
    std::uint64_t boundary_pairs = 0;         ///< pairs across a sheared boundary
    std::uint64_t coincident_pairs = 0;       ///< pairs left out because r = 0

    /// A search and what it found.
    template <int d>
    void count_search(PairList<d> const& found) {
        ++searches;
        pairs_found += found.count;
        boundary_pairs += found.crossing.size();
        coincident_pairs += found.coincident;
    }
    /// Updates of pairs with a variate each.
    void count_updates(std::uint64_t pairs) {
        pair_updates += pairs;
        random_draws += pairs;
    }
};

/// Sums over pairs of f e_x y_ij, by the kind of force; zero where no stress is wanted.
struct PairVirials {
    double potential = 0.0;   ///< part of conservative forces
    double thermostat = 0.0;  ///< friction and noise
    double friction = 0.0;    ///< friction alone
};

/// Contributions to the stress sigma_xy that only the stage which makes them can see, averaged over its last
/// step. Measured where wanted.
struct StageStress {
    bool wanted = false;           ///< whether a stress is sampled; else nothing is summed
    bool streamed = false;         ///< kinetic and potential part have been measured
    double kinetic = 0.0;          ///< part that particles carry
    double potential = 0.0;        ///< part of conservative forces
    double collision = 0.0;        ///< of thermal forces that act while streaming
    double rescaling = 0.0;        ///< part that rescaling moves
    double friction = 0.0;         ///< collision stress without the noise of each pair's own update
    bool virial_wanted = false;    ///< whether the friction's virial is sampled; else it is not summed
    double friction_virial = 0.0;  ///< sum over pairs of f_D r, of the friction that found the present forces

    /// What the pairs contribute whose forces kick half a step from the virials `before` it and half from
    /// those `after`.
    void take_mean_of(PairVirials const& before, PairVirials const& after, double volume) {
        potential = -0.5 * (before.potential + after.potential) / volume;
        collision = -0.5 * (before.thermostat + after.thermostat) / volume;
        friction = -0.5 * (before.friction + after.friction) / volume;
    }
};

/// Sums over the pairs of a conservative force.
struct PotentialSums {
    double energy = 0.0;         ///< of all pairs
    double virial = 0.0;         ///< sum over pairs of f r
    double force_squared = 0.0;  ///< sum over particles of |F|^2
    double laplacian = 0.0;      ///< sum over particles of the divergence of -F
};

/// One particle state, what its stages hand on to each other, and what they leave to be measured. Units are
/// the scene's: of mass, length and time.
template <int d>
struct State {
    Particles<d> particles;      ///< positions and velocities
    Box<d> box;                  ///< that holds them
    std::uint64_t seed = 0;      ///< of all noise
    std::uint64_t step = 0;      ///< steps done
    double time_step = 0.0;      ///< time
    double time = 0.0;           ///< of the positions; the drift advances it
    double wall_strength = 1.0;  ///< conservative force between fluid and wall over that of the fluid
    PairList<d> pair_list;       ///< of the last search
    Field<d> momentum_change;    ///< Euler impulses waiting for the kick; empty where no stage needs it
    Field<d> force;              ///< forces that the streaming stage keeps; empty where there are none
    PairVirials pair_virials;    ///< that belong to `force`
    StageStress stage_stress;    ///< what stages measured while they moved
    Counters counters;           ///< of the work done

    /// The step in which `pair_list` was found; nothing if positions have changed since. With the state all
    /// that a checkpoint needs to have the pairs again.
    std::optional<std::uint64_t> pairs_of_step() const { return pairs_of_step_; }
    /// To be called when `pair_list` has been filled.
    void pairs_found(std::uint64_t in_step) { pairs_of_step_ = in_step; }

    /// Whether `force` belongs to the present positions.
    bool forces_valid() const { return forces_valid_; }
    /// To be called when `force` has been filled.
    void forces_found() { forces_valid_ = true; }

    /// To be called by whatever moves particles.
    void positions_changed() {
        pairs_of_step_.reset();
        forces_valid_ = false;
    }

private:
    std::optional<std::uint64_t> pairs_of_step_;
    bool forces_valid_ = false;
};

}  // namespace dpd
