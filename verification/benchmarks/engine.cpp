/// @file
/// What a particle and step costs, as a whole and by part. CPU time; the counter `per_particle_step`
/// (seconds, printed in ns) is the one to compare.
#include <benchmark/benchmark.h>

#include <cstdint>
#include <string>
#include <vector>

#include "run.hpp"
#include "stages.hpp"

namespace {

using namespace dpd;

enum class Thermostat { shardlow, euler };

// The ideal gas of NG2007: n* = 3 in 3D, gamma = 4.5, m = kT = rc = 1.
Simulation<3> ideal_gas(Thermostat thermostat, double shear_rate) {
    Simulation<3> simulation;
    simulation.box.length = Vec<3>::Constant(20.0);
    simulation.box.shear_rate = shear_rate;
    simulation.particles.resize(24000);
    simulation.time_step = 0.02;
    simulation.seed = 1;
    randomize(simulation.particles, simulation.box, 1.0, simulation.seed);
    if (thermostat == Thermostat::shardlow)
        simulation.stages = {{"shardlow", Shardlow<3>{.friction = 4.5}}, {"drift", Drift<3>{}}};
    else
        simulation.stages = {{"euler", EulerImpulses<3>{.gamma = 4.5, .sigma = 3.0}},
                             {"kick", Kick<3>{}},
                             {"drift", Drift<3>{}}};
    return simulation;
}

// The system of MY1997: n = 0.2 in 2D, cutoff 4, gamma = sigma = 1.
Simulation<2> marsh_yeomans() {
    Simulation<2> simulation;
    simulation.box.length = Vec<2>::Constant(100.0);
    simulation.particles.resize(2000);
    simulation.pair_search.cutoff = 4.0;
    simulation.time_step = 0.1;
    simulation.seed = 1;
    randomize(simulation.particles, simulation.box, 0.5, simulation.seed);
    simulation.stages = {
        {"euler", EulerImpulses<2>{.cutoff = 4.0}}, {"kick", Kick<2>{}}, {"drift", Drift<2>{}}};
    return simulation;
}

// The soft fluid of NG2007 Fig. 3: n* = 3, a = 25, ten force steps of 0.01 in each step.
Simulation<3> soft_fluid(std::string const& stages, std::string const& tables) {
    return build<3>(
        parse_scene("dimension = 3\nstages = [" + stages +
                        "]\n[box]\nlength = [20, 20, 20]\n[particles]\ndensity = 3\n[time]\nstep = "
                        "0.1\nduration = 1\n[verlet]\nsubsteps = 10\n[verlet.soft]\nstrength = 25\n" +
                        tables,
                    "benchmark"),
        {});
}

// Runs `part` on a warm simulation.
template <int d, class Part>
void run(benchmark::State& state, Simulation<d> simulation, Part part) {
    for (int warm_up = 0; warm_up < 50; ++warm_up) simulation.advance();
    for (auto iteration : state) {
        static_cast<void>(iteration);
        part(simulation);
    }
    auto const updates = double(state.iterations()) * double(simulation.particles.size());
    state.counters["per_particle_step"] =
        benchmark::Counter(updates, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

constexpr auto whole_step = [](auto& simulation) { simulation.advance(); };

constexpr auto pair_search = [](auto& simulation) {
    simulation.positions_changed();
    benchmark::DoNotOptimize(simulation.pairs().count);
};

// The thermostat with its noise, on pairs that are found already.
constexpr auto thermostat = [](auto& simulation) {
    simulation.stages.front().act(simulation, {simulation.seed, ++simulation.step, 0});
};

void noise_batch(benchmark::State& state, Simulation<3> simulation) {
    simulation.advance();
    auto const& pairs = simulation.pairs();
    std::vector<double> out(pairs.count);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        pair_normals({1, ++simulation.step, 0}, {pairs.i.data(), pairs.count}, {pairs.j.data(), pairs.count},
                     simulation.particles.id.data(), out);
        benchmark::DoNotOptimize(out.data());
    }
    auto const normals = double(state.iterations()) * double(pairs.count);
    state.counters["per_normal"] =
        benchmark::Counter(normals, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(noise_batch, , ideal_gas(Thermostat::shardlow, 0.0));

struct Register {
    Register() {
        auto const add = [](char const* name, auto make, auto part) {
            benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { run(state, make(), part); });
        };
        auto const shardlow = [] { return ideal_gas(Thermostat::shardlow, 0.0); };
        auto const shardlow_sheared = [] { return ideal_gas(Thermostat::shardlow, 0.1); };
        auto const euler = [] { return ideal_gas(Thermostat::euler, 0.0); };
        auto const euler_sheared = [] { return ideal_gas(Thermostat::euler, 0.1); };
        add("step/shardlow", shardlow, whole_step);
        add("step/shardlow/sheared", shardlow_sheared, whole_step);
        add("step/euler", euler, whole_step);
        add("step/euler/sheared", euler_sheared, whole_step);
        add("step/marsh_yeomans_2d", marsh_yeomans, whole_step);
        auto const soft = [](std::string const& stages, std::string const& tables) {
            return [=] { return soft_fluid(stages, tables); };
        };
        add("step/soft_ten_substeps", soft("'verlet'", ""), whole_step);
        add("step/soft_ten_substeps/shardlow", soft("'shardlow', 'verlet'", "[shardlow]\nfriction = 4.5\n"),
            whole_step);
        add("step/soft_ten_substeps/lowe", soft("'lowe', 'verlet'", "[lowe]\nrate = 1\n"), whole_step);
        add("step/soft_ten_substeps/rescale", soft("'rescale', 'verlet'", "[rescale]\n"), whole_step);
        add("pair_search", shardlow, pair_search);
        add("pair_search/sheared", shardlow_sheared, pair_search);
        add("thermostat/shardlow", shardlow, thermostat);
        add("thermostat/euler", euler, thermostat);
    }
} const registered;

}  // namespace

BENCHMARK_MAIN();
