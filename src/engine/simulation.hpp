/// @file
/// A simulation: one particle state, and a time step that is a list of stages.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "noise.hpp"
#include "pairs.hpp"
#include "stages.hpp"
#include "state.hpp"

namespace dpd {

template <int d>
struct Simulation;

/// A stage acts on the state once per step. Its place in the list is the stream of its noise.
template <int d>
struct Stage {
    using Act =
        std::function<void(Simulation<d>&, NoiseKey)>;  ///< what a stage does, and the key of its noise
    std::string name;                                   ///< as a scene has it
    Act act;                                            ///< what it does

    /// One of the table.
    Stage(AnyStage const& stage);
    /// The same, from its struct.
    template <class S>
    requires std::constructible_from<AnyStage, S> Stage(S const& stage) : Stage(AnyStage(stage)) {}
    /// One that is in no table.
    Stage(std::string its_name, Act does) : name(std::move(its_name)), act(std::move(does)) {}
};

extern template struct Stage<2>;
extern template struct Stage<3>;

/// A state, the stages of its time step, and the search that they share.
template <int d>
struct Simulation : State<d> {
    using State<d>::particles, State<d>::box, State<d>::seed, State<d>::step, State<d>::time_step,
        State<d>::time, State<d>::pair_list, State<d>::momentum_change, State<d>::force, State<d>::counters,
        State<d>::pairs_of_step, State<d>::pairs_found;

    std::vector<Stage<d>> stages;  ///< of a time step, in order
    PairSearch<d> pair_search;     ///< whose list all stages share
    double hottest = 0.0;          ///< kT beyond which the run counts as diverged; 0: none
    std::function<PotentialSums(Simulation&)> potential_sums;  ///< of the scene's potential, if it has one
    std::function<void(Simulation&)> sample;                   ///< what the stage of that name calls

    /// The pairs within the cutoff of the pair search, at the present positions; shared by all stages until
    /// positions change.
    PairList<d>& pairs();

    /// Finds the pairs as in an earlier step, from which a checkpoint was left.
    void find_pairs_again(std::uint64_t of_step);

    /// Runs the stage list once. Throws Diverged, with the step's number.
    void advance();

    /// Bytes held by the state and its work arrays.
    std::size_t bytes() const;

private:
    void sort_particles();
    void check_divergence() const;
};

/// One stage, outside of any list.
template <int d>
void act(AnyStage const& stage, Simulation<d>& simulation, NoiseKey key) {
    Stage<d>(stage).act(simulation, key);
}

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

constexpr std::string_view name_of(Start value) {
    switch (value) {
        case Start::random:
            return "random";
        case Start::dense:
            return "dense";
        case Start::lattice:
            return "lattice";
    }
    return "";
}

/// Starting positions and Maxwell velocities at kT with zero total momentum, on top of the flow. A function
/// of the seed alone.
template <int d>
void randomize(Particles<d>& particles, Box<d> const& box, double kT, std::uint64_t seed,
               Start start = Start::random);

extern template struct Simulation<2>;
extern template struct Simulation<3>;

}  // namespace dpd
