/// @file
/// A scene: what to simulate, how, and what to measure. Read from TOML; the keys, units and defaults are in
/// docs/scene.md.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pairs.hpp"
#include "sample.hpp"
#include "stages.hpp"

namespace dpd {

struct Configuration;

/// The paper's own description of a DPD fluid, @eq{PK2006,1} to @eq{PK2006,4}: what is missing in the scene
/// follows from it. Lengths and forces in the atoms' units.
struct CoarseGrainingParameters {
    double atoms_per_particle = 1.0;  ///< N_m of PK2006
    std::vector<double> length;       ///< sides of the fluid, sigma; empty: box.length counts
    double force = 0.0;               ///< on each atom, along x, m sigma/tau^2
    double viscosity = 0.0;           ///< of the DPD fluid, its own units; with `force` only
};

/// A run that goes on until its relative errors are small enough. They are looked at after 1, 2, 4, ... times
/// `production_steps`, the last time after `longest`.
struct Until {
    std::map<std::string, double> errors;  ///< wanted, relative: by quantity
    std::uint64_t longest = 0;  ///< steps after equilibration: `production_steps` times a power of 2
};

/// Which of the two implementations of the stages runs a scene.
enum class Engine {
    fast,   ///< src/engine
    plain,  ///< src/plain: all pairs, in the order of ids
};

constexpr std::string_view name_of(Engine engine) {
    switch (engine) {
        case Engine::fast:
            return "fast";
        case Engine::plain:
            return "plain";
    }
    return "";
}

/// A scene file, checked: what is simulated and what is measured. Units are its own, of mass, length and
/// time.
struct Scene {
    std::string title;                    ///< for the reader
    int dimension = 3;                    ///< 2 or 3
    std::uint64_t seed = 1;               ///< of all noise
    std::vector<AnyStage> stages;         ///< with their parameters, in the order of a step
    std::vector<double> length;           ///< sides of the box
    double shear_rate = 0.0;              ///< du_x/dy, 1/time
    double wall = 0.0;                    ///< thickness of either wall; 0: none
    std::optional<double> wall_strength;  ///< of the potential between fluid and wall; none: the fluid's
    std::uint64_t particles = 0;          ///< of the fluid
    std::uint64_t wall_particles = 0;     ///< frozen ones
    double mass = 1.0;                    ///< of a particle
    double kT = 1.0;                      ///< of the initial velocities
    std::optional<CoarseGrainingParameters>
        coarse_graining;                                 ///< the map from atoms; none: the file has no table
    Start start = Start::random;                         ///< where particles begin, without a file
    std::shared_ptr<Configuration const> configuration;  ///< with which they begin; none: by `start` and `kT`
    double time_step = 0.0;                              ///< time
    std::uint64_t equilibration_steps = 0;               ///< before the first sample
    std::uint64_t production_steps = 0;     ///< in which samples are taken; with `until` at least so many
    std::optional<Until> until;             ///< none: `production_steps` it is
    double checkpoint_seconds = 30.0;       ///< wall clock between checkpoints
    Search search = Search::cell;           ///< how pairs are found
    Order order = Order::cell;              ///< in which sequential updates visit them
    SampleParameters sample;                ///< what is measured, and when
    std::uint64_t trajectory_interval = 0;  ///< steps between frames; 0: none
    Engine engine = Engine::fast;           ///< `use` chooses it, not the file

    /// The merged TOML text, sorted and without comments: with the seed and the revision it
    /// determines the results.
    std::string text;

    double volume() const;        ///< of the box
    double fluid_volume() const;  ///< without walls
    double channel_width()
        const;  ///< of a Poiseuille flow: between the walls, or half a box of opposed flows
    /// Of the fluid, particles per volume.
    double density() const { return double(particles) / fluid_volume(); }
    /// Of the whole run; with `until` the most that there may be.
    std::uint64_t steps() const { return equilibration_steps + (until ? until->longest : production_steps); }

    /// The scene's stage of that kind, or none.
    template <class S>
    S const* stage() const {
        for (auto const& candidate : stages)
            if (auto const* const found = std::get_if<S>(&candidate)) return found;
        return nullptr;
    }
    /// Whether its step has a stage of that name.
    bool has_stage(std::string_view name) const;
    /// In the order of a step.
    std::vector<std::string> stage_names() const;
    /// What the parameters of stages may depend on.
    StageSetting stage_setting() const;
    AnyPotential const* potential() const;  ///< the conservative force that a stage knows, or none
    Soft const* soft() const;               ///< the same if it is a soft repulsion

    bool flows() const { return shear_rate != 0.0 || stage<BodyForce>(); }  ///< along x
    bool opposed_flows() const;                                             ///< two, without walls
    double cutoff() const;         ///< the longest of the scene's pair interactions; 0 without any
    double thermostat_kT() const;  ///< the highest that a thermostat of the scene is set to; 0 without any

    /// Chooses the engine. Throws InputError if that cannot run the scene: the plain one knows no random
    /// order.
    void use(Engine which);

    /// Name of this scene's cached result: a UUID (version 5) of text, seed, engine and revision; for the
    /// plain engine also of its own source.
    std::string key() const;
};

/// The last so many axes are those along which displacements and velocities tell of diffusion: not x where
/// the fluid flows, and between walls only the last.
int diffusing_components(Scene const& scene);

/// Reads and checks a scene. `overrides` are "table.key=value", applied on top of the file. Throws
/// InputError: "file:line: key: problem; allowed: ...".
Scene load_scene(std::filesystem::path const& file, std::vector<std::string> const& overrides = {},
                 std::optional<std::uint64_t> seed = {});

/// The same for a scene given as text, which messages call `name`.
Scene parse_scene(std::string const& text, std::string const& name,
                  std::vector<std::string> const& overrides = {}, std::optional<std::uint64_t> seed = {});

}  // namespace dpd
