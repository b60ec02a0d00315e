#include "build.hpp"

#include <algorithm>

#include "configuration.hpp"
#include "forces.hpp"
#include "plain_stages.hpp"

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
    if (auto const* const start = scene.configuration.get()) {
        auto const take = [d_ = Eigen::Index(d)](auto& field, std::vector<double> const& values) {
            for (Eigen::Index p = 0; p < field.rows(); ++p)
                for (Eigen::Index axis = 0; axis < d_; ++axis)
                    field(p, axis) = values[static_cast<std::size_t>(d_ * p + axis)];
        };
        Eigen::ArrayXd const drawn_height = simulation.particles.position.col(1);
        take(simulation.particles.position, start->position);
        if (!start->velocity.empty())
            take(simulation.particles.velocity, start->velocity);
        else  // drawn, about the flow where the particles now are
            simulation.particles.velocity.col(0) +=
                scene.shear_rate * (simulation.particles.position.col(1) - drawn_height);
    }
    simulation.seed = scene.seed;
    simulation.time_step = scene.time_step;

    simulation.hottest = divergence_factor * std::max(scene.kT, scene.thermostat_kT());
    simulation.pair_search.cutoff = scene.cutoff() > 0.0 ? scene.cutoff() : 1.0;
    simulation.stage_stress.wanted = scene.sample.asks("stress");
    simulation.stage_stress.virial_wanted = scene.sample.asks("lammps_pressure");
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

}  // namespace dpd
