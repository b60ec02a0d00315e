/// @file
/// What a particle and step costs, as a whole and by part. CPU time; the counter `per_particle_step`
/// (seconds, printed in ns) is the one to compare.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "forces.hpp"
#include "run.hpp"
#include "wide.hpp"

namespace {

using namespace dpd;

constexpr double skin = 0.3;

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
        simulation.stages = {Shardlow{.friction = 4.5}, Drift{}};
    else
        simulation.stages = {EulerImpulses{.gamma = 4.5, .sigma = 3.0}, Kick{}, Drift{}};
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
    simulation.stages = {EulerImpulses{.cutoff = 4.0}, Kick{}, Drift{}};
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

// The same with one force step of 0.02: the fluid of the race.
Simulation<3> race_fluid() {
    return build<3>(
        parse_scene("dimension = 3\nstages = ['shardlow', 'verlet']\n[box]\nlength = [20, 20, 20]\n"
                    "[particles]\ndensity = 3\n[time]\nstep = 0.02\nduration = 1\n[verlet.soft]\n"
                    "strength = 25\n[shardlow]\nfriction = 4.5\nweight = 'quadratic'\n",
                    "benchmark"),
        {});
}

// The Lennard-Jones liquid of the race.
Simulation<3> race_liquid() {
    return build<3>(
        parse_scene("dimension = 3\nstages = ['verlet']\n[box]\nlength = [31.07, 31.07, 31.07]\n"
                    "[particles]\nnumber = 24000\nstart = 'lattice'\nkT = 1\n[time]\nstep = 0.005\n"
                    "duration = 1\n[verlet.lennard_jones]\ncutoff = 2.5\n",
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

// The same with a skin: what it costs to make a list that lasts for some steps.
constexpr auto skin_search = [](auto& simulation) {
    static PairList<3> list;
    simulation.pair_search.cutoff += skin;
    simulation.pair_search.find(simulation.particles, simulation.box, simulation.time, {}, list);
    simulation.pair_search.cutoff -= skin;
    benchmark::DoNotOptimize(list.count);
};

// The forces, on pairs that are found already.
constexpr auto forces_alone = [](auto& simulation) {
    simulation.force.setZero();
    benchmark::DoNotOptimize(add_forces(simulation, Soft{25.0, 1.0}, simulation.force));
};

// The thermostat with its noise, on pairs that are found already.
constexpr auto thermostat = [](auto& simulation) {
    simulation.stages.front().act(simulation, {simulation.seed, ++simulation.step, 0});
};

// What such a list costs in each step: separations of all it holds, and the pairs picked from them.
void skin_pick(benchmark::State& state, Simulation<3> simulation) {
    for (int warm_up = 0; warm_up < 50; ++warm_up) simulation.advance();
    double const cutoff = simulation.pair_search.cutoff;
    PairList<3> list, pairs;
    simulation.pair_search.cutoff += skin;
    simulation.pair_search.find(simulation.particles, simulation.box, simulation.time, {}, list);
    pairs.grow_to(list.count);
    constexpr std::size_t block = 256;
    std::array<std::array<double, block + simd::widest>, 4> scratch;
    auto& [x, y, z, distance] = scratch;
    simd::Geometry<3> geometry{{}, {}, cutoff * cutoff};
    for (std::size_t axis = 0; axis < 3; ++axis)
        geometry.period[axis] = simulation.box.length[Eigen::Index(axis)];
    double const* const position = simulation.particles.position.data();
    for (auto iteration : state) {
        static_cast<void>(iteration);
        pairs.clear();
        for (std::size_t begin = 0; begin < list.count; begin += block) {
            std::size_t const size = std::min(block, list.count - begin);
            std::uint32_t const *const i = list.i.data() + begin, *const j = list.j.data() + begin;
            for (std::size_t k = 0; k < size; ++k)
                for (std::size_t axis = 0; axis < 3; ++axis)
                    scratch[axis][k] =
                        position[3 * std::size_t{i[k]} + axis] - position[3 * std::size_t{j[k]} + axis];
            simd::normalize(geometry,
                            simd::PairColumns<3>{size, {x.data(), y.data(), z.data()}, distance.data()});
            for (std::size_t k = 0; k < size; ++k) {  // what is no pair is written over by the next
                pairs.i[pairs.count] = i[k];
                pairs.j[pairs.count] = j[k];
                for (std::size_t axis = 0; axis < 3; ++axis) pairs.unit[axis][pairs.count] = scratch[axis][k];
                pairs.distance[pairs.count] = distance[k];
                pairs.count += distance[k] > 0.0 && distance[k] < cutoff;
            }
        }
        benchmark::DoNotOptimize(pairs.count);
    }
    auto const updates = double(state.iterations()) * double(simulation.particles.size());
    state.counters["per_particle_step"] =
        benchmark::Counter(updates, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
    state.counters["listed"] = double(list.count) / double(simulation.particles.size());
    state.counters["pairs"] = double(pairs.count) / double(simulation.particles.size());
}

BENCHMARK_CAPTURE(skin_pick, fluid, race_fluid());
BENCHMARK_CAPTURE(skin_pick, liquid, race_liquid());

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

// What a pair of the soft fluid with S1 cannot do without, for pairs that are known and particles that stay
// in the nearest cache: its separation, a normal variate, the coefficients, the update of two velocities, the
// force.
void unavoidable(benchmark::State& state) {
    constexpr std::size_t particles = 64, pairs = 256;
    constexpr double rate = 4.5 * 0.02;
    std::array<std::uint32_t, particles> id;
    std::iota(id.begin(), id.end(), 0u);
    std::array<std::uint32_t, pairs> i, j;
    std::array<double, 3 * particles> position, velocity{}, force{};
    for (std::size_t c = 0; c < position.size(); ++c) position[c] = 0.5 * uniform({}, std::uint32_t(c), 0);
    // so that one pair's particles are not the next one's
    for (std::size_t k = 0; k < pairs; ++k) {
        i[k] = std::uint32_t(k % particles);
        j[k] = std::uint32_t((k + 5 + 8 * (k / particles)) % particles);
    }
    std::array<std::array<double, pairs>, 3> e;
    std::array<double, pairs> a, noise, f;
    std::uint64_t step = 0;
    for (auto iteration : state) {
        static_cast<void>(iteration);
        pair_normals({1, ++step, 0}, i, j, id.data(), noise);
        ordered_loop(0, pairs,
                     [i = i.data(), j = j.data(), position = position.data(), e = e.data()](std::size_t k) {
                         for (std::size_t axis = 0; axis < 3; ++axis)
                             e[axis][k] = position[3 * i[k] + axis] - position[3 * j[k] + axis];
                     });
        wide_loop(pairs, [x = e[0].data(), y = e[1].data(), z = e[2].data(), a = a.data(),
                          noise = noise.data(), f = f.data()](std::size_t k) {
            double const r = std::sqrt(x[k] * x[k] + y[k] * y[k] + z[k] * z[k]), inverse = 1.0 / r;
            x[k] *= inverse;
            y[k] *= inverse;
            z[k] *= inverse;
            a[k] = update_a<Scheme::shardlow>(rate * weight_at<Weight::quadratic>(r));
            noise[k] *= update_b(a[k], 1.0) * std::numbers::sqrt2;
            f[k] = 25.0 * (1.0 - r);
        });
        ordered_loop(0, pairs,
                     [i = i.data(), j = j.data(), e = e.data(), a = a.data(), noise = noise.data(),
                      velocity = velocity.data()](std::size_t k) {
                         std::size_t const from = 3 * std::size_t{i[k]}, to = 3 * std::size_t{j[k]};
                         double approach = 0.0;
                         for (std::size_t axis = 0; axis < 3; ++axis)
                             approach += (velocity[from + axis] - velocity[to + axis]) * e[axis][k];
                         double const change = noise[k] - a[k] * approach;
                         for (std::size_t axis = 0; axis < 3; ++axis) {
                             velocity[from + axis] += change * e[axis][k];
                             velocity[to + axis] -= change * e[axis][k];
                         }
                     });
        ordered_loop(
            0, pairs,
            [i = i.data(), j = j.data(), e = e.data(), f = f.data(), force = force.data()](std::size_t k) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    force[3 * i[k] + axis] += f[k] * e[axis][k];
                    force[3 * j[k] + axis] -= f[k] * e[axis][k];
                }
            });
        benchmark::DoNotOptimize(velocity.data());
        benchmark::DoNotOptimize(force.data());
        benchmark::ClobberMemory();
    }
    state.counters["per_pair"] = benchmark::Counter(
        double(state.iterations()) * pairs, benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK(unavoidable);

// What memory delivers to one core: an array far larger than the caches is read and written.
void memory(benchmark::State& state) {
    std::vector<double> array(std::size_t{1} << 25, 1.0);
    for (auto iteration : state) {
        static_cast<void>(iteration);
        wide_loop(array.size(), [x = array.data()](std::size_t k) { x[k] *= 1.0000001; });
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(state.iterations() * std::int64_t(2 * sizeof(double) * array.size()));
}

BENCHMARK(memory);

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
        add("fluid/step", race_fluid, whole_step);
        add("fluid/pair_search", race_fluid, pair_search);
        add("fluid/thermostat", race_fluid, thermostat);
        add("fluid/forces", race_fluid, forces_alone);
        add("skin_search/fluid", race_fluid, skin_search);
        add("liquid/step", race_liquid, whole_step);
        add("liquid/pair_search", race_liquid, pair_search);
        add("skin_search/liquid", race_liquid, skin_search);
        add("pair_search", shardlow, pair_search);
        add("pair_search/sheared", shardlow_sheared, pair_search);
        add("thermostat/shardlow", shardlow, thermostat);
        add("thermostat/euler", euler, thermostat);
    }
} const registered;

}  // namespace

BENCHMARK_MAIN();
