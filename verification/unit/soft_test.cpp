// Conservative forces, Lowe's thermostat, the schemes of Shardlow's and rescaling. Mechanics to rounding;
// statistics with fixed seeds: each of some 75 comparisons may raise a false alarm with probability 7e-6, all
// together 5e-4 had the seeds not been fixed. The bounds are Student's, for the number of blocks behind an
// error.
#define BOOST_TEST_MODULE soft
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>
#include <numbers>
#include <ostream>
#include <string>
#include <tuple>
#include <vector>

#include "analysis.hpp"
#include "forces.hpp"
#include "run.hpp"
#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;
using boost::test_tools::tolerance;

namespace {

constexpr double false_alarm = 7e-6, false_alarm_bound = 4.5;  // the same for a normal variate

void check_equal(Estimate const& estimate, double expected, double resolution) {
    BOOST_TEST(
        std::abs(estimate.value - expected) < critical_z(false_alarm, estimate.blocks) * estimate.error,
        estimate.value << " +- " << estimate.error << " is not " << expected);
    BOOST_TEST(estimate.error < resolution);
}

Soft const soft{.strength = 25.0};

template <int d>
Simulation<d> gas(std::array<double, d> length, Eigen::Index n, double shear_rate, double time_step,
                  double mass = 1.0, double kT = 1.0) {
    Simulation<d> simulation;
    simulation.box.length = Eigen::Map<Vec<d>>(length.data());
    simulation.box.shear_rate = shear_rate;
    simulation.particles.resize(n);
    simulation.particles.mass = mass;
    simulation.time_step = time_step;
    simulation.seed = 1;
    simulation.pair_search.order = Order::id;
    simulation.stage_stress.wanted = true;
    randomize(simulation.particles, simulation.box, kT, 1);
    return simulation;
}

template <int d>
Simulation<d> small_gas(double shear_rate, double time_step, double mass = 1.0) {
    if constexpr (d == 2) return gas<2>({4.0, 5.0}, 60, shear_rate, time_step, mass);
    if constexpr (d == 3) return gas<3>({4.0, 5.0, 3.0}, 180, shear_rate, time_step, mass);
}

template <int d>
void advance(Simulation<d>& simulation, int steps) {
    for (int step = 0; step < steps; ++step) simulation.advance();
}

// Rows in order of the particles' ids.
template <int d, class Rows>
Field<d> by_id(Simulation<d> const& simulation, Rows const& rows) {
    Field<d> sorted(rows.rows(), d);
    for (Eigen::Index p = 0; p < rows.rows(); ++p) sorted.row(simulation.particles.id[p]) = rows.row(p);
    return sorted;
}

template <int d>
Field<d> unwrapped(Simulation<d> const& simulation) {
    auto const& p = simulation.particles;
    return by_id(simulation, (p.position + p.image.template cast<double>().rowwise() *
                                               simulation.box.length.transpose().array())
                                 .eval());
}

template <int d>
void check_same_motion(Simulation<d> const& a, Simulation<d> const& b, double within) {
    BOOST_TEST((by_id(a, a.particles.velocity) - by_id(b, b.particles.velocity)).abs().maxCoeff() <= within);
    BOOST_TEST((unwrapped(a) - unwrapped(b)).abs().maxCoeff() <= within);
}

template <int d>
double energy(Simulation<d>& simulation) {
    return 0.5 * simulation.particles.mass * simulation.particles.velocity.square().sum() +
           potential_sums(simulation, soft).energy;
}

template <int d>
bool crosses(PairList<d> const& pairs, std::size_t k) {
    return std::binary_search(pairs.crossing.begin(), pairs.crossing.end(), k);
}

// A scene in a few assignments; tables that a stage needs have defaults.
Scene scene(std::string const& stages, std::vector<std::string> const& assignments = {},
            std::uint64_t seed = 1) {
    std::vector<std::string> all{"dimension=3",   "stages=[" + stages + "]", "box.length=[5, 5, 5]",
                                 "time.step=0.1", "particles.density=3",     "time.duration=20"};
    for (auto const& [stage, assignment] : std::vector<std::pair<char const*, char const*>>{
             {"'shardlow'", "shardlow.friction=4.5"},
             {"'lowe'", "lowe.rate=5"},
             {"'euler'", "euler.sigma=1"},
             {"'euler'", "euler.gamma=1"},
             {"'rescale'", "rescale.mode=global"},
             {"'body_force'", "body_force.acceleration=0.3"},
             {"'modified_verlet'", "modified_verlet.gamma=4.5"},
             {"'modified_verlet'", "modified_verlet.sigma=3"},
             {"'modified_verlet'", "modified_verlet.lambda=0.65"},
             {"'modified_verlet'", "modified_verlet.soft.strength=25"},
             {"'verlet'", "verlet.soft.strength=25"}})
        if (stages.find(stage) != std::string::npos) all.push_back(assignment);
    if (stages.find("'verlet'") != std::string::npos) all.push_back("verlet.substeps=10");
    all.insert(all.end(), assignments.begin(), assignments.end());
    return parse_scene("[time]\n", "soft_test", all, seed);
}

}  // namespace

// --- potential and forces --------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(force_and_curvature_are_derivatives_of_the_energy) {
    Soft const potential{.strength = 7.0, .cutoff = 1.6};
    double const h = 1e-4;
    for (double const r : {0.1, 0.7, 1.2, 1.5}) {
        double const below = potential.energy(r - h), at = potential.energy(r),
                     above = potential.energy(r + h);
        BOOST_TEST(potential.force(r) == (below - above) / (2.0 * h), tolerance(1e-9));
        BOOST_TEST(potential.curvature(r) == (below - 2.0 * at + above) / (h * h), tolerance(1e-6));
    }
    BOOST_TEST(potential.energy(0.0) == 3.5);
    BOOST_TEST(potential.energy(1.6) == 0.0);
    BOOST_TEST(potential.force(1.6) == 0.0);
}

template <int d>
void check_force_sums(double shear_rate) {
    std::vector<Simulation<d>> both;
    for (Search const search : {Search::cell, Search::brute}) {
        both.push_back(small_gas<d>(shear_rate, 0.1));
        auto& simulation = both.back();
        simulation.time = 0.7;
        simulation.pair_search.search = search;
        forces(simulation, soft);
        double const scale = simulation.force.abs().sum();
        BOOST_TEST(simulation.force.colwise().sum().abs().maxCoeff() < 1e-15 * scale);
        BOOST_TEST((simulation.pairs().crossing.empty()) == (shear_rate == 0.0));
    }
    BOOST_TEST((by_id(both[0], both[0].force) == by_id(both[1], both[1].force)).all());
    BOOST_TEST(both[0].pair_virials.potential == both[1].pair_virials.potential);

    // every force is minus the derivative of the total energy by its particle's position
    auto simulation = both[1];
    Field<d> const force = simulation.force;
    double const h = 1e-5;
    for (Eigen::Index p = 0; p < 5; ++p)
        for (int axis = 0; axis < d; ++axis) {
            double& x = simulation.particles.position(p, axis);
            double const at = x;
            auto const energy_at = [&](double there) {
                x = there;
                simulation.positions_changed();
                return potential_sums(simulation, soft).energy;
            };
            BOOST_TEST(std::abs(force(p, axis) - (energy_at(at - h) - energy_at(at + h)) / (2.0 * h)) < 2e-3);
            x = at;
        }
}

BOOST_DATA_TEST_CASE(forces_do_not_depend_on_the_search_and_add_up_to_nothing, data::make({0.0, 0.4}),
                     shear_rate) {
    check_force_sums<2>(shear_rate);
    check_force_sums<3>(shear_rate);
}

// Both virials are derivatives of the energy: by the volume, and by a shear strain of box and particles.
BOOST_DATA_TEST_CASE(virials_are_derivatives_of_the_energy, data::make({0.0, 0.4}), shear_rate) {
    auto const start = [&] {
        auto simulation = gas<3>({5.0, 6.0, 4.0}, 360, shear_rate, 0.1);
        simulation.time = 0.7;
        return simulation;
    };
    auto at = start();
    auto const sums = potential_sums(at, soft);
    forces(at, soft);  // finds the virial of the shear stress
    auto const scaled = [&](double e) {
        auto simulation = start();
        simulation.box.length *= 1.0 + e;
        simulation.particles.position *= 1.0 + e;
        return potential_sums(simulation, soft).energy;
    };
    auto const strained = [&](double e) {
        auto simulation = start();
        simulation.box.shear_rate = 0.4;
        simulation.time = (shear_rate * 0.7 + e) / 0.4;
        simulation.particles.position.col(0) += e * simulation.particles.position.col(1);
        simulation.box.wrap(simulation.particles, simulation.time);
        return potential_sums(simulation, soft).energy;
    };
    double const h = 1e-6;
    BOOST_TEST((scaled(h) - scaled(-h)) / (2.0 * h) == -sums.virial, tolerance(1e-6));
    BOOST_TEST(std::abs((strained(h) - strained(-h)) / (2.0 * h) + at.pair_virials.potential) <
               1e-6 * sums.virial);
    BOOST_TEST(std::abs(at.pair_virials.potential) > 1e-3 * sums.virial);
}

// --- Verlet ----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(one_verlet_step_by_hand) {
    double const m = 2.5, dt = 0.13, L = 4.0;
    Soft const potential{.strength = 6.0, .cutoff = 1.4};
    auto simulation = gas<2>({L, L}, 6, 0.0, dt, m);
    auto& p = simulation.particles;
    p.position << 0.1, 0.2, 3.8, 0.5, 0.6, 3.9, 1.0, 1.0, 2.5, 2.4, 1.2, 0.1;
    Field<2> x = p.position, v = p.velocity;
    auto const force_at = [&](Field<2> const& at) {
        Field<2> force = Field<2>::Zero(6, 2);
        for (Eigen::Index i = 0; i < 6; ++i)
            for (Eigen::Index j = 0; j < 6; ++j) {
                Eigen::Array2d s = (at.row(i) - at.row(j)).transpose();
                s -= L * (s / L).round();
                double const r = std::hypot(s[0], s[1]);
                if (i != j && r < 1.4) force.row(i) += (6.0 / 1.4 * (1.0 - r / 1.4) / r * s).transpose();
            }
        return force;
    };
    BOOST_TEST((force_at(x).abs().rowwise().sum() > 0.0).count() == 5);
    v += 0.5 * dt / m * force_at(x);
    x += dt * v;
    v += 0.5 * dt / m * force_at(x);
    simulation.pair_search.cutoff = 1.4;
    simulation.stages = {Verlet{.potential = potential}};
    simulation.advance();
    BOOST_TEST((unwrapped(simulation) - x).abs().maxCoeff() < 1e-14);
    BOOST_TEST((by_id(simulation, p.velocity) - v).abs().maxCoeff() < 1e-14);
    BOOST_TEST(simulation.time == dt);
}

// Two steps, so that the force of the first step's end begins the second; lambda is not 1/2, so that the
// predicted velocity is not that of the drift.
BOOST_AUTO_TEST_CASE(two_modified_verlet_steps_by_hand) {
    double const m = 2.5, dt = 0.13, L = 4.0, lambda = 0.65, gamma = 3.0, sigma = 1.5, cutoff = 1.3;
    auto simulation = gas<2>({L, L}, 6, 0.0, dt, m);
    auto& p = simulation.particles;
    p.position << 0.1, 0.2, 3.8, 0.5, 0.6, 3.9, 1.0, 1.0, 2.5, 2.4, 1.2, 0.1;
    Field<2> x = p.position, v = p.velocity;
    auto const force_at = [&](Field<2> const& at, Field<2> const& speed, NoiseKey key) {
        Field<2> force = Field<2>::Zero(6, 2);
        for (std::uint32_t i = 0; i < 6; ++i)
            for (std::uint32_t j = 0; j < 6; ++j) {
                Eigen::Array2d e = (at.row(i) - at.row(j)).transpose();
                e -= L * (e / L).round();
                double const r = std::hypot(e[0], e[1]);
                e /= r;
                double f = i != j && r < 1.4 ? 6.0 / 1.4 * (1.0 - r / 1.4) : 0.0;
                if (i != j && r < cutoff) {
                    double const w = 1.0 - r / cutoff;
                    double const u = ((speed.row(i) - speed.row(j)).transpose() * e).sum();
                    f += -gamma * w * w * u +
                         sigma * w * normal(key, std::min(i, j), std::max(i, j)) / std::sqrt(dt);
                }
                if (i != j) force.row(i) += (f * e).transpose();
            }
        return force;
    };
    Field<2> f = force_at(x, v, {1, 0, 0, 1});
    for (std::uint64_t step = 0; step < 2; ++step) {
        x += dt * (v + 0.5 * dt / m * f);
        Field<2> const next = force_at(x, v + lambda * dt / m * f, {1, step, 0});
        v += 0.5 * dt / m * (f + next);
        f = next;
    }
    simulation.pair_search.cutoff = 1.4;
    ModifiedVerlet stage;
    stage.potential = Soft{.strength = 6.0, .cutoff = 1.4};
    stage.gamma = gamma;
    stage.sigma = sigma;
    stage.cutoff = cutoff;
    stage.lambda = lambda;
    simulation.stages = {stage};
    advance(simulation, 2);
    BOOST_TEST((unwrapped(simulation) - x).abs().maxCoeff() < 1e-13);
    BOOST_TEST((by_id(simulation, p.velocity) - v).abs().maxCoeff() < 1e-13);
    BOOST_TEST(simulation.counters.searches == 3u);
}

// Without friction and noise it is velocity-Verlet, whatever lambda, and so are its stresses.
BOOST_DATA_TEST_CASE(modified_verlet_without_thermostat_is_verlet,
                     data::make({0.0, 0.4}) * data::make({0.5, 0.65}), shear_rate, lambda) {
    auto plain = small_gas<3>(shear_rate, 0.02), modified = plain;
    ModifiedVerlet stage;
    stage.potential = soft;
    stage.gamma = stage.sigma = 0.0;
    stage.lambda = lambda;
    plain.stages = {Verlet{.potential = soft}};
    modified.stages = {stage};
    plain.stage_stress.wanted = modified.stage_stress.wanted = true;
    advance(plain, 40);
    advance(modified, 40);
    check_same_motion(plain, modified, 1e-9);
    BOOST_TEST(plain.stage_stress.kinetic == modified.stage_stress.kinetic, tolerance(1e-9));
    BOOST_TEST(plain.stage_stress.potential == modified.stage_stress.potential, tolerance(1e-9));
    BOOST_TEST(modified.stage_stress.collision == 0.0);
}

// Without a potential and with lambda = 1/2 it moves the particles as Euler with the new momentum does. Let
// u_n = v_n - (dt/2m) F_n be the velocity of the drift to x_n. The next drift, to x_n + dt u_(n+1), has
//     u_(n+1) = v_n + (dt/2m) F_n = u_n + (dt/m) F_n,
// and as lambda = 1/2 predicts nothing, F_n is friction and noise at x_n with this very u_n: the impulse dt
// F_n, and its noise sigma dt^(1/2), are those of "euler" in the state (x_n, u_n), followed by "kick" and
// "drift". The first force alone is another one: it sees v_0, and u_1 = v_0 + (dt/2m) F_0 has got half a
// kick. So Euler starts from (x_1, u_1), and from step 0: step n-1 of modified Verlet draws the noise of F_n,
// and step n-1 of Euler uses it. Positions are then the same, and velocities differ by half a kick.
BOOST_DATA_TEST_CASE(modified_verlet_at_one_half_is_euler_half_a_kick_later,
                     data::make({0.0, 1.5}) * data::make({"quadratic", "linear"}), sigma, name) {
    Weight const weight = *value_of<Weight::Kind>(name);
    double const dt = 0.05, m = 1.3, gamma = 3.0;
    auto modified = small_gas<3>(0.0, dt, m);
    ModifiedVerlet stage;
    stage.gamma = gamma;
    stage.sigma = sigma;
    stage.weight = weight;
    stage.cutoff = 0.9;
    stage.lambda = 0.5;
    modified.stages = {stage};
    modified.advance();
    auto euler = modified;
    euler.particles.velocity -= 0.5 * dt / m * modified.force;
    euler.step = 0;
    euler.stages = {EulerImpulses{.gamma = gamma, .sigma = sigma, .weight = weight, .cutoff = 0.9}, Kick{},
                    Drift{}};
    auto const start = unwrapped(euler);
    for (int step = 0; step < 40; ++step) {
        modified.advance();
        euler.advance();
        BOOST_TEST((unwrapped(modified) - unwrapped(euler)).abs().maxCoeff() < 1e-11);
        auto at_half = modified;
        at_half.particles.velocity -= 0.5 * dt / m * modified.force;
        check_same_motion(at_half, euler, 1e-11);
        BOOST_TEST((by_id(modified, modified.particles.velocity) - by_id(euler, euler.particles.velocity))
                       .abs()
                       .maxCoeff() > 1e-3);
    }
    BOOST_TEST((unwrapped(euler) - start).abs().maxCoeff() > 1.0);
}

BOOST_AUTO_TEST_CASE(lennard_jones_derivatives_and_shift) {
    LennardJones const lj{.epsilon = 1.7, .sigma = 0.9, .cutoff = 2.3, .shifted = true};
    LennardJones plain = lj;
    plain.shifted = false;
    BOOST_TEST(lj.energy(2.3) == 0.0, tolerance(1e-15));
    BOOST_TEST(plain.energy(std::pow(2.0, 1.0 / 6.0) * 0.9) == -1.7, tolerance(1e-14));
    BOOST_TEST(std::abs(lj.force(std::pow(2.0, 1.0 / 6.0) * 0.9)) < 1e-13);
    for (double const r : {0.85, 1.1, 1.6, 2.2}) {
        double const h = 1e-5;
        BOOST_TEST(lj.force(r) == -(lj.energy(r + h) - lj.energy(r - h)) / (2.0 * h), tolerance(1e-7));
        BOOST_TEST(lj.curvature(r) == -(lj.force(r + h) - lj.force(r - h)) / (2.0 * h), tolerance(1e-7));
        BOOST_TEST(lj.force(r) == plain.force(r));
    }
}

BOOST_AUTO_TEST_CASE(particles_start_where_asked) {
    auto simulation = gas<3>({4.0, 6.0, 5.0}, 100, 0.0, 0.1);
    randomize(simulation.particles, simulation.box, 1.0, 1, Start::dense);
    for (int axis = 0; axis < 3; ++axis) {
        auto const x = simulation.particles.position.col(axis) / simulation.box.length[axis];
        BOOST_TEST((x >= 0.0 && x < 0.5).all());
    }
    randomize(simulation.particles, simulation.box, 1.0, 1, Start::lattice);
    simulation.pair_search.cutoff = 0.8;  // 4 x 6 x 5 sites are 1 apart; 100 particles on 120 sites
    simulation.positions_changed();
    BOOST_TEST(simulation.pairs().count == 0u);
    BOOST_TEST(simulation.particles.position.colwise().minCoeff().minCoeff() > 0.0);
}

BOOST_DATA_TEST_CASE(ten_substeps_are_ten_short_steps, data::make({0.0, 0.4}), shear_rate) {
    auto coarse = small_gas<3>(shear_rate, 0.1), fine = small_gas<3>(shear_rate, 0.01);
    coarse.stages = {Verlet{.potential = soft, .substeps = 10}};
    fine.stages = {Verlet{.potential = soft}};
    advance(coarse, 3);
    advance(fine, 30);
    check_same_motion(coarse, fine, 1e-11);
    BOOST_TEST(coarse.time == fine.time, tolerance(1e-15));
    BOOST_TEST(coarse.time == 0.3, tolerance(1e-15));
    BOOST_TEST(coarse.counters.searches == 31u);
}

BOOST_AUTO_TEST_CASE(verlet_is_reversible_and_conserves_momentum) {
    auto simulation = small_gas<3>(0.0, 0.02, 1.5);
    auto const start = simulation;
    simulation.stages = {Verlet{.potential = soft, .substeps = 2}};
    advance(simulation, 50);
    BOOST_TEST((unwrapped(simulation) - unwrapped(start)).abs().maxCoeff() > 1.0);
    BOOST_TEST(total_momentum(simulation.particles, simulation.box).norm() < 1e-12);
    simulation.particles.velocity *= -1.0;
    advance(simulation, 50);
    simulation.particles.velocity *= -1.0;
    check_same_motion(simulation, start, 1e-10);
}

BOOST_AUTO_TEST_CASE(energy_error_of_verlet_is_of_second_order) {
    auto start = gas<3>({5.0, 5.0, 5.0}, 375, 0.0, 0.02);
    start.stages = {Shardlow{.friction = 4.5}, Verlet{.potential = soft}};
    advance(start, 200);
    auto const deviation = [&](double time_step) {
        auto simulation = start;
        simulation.step = 0;
        simulation.time_step = time_step;
        simulation.stages.erase(simulation.stages.begin());
        double const before = energy(simulation);
        double sum = 0.0;
        auto const steps = static_cast<int>(std::lround(1.0 / time_step));
        for (int step = 0; step < steps; ++step) {
            simulation.advance();
            sum += std::pow(energy(simulation) - before, 2);
        }
        return std::sqrt(sum / steps);
    };
    double const coarse = deviation(0.01), fine = deviation(0.005);
    BOOST_TEST(coarse < 1e-2 * 375.0);
    BOOST_TEST(coarse / fine > 3.5);
    BOOST_TEST(coarse / fine < 4.5);
}

BOOST_AUTO_TEST_CASE(without_a_potential_verlet_is_the_drift) {
    for (double const shear_rate : {0.0, 0.4}) {
        auto drift = small_gas<3>(shear_rate, 0.3), verlet = drift;
        drift.stages = {Shardlow{}, Drift{}};
        verlet.stages = {Shardlow{}, Verlet{}};
        advance(drift, 50);
        advance(verlet, 50);
        check_same_motion(drift, verlet, 0.0);
    }
}

// Stages that hand something on do so whatever happens to the rows in between: the brute force search never
// sorts them.
BOOST_DATA_TEST_CASE(the_search_does_not_show, data::make({"lowe", "euler", "rescale", "modified_verlet"}),
                     method) {
    std::vector<Simulation<3>> both;
    for (Search const search : {Search::cell, Search::brute}) {
        auto simulation = small_gas<3>(0.4, 0.02);
        simulation.pair_search.search = search;
        Stage<3> const verlet{Verlet{.potential = soft, .substeps = 3}};
        if (method == std::string("lowe")) simulation.stages = {Lowe{.rate = 75.0}, verlet};
        if (method == std::string("rescale")) simulation.stages = {verlet, Rescale{}};
        if (method == std::string("euler")) simulation.stages = {EulerImpulses{}, verlet, Kick{}};
        if (method == std::string("modified_verlet")) {
            ModifiedVerlet stage;
            stage.potential = soft;
            stage.lambda = 0.65;  // leaves impulses waiting while the rows are sorted
            simulation.stages = {stage};
        }
        advance(simulation, 20);
        both.push_back(simulation);
    }
    check_same_motion(both[0], both[1], 1e-8);
}

BOOST_AUTO_TEST_CASE(body_force_accelerates_along_x) {
    for (bool const opposed : {false, true}) {
        auto simulation = small_gas<2>(0.0, 0.2);
        Field<2> expected = simulation.particles.velocity;
        for (Eigen::Index p = 0; p < expected.rows(); ++p)
            expected(p, 0) += opposed && simulation.particles.position(p, 1) >= 2.5 ? -0.06 : 0.06;
        act(BodyForce{.acceleration = 0.3, .opposed = opposed}, simulation, {});
        BOOST_TEST((simulation.particles.velocity - expected).abs().maxCoeff() < 1e-15);
    }
}

// --- rescaling -------------------------------------------------------------------------------------------

namespace {

// A cell of Rescale's lattice, found independently: the lattice begins at minus its shift, and each particle
// has one image in it.
template <int d>
struct Cell {
    std::vector<Eigen::Index> rows;
    std::vector<double> y;         // of the images
    std::vector<Vec<d>> velocity;  // of the images
    Vec<d> mean = Vec<d>::Zero();
    double square = 0.0;  // sum of |u|^2
    double free() const { return d * (double(rows.size()) - 1.0); }
};

template <int d>
using Cells = std::map<std::array<long, d>, Cell<d>>;

template <int d>
Cells<d> cells_of(Simulation<d> const& simulation, NoiseKey key, double side) {
    auto const& [p, box] = std::tie(simulation.particles, simulation.box);
    Cells<d> cells;
    for (Eigen::Index row = 0; row < p.size(); ++row) {
        Vec<d> x = p.position.row(row).transpose(), v = p.velocity.row(row).transpose();
        std::array<long, d> where{};
        for (int axis : {1, 0, 2}) {
            if (axis >= d) continue;
            double const shift = side * uniform(key, static_cast<std::uint32_t>(axis), 0);
            double const turns = std::floor((x[axis] + shift) / box.length[axis]);
            x[axis] -= turns * box.length[axis];
            if (axis == 1) {
                x[0] -= turns * box.offset(simulation.time);
                v[0] -= turns * box.image_speed();
            }
            where[std::size_t(axis)] = long(std::floor((x[axis] + shift) / side));
        }
        Cell<d>& cell = cells[where];
        cell.rows.push_back(row);
        cell.y.push_back(x[1]);
        cell.velocity.push_back(v);
    }
    for (auto& [where, cell] : cells) {
        for (auto const& v : cell.velocity) cell.mean += v / double(cell.rows.size());
        for (auto const& v : cell.velocity) cell.square += (v - cell.mean).squaredNorm();
    }
    return cells;
}

Rescaling rescaling_of(std::string_view name) { return *value_of<Rescaling>(name); }

template <int d>
void check_rescaling(std::string_view name, double shear_rate, double side, std::uint64_t thickness) {
    double const m = 1.7, kT = 0.6;
    Rescaling const mode = rescaling_of(name);
    NoiseKey const key{5, 9, 2};
    auto simulation = small_gas<d>(shear_rate, 0.1, m);
    simulation.time = 2.9;
    Rescale rescale;
    rescale.mode = mode;
    rescale.kT = kT;
    rescale.cell = side;
    rescale.thickness = thickness;
    rescale.amplitude = 0.3;
    auto boosted = simulation;
    auto const before = cells_of(simulation, key, side);
    act(rescale, simulation, key);
    auto const after = cells_of(simulation, key, side);

    std::map<long, double> square, free;  // by layer; the whole is one layer
    std::vector<double> factors;
    std::map<long, double> shared;  // factor by layer
    for (auto const& [where, cell] : after) {
        auto const& old = before.at(where);
        BOOST_REQUIRE((cell.rows == old.rows));
        BOOST_TEST((cell.mean - old.mean).norm() < 1e-13);
        long const layer = mode == Rescaling::layers ? where[1] / long(thickness) : 0;
        square[layer] += m * cell.square;
        free[layer] += cell.free();
        if (cell.rows.size() < 2) continue;
        double const factor = factors.emplace_back(std::sqrt(cell.square / old.square));
        if (mode != Rescaling::monte_carlo)
            BOOST_TEST(shared.emplace(layer, factor).first->second == factor, tolerance(1e-12));
        for (std::size_t k = 0; k < cell.rows.size(); ++k)
            BOOST_TEST((cell.velocity[k] - cell.mean - factor * (old.velocity[k] - old.mean)).norm() < 1e-13);
    }
    BOOST_TEST(factors.size() > 5u);
    auto const [least, most] = std::minmax_element(factors.begin(), factors.end());
    if (mode == Rescaling::monte_carlo) {
        BOOST_TEST(*most <= 1.3 * (1.0 + 1e-12));
        BOOST_TEST(*least >= (1.0 - 1e-12) / 1.3);
    } else {
        for (auto const& [layer, sum] : square) BOOST_TEST(sum == free[layer] * kT, tolerance(1e-12));
        BOOST_TEST(square.size() ==
                   (mode == Rescaling::layers ? std::ceil(std::round(5.0 / side) / double(thickness)) : 1.0));
    }
    if (mode != Rescaling::global) BOOST_TEST(*most - *least > 1e-3);

    // as seen from a moving frame
    Eigen::Array<double, 1, d> const frame = Eigen::Array<double, 1, d>::LinSpaced(-1.0, 2.5);
    boosted.particles.velocity.rowwise() += frame;
    act(rescale, boosted, key);
    boosted.particles.velocity.rowwise() -= frame;
    check_same_motion(boosted, simulation, 1e-13);
}

}  // namespace

BOOST_DATA_TEST_CASE(rescaling_by_hand,
                     data::make(names<Rescaling>) * data::make({0.0, 0.4}) * data::make({1, 2}), name,
                     shear_rate, thickness) {
    check_rescaling<2>(name, shear_rate, 1.0, std::uint64_t(thickness));
    check_rescaling<3>(name, shear_rate, 1.0, std::uint64_t(thickness));
    check_rescaling<3>(name, shear_rate, 0.5, std::uint64_t(thickness));  // most particles are alone
}

BOOST_DATA_TEST_CASE(rescaling_of_two_particles_and_a_lone_one, data::make(names<Rescaling>), name) {
    Rescale rescale;
    rescale.mode = rescaling_of(name);
    int alone = 0, together = 0;
    for (std::uint64_t step = 0; step < 40; ++step) {
        auto simulation = gas<3>({5.0, 5.0, 5.0}, 3, 0.0, 0.1);
        auto& p = simulation.particles;
        p.position << 1.0, 1.0, 1.0, 1.2, 1.1, 1.3, 3.5, 4.5, 0.5;
        Field<3> const before = p.velocity;
        act(rescale, simulation, {3, step, 0});
        auto const cells = cells_of(simulation, {3, step, 0}, 1.0);
        BOOST_TEST((p.velocity.row(2) == before.row(2)).all());
        ++(cells.size() == 3 ? alone : together);
        if (cells.size() == 3) BOOST_TEST((p.velocity == before).all());
        if (cells.size() == 2 && rescale.mode != Rescaling::monte_carlo)
            BOOST_TEST((p.velocity.row(0) - p.velocity.row(1)).square().sum() == 6.0, tolerance(1e-13));
        BOOST_TEST((p.velocity.colwise().sum() - before.colwise().sum()).abs().maxCoeff() < 1e-14);
    }
    BOOST_TEST(alone > 5);
    BOOST_TEST(together > 5);
}

BOOST_AUTO_TEST_CASE(a_cold_gas_stays_cold_when_rescaled) {
    auto simulation = small_gas<3>(0.0, 0.1);
    simulation.particles.velocity.setZero();
    act(Rescale{}, simulation, {});
    BOOST_TEST((simulation.particles.velocity == 0.0).all());
}

// A cell of n particles gets the canonical chi-square distribution: mean d(n-1), variance twice that.
BOOST_AUTO_TEST_CASE(monte_carlo_rescaling_finds_the_canonical_distribution) {
    double const m = 1.7, kT = 0.6;
    auto simulation = gas<3>({6.0, 6.0, 6.0}, 648, 0.0, 0.5, m, 2.0 * kT);
    Rescale rescale;
    rescale.mode = Rescaling::monte_carlo;
    rescale.kT = kT;
    rescale.amplitude = 0.5;
    simulation.stages = {Drift{}, rescale};
    constexpr std::size_t least = 2, most = 6;
    std::vector<double> mean[most + 1], variance[most + 1];
    for (std::uint64_t step = 0; step < 2200; ++step) {
        simulation.advance();
        if (step < 200) continue;
        double count[most + 1] = {}, sum[most + 1] = {}, squares[most + 1] = {};
        for (auto const& [where, cell] : cells_of(simulation, {1, step, 1}, 1.0)) {
            std::size_t const n = cell.rows.size();
            if (n > most) continue;
            double const x = m * cell.square / kT - cell.free();
            count[n] += 1.0;
            sum[n] += x / cell.free();
            squares[n] += x * x / (2.0 * cell.free());
        }
        for (std::size_t n = least; n <= most; ++n) {
            mean[n].push_back(sum[n] / count[n]);
            variance[n].push_back(squares[n] / count[n]);
        }
    }
    for (std::size_t n = least; n <= most; ++n) {
        check_equal(blocking(mean[n]), 0.0, 0.006);
        check_equal(blocking(variance[n]), 1.0, 0.015);
    }
}

// --- stress against counted momentum ---------------------------------------------------------------------

// Counts the x momentum that passes each of many planes of constant y, in the frame of the flow there: pairs
// hand it along the line between them, particles carry it, and a cell of Rescale moves it within. The mean
// over planes is what the estimators give, up to the planes' finite distance. Without the substeps'
// streaming term the kinetic stress would be off by n kT rate span/2 = 0.03; with it that of the whole step,
// by 0.1.
BOOST_DATA_TEST_CASE(stresses_equal_the_momentum_through_planes, data::make({0.0, 0.4}), rate) {
    constexpr int substeps = 4;
    double const dt = 0.2, span = dt / substeps, L = 8.0, planes = 1e5, m = 1.3;
    double const gap = L / planes, per_plane = -1.0 / (planes * 25.0 * dt), kick = 0.5 * span / m;
    auto simulation = gas<3>({5.0, L, 5.0}, 600, rate, dt, m);
    auto const planes_below = [&](double y) { return std::floor(y / gap - 0.5) + 1.0; };
    auto const through_pairs = [&](auto&& momentum) {
        auto const& pairs = simulation.pairs();
        double sum = 0.0;
        for (std::size_t k = 0; k < pairs.count; ++k) {
            double const y_i = simulation.particles.position(pairs.i[k], 1);
            double const y_j = y_i - pairs.unit[1][k] * pairs.distance[k];
            sum += momentum(k) * pairs.unit[0][k] * (planes_below(y_i) - planes_below(y_j));
        }
        return sum * per_plane;
    };
    auto const by_half_a_force = [&](std::size_t k) {
        return 0.5 * span * std::max(0.0, soft.force(simulation.pairs().distance[k]));
    };
    for (std::uint64_t step = 0; step < 8; ++step) {
        auto& p = simulation.particles;
        simulation.step = step;
        simulation.time_step = dt;
        act(Lowe{.rate = 2.5 / dt}, simulation, {1, step, 0});
        double const collisions =
            through_pairs([&](std::size_t k) { return m * simulation.pairs().impulse[k]; });
        BOOST_TEST(std::abs(collision_stress(simulation.pairs(), m, simulation.box, dt) - collisions) < 1e-3);

        auto whole = simulation;
        act(Verlet{.potential = soft, .substeps = substeps}, whole, {});
        double kinetic = 0.0, potential = 0.0;
        simulation.time_step = span;
        for (std::uint64_t s = 0; s < substeps; ++s) {
            simulation.step = substeps * step + s;
            Field<3> const v = p.velocity + kick * forces(simulation, soft);
            potential += through_pairs(by_half_a_force);
            for (Eigen::Index i = 0; i < p.size(); ++i) {
                double const from = planes_below(p.position(i, 1)),
                             to = planes_below(p.position(i, 1) + v(i, 1) * span);
                // the planes from .. to-1 upwards, or from-1 .. to downwards; plane q at (q + 1/2) gap
                double const passed = to - from, middle = 0.5 * (from + to) * gap;
                kinetic += m * passed * (v(i, 0) - simulation.box.flow_velocity(middle)) * per_plane;
            }
            act(Verlet{.potential = soft}, simulation, {});
            potential += through_pairs(by_half_a_force);
        }
        BOOST_TEST(whole.stage_stress.streamed);
        BOOST_TEST(std::abs(whole.stage_stress.kinetic - kinetic) < 4e-3);
        BOOST_TEST(std::abs(whole.stage_stress.potential - potential) < 1e-3);

        simulation.time_step = dt;
        NoiseKey const key{1, step, 2};
        auto const before = cells_of(simulation, key, 1.0);
        Field<3> const old = p.velocity;
        Rescale rescale;
        rescale.kT = 1.5;
        act(rescale, simulation, key);
        double moved = 0.0;
        for (auto const& [where, cell] : before)
            for (std::size_t k = 0; k < cell.rows.size(); ++k)
                moved += m * (p.velocity(cell.rows[k], 0) - old(cell.rows[k], 0)) * planes_below(cell.y[k]);
        BOOST_TEST(std::abs(simulation.stage_stress.rescaling - moved * per_plane) < 1e-3);
        BOOST_TEST(std::abs(simulation.stage_stress.rescaling) > 1e-3);
    }
}

// --- Lowe and the schemes --------------------------------------------------------------------------------

namespace {

// Lowe's sweeps one pair after another, with scalar noise; the changes of velocity by pair.
template <int d>
std::vector<double> sweep_by_hand(Simulation<d>& simulation, NoiseKey key, double updates, double kT) {
    auto const& pairs = simulation.pairs();
    auto& p = simulation.particles;
    std::vector<double> impulse(pairs.count, 0.0);
    for (std::uint8_t sweep = 0; updates - sweep > 0.0; ++sweep)
        for (std::size_t k = 0; k < pairs.count; ++k) {
            auto const i = pairs.i[k], j = pairs.j[k];
            auto const [a, b] = std::minmax(p.id[i], p.id[j]);
            NoiseKey lot = key, gauss = key;
            gauss.sweep = sweep;
            lot.sweep = static_cast<std::uint8_t>(128 + sweep);
            if (updates - sweep < 1.0 && uniform(lot, a, b) >= updates - sweep) continue;
            Eigen::Array<double, 1, d> e;
            for (int axis = 0; axis < d; ++axis) e[axis] = pairs.unit[std::size_t(axis)][k];
            double approach = ((p.velocity.row(i) - p.velocity.row(j)) * e).sum();
            if (crosses(pairs, k)) approach -= simulation.box.image_speed() * e[0];
            // a new approach from the Maxwell distribution, of variance 2 kT/m
            double const change = 0.5 * (std::sqrt(2.0 * kT / p.mass) * normal(gauss, a, b) - approach);
            p.velocity.row(i) += change * e;
            p.velocity.row(j) -= change * e;
            impulse[k] += change;
        }
    return impulse;
}

template <int d>
void check_sweeps(double updates, double shear_rate) {
    double const dt = 0.25, kT = 0.7;
    NoiseKey const key{1, 12, 3};
    auto simulation = small_gas<d>(shear_rate, dt, 1.8);
    simulation.time = 2.9;
    auto by_hand = simulation;
    auto const expected = sweep_by_hand(by_hand, key, updates, kT);
    act(Lowe{.rate = updates / dt, .kT = kT}, simulation, key);
    check_same_motion(simulation, by_hand, 1e-13);
    auto const& pairs = simulation.pairs();
    BOOST_REQUIRE_EQUAL(pairs.count, expected.size());
    BOOST_TEST(pairs.crossing.empty() == (shear_rate == 0.0));
    BOOST_TEST(pairs.updated);
    double updated = 0.0;
    for (std::size_t k = 0; k < pairs.count; ++k) {
        BOOST_TEST(std::abs(pairs.impulse[k] - expected[k]) < 1e-13);
        updated += pairs.impulse[k] != 0.0;
    }
    double const n = double(pairs.count), p = std::min(updates, 1.0);
    BOOST_TEST(std::abs(updated - n * p) <= false_alarm_bound * std::sqrt(n * p * (1.0 - p)));
    Vec<d> const change = (total_momentum(simulation.particles, simulation.box) -
                           total_momentum(small_gas<d>(shear_rate, dt, 1.8).particles, simulation.box));
    BOOST_TEST(change.norm() < 1e-12);
}

}  // namespace

BOOST_DATA_TEST_CASE(lowe_sweeps_by_hand, data::make({0.0, 0.3, 1.0, 2.5, 3.0}) * data::make({0.0, 0.4}),
                     updates, shear_rate) {
    check_sweeps<2>(updates, shear_rate);
    check_sweeps<3>(updates, shear_rate);
}

// One pair obeys a Langevin equation along its line, which `exponential` solves exactly; the others are what
// their definitions say. All keep the variance 2 kT/m of the approach.
BOOST_DATA_TEST_CASE(schemes_of_one_pair,
                     data::make({"shardlow", "exponential", "linear"}) * data::make({0.01, 0.5, 0.9, 20.0}),
                     name, friction) {
    Scheme const scheme = *value_of<Scheme>(name);
    double const m = 2.5, dt = 0.8, kT = 1.7, a = friction * dt / m;  // at constant weight
    if (scheme == Scheme::linear && a > 1.0) return;
    double const kept = scheme == Scheme::exponential ? std::exp(-2.0 * a)
                        : scheme == Scheme::shardlow  ? (1.0 - a) / (1.0 + a)
                                                      : 1.0 - 2.0 * a;
    double const A = update_a(scheme, a);
    BOOST_TEST(std::abs(1.0 - 2.0 * A - kept) < 1e-15);
    BOOST_TEST(kept * kept + 4.0 * m * std::pow(update_b(A, m), 2) == 1.0, tolerance(1e-13));
    auto simulation = gas<2>({5.0, 5.0}, 2, 0.0, dt, m);
    auto& p = simulation.particles;
    p.position << 1.0, 1.0, 1.3, 1.4;
    auto const approach = [&] {
        return -0.6 * (p.velocity(0, 0) - p.velocity(1, 0)) - 0.8 * (p.velocity(0, 1) - p.velocity(1, 1));
    };
    double const before = approach();
    act(Shardlow{.friction = friction, .weight = Weight::constant, .scheme = scheme, .kT = kT}, simulation,
        {1, 4, 2});
    double const noise = std::sqrt((1.0 - kept * kept) * 2.0 * kT / m) * normal({1, 4, 2}, 0, 1);
    BOOST_TEST(approach() == kept * before + noise, tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(the_linear_scheme_is_refused_beyond_its_step) {
    std::vector<std::string> const at_limit{"shardlow.scheme=linear", "particles.mass=2",
                                            "shardlow.friction=20"};
    BOOST_CHECK_NO_THROW(scene("'shardlow', 'drift'", at_limit));
    auto beyond = at_limit;
    beyond.push_back("time.step=0.11");
    BOOST_CHECK_EXCEPTION(scene("'shardlow', 'drift'", beyond), InputError, [](InputError const& error) {
        std::string const message = error.what();
        BOOST_TEST_MESSAGE(message);
        return message.find("friction") != std::string::npos &&
               message.find("\"linear\"") != std::string::npos && message.find('\n') == std::string::npos;
    });
}

// An ideal gas keeps kT and g(r) = 1 at any step, mass, and rate.
BOOST_DATA_TEST_CASE(thermostats_keep_temperature_and_structure,
                     data::make({"lowe.rate=0.1", "lowe.rate=1", "lowe.rate=5", "shardlow.scheme=exponential",
                                 "shardlow.scheme=linear", "rescale.mode=global", "rescale.mode=layers",
                                 "rescale.mode=monte_carlo"}),
                     assignment) {
    std::string const text = assignment, stage = text.substr(0, text.find('.'));
    auto const parsed =
        scene("'" + stage + "', 'sample', 'drift'",
              {stage == "shardlow" ? "shardlow.friction=2" : "title=other", text, stage + ".kT=1.5",
               "particles.mass=2", "particles.kT=1.5", "time.step=1", "time.duration=800",
               "sample.observables=['kinetic_temperature']", "sample.radial_distribution.range=1",
               "sample.radial_distribution.interval=4", "sample.radial_distribution.bins=10"});
    auto const quantities = analyze(parsed, {run(parsed).record});
    check_equal(find_quantity(quantities, "kinetic_temperature")->estimate, 1.5, 0.02);
    check_equal(find_quantity(quantities, "pair_density")->estimate, 1.0, 0.01);
}

// --- noise -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(lots_are_uniform_and_independent_of_the_normals) {
    constexpr std::size_t n = 200'000;
    std::vector<std::uint32_t> id(1000), i, j;
    for (std::uint32_t k = 0; k < 1000; ++k) id[k] = (k * 7919u) % 1000u;
    for (std::uint32_t a = 0; a < 1000 && i.size() < n; ++a)
        for (std::uint32_t b = 0; b < a && i.size() < n; ++b)
            i.push_back(b % 2 ? a : b), j.push_back(b % 2 ? b : a);
    std::vector<double> u(n), other(n);
    NoiseKey const key{42, (std::uint64_t{1} << 40) + 3, 7, 0x80};
    pair_uniforms(key, i, j, id.data(), u);
    double mean = 0.0, square = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        auto const [a, b] = std::minmax(id[i[k]], id[j[k]]);
        BOOST_REQUIRE(u[k] == uniform(key, a, b));
        BOOST_REQUIRE((u[k] >= 0.0 && u[k] < 1.0));
        u[k] = (u[k] - 0.5) * std::sqrt(12.0);
        mean += u[k] / std::sqrt(double(n));
        square += (u[k] * u[k] - 1.0) / std::sqrt(double(n) * 0.8);
    }
    BOOST_TEST(std::abs(mean) < false_alarm_bound);
    BOOST_TEST(std::abs(square) < false_alarm_bound);
    auto const correlation = [&](auto&& value) {
        double sum = 0.0;
        for (std::size_t k = 0; k < n; ++k) sum += u[k] * value(other[k]);
        return std::abs(sum) / std::sqrt(double(n));
    };
    auto const itself = [](double x) { return x; };
    auto const squared = [](double x) { return (x * x - 1.0) / std::numbers::sqrt2; };
    for (std::uint8_t sweep = 0; sweep < 3; ++sweep) {  // as Lowe draws them
        NoiseKey at = key;
        at.sweep = sweep;
        pair_normals(at, i, j, id.data(), other);
        BOOST_TEST(correlation(itself) < false_alarm_bound);
        BOOST_TEST(correlation(squared) < false_alarm_bound);
        at.sweep = static_cast<std::uint8_t>(0x81 + sweep);
        pair_uniforms(at, i, j, id.data(), other);
        BOOST_TEST(correlation([](double x) { return (x - 0.5) * std::sqrt(12.0); }) < false_alarm_bound);
    }
    pair_normals(key, i, j, id.data(), other);  // the same bits: what the keys must keep apart
    BOOST_TEST(correlation(squared) > 10.0 * false_alarm_bound);
    static_assert(Lowe::most_sweeps <= 0x80);
}

// --- the soft fluid --------------------------------------------------------------------------------------

// Groot & Warren's fluid. Its pressure, 23.65, is known from many simulations since theirs of 1997.
BOOST_AUTO_TEST_CASE(soft_fluid_in_equilibrium) {
    auto const parsed =
        scene("'shardlow', 'sample', 'verlet'", {"time.equilibration=20", "time.duration=160",
                                                 "sample.observables=['kinetic_temperature', 'pressure', "
                                                 "'configurational_temperature', 'momentum']"});
    auto const quantities = analyze(parsed, {run(parsed).record});
    auto const estimate = [&](char const* name) { return find_quantity(quantities, name)->estimate; };
    check_equal(estimate("kinetic_temperature"), 1.0, 0.005);
    check_equal(estimate("configurational_temperature"), 1.0, 0.004);
    BOOST_TEST(std::abs(estimate("pressure").value - 23.65) < 0.1);
    BOOST_TEST(estimate("pressure").error < 0.02);
    BOOST_TEST(estimate("largest_momentum").value < 1e-11);
}

namespace {

struct Extreme {
    char const* stage;
    double density, strength, side, step, steps, equilibration;
    std::string assignment;
};

std::ostream& operator<<(std::ostream& stream, Extreme const& e) {
    return stream << e.stage << ", n " << e.density << ", a " << e.strength << ", step " << e.step << ", "
                  << e.assignment;
}

}  // namespace

// The ends of every range: momentum is conserved and kT is one, within the spread of a single sample (the
// runs are hardly longer than their correlation). Where nothing thermalizes, an ideal gas keeps its kT.
BOOST_DATA_TEST_CASE(extremes,
                     data::make(std::vector<Extreme>{
                         {"shardlow", 3, 0, 5, 0.1, 100, 0, "shardlow.friction=0"},
                         {"shardlow", 3, 0, 5, 0.1, 100, 0, "shardlow.friction=1000"},
                         {"shardlow", 0.1, 0, 14, 0.1, 100, 0, "shardlow.friction=4.5"},
                         {"shardlow", 20, 0, 3, 10, 100, 0, "shardlow.friction=1000"},
                         {"shardlow", 3, 0, 5, 1e-3, 100, 0, "shardlow.friction=4.5"},
                         {"shardlow", 3, 0, 5, 10, 300, 0, "shardlow.friction=4.5"},
                         {"shardlow", 3, 25, 5, 1e-3, 100, 300, "shardlow.friction=100"},
                         {"shardlow", 3, 25, 5, 0.1, 100, 200, "shardlow.friction=1000"},
                         {"shardlow", 0.1, 200, 14, 0.05, 100, 600, "shardlow.friction=1000"},
                         {"shardlow", 3, 200, 5, 0.05, 100, 100, "shardlow.friction=4.5"},
                         {"shardlow", 20, 200, 2.5, 0.01, 50, 100, "shardlow.friction=4.5"},
                         {"lowe", 20, 0, 3, 0.1, 50, 0, "lowe.rate=100"},
                         {"lowe", 0.1, 25, 14, 0.1, 100, 100, "lowe.rate=0"},
                         {"rescale", 0.1, 25, 14, 0.1, 100, 100, "rescale.mode=global"},
                         {"rescale", 0.1, 0, 14, 0.1, 100, 0, "rescale.mode=monte_carlo"},
                         {"rescale", 20, 25, 3, 0.02, 50, 100, "rescale.mode=layers"}}),
                     e) {
    auto const set = [](char const* key, double value) { return fmt::format("{}={}", key, value); };
    auto const parsed =
        scene(fmt::format("'{}', 'sample', 'verlet'", e.stage),
              {fmt::format("box.length=[{0}, {0}, {0}]", e.side), set("particles.density", e.density),
               set("verlet.soft.strength", e.strength), set("time.step", e.step),
               set("time.duration", e.step * e.steps), set("time.equilibration", e.step * e.equilibration),
               e.assignment, "sample.observables=['kinetic_temperature', 'momentum', 'pressure']"});
    auto const result = run(parsed);
    auto const quantities = analyze(parsed, {result.record});
    double const kT = find_quantity(quantities, "kinetic_temperature")->estimate.value;
    double const n = double(parsed.particles);
    BOOST_TEST(result.record.series.at("pressure").size() >= std::size_t(e.steps));
    BOOST_TEST(find_quantity(quantities, "pressure")->estimate.value > 0.9 * e.density);
    BOOST_TEST(find_quantity(quantities, "largest_momentum")->estimate.value < 1e-9);
    // no thermostat: the potential energy of the random start, pi a n/30 per particle, may become heat
    double const heat =
        e.assignment == "lowe.rate=0" ? std::numbers::pi * e.strength * e.density / 45.0 : 0.0;
    double const spread = false_alarm_bound * std::sqrt(2.0 / (3.0 * n));
    BOOST_TEST(kT > 1.0 - spread);
    BOOST_TEST(kT < 1.0 + heat + spread);
}

// --- runs ------------------------------------------------------------------------------------------------

// What a stage leaves for the next step survives an interruption after any step.
BOOST_DATA_TEST_CASE(interrupted_soft_runs_give_the_same_bits,
                     data::make({"'shardlow', 'sample', 'verlet'", "'verlet', 'lowe', 'sample'",
                                 "'sample', 'rescale', 'body_force', 'drift'",
                                 "'rescale', 'verlet', 'sample'", "'euler', 'sample', 'verlet', 'kick'",
                                 "'modified_verlet', 'sample'", "'sample', 'modified_verlet'"}),
                     stages) {
    auto const output =
        std::filesystem::temp_directory_path() / ("dpdref_soft_test." + std::to_string(::getpid()) + ".h5");
    std::vector<std::string> const assignments{
        "box.length=[3, 4, 3]",
        "box.shear_rate=0.5",
        "pairs.order=random",
        "time.step=0.05",
        "time.duration=1",
        "time.equilibration=0.1",
        "sample.observables=['kinetic_temperature', 'stress', 'pressure', 'potential_energy', "
        "'configurational_temperature']"};
    auto const parsed = scene(stages, assignments);
    RunResult const whole = run(parsed);
    RunResult pieces;
    std::uint64_t interruptions = 0;
    std::atomic<bool> const stop = true;
    for (bool complete = false; !complete;) try {
            pieces = run(parsed, {.output = output, .stop = &stop, .progress = {}});
            complete = true;
        } catch (Interrupted const&) {
            ++interruptions;
        }
    std::filesystem::remove(output);
    BOOST_TEST(interruptions == parsed.steps() - 1);
    BOOST_TEST(whole.record.series.size() >= 7u);
    for (auto const& [name, values] : whole.record.series)
        BOOST_TEST((values == pieces.record.series.at(name)), name);
    BOOST_TEST(whole.counters.searches == pieces.counters.searches);
    BOOST_TEST(whole.counters.random_draws == pieces.counters.random_draws);
    BOOST_TEST(whole.counters.potential_evaluations == pieces.counters.potential_evaluations);
}

// --- walls -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(bounce_back_by_hand) {
    auto simulation = gas<3>({4.0, 6.0, 4.0}, 3, 0.0, 0.5);
    auto& p = simulation.particles;
    simulation.box.wall = 1.0;
    p.fluid = 2;
    p.position << 1.0, 0.9, 1.0, 2.0, 5.2, 2.0, 3.0, 0.5, 3.0;  // below, above, frozen
    p.velocity << 0.3, -0.5, 0.2, 0.1, 0.8, 0.0, 0.0, 0.0, 0.0;
    simulation.box.bounce_back(p, 0.5);
    Field<3> position(3, 3), velocity(3, 3);
    position << 0.88, 1.1, 0.92, 1.95, 4.8, 2.0, 3.0, 0.5, 3.0;
    velocity << -0.3, 0.5, -0.2, -0.1, -0.8, 0.0, 0.0, 0.0, 0.0;
    BOOST_TEST((p.position - position).abs().maxCoeff() < 1e-15);
    BOOST_TEST((p.velocity - velocity).abs().maxCoeff() == 0.0);
    p.position(0, 1) = -0.1;
    p.velocity(0, 1) = -3.0;
    BOOST_CHECK_THROW(simulation.box.bounce_back(p, 0.5), Diverged);
}

// A hard, strongly driven fluid: nothing leaves, and the walls stay as they are.
BOOST_AUTO_TEST_CASE(walls_hold_the_fluid) {
    auto const parsed =
        scene("'body_force', 'modified_verlet', 'sample'",
              {"box.length=[4, 7, 4]", "walls.thickness=1", "time.step=0.02", "body_force.acceleration=0.5",
               "modified_verlet.soft.strength=100", "sample.profile.bins=28"});
    auto simulation = build<3>(parsed, {});
    auto const& p = simulation.particles;
    auto const walls = p.size() - Eigen::Index(p.fluid);
    BOOST_TEST(p.fluid == 240u);
    BOOST_TEST(walls == 96);
    Field<3> const at_first = by_id(simulation, p.position).bottomRows(walls);
    for (int step = 0; step < 2000; ++step) {
        simulation.advance();
        auto const y = by_id(simulation, p.position).col(1).head(p.fluid).eval();
        if (!((y >= 1.0).all() && (y <= 6.0).all())) BOOST_FAIL("a particle is in the wall at step " << step);
    }
    BOOST_TEST((by_id(simulation, p.position).bottomRows(walls) == at_first).all());
    BOOST_TEST((by_id(simulation, p.velocity).bottomRows(walls) == 0.0).all());
    BOOST_TEST(by_id(simulation, p.velocity).topRows(p.fluid).col(0).mean() > 0.1);  // it flows
}

// PK2006's fluid at twenty atoms per particle, packed into a corner at first, with walls that repel more than
// the fluid or not at all: bounce-back alone must hold it.
BOOST_DATA_TEST_CASE(walls_hold_a_coarse_cold_fluid, data::make({70.7, 0.0}), strength) {
    auto const parsed =
        scene("'modified_verlet', 'body_force', 'sample'",
              {"box.length=[4, 7, 4]", "walls.thickness=1", fmt::format("walls.strength={}", strength),
               "time.step=0.02", "time.duration=20", "particles.start=dense", "particles.kT=0.1",
               "body_force.acceleration=0.05", "modified_verlet.gamma=45", "modified_verlet.lambda=0.5",
               "modified_verlet.soft.strength=50", "sample.profile.bins=28"});
    std::unique_ptr<Recorder<3>> recorder;
    auto simulation = build<3>(parsed, [&](Simulation<3>& s) { (*recorder)(s); });
    recorder = std::make_unique<Recorder<3>>(parsed.sample, simulation);
    auto const& p = simulation.particles;
    auto const walls = p.size() - Eigen::Index(p.fluid);
    Field<3> const at_first = by_id(simulation, p.position).bottomRows(walls);
    BOOST_TEST(p.fluid == 240u);
    int bounced = 0;
    for (int step = 0; step < 2000; ++step) {
        Field<3> const before = by_id(simulation, p.velocity);
        simulation.advance();
        auto const y = by_id(simulation, p.position).col(1).head(p.fluid).eval();
        if (!((y >= 1.0).all() && (y <= 6.0).all())) BOOST_FAIL("a particle is in the wall at step " << step);
        std::vector<std::uint32_t> ids(p.id.begin(), p.id.end());
        std::sort(ids.begin(), ids.end());
        for (std::size_t k = 0; k < ids.size(); ++k)
            if (ids[k] != k) BOOST_FAIL("a particle is lost at step " << step);
        // one near the wall that has turned round
        auto const v = by_id(simulation, p.velocity).col(1).head(p.fluid).eval();
        bounced += int(((y < 1.02) && (v > 0.0) && (before.col(1).head(p.fluid) < 0.0)).count());
    }
    BOOST_TEST(bounced > (strength > 0.0 ? 0 : 100));
    BOOST_TEST((by_id(simulation, p.position).bottomRows(walls) == at_first).all());
    // the same seen by the profile: nobody in the walls (bins of 1/4), everybody between them
    auto const& density = recorder->record().curves.at("density_profile");
    for (Eigen::Index block = 0; block < curve_blocks; ++block) {
        auto const profile = (density.sum.col(block) / density.weight.col(block)).eval();
        BOOST_TEST((profile.head(4) == 0.0).all());
        BOOST_TEST((profile.tail(4) == 0.0).all());
        BOOST_TEST(profile.sum() * (4.0 * 4.0 * 0.25) == 240.0, tolerance(1e-10));
    }
}

BOOST_AUTO_TEST_CASE(too_large_a_step_between_walls_ends_in_divergence) {
    auto const message = [](std::vector<std::string> assignments) {
        for (char const* more : {"box.length=[4, 7, 4]", "walls.thickness=1", "time.duration=600"})
            assignments.push_back(more);
        try {
            run(scene("'modified_verlet', 'sample'", assignments));
        } catch (Diverged const& divergence) {
            return std::string(divergence.what());
        }
        return std::string("no divergence");
    };
    for (char const* step : {"time.step=0.3", "time.step=2"}) {
        auto const found = message({"modified_verlet.gamma=45", "modified_verlet.lambda=0.5",
                                    "particles.kT=0.1", "modified_verlet.soft.strength=50", step});
        BOOST_TEST(found.starts_with("diverged at step "), found);
        BOOST_TEST(found.find("time.step") != std::string::npos, found);
    }
    // without any force: what flies farther than the wall is thick has gone through it
    std::vector<std::string> flight{"modified_verlet.gamma=0", "modified_verlet.sigma=0",
                                    "modified_verlet.soft.strength=0", "particles.kT=25", "time.step=0.5"};
    BOOST_TEST(message(flight).find("a particle went through a wall") != std::string::npos);
    flight.back() = "time.step=0.02";
    BOOST_TEST(message(flight) == "no divergence");
}

// The force of a wall on a particle, as a sum over its lattice; the fluid-wall coefficient scales it.
BOOST_AUTO_TEST_CASE(wall_strength_scales_the_force_of_the_wall) {
    std::vector<double> forces_found;
    for (std::string const strength : {"25.0", "50.0"}) {
        auto simulation =
            build<3>(scene("'modified_verlet'", {"box.length=[4, 7, 4]", "walls.thickness=1",
                                                 "walls.strength=" + strength, "particles.density=1"}),
                     {});
        auto& p = simulation.particles;
        p.position.topRows(p.fluid).col(1) = 3.5;  // out of the wall's reach, but for one
        p.position.row(0) << 2.1, 1.3, 1.7;
        simulation.positions_changed();
        auto const& field = forces(simulation, soft);
        BOOST_TEST((by_id(simulation, field).bottomRows(p.size() - Eigen::Index(p.fluid)) == 0.0).all());
        forces_found.push_back(by_id(simulation, field)(0, 1));
    }
    BOOST_TEST(forces_found[0] > 1.0);
    BOOST_TEST(forces_found[1] == 2.0 * forces_found[0], tolerance(1e-14));
}

BOOST_AUTO_TEST_CASE(what_cannot_be_between_walls_is_refused) {
    for (std::vector<std::string> const& wrong :
         {std::vector<std::string>{"walls.thickness=0.9"},
          {"walls.thickness=2.5"},
          {"walls.thickness=1", "box.shear_rate=0.1"},
          {"walls.thickness=1", "sample.observables=['stress']", "time.equilibration=1"}})
        BOOST_CHECK_THROW(scene("'modified_verlet', 'sample'", wrong), InputError);
    BOOST_CHECK_THROW(scene("'shardlow', 'drift'", {"walls.thickness=1"}), InputError);
}

BOOST_AUTO_TEST_CASE(a_trajectory_without_an_output_is_refused) {
    BOOST_CHECK_EXCEPTION(
        run(scene("'verlet'", {"trajectory.interval=5"})), InputError,
        [](InputError const& error) { return std::string(error.what()).starts_with("trajectory: "); });
}
