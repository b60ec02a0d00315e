/// @file
/// A simulation: one particle state, and a time step that is a list of stages.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
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
    double time = 0.0;         ///< of the positions; the drift advances it
    double hottest = 0.0;      ///< kT beyond which the run counts as diverged
    Field<d> momentum_change;  ///< Euler impulses waiting for the kick; empty where no stage needs it

    /// The pairs within the cutoff of the pair search, at the present positions; shared by all stages until
    /// positions change.
    PairList<d>& pairs();

    /// To be called by whatever moves particles.
    void positions_changed() { pairs_valid_ = false; }

    /// Runs the stage list once. Throws Diverged, with the step's number.
    void advance();

    /// Bytes held by the state and its work arrays.
    std::size_t bytes() const;

private:
    void check_divergence() const;

    PairList<d> pairs_;
    bool pairs_valid_ = false;
};

/// kT of the peculiar velocities, (1/(d(N-1))) sum m (v - u(y))^2: momentum is conserved.
template <int d>
double kinetic_temperature(Particles<d> const& particles, Box<d> const& box);

/// Total momentum relative to the flow, sum m (v - u(y)).
template <int d>
Vec<d> total_momentum(Particles<d> const& particles, Box<d> const& box);

/// Uniformly random positions and Maxwell velocities at kT with zero total momentum, on top of the flow. A
/// function of the seed alone.
template <int d>
void randomize(Particles<d>& particles, Box<d> const& box, double kT, std::uint64_t seed);

extern template struct Simulation<2>;
extern template struct Simulation<3>;

}  // namespace dpd
