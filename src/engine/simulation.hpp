/// @file
/// A simulation: one particle state, and a time step that is a list of stages.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "box.hpp"
#include "noise.hpp"
#include "pairs.hpp"
#include "particles.hpp"

namespace dpd {

/// What a run did: the proof that a scene pays only for what it names.
struct Counters {
    std::uint64_t steps = 0;
    std::uint64_t searches = 0;      ///< pair searches
    std::uint64_t pairs_found = 0;   ///< pairs within the cutoff, over all searches
    std::uint64_t pair_updates = 0;  ///< pairs visited by thermostats
    std::uint64_t potential_evaluations = 0;
    std::uint64_t random_draws = 0;      ///< variates drawn while stepping
    std::uint64_t boundary_pairs = 0;    ///< pairs across a sheared boundary
    std::uint64_t coincident_pairs = 0;  ///< pairs left out because r = 0
};

template <int d>
struct Simulation;

/// A stage acts on the state once per step. Its place in the list is the stream of its noise.
template <int d>
struct Stage {
    std::string name;
    std::function<void(Simulation<d>&, NoiseKey)> act;
};

/// Contributions to the stress sigma_xy that only the stage which makes them can see, averaged over its last
/// step. Measured where wanted.
struct StageStress {
    bool wanted = false;
    bool streamed = false;  ///< kinetic and potential part have been measured
    double kinetic = 0.0;
    double potential = 0.0;
    double collision = 0.0;  ///< of thermal forces that act while streaming
    double rescaling = 0.0;
    double friction = 0.0;  ///< collision stress without the noise of each pair's own update
};

/// Sums over pairs of f e_x y_ij, by the kind of force; zero where no stress is wanted.
struct PairVirials {
    double potential = 0.0;
    double thermostat = 0.0;  ///< friction and noise
    double friction = 0.0;    ///< friction alone
};

/// Sums over the pairs of a conservative force.
struct PotentialSums {
    double energy = 0.0;
    double virial = 0.0;         ///< sum over pairs of f r
    double force_squared = 0.0;  ///< sum over particles of |F|^2
    double laplacian = 0.0;      ///< sum over particles of the divergence of -F
};

template <int d>
struct Simulation {
    Particles<d> particles;
    Box<d> box;
    std::vector<Stage<d>> stages;
    PairSearch<d> pair_search;
    Counters counters;
    std::uint64_t seed = 0;
    std::uint64_t step = 0;  ///< steps done
    double time_step = 0.0;
    double time = 0.0;           ///< of the positions; the drift advances it
    double wall_strength = 1.0;  ///< conservative force between fluid and wall over that of the fluid
    double hottest = 0.0;        ///< kT beyond which the run counts as diverged
    Field<d> momentum_change;    ///< Euler impulses waiting for the kick; empty where no stage needs it
    Field<d> force;              ///< forces that the streaming stage keeps; empty where there are none
    PairVirials pair_virials;    ///< that belong to `force`
    StageStress stage_stress;
    std::function<PotentialSums(Simulation&)> potential_sums;  ///< of the scene's potential, if it has one

    /// The pairs within the cutoff of the pair search, at the present positions; shared by all stages until
    /// positions change.
    PairList<d>& pairs();

    /// To be called by whatever moves particles.
    void positions_changed() {
        pairs_of_step_.reset();
        forces_valid_ = false;
    }

    /// Whether `force` belongs to the present positions.
    bool forces_valid() const { return forces_valid_; }
    void forces_found() { forces_valid_ = true; }

    /// The step in which the present pairs were found, if they are: with the state all that a checkpoint
    /// needs to have them again.
    std::optional<std::uint64_t> pairs_of_step() const { return pairs_of_step_; }
    void find_pairs_again(std::uint64_t of_step);

    /// Runs the stage list once. Throws Diverged, with the step's number.
    void advance();

    /// Bytes held by the state and its work arrays.
    std::size_t bytes() const;

private:
    void sort_particles();
    void check_divergence() const;

    PairList<d> pairs_;
    std::optional<std::uint64_t> pairs_of_step_;
    bool forces_valid_ = false;
};

/// kT of the peculiar velocities, (1/(d(N-1))) sum m (v - u(y))^2: momentum is conserved.
template <int d>
double kinetic_temperature(Particles<d> const& particles, Box<d> const& box);

/// Total momentum relative to the flow, sum m (v - u(y)).
template <int d>
Vec<d> total_momentum(Particles<d> const& particles, Box<d> const& box);

/// Where particles start.
enum class Start {
    random,   ///< uniformly random in the box
    dense,    ///< uniformly random in its lower halves: all in one corner
    lattice,  ///< on a simple cubic (square) lattice that fills the box
};

inline constexpr std::array<std::string_view, 3> start_names{"random", "dense", "lattice"};

/// Starting positions and Maxwell velocities at kT with zero total momentum, on top of the flow. A function
/// of the seed alone.
template <int d>
void randomize(Particles<d>& particles, Box<d> const& box, double kT, std::uint64_t seed,
               Start start = Start::random);

extern template struct Simulation<2>;
extern template struct Simulation<3>;

}  // namespace dpd
