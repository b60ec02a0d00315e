#include "run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "archive.hpp"
#include "checkpoint.hpp"
#include "forces.hpp"
#include "rescale.hpp"
#include "stages.hpp"

namespace dpd {
namespace {

// kT may exceed what the scene sets by this factor before the run counts as diverged; Euler runs just below
// their critical step stay far below it.
constexpr double divergence_factor = 1e6;

template <int d>
Stage<d> make_stage(Scene const& scene, std::string const& name,
                    std::function<void(Simulation<d>&)> const& sample) {
    if (name == "shardlow") {
        auto const& p = scene.shardlow;
        return {name, Shardlow<d>{.friction = p.friction,
                                  .weight = p.weight,
                                  .scheme = p.scheme,
                                  .cutoff = p.cutoff,
                                  .kT = p.kT}};
    }
    if (name == "lowe") {
        auto const& p = scene.lowe;
        return {name, Lowe<d>{.rate = p.rate, .cutoff = p.cutoff, .kT = p.kT}};
    }
    if (name == "rescale") {
        auto const& p = scene.rescale;
        Rescale<d> rescale;
        rescale.mode = p.mode;
        rescale.kT = p.kT;
        rescale.cell = p.cell;
        rescale.thickness = p.thickness;
        rescale.amplitude = p.amplitude;
        return {name, rescale};
    }
    // [body force]
    if (name == "body_force") {
        auto const& p = scene.body_force;
        return {name, BodyForce<d>{.acceleration = p.acceleration, .opposed = p.opposed}};
    }
    // [body force]
    if (name == "verlet")
        return std::visit(
            [&](auto const& potential) -> Stage<d> {
                return {name, Verlet<d, std::decay_t<decltype(potential)>>{.potential = potential,
                                                                           .substeps = scene.substeps}};
            },
            scene.potential);
    if (name == "modified_verlet")
        return std::visit(
            [&](auto const& potential) -> Stage<d> {
                auto const& p = scene.modified_verlet;
                ModifiedVerlet<d, std::decay_t<decltype(potential)>> stage;
                stage.potential = potential;
                stage.gamma = p.gamma;
                stage.sigma = p.sigma;
                stage.weight = p.weight;
                stage.cutoff = p.cutoff;
                stage.lambda = p.lambda;
                stage.friction_again = p.friction_again;
                return {name, stage};
            },
            scene.potential);
    if (name == "force" || name == "half_kick")
        return std::visit(
            [&](auto const& potential) -> Stage<d> {
                using Potential = std::decay_t<decltype(potential)>;
                if (name == "force") return {name, ForceImpulses<d, Potential>{.potential = potential}};
                return {name, HalfKick<d, Potential>{.potential = potential}};
            },
            scene.potential);
    if (name == "euler") {
        auto const& p = scene.euler;
        return {name, EulerImpulses<d>{.gamma = p.gamma,
                                       .sigma = p.sigma,
                                       .weight = p.weight,
                                       .random_weight = p.random_weight.value_or(p.weight),
                                       .matched = !p.random_weight,
                                       .cutoff = p.cutoff}};
    }
    if (name == "kick") return {name, Kick<d>{}};
    if (name == "drift") return {name, Drift<d>{}};
    if (name == "half_drift") return {name, HalfDrift<d>{}};
    if (name == "scatter") return {name, Scatter<d>{}};
    return {name, [sample](Simulation<d>& simulation, NoiseKey) {
                if (sample) sample(simulation);
            }};
}

}  // namespace

template <int d>
Simulation<d> build(Scene const& scene, std::function<void(Simulation<d>&)> sample) {
    Simulation<d> simulation;
    simulation.box.length = Eigen::Map<Vec<d> const>(scene.length.data());
    simulation.box.shear_rate = scene.shear_rate;
    simulation.particles.mass = scene.mass;
    simulation.box.wall = scene.wall;
    simulation.particles.resize(static_cast<Eigen::Index>(scene.particles + scene.wall_particles));
    simulation.particles.mobile = static_cast<std::uint32_t>(scene.particles);
    if (auto const* const soft = std::get_if<Soft>(&scene.potential);
        scene.wall_strength && soft && soft->strength > 0.0)
        simulation.wall_strength = *scene.wall_strength / soft->strength;
    randomize(simulation.particles, simulation.box, scene.kT, scene.seed, scene.start);
    simulation.seed = scene.seed;
    simulation.time_step = scene.time_step;

    simulation.hottest = divergence_factor * std::max(scene.kT, scene.thermostat_kT());
    simulation.pair_search.cutoff = scene.cutoff() > 0.0 ? scene.cutoff() : 1.0;
    simulation.stage_stress.wanted = scene.sample.stress;
    if (scene.has_potential())
        std::visit(
            [&](auto const& potential) {
                simulation.potential_sums = [potential](Simulation<d>& s) {
                    return potential_sums(s, potential);
                };
            },
            scene.potential);
    simulation.pair_search.search = scene.search;
    simulation.pair_search.order = scene.order;
    for (auto const& name : scene.stages) simulation.stages.push_back(make_stage<d>(scene, name, sample));
    return simulation;
}

template Simulation<2> build(Scene const&, std::function<void(Simulation<2>&)>);
template Simulation<3> build(Scene const&, std::function<void(Simulation<3>&)>);

namespace {

// The trajectory goes beside the results.
std::filesystem::path trajectory_path(std::filesystem::path const& output) {
    return std::filesystem::path(output).replace_extension(".h5md");
}

template <int d>
void append_frame(Trajectory& trajectory, Simulation<d> const& simulation) {
    auto const& particles = simulation.particles;
    auto const count = static_cast<std::size_t>(particles.size());
    std::vector<double> position(count * d), velocity(count * d);
    std::vector<std::int32_t> image(count * d);
    for (Eigen::Index p = 0; p < particles.size(); ++p)
        for (int axis = 0; axis < d; ++axis) {
            std::size_t const slot = std::size_t{particles.id[p]} * d + static_cast<std::size_t>(axis);
            position[slot] = particles.position(p, axis);
            velocity[slot] = particles.velocity(p, axis);
            image[slot] = particles.image(p, axis);
        }
    trajectory.append(simulation.step, simulation.time, position, velocity, image);
}

template <int d>
RunResult run_in(Scene const& scene, RunOptions const& options) {
    using Clock = std::chrono::steady_clock;
    std::unique_ptr<Recorder<d>> recorder;
    Simulation<d> simulation = build<d>(scene, [&recorder](Simulation<d>& s) { (*recorder)(s); });
    recorder = std::make_unique<Recorder<d>>(scene.sample, simulation);

    double earlier_seconds = 0.0;
    std::uint64_t earlier_bytes = 0;
    bool complete = false;
    std::optional<RunFile<d>> file;
    if (options.output && scene.trajectory_interval > 0 &&
        trajectory_path(*options.output) == *options.output)
        throw InputError(
            fmt::format("{}: is where the trajectory goes; allowed: another extension for results",
                        options.output->string()));
    if (!options.output && scene.trajectory_interval > 0)
        throw InputError("trajectory: has no place to go; allowed: with an output file (--out)");
    if (options.output) file.emplace(scene, *options.output);
    bool const resumed = file && file->load(simulation, *recorder, earlier_seconds, earlier_bytes, complete);
    RunResult result;
    result.particles = scene.particles;
    if (complete) {
        result.from_cache = true;
    } else {
        // an output that cannot be written is refused before the work, not after it
        if (file && !resumed) file->save("interrupted", simulation, *recorder, 0.0);
        std::unique_ptr<Trajectory> trajectory;
        if (scene.trajectory_interval > 0 && options.output)
            trajectory = std::make_unique<Trajectory>(trajectory_path(*options.output), scene.length,
                                                      scene.particles + scene.wall_particles,
                                                      scene.shear_rate, simulation.step);
        auto const start = Clock::now();
        auto const seconds = [&] {
            return earlier_seconds + std::chrono::duration<double>(Clock::now() - start).count();
        };
        auto last_checkpoint = start, last_progress = start;
        try {
            while (simulation.step < scene.steps()) {
                simulation.advance();
                if (trajectory && simulation.step % scene.trajectory_interval == 0)
                    append_frame(*trajectory, simulation);
                auto const now = Clock::now();
                if (options.progress && now - last_progress > std::chrono::milliseconds(200)) {
                    options.progress(double(simulation.step) / double(scene.steps()));
                    last_progress = now;
                }
                bool const stop = options.stop && *options.stop && simulation.step < scene.steps();
                if (file && (stop || now - last_checkpoint >
                                         std::chrono::duration<double>(scene.checkpoint_seconds))) {
                    file->save("interrupted", simulation, *recorder, seconds());
                    last_checkpoint = now;
                }
                if (stop)
                    throw Interrupted(
                        fmt::format("interrupted at step {} of {}", simulation.step, scene.steps()));
            }
        } catch (Diverged const& divergence) {
            if (file)
                file->save(fmt::format("{}{}", diverged, divergence.what()), simulation, *recorder,
                           seconds());
            throw;
        }
        earlier_seconds = seconds();
        if (file) file->save("complete", simulation, *recorder, earlier_seconds);
    }
    if (options.progress) options.progress(1.0);
    if (!complete) result.kinetic_temperature = kinetic_temperature(simulation.particles, simulation.box);
    result.record = recorder->record();
    result.counters = simulation.counters;
    result.seconds = earlier_seconds;
    result.bytes = complete ? earlier_bytes : simulation.bytes();
    return result;
}

}  // namespace

RunResult run(Scene const& scene, RunOptions const& options) {
    return scene.dimension == 2 ? run_in<2>(scene, options) : run_in<3>(scene, options);
}

}  // namespace dpd
