/// @file
/// Stability maps: the largest step of each integrator over friction, repulsion and density, by bisection.
/// Defined by verification/stability/stability.toml, drawn by the *.gp beside it; docs/stability.md.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "campaign.hpp"
#include "scene.hpp"
#include "simulation.hpp"
#include "statistics.hpp"

namespace dpd {

/// What a trial at one step came to, from good to bad.
enum class Outcome {
    stable,    ///< kT of the second half at most twice the set one
    hot,       ///< above, but bounded: no use, yet no blow-up
    diverged,  ///< the engine gave up (Diverged)
};

constexpr std::string_view name_of(Outcome outcome) {
    switch (outcome) {
        case Outcome::stable:
            return "stable";
        case Outcome::hot:
            return "hot";
        case Outcome::diverged:
            return "diverged";
    }
    return {};
}

/// A scene run for some steps at one step.
struct Trial {
    double step = 0.0;                  ///< time
    Outcome outcome = Outcome::stable;  ///< of the trial
    std::uint64_t steps = 0;            ///< done
    Estimate kT{};                      ///< kinetic temperature in the second half; none if diverged
    std::vector<double> trace{};        ///< kinetic temperature after the steps that trace_steps names
};

/// Steps at which a trace of so many steps is kept: all the first, then ever fewer, evenly in the logarithm.
std::vector<std::uint64_t> trace_steps(std::uint64_t steps);

/// The neighbouring steps between which trials turn bad, time.
struct Edge {
    double below = 0.0;                                      ///< 0: bad at every step tried
    double above = std::numeric_limits<double>::infinity();  ///< infinity: good at every step tried
    double step() const;  ///< their geometric mean; 0 or infinity where there is no edge
};

struct StepRange {
    double smallest = 1e-5;    ///< time
    double largest = 10.0;     ///< time
    double resolution = 0.05;  ///< ratio of the steps at an edge, minus one
};

/// All trials of a search, by step.
using Trials = std::map<double, Trial>;

/// Where outcomes get worse than `allowed`.
Edge edge_of(Trials const& trials, Outcome allowed);

/// Whether no step is better than a shorter one. Where not, an edge is the one below the shortest bad step
/// that the bisection happened to try.
bool monotonic(Trials const& trials);

/// Bisects in the logarithm of the step for the edge of `stable`, then for that of `hot`.
Trials bisect(StepRange const& range, std::function<Trial(double step)> const& trial);

/// How long a trial takes: `time`, but at least `fewest` and at most `most` steps.
struct TrialLength {
    double time = 10.0;           ///< that a trial simulates
    std::uint64_t fewest = 1000;  ///< steps, where the step is long
    std::uint64_t most = 10000;   ///< steps, where it is short
    /// How many for a time step.
    std::uint64_t steps(double step) const;
};

/// Largest steps that the positions of one state allow, all partners kept: two over the largest eigenvalue of
/// the friction matrix (theory/MY1997.md), and over the largest frequency of the Hessian. Time; infinity
/// without.
struct FrozenLimits {
    double friction = std::numeric_limits<double>::infinity();   ///< largest step by the friction matrix
    double repulsion = std::numeric_limits<double>::infinity();  ///< largest step by the Hessian
};

/// For a friction `friction` of that weight and the force `repulsion` (1 - r), both of range 1.
template <int d>
FrozenLimits frozen_limits(Particles<d> const& particles, Box<d> const& box, double friction, Weight weight,
                           double repulsion);

/// One point of a map: an integrator at one friction, repulsion and density.
struct StabilityPoint {
    std::string integrator;          ///< by name
    double friction = 0.0;           ///< of the fluid
    double repulsion = 0.0;          ///< of the fluid
    double density = 0.0;            ///< of the fluid
    std::string scene;               ///< TOML; its time.step is replaced
    std::string start;               ///< TOML of the scene whose end is the start of every trial
    StepRange range;                 ///< of the steps that are tried
    TrialLength length;              ///< of each trial
    Weight weight = Weight::linear;  ///< of the friction, for the limits
    double critical_step = 0.0;      ///< @eq{MY1997,25} for the friction; infinity without friction
    double harmonic_limit = 0.0;     ///< for the repulsion; infinity without
    FrozenLimits frozen{};           ///< of the start
    Trials trials{};                 ///< those made so far
    double seconds = 0.0;            ///< processor time of the bisection

    /// Name of this point's cached result.
    std::string key() const;
};

/// Points over one or two axes, and how they are drawn.
struct StabilityMap {
    std::string name;                    ///< of its files
    std::string curves;                  ///< the axis of which each value is a curve of its own
    std::vector<std::string> plots;      ///< names of the scripts that draw it
    bool traces = false;                 ///< whether kT is kept step by step beyond the edge
    std::vector<StabilityPoint> points;  ///< all of them
};

/// Reads the maps of a budget ("quick" or "paper"). InputError as for scenes.
std::vector<StabilityMap> load_stability(std::filesystem::path const& file, std::string const& budget);

/// Bisects for one point, from its start. Throws InputError, and Interrupted on `stop`.
void find_edges(StabilityPoint& point, std::atomic<bool> const* stop = nullptr);

/// Bisects for all points that the cache lacks, `jobs` at a time; each is stored as soon as it is done.
/// Throws the first error, or Interrupted. False if options name a shard: some points are then unknown.
bool find_edges(std::vector<StabilityMap>& maps, CampaignOptions const& options);

/// Writes data and pictures of the maps to `output`; gnuplot draws with the scripts of `directory`.
void write_stability(std::vector<StabilityMap> const& maps, std::string const& budget,
                     std::filesystem::path const& directory, std::filesystem::path const& output);

/// The pictures alone, of the data in `output`; InputError where there are none.
void draw_stability(std::vector<StabilityMap> const& maps, std::filesystem::path const& directory,
                    std::filesystem::path const& output);

}  // namespace dpd
