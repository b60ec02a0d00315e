#include "run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "checkpoint.hpp"
#include "forces.hpp"
#include "plain_stages.hpp"
#include "trajectory.hpp"

namespace dpd {
namespace {

// kT may exceed what the scene sets by this factor before the run counts as diverged; Euler runs just below
// their critical step stay far below it.
constexpr double divergence_factor = 1e6;

}  // namespace

template <int d>
Simulation<d> build(Scene const& scene, std::function<void(Simulation<d>&)> sample) {
    Simulation<d> simulation;
    simulation.box.length = Eigen::Map<Vec<d> const>(scene.length.data());
    simulation.box.shear_rate = scene.shear_rate;
    simulation.particles.mass = scene.mass;
    simulation.box.wall = scene.wall;
    simulation.particles.resize(static_cast<Eigen::Index>(scene.particles + scene.wall_particles));
    simulation.particles.fluid = static_cast<std::uint32_t>(scene.particles);
    if (auto const* const soft = scene.soft(); scene.wall_strength && soft && soft->strength > 0.0)
        simulation.wall_strength = *scene.wall_strength / soft->strength;
    randomize(simulation.particles, simulation.box, scene.kT, scene.seed, scene.start);
    simulation.seed = scene.seed;
    simulation.time_step = scene.time_step;

    simulation.hottest = divergence_factor * std::max(scene.kT, scene.thermostat_kT());
    simulation.pair_search.cutoff = scene.cutoff() > 0.0 ? scene.cutoff() : 1.0;
    simulation.stage_stress.wanted = scene.sample.asks("stress");
    simulation.pair_search.search = scene.search;
    simulation.pair_search.order = scene.order;
    simulation.sample = std::move(sample);
    simulation.pair_list.cutoff = simulation.pair_search.cutoff;
    bool const plain = scene.engine == Engine::plain;
    for (AnyStage const& stage : scene.stages)
        simulation.stages.push_back(plain ? plain_stage<d>(stage) : Stage<d>(stage));
    if (AnyPotential const* const known = scene.potential())
        simulation.potential_sums = [plain, potential = *known](Simulation<d>& s) {
            if (plain) return plain_potential_sums(s, potential);
            return std::visit([&](auto const& p) { return potential_sums(s, p); }, potential);
        };
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
                    throw Interrupted(fmt::format(
                        "interrupted at step {} of {}; {}", simulation.step, scene.steps(),
                        file ? "the same command goes on from there" : "without --out nothing is kept"));
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
