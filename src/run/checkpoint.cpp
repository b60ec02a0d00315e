#include "checkpoint.hpp"

#include <fmt/format.h>

#include "archive.hpp"
#include "errors.hpp"
#include "plain_stages.hpp"
#include "until.hpp"
#include "version.hpp"

namespace dpd {
namespace {

// Rows that a file names and that are not there would be read.
template <int d>
void check_state(Archive const& archive, Simulation<d> const& simulation, Eigen::Index count) {
    auto const& particles = simulation.particles;
    if (particles.position.rows() != count || particles.velocity.rows() != count ||
        particles.image.rows() != count || particles.id.rows() != count)
        archive.refuse("checkpoint", fmt::format("is not of {} particles", count));
    std::vector<bool> seen(static_cast<std::size_t>(count));
    for (Eigen::Index p = 0; p < count; ++p) {
        if (particles.id[p] >= count || seen[particles.id[p]])
            archive.refuse("checkpoint/id", "is not each particle once");
        seen[particles.id[p]] = true;
    }
    for (int axis = 0; axis < d; ++axis)
        if (!(particles.position.col(axis) >= 0.0).all() ||
            !(particles.position.col(axis) <= simulation.box.length[axis]).all())
            archive.refuse("checkpoint/position", "is not in the box");
    if (!particles.velocity.isFinite().all()) archive.refuse("checkpoint/velocity", "is not finite");
}

// Everything a run needs to go on as if it had never stopped.
template <int d>
void archive_state(Archive& archive, Engine engine, Simulation<d>& simulation) {
    Eigen::Index const count = simulation.particles.size();
    archive("checkpoint/position", simulation.particles.position);
    archive("checkpoint/velocity", simulation.particles.velocity);
    archive("checkpoint/image", simulation.particles.image);
    archive("checkpoint/id", simulation.particles.id);
    if (archive.reading()) check_state(archive, simulation, count);
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
    if (reading && found && engine == Engine::plain) find_pairs_plainly(simulation, of_step);
    if (reading && found && engine == Engine::fast) simulation.find_pairs_again(of_step);
    std::uint64_t forces = simulation.forces_valid();
    archive("checkpoint/forces/found", forces);
    if (forces) {
        archive("checkpoint/forces/force", simulation.force);
        if (simulation.force.rows() != count || !simulation.force.isFinite().all())
            archive.refuse("checkpoint/forces/force", "is not one force per particle");
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

}  // namespace

template <int d>
void RunFile<d>::save(std::string status, Simulation<d>& simulation, Recorder<d>& recorder,
                      double seconds) const {
    Archive archive(path_, Archive::Mode::write);
    archive.describe_as_h5md();
    std::string key = scene_.key(), text = scene_.text;
    std::uint64_t seed = scene_.seed, bytes = simulation.bytes();
    std::string program = fmt::format("dpdref {}{}", version,
                                      scene_.engine == Engine::plain ? ", plain engine" : ""),
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
    if (scene_.until && status == "complete") {
        double duration = double(simulation.step - scene_.equilibration_steps) * scene_.time_step;
        archive("dpdref/until/duration", duration);
        for (auto const& e : errors_wanted(scene_, recorder.record())) {
            double wanted = e.wanted, reached = e.error();
            archive("dpdref/until/" + e.quantity + "/wanted", wanted);
            archive("dpdref/until/" + e.quantity + "/reached", reached);
        }
    }
    if (status == "interrupted") archive_state(archive, scene_.engine, simulation);
    archive.commit();
}

template <int d>
bool RunFile<d>::load(Simulation<d>& simulation, Recorder<d>& recorder, double& seconds, std::uint64_t& bytes,
                      bool& complete) const {
    if (!std::filesystem::exists(path_)) return false;
    Archive archive(path_, Archive::Mode::read);
    std::string key, status;
    if (archive.has("dpdref/key")) archive("dpdref/key", key);
    if (key != scene_.key())
        throw InputError(
            fmt::format("{}: exists and is not a result of this scene, seed and engine; allowed: a new file",
                        path_.string()));
    archive("dpdref/status", status);
    complete = status == "complete";
    if (status.starts_with(diverged)) throw Diverged(status.substr(diverged.size()));
    if (!complete && status != "interrupted") return false;
    archive("dpdref/seconds", seconds);
    archive("dpdref/bytes", bytes);
    archive_counters(archive, simulation.counters);
    recorder.archive(archive);
    if (!complete) {
        archive_state(archive, scene_.engine, simulation);
        if (simulation.step > scene_.steps())
            archive.refuse("checkpoint/step", "is behind the end of the run");
    }
    return true;
}

template class RunFile<2>;
template class RunFile<3>;

}  // namespace dpd
