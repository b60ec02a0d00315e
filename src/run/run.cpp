#include "run.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <chrono>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "stages.hpp"
#include "archive.hpp"
#include "theory/closed_forms.hpp"
#include "version.hpp"

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

// Everything a run needs to go on as if it had never stopped.
template <int d>
void archive_state(Archive& archive, Simulation<d>& simulation) {
    archive("checkpoint/position", simulation.particles.position);
    archive("checkpoint/velocity", simulation.particles.velocity);
    archive("checkpoint/image", simulation.particles.image);
    archive("checkpoint/id", simulation.particles.id);
    archive("checkpoint/time", simulation.time);
    archive("checkpoint/step", simulation.step);
    auto& stress = simulation.stage_stress;
    std::uint64_t streamed = stress.streamed;
    archive("checkpoint/stress/streamed", streamed);
    archive("checkpoint/stress/kinetic", stress.kinetic);
    archive("checkpoint/stress/potential", stress.potential);
    archive("checkpoint/stress/collision", stress.collision);
    archive("checkpoint/stress/friction", stress.friction);
    archive("checkpoint/stress/rescaling", stress.rescaling);
    stress.streamed = streamed != 0;

    // pairs are found again as they were; forces are kept
    bool const reading = archive.reading();
    std::uint64_t found = simulation.pairs_of_step().has_value(),
                  of_step = simulation.pairs_of_step().value_or(0);
    archive("checkpoint/pairs/found", found);
    archive("checkpoint/pairs/of_step", of_step);
    if (reading && found) simulation.find_pairs_again(of_step);
    std::uint64_t forces = simulation.forces_valid();
    archive("checkpoint/forces/found", forces);
    if (forces) {
        archive("checkpoint/forces/force", simulation.force);
        archive("checkpoint/forces/potential_virial", simulation.pair_virials.potential);
        archive("checkpoint/forces/thermostat_virial", simulation.pair_virials.thermostat);
        archive("checkpoint/forces/friction_virial", simulation.pair_virials.friction);
        simulation.forces_found();
    }
}

void archive_counters(Archive& archive, Counters& counters) {
    archive("dpdref/counters/steps", counters.steps);
    archive("dpdref/counters/searches", counters.searches);
    archive("dpdref/counters/pairs_found", counters.pairs_found);
    archive("dpdref/counters/pair_updates", counters.pair_updates);
    archive("dpdref/counters/potential_evaluations", counters.potential_evaluations);
    archive("dpdref/counters/random_draws", counters.random_draws);
    archive("dpdref/counters/boundary_pairs", counters.boundary_pairs);
    archive("dpdref/counters/coincident_pairs", counters.coincident_pairs);
}

constexpr std::string_view diverged = "diverged: ";

// The file of one run. Its state is "complete", "interrupted" (with a checkpoint) or "diverged: ...".
template <int d>
class RunFile {
public:
    RunFile(Scene const& scene, std::filesystem::path path) : scene_(scene), path_(std::move(path)) {}

    void save(std::string status, Simulation<d>& simulation, Recorder<d>& recorder, double seconds) const {
        Archive archive(path_, Archive::Mode::write);
        archive.describe_as_h5md();
        std::string key = scene_.key(), text = scene_.text;
        std::uint64_t seed = scene_.seed, bytes = simulation.bytes();
        std::string program = fmt::format("dpdref {}", version),
                    built = fmt::format("{} {}", compiler, build_flags);
        archive("dpdref/status", status);
        archive("dpdref/key", key);
        archive("dpdref/scene", text);
        archive("dpdref/seed", seed);
        archive("dpdref/program", program);
        archive("dpdref/compiler", built);
        archive("dpdref/seconds", seconds);
        archive("dpdref/bytes", bytes);
        archive_counters(archive, simulation.counters);
        recorder.archive(archive);
        if (status == "interrupted") archive_state(archive, simulation);
        archive.commit();
    }

    // Restores a checkpoint or a result; false if there is no file yet. A run that diverged would do so
    // again: throws what it said.
    bool load(Simulation<d>& simulation, Recorder<d>& recorder, double& seconds, std::uint64_t& bytes,
              bool& complete) const {
        if (!std::filesystem::exists(path_)) return false;
        Archive archive(path_, Archive::Mode::read);
        std::string key, status;
        if (archive.has("dpdref/key")) archive("dpdref/key", key);
        if (key != scene_.key())
            throw InputError(
                fmt::format("{}: exists and is not a result of this scene and seed; allowed: a new file",
                            path_.string()));
        archive("dpdref/status", status);
        complete = status == "complete";
        if (status.starts_with(diverged)) throw Diverged(status.substr(diverged.size()));
        if (!complete && status != "interrupted") return false;
        archive("dpdref/seconds", seconds);
        archive("dpdref/bytes", bytes);
        archive_counters(archive, simulation.counters);
        recorder.archive(archive);
        if (!complete) archive_state(archive, simulation);
        return true;
    }

private:
    Scene const& scene_;
    std::filesystem::path path_;
};

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

// --- analysis --------------------------------------------------------------------------------------------

std::vector<std::vector<double>> series_of(std::vector<Record> const& records, std::string const& name) {
    std::vector<std::vector<double>> runs;
    for (auto const& record : records)
        if (auto const found = record.series.find(name); found != record.series.end())
            runs.push_back(found->second);
    return runs;
}

std::vector<Curve const*> curves_of(std::vector<Record> const& records, std::string const& name) {
    std::vector<Curve const*> curves;
    for (auto const& record : records)
        if (auto const found = record.curves.find(name); found != record.curves.end())
            curves.push_back(&found->second);
    return curves;
}

// Evaluates `f(means)` for each block of each curve, where means(bin) is the block's mean in that bin.
template <class F>
Estimate by_block(std::vector<Curve const*> const& curves, F&& f) {
    std::vector<double> values;
    for (auto const* curve : curves)
        for (Eigen::Index block = 0; block < curve->sum.cols(); ++block) {
            if ((curve->weight.col(block) == 0.0).any()) continue;
            values.push_back(f(*curve, (curve->sum.col(block) / curve->weight.col(block)).eval()));
        }
    return independent(values);
}

// Ratio of the means of two series sampled together; the error is that of numerator - ratio*denominator.
Estimate ratio_of(std::vector<std::vector<double>> numerator,
                  std::vector<std::vector<double>> const& denominator) {
    double above = 0.0, below = 0.0, count = 0.0;
    for (std::size_t r = 0; r < numerator.size(); ++r)
        for (std::size_t k = 0; k < numerator[r].size(); ++k) {
            above += numerator[r][k];
            below += denominator[r][k];
            count += 1.0;
        }
    if (below == 0.0) return {};
    double const ratio = above / below, mean = below / count;
    for (std::size_t r = 0; r < numerator.size(); ++r)
        for (std::size_t k = 0; k < numerator[r].size(); ++k)
            numerator[r][k] = ratio + (numerator[r][k] - ratio * denominator[r][k]) / mean;
    return combine(numerator);
}

// Slope of the mean-square displacement over the second half of its lags, over twice the number of
// components.
double diffusion_from(Curve const& curve, Eigen::ArrayXd const& mean, int components) {
    auto const last = static_cast<Eigen::Index>(curve.x.size()) - 1;
    Eigen::Index const first = last / 2;
    return (mean[last] - mean[first]) /
           (2.0 * components *
            (curve.x[static_cast<std::size_t>(last)] - curve.x[static_cast<std::size_t>(first)]));
}

// Least-squares slope of the velocity profile over the imposed shear rate.
double relative_slope(Curve const& curve, Eigen::ArrayXd const& mean, double shear_rate) {
    Eigen::Map<Eigen::ArrayXd const> const y(curve.x.data(), mean.size());
    Eigen::ArrayXd const centred = y - y.mean();
    return (centred * mean).sum() / centred.square().sum() / shear_rate;
}

// kT in bins of y, one value per block: what flows, imposed or not, is not heat.
std::vector<Curve> temperature_profiles(Scene const& scene, std::vector<Record> const& records) {
    std::vector<Curve> profiles;
    auto const velocities = curves_of(records, "velocity_profile");
    for (Curve const* const square : curves_of(records, "velocity_squared_profile")) {
        Curve const& velocity = *velocities[profiles.size()];
        Curve profile = *square;
        Eigen::Map<Eigen::ArrayXd const> const y(profile.x.data(), profile.sum.rows());
        for (Eigen::Index block = 0; block < profile.sum.cols(); ++block) {
            Eigen::ArrayXd const flow = velocity.sum.col(block) / velocity.weight.col(block) -
                                        scene.shear_rate * (y - 0.5 * scene.length[1]);
            profile.sum.col(block) = scene.mass / scene.dimension *
                                     (profile.sum.col(block) / profile.weight.col(block) - flow.square());
            profile.weight.col(block) = (profile.weight.col(block) > 0.0).cast<double>();
        }
        profile.sum = (profile.weight > 0.0).select(profile.sum, 0.0);
        profiles.push_back(std::move(profile));
    }
    return profiles;
}

// One bin of a plane Poiseuille flow: height above the lower wall, and the direction in which the fluid is
// driven.
struct ChannelBin {
    Eigen::Index bin;
    double z, direction;
};

// The bins of a profile that lie in the channel: between walls, or in one of two opposed flows, each half a
// box wide. None without a flow.
std::vector<ChannelBin> channel_bins(Scene const& scene, Curve const& profile) {
    std::vector<ChannelBin> bins;
    if (!scene.has_stage("body_force") || (scene.wall == 0.0 && !scene.body_force.opposed)) return bins;
    double const width = scene.channel_width();
    for (std::size_t b = 0; b < profile.x.size(); ++b) {
        bool const upper = scene.body_force.opposed && profile.x[b] >= width;
        double const z = upper ? profile.x[b] - width : profile.x[b] - scene.wall;
        if (z > 0.0 && z < width) bins.push_back({Eigen::Index(b), z, upper ? -1.0 : 1.0});
    }
    return bins;
}

// Least squares for u = sum over columns of c_k f_k.
Eigen::VectorXd fit(Eigen::MatrixXd const& f, Eigen::VectorXd const& u) {
    return f.colPivHouseholderQr().solve(u);
}

// The power-law profile that fits best; index 1 is the parabola. PK2006 sect. IV.
struct PowerLaw {
    double maximum = 0.0, index = 1.0;
};
PowerLaw fit_power_law(Eigen::VectorXd const& z, Eigen::VectorXd const& u, double width) {
    Eigen::MatrixXd shape(z.size(), 1);
    auto const fitted = [&](double index) {
        for (Eigen::Index k = 0; k < z.size(); ++k)
            shape(k, 0) = theory::power_law_velocity(1.0, index, width, z[k]);
        return fit(shape, u)[0];
    };
    constexpr double least = 0.05, most = 20.0;
    constexpr int bits = 24;  // of a minimum that is flat: more is noise
    auto const [logarithm, residual] = boost::math::tools::brent_find_minima(
        [&](double x) {
            double const maximum = fitted(std::exp(x));
            return (u - maximum * shape.col(0)).squaredNorm();
        },
        std::log(least), std::log(most), bits);
    static_cast<void>(residual);
    return {fitted(std::exp(logarithm)), std::exp(logarithm)};
}

// What a velocity profile says about the fluid in a channel. PK2006 sect. IV.
template <class Add>
void add_channel(Scene const& scene, std::vector<Record> const& records, Add&& add) {
    auto const velocities = curves_of(records, "velocity_profile");
    auto const densities = curves_of(records, "density_profile");
    if (velocities.empty()) return;
    double const width = scene.channel_width(), n = scene.density();
    auto const bins = channel_bins(scene, *velocities.front());
    if (bins.size() < 4 || scene.body_force.acceleration == 0.0) return;
    auto const size = static_cast<Eigen::Index>(bins.size());
    Eigen::VectorXd z(size);
    for (Eigen::Index k = 0; k < size; ++k) z[k] = bins[std::size_t(k)].z;
    Eigen::MatrixXd parabola(size, 2);
    parabola.col(0) = z.array() * (width - z.array());
    parabola.col(1).setOnes();
    double const force = scene.mass * scene.body_force.acceleration;

    // f(profile in the direction of the flow), for each block
    auto const over = [&](std::vector<Curve const*> const& curves, bool directed, auto&& f) {
        std::vector<double> values;
        for (Curve const* const curve : curves)
            for (Eigen::Index block = 0; block < curve->sum.cols(); ++block) {
                Eigen::VectorXd u(size);
                bool whole = true;
                for (Eigen::Index k = 0; k < size; ++k) {
                    auto const& at = bins[std::size_t(k)];
                    double const weight = curve->weight(at.bin, block);
                    whole &= weight > 0.0;
                    u[k] = (directed ? at.direction : 1.0) * curve->sum(at.bin, block) / weight;
                }
                if (whole) values.push_back(f(u));
            }
        return independent(values);
    };
    add("poiseuille_viscosity", over(velocities, true, [&](Eigen::VectorXd const& u) {
            return n * force / (2.0 * fit(parabola.leftCols(1), u)[0]);
        }));
    Estimate const fastest =
        over(velocities, true, [&](Eigen::VectorXd const& u) { return fit_power_law(z, u, width).maximum; });
    add("maximum_velocity", fastest);
    add("power_law_index",
        over(velocities, true, [&](Eigen::VectorXd const& u) { return fit_power_law(z, u, width).index; }));
    add("slip", over(velocities, true, [&](Eigen::VectorXd const& u) {
            Eigen::VectorXd const c = fit(parabola, u);
            return c[1] / (c[0] * width * width / 4.0);
        }));
    add("bulk_density", over(densities, false, [&](Eigen::VectorXd const& density) {
            double sum = 0.0, count = 0.0;
            for (Eigen::Index k = 0; k < size; ++k)
                if (std::abs(z[k] / width - 0.5) < 0.25) sum += density[k], count += 1.0;
            return sum / (count * n);
        }));
    add("density_peak",
        over(densities, false, [&](Eigen::VectorXd const& density) { return density.maxCoeff() / n; }));
    if (!scene.coarse_graining || scene.coarse_graining->viscosity == 0.0) return;
    double const eta = scene.coarse_graining->viscosity;
    Eigen::VectorXd expected(size);
    for (Eigen::Index k = 0; k < size; ++k)
        expected[k] = theory::poiseuille_velocity(n, force, eta, width, z[k]);
    double const maximum = theory::poiseuille_maximum_velocity(n, force, eta, width);
    add("navier_stokes_deviation", over(velocities, true, [&](Eigen::VectorXd const& u) {
            return std::sqrt((u - expected).squaredNorm() / double(size)) / maximum;
        }));
    auto const fastest_over = [&](double speed) {
        Estimate ratio = fastest;
        ratio.value /= speed;
        ratio.error /= speed;
        return ratio;
    };
    add("navier_stokes_ratio", fastest_over(maximum));
    theory::CoarseGraining const map{.Nm = scene.coarse_graining->atoms_per_particle};
    double const kT = scene.thermostat_kT();
    add("mach_number",
        fastest_over(theory::groot_warren_sound_speed({.n = n, .m = scene.mass, .kT = kT},
                                                      theory::conservative_coefficient(map, kT), map.alpha)));
}

// The mean square of a stress summed over a window of time, for every start of it and each eighth of the
// series: <G^2>, G(t) = dt sum of sigma. It grows as 2 kT eta t/V once t exceeds the memory of the stress.
std::vector<double> mean_square_impulse(std::vector<double> const& stress, double dt, std::size_t window) {
    std::vector<double> means;
    std::size_t const length = stress.size() / curve_blocks;
    for (std::size_t block = 0; block < curve_blocks && length > window; ++block) {
        auto const from = stress.begin() + std::ptrdiff_t(block * length);
        double impulse = dt * std::accumulate(from, from + std::ptrdiff_t(window), 0.0), sum = 0.0;
        std::size_t const origins = length - window;
        for (std::size_t k = 0; k < origins; ++k) {
            sum += impulse * impulse;
            impulse += dt * (from[std::ptrdiff_t(k + window)] - from[std::ptrdiff_t(k)]);
        }
        means.push_back(sum / double(origins));
    }
    return means;
}

// The stress that all of the fluid carries, the pairs' noise included, at each step of a run.
std::vector<double> total_stress(Record const& record) {
    std::vector<double> total = record.series.at("kinetic_stress");
    for (char const* name : {"collision_stress", "potential_stress"})
        if (auto const part = record.series.find(name); part != record.series.end())
            for (std::size_t k = 0; k < total.size(); ++k) total[k] += part->second[k];
    return total;
}

// The shear viscosity of a fluid at rest from the growth of <G^2> over the second half of the window. The
// stress counts whole impulses, noise too, so that it is the momentum that crosses planes in a step and no
// term has to be added by hand, as it has to where forces are sampled at an instant (M. H. Ernst & R. Brito,
// Europhys. Lett. 73 (2006) 183). E. Helfand, Phys. Rev. 119 (1960) 1.
// [green kubo]
Estimate green_kubo_viscosity(Scene const& scene, std::vector<Record> const& records) {
    std::size_t const window = scene.sample.green_kubo_window;
    double const per_time = scene.volume() / (scene.thermostat_kT() * double(window) * scene.time_step);
    std::vector<double> values;
    for (auto const& record : records) {
        auto const stress = total_stress(record);
        auto const whole = mean_square_impulse(stress, scene.time_step, window),
                   half = mean_square_impulse(stress, scene.time_step, window / 2);
        for (std::size_t block = 0; block < whole.size(); ++block)
            values.push_back((whole[block] - half[block]) * per_time);
    }
    return independent(values);
}
// [green kubo]

// What theory makes of a measured g(r): the relaxation rate of friction, the collision viscosity, and the
// potential viscosity that goes with a relaxation rate of one. @eq{NG2007,12} @eq{NG2007,14} @eq{NG2007,16}
template <class Add>
void add_integrals_of_g(Scene const& scene, std::vector<Record> const& records, Add&& add) {
    auto const curves = curves_of(records, "radial_distribution");
    auto const over_g = [&](auto&& f) {
        return by_block(curves, [&](Curve const& curve, Eigen::ArrayXd const& mean) {
            double const width = 2.0 * curve.x[0];
            return f([&](double r) {
                auto const bin = static_cast<Eigen::Index>(r / width);
                return bin < mean.size() ? mean[bin] : 1.0;
            });
        });
    };
    theory::Gas gas{.d = scene.dimension, .n = scene.density(), .m = scene.mass, .kT = scene.thermostat_kT()};
    if (scene.has_stage("shardlow") && scene.shardlow.friction > 0.0) {
        gas.rc = scene.shardlow.cutoff;
        theory::Shardlow const thermostat{.gamma = scene.shardlow.friction,
                                          .weight = scene.shardlow.weight,
                                          .scheme = scene.shardlow.scheme};
        add("dpd_relaxation_rate",
            over_g([&](auto const& g) { return theory::relaxation_rate(gas, thermostat, g); }));
        add("collision_viscosity_by_g", over_g([&](auto const& g) {
                return theory::collision_viscosity(gas, thermostat, scene.time_step, g);
            }));
    }
    auto const* const repulsion = std::get_if<Soft>(&scene.potential);
    if (scene.has_potential() && repulsion && repulsion->strength > 0.0 && gas.kT > 0.0) {
        gas.rc = repulsion->cutoff;
        theory::Soft const soft{.a = repulsion->strength / gas.kT};
        double const a = repulsion->strength / repulsion->cutoff;
        add("pressure_by_g", over_g([&](auto const& g) { return theory::virial_pressure(gas, a, g); }));
        add("speed_of_sound_by_g",
            over_g([&](auto const& g) { return theory::virial_sound_speed(gas, a, g); }));
        add("repulsion_constant", over_g([&](auto const& g) { return theory::repulsion_constant(gas, g); }));
        add("potential_viscosity_per_rate",
            over_g([&](auto const& g) { return theory::potential_viscosity(gas, soft, 1.0, g); }));
    }
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

RunResult run(Scene const& scene, RunOptions const& options) {
    return scene.dimension == 2 ? run_in<2>(scene, options) : run_in<3>(scene, options);
}

std::vector<Quantity> analyze(Scene const& scene, std::vector<Record> const& records) {
    std::vector<Quantity> quantities;
    auto const add = [&](std::string name, Estimate estimate) {
        if (estimate.blocks > 0) quantities.push_back({std::move(name), estimate});
    };
    add("kinetic_temperature", combine(series_of(records, "kinetic_temperature")));
    double largest_momentum = 0.0;
    auto const momenta = series_of(records, "momentum");
    for (auto const& momentum : momenta)
        for (double const value : momentum) largest_momentum = std::max(largest_momentum, value);
    if (!momenta.empty()) add("largest_momentum", {.value = largest_momentum, .error = 0.0, .blocks = 1});

    for (char const* name : {"potential_energy", "pressure"}) add(name, combine(series_of(records, name)));
    add("configurational_temperature",
        ratio_of(series_of(records, "force_squared"), series_of(records, "laplacian")));

    auto kinetic = series_of(records, "kinetic_stress"), collision = series_of(records, "collision_stress"),
         potential = series_of(records, "potential_stress");
    // the same mean with a smaller error
    if (auto friction = series_of(records, "friction_stress"); !friction.empty()) collision = friction;
    if (scene.shear_rate != 0.0) {
        auto total = kinetic, rest = kinetic;
        for (std::size_t r = 0; r < total.size(); ++r)
            for (std::size_t k = 0; k < total[r].size(); ++k) {
                kinetic[r][k] /= scene.shear_rate;
                collision[r][k] /= scene.shear_rate;
                rest[r][k] = collision[r][k];
                if (!potential.empty()) rest[r][k] += potential[r][k] /= scene.shear_rate;
                total[r][k] = kinetic[r][k] + rest[r][k];
            }
        add("kinetic_viscosity", combine(kinetic));
        add("collision_viscosity", combine(collision));
        add("potential_viscosity", combine(potential));
        add("viscosity", combine(total));
        // of what pairs carry over what particles carry
        add("viscosity_ratio", ratio_of(rest, kinetic));
    } else {
        add("kinetic_stress", combine(kinetic));
        add("collision_stress", combine(collision));
        add("potential_stress", combine(potential));
    }
    if (scene.sample.green_kubo_window > 0) add("green_kubo_viscosity", green_kubo_viscosity(scene, records));
    if (scene.shear_rate != 0.0)
        add("profile_slope",
            by_block(curves_of(records, "velocity_profile"), [&](auto const& curve, auto const& mean) {
                return relative_slope(curve, mean, scene.shear_rate);
            }));
    add("pair_density",
        by_block(curves_of(records, "radial_distribution"), [&](auto const& curve, auto const& mean) {
            // share of pairs within the range over that of a uniform gas
            double found = 0.0, uniform = 0.0;
            for (Eigen::Index bin = 0; bin < mean.size(); ++bin) {
                double const shell =
                    std::pow(double(bin + 1), scene.dimension) - std::pow(double(bin), scene.dimension);
                found += mean[bin] * shell;
                uniform += shell;
            }
            static_cast<void>(curve);
            return found / uniform;
        }));
    int const components = diffusing_components(scene);
    add("diffusion_constant",
        by_block(curves_of(records, "mean_square_displacement"), [&](auto const& curve, auto const& mean) {
            return diffusion_from(curve, mean, components);
        }));
    add("green_kubo_diffusion_constant",
        by_block(curves_of(records, "velocity_autocorrelation"), [&](auto const& curve, auto const& mean) {
            // the trapezium rule is exact for free streaming in steps of the spacing
            return (mean.sum() - 0.5 * mean[0] - 0.5 * mean[mean.size() - 1]) * (curve.x[1] - curve.x[0]) /
                   components;
        }));
    // first moment over the square of the integral: 1 for an exponential
    add("correlation_moment",
        by_block(curves_of(records, "velocity_autocorrelation"), [&](auto const& curve, auto const& mean) {
            Eigen::Map<Eigen::ArrayXd const> const t(curve.x.data(), mean.size());
            double const integral = mean.sum() - 0.5 * mean[0] - 0.5 * mean[mean.size() - 1];
            return mean[0] * (t * mean).sum() / (t[1] * integral * integral);
        }));
    std::vector<Curve> const temperatures = temperature_profiles(scene, records);
    std::vector<Curve const*> profiles;
    for (auto const& profile : temperatures) profiles.push_back(&profile);
    add("profile_temperature", by_block(profiles, [](auto const&, auto const& mean) { return mean.mean(); }));
    // share of cos(4 pi y/L), along which two opposed flows dissipate
    add("temperature_modulation", by_block(profiles, [&](auto const& curve, auto const& mean) {
            Eigen::Map<Eigen::ArrayXd const> const y(curve.x.data(), mean.size());
            return 2.0 * (mean * (4.0 * std::numbers::pi / scene.length[1] * y).cos()).mean() / mean.mean();
        }));
    for (char const* name : {"global_q4", "local_q4", "global_q6", "local_q6"})
        add(name, combine(series_of(records, name)));
    add_channel(scene, records, add);
    add_integrals_of_g(scene, records, add);
    return quantities;
}

namespace {

Estimate estimate_of(std::vector<Quantity> const& quantities, std::string_view name) {
    Quantity const* const found = find_quantity(quantities, name);
    return found ? found->estimate : Estimate{};
}

// Adds f(arguments) where all arguments are known; its error from theirs, taken as independent, by finite
// differences.
template <class F>
void add_function(std::vector<Quantity>& quantities, std::string name, std::vector<Estimate> const& arguments,
                  F&& f) {
    if (find_quantity(quantities, name)) return;
    Estimate result;
    std::vector<double> at;
    for (auto const& argument : arguments) {
        if (argument.blocks == 0) return;
        at.push_back(argument.value);
        result.blocks = at.size() == 1 ? argument.blocks : std::min(result.blocks, argument.blocks);
    }
    result.value = f(at);
    double variance = 0.0;
    for (std::size_t a = 0; a < at.size(); ++a) {
        auto shifted = at;
        shifted[a] += arguments[a].error;
        variance += std::pow(f(shifted) - result.value, 2);
    }
    result.error = std::sqrt(variance);
    quantities.push_back({std::move(name), result});
}

}  // namespace

void add_function(std::vector<Quantity>& quantities, std::string name,
                  std::vector<std::string> const& arguments,
                  std::function<double(std::vector<double> const&)> const& f) {
    std::vector<Estimate> estimates;
    for (auto const& argument : arguments) estimates.push_back(estimate_of(quantities, argument));
    add_function(quantities, std::move(name), estimates, f);
}

void derive(Scene const& scene, std::vector<Quantity>& quantities) {
    auto const value = [&](std::string_view name) { return estimate_of(quantities, name); };
    double const n = scene.density(), kT = scene.thermostat_kT();
    add_function(quantities, "potential_relaxation_rate",
                 {value("potential_viscosity"), value("potential_viscosity_per_rate")},
                 [](auto const& x) { return x[0] / x[1]; });
    add_function(quantities, "kinetic_viscosity_by_rates",
                 {value("potential_relaxation_rate"), value("dpd_relaxation_rate")},
                 [&](auto const& x) { return theory::kinetic_viscosity(n, kT, x[0], x[1]); });
    add_function(quantities, "schmidt_number", {value("viscosity"), value("diffusion_constant")},
                 [&](auto const& x) { return x[0] / (n * scene.mass * x[1]); });
    if (!scene.coarse_graining) return;
    // eq. 4 with the viscosity that was measured
    theory::CoarseGraining const map{.Nm = scene.coarse_graining->atoms_per_particle};
    theory::Channel const channel;
    add_function(quantities, "time_unit", {value("viscosity")},
                 [&](auto const& x) { return theory::time_unit(map, x[0]); });
    add_function(quantities, "predicted_velocity", {value("viscosity")}, [&](auto const& x) {
        return theory::poiseuille_maximum_velocity(map.n,
                                                   theory::force_in_dpd_units(map, x[0], channel.force), x[0],
                                                   theory::length_in_dpd_units(map, channel.width));
    });
    add_function(quantities, "predicted_mach_number", {value("viscosity")}, [&](auto const& x) {
        return theory::mach_number(map, x[0], kT, channel.force, channel.width);
    });
    if (scene.coarse_graining->force > 0.0)
        add_function(quantities, "force_ratio", {value("viscosity")}, [&](auto const& x) {
            return scene.mass * scene.body_force.acceleration /
                   theory::force_in_dpd_units(map, x[0], scene.coarse_graining->force);
        });
}

void derive_from_densities(Scene const& scene, double densities, Estimate const& below, Estimate const& above,
                           std::vector<Quantity>& quantities) {
    double const kT = scene.thermostat_kT();
    add_function(quantities, "pressure_slope", {below, above},
                 [&](auto const& x) { return (x[1] - x[0]) / densities; });
    Estimate const slope = estimate_of(quantities, "pressure_slope");
    add_function(quantities, "inverse_compressibility", {slope}, [&](auto const& x) { return x[0] / kT; });
    if (scene.coarse_graining)
        add_function(quantities, "inverse_compressibility_per_atom", {slope},
                     [&](auto const& x) { return x[0] / (kT * scene.coarse_graining->atoms_per_particle); });
    add_function(quantities, "speed_of_sound", {slope},
                 [&](auto const& x) { return std::sqrt(std::max(0.0, x[0]) / scene.mass); });
}

void derive_at_lag(Scene const& scene, std::vector<Quantity>& quantities, double t) {
    auto const value = [&](std::string_view name) { return estimate_of(quantities, name); };
    double const kT = scene.thermostat_kT(), m = scene.mass;
    add_function(quantities, "exponential_decay", {value("green_kubo_diffusion_constant")},
                 [&](auto const& x) { return kT / m * std::exp(-t * kT / (m * x[0])); });
    bool const cube = std::all_of(scene.length.begin(), scene.length.end(),
                                  [&](double side) { return side == scene.length.front(); });
    if (!cube || t <= 0.0) return;
    theory::Gas const gas{.d = scene.dimension, .n = scene.density(), .m = m, .kT = kT};
    add_function(quantities, "hydrodynamic_tail",
                 {value("viscosity"), value("green_kubo_diffusion_constant")}, [&](auto const& x) {
                     return theory::velocity_autocorrelation_tail_in_box(gas, x[0], x[1],
                                                                         scene.length.front(), t);
                 });
}

namespace {

// The velocity between the walls of a channel, block by block; opposed flows are laid over each other. In the
// atoms' units (sigma, sigma/tau) where the scene says what an atom is.
Curve channel_profile(Scene const& scene, Curve const& velocity) {
    double length = 1.0, speed = 1.0;
    if (scene.coarse_graining && scene.coarse_graining->viscosity > 0.0) {
        theory::CoarseGraining const map{.Nm = scene.coarse_graining->atoms_per_particle};
        length = theory::cutoff_radius(map);
        speed = length / theory::time_unit(map, scene.coarse_graining->viscosity);
    }
    std::map<double, std::vector<ChannelBin>> by_height;
    for (auto const& bin : channel_bins(scene, velocity))
        by_height[std::round(bin.z * 1e9) * 1e-9].push_back(bin);
    Curve profile;
    profile.resize(by_height.size());
    Eigen::Index to = 0;
    for (auto const& [z, bins] : by_height) {
        profile.x[std::size_t(to)] = z * length;
        for (auto const& from : bins) {
            profile.sum.row(to) += from.direction * speed * velocity.sum.row(from.bin);
            profile.weight.row(to) += velocity.weight.row(from.bin);
        }
        ++to;
    }
    return profile;
}

}  // namespace

CurveEstimate curve_of(Scene const& scene, std::vector<Record> const& records, std::string const& name) {
    std::vector<Curve> derived =
        name == "temperature_profile" ? temperature_profiles(scene, records) : std::vector<Curve>{};
    if (name == "channel_profile")
        for (Curve const* const velocity : curves_of(records, "velocity_profile"))
            derived.push_back(channel_profile(scene, *velocity));
    auto curves = curves_of(records, name);
    for (auto const& curve : derived) curves.push_back(&curve);
    CurveEstimate result;
    if (curves.empty()) return result;
    result.x = curves.front()->x;
    double const components = name == "velocity_autocorrelation" ? diffusing_components(scene) : 1.0;
    for (std::size_t bin = 0; bin < result.x.size(); ++bin) {
        std::vector<double> values;
        for (Curve const* const curve : curves)
            for (double const mean : curve->block_means(Eigen::Index(bin)))
                values.push_back(mean / components);
        result.y.push_back(independent(values));
    }
    return result;
}

Quantity const* find_quantity(std::vector<Quantity> const& quantities, std::string_view name) {
    auto const found =
        std::find_if(quantities.begin(), quantities.end(), [&](auto const& q) { return q.name == name; });
    return found == quantities.end() ? nullptr : &*found;
}

}  // namespace dpd
