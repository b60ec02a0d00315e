#include "run.hpp"

#include <fmt/format.h>

#include <chrono>

#include "archive.hpp"
#include "checkpoint.hpp"
#include "files.hpp"
#include "processor_time.hpp"
#include "progress.hpp"
#include "signals.hpp"
#include "sums.hpp"
#include "trajectory.hpp"

namespace dpd {
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

// Of the velocities across the flow along x, which do not know it; walls are at rest.
template <int d>
double temperature_across(Particles<d> const& particles) {
    double const sum = sum_of_squares(particles.velocity.rightCols(d - 1));
    return particles.mass * sum / (double(d - 1) * double(particles.fluid));
}

void check_place_of_trajectory(Scene const& scene, RunOptions const& options) {
    if (scene.trajectory_interval == 0) return;
    if (!options.output)
        throw InputError("trajectory: has no place to go; allowed: with an output file (--out)");
    if (trajectory_path(*options.output) == *options.output)
        throw InputError(
            fmt::format("{}: is where the trajectory goes; allowed: another extension for results",
                        options.output->string()));
}

template <int d>
RunResult run_in(Scene const& scene, RunOptions const& options) {
    using Clock = std::chrono::steady_clock;
    check_place_of_trajectory(scene, options);
    std::optional<FileLock> lock;
    std::optional<RunFile<d>> file;
    if (options.output) {
        lock.emplace(*options.output, [&] { return options.stop && *options.stop; });
        file.emplace(scene, *options.output);
    }
    std::unique_ptr<Recorder<d>> recorder;
    Simulation<d> simulation = build<d>(scene, [&recorder](Simulation<d>& s) { (*recorder)(s); });
    recorder = std::make_unique<Recorder<d>>(scene.sample, simulation);
    check_errors_wanted(scene, recorder->record());
    double earlier_seconds = 0.0;
    std::uint64_t earlier_bytes = 0;
    bool complete = false, resumed = false;
    if (file) try {
            resumed = file->load(simulation, *recorder, earlier_seconds, earlier_bytes, complete);
        } catch (InputError const& error) {
            bool const damaged = dynamic_cast<Damaged const*>(&error) && Archive::is_ours(*options.output);
            if (!options.cache && !damaged) throw;
            auto const aside = move_aside(*options.output);
            warn(fmt::format("{}; moved to {}, and the run is made again", error.what(), aside.string()));
            lock.reset();
            return run_in<d>(scene, options);
        }
    RunResult result;
    result.particles = scene.particles;
    if (complete) {
        result.from_cache = true;
        result.seconds = earlier_seconds;
        if (scene.trajectory_interval > 0 && !std::filesystem::exists(trajectory_path(*options.output)))
            warn(fmt::format("{}: is gone; remove {} to make both again",
                             trajectory_path(*options.output).string(), options.output->string()));
    } else {
        std::unique_ptr<Trajectory> trajectory;
        if (scene.trajectory_interval > 0) {
            std::uint64_t const frames = simulation.step / scene.trajectory_interval;
            trajectory =
                std::make_unique<Trajectory>(trajectory_path(*options.output),
                                             TrajectoryOf{.run = scene.key(),
                                                          .box_length = scene.length,
                                                          .particles = scene.particles + scene.wall_particles,
                                                          .shear_rate = scene.shear_rate},
                                             frames, frames * scene.trajectory_interval);
        }
        auto const start = Clock::now();
        auto const seconds = [&, from = thread_seconds()] {
            return earlier_seconds + thread_seconds() - from;
        };
        // the trajectory first: frames beyond a checkpoint are made again, missing ones are not
        auto const save = [&](std::string const& status) {
            Unhurried const whole;
            if (trajectory) trajectory->commit();
            result.seconds = seconds();
            if (file) file->save(status, simulation, *recorder, result.seconds);
        };
        // an output that cannot be written is refused before the work, not after it
        if (!resumed) save("interrupted");
        using Seconds = std::chrono::duration<double>;
        auto next_checkpoint = start + Seconds(scene.checkpoint_seconds);
        auto last_progress = start, next_look = start;
        std::uint64_t expected = expected_steps(scene, simulation.step, {});
        auto const look_at_errors = [&] {
            auto const begin = Clock::now();
            auto const errors = errors_wanted(scene, recorder->record());
            expected = expected_steps(scene, simulation.step, errors);
            if (options.tell) options.tell(progress_text(errors));
            auto const end = Clock::now();
            next_look = end + std::max<Clock::duration>(std::chrono::seconds(1), 20 * (end - begin));
        };
        try {
            while (!is_over(scene, simulation.step, recorder->record())) {
                simulation.advance();
                if (trajectory && simulation.step % scene.trajectory_interval == 0)
                    append_frame(*trajectory, simulation);
                auto const now = Clock::now();
                if (options.progress && now - last_progress > std::chrono::milliseconds(200)) {
                    if (scene.until && now > next_look && simulation.step > scene.equilibration_steps)
                        look_at_errors();
                    options.progress(double(simulation.step) / double(expected));
                    last_progress = now;
                }
                bool const stop = options.stop && *options.stop && simulation.step < scene.steps();
                if (file && (stop || now > next_checkpoint)) {
                    save("interrupted");
                    auto const end = Clock::now();
                    next_checkpoint =
                        end + Seconds(checkpoint_pause(scene.checkpoint_seconds, Seconds(end - now).count()));
                }
                if (stop)
                    throw Interrupted(fmt::format(
                        "interrupted at step {} of {}{}; {}", simulation.step, scene.until ? "at most " : "",
                        scene.steps(),
                        file ? "the same command goes on from there" : "without --out nothing is kept"));
            }
        } catch (Diverged const& divergence) {
            save(fmt::format("{}{}", diverged, divergence.what()));
            throw;
        }
        recorder->finish();
        save("complete");
    }
    if (options.progress) options.progress(1.0);
    if (!complete)
        result.kinetic_temperature = scene.stage<BodyForce>()
                                         ? temperature_across(simulation.particles)
                                         : kinetic_temperature(simulation.particles, simulation.box);
    result.record = recorder->record();
    result.counters = simulation.counters;
    result.duration = double(result.counters.steps - scene.equilibration_steps) * scene.time_step;
    result.errors = errors_wanted(scene, result.record);
    result.bytes = complete ? earlier_bytes : simulation.bytes();
    return result;
}

}  // namespace

RunResult run(Scene const& scene, RunOptions const& options) {
    return scene.dimension == 2 ? run_in<2>(scene, options) : run_in<3>(scene, options);
}

}  // namespace dpd
