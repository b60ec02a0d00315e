// Stages from which integrators are put together (force, half_kick, half_drift), friction found again
// (DPD-VV), and the viscosity from stress at rest. Mechanics to rounding; the one statistical comparison has
// a fixed seed and a false-alarm rate of 1e-5.
#define BOOST_TEST_MODULE splitting
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <random>

#include "analysis.hpp"
#include "sample.hpp"
#include "scene.hpp"
#include "statistics.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;
using boost::test_tools::tolerance;

namespace {

Soft const soft{.strength = 25.0};

Simulation<3> gas(double shear_rate, double time_step, double mass = 1.3) {
    Simulation<3> simulation;
    simulation.box.length = {4.0, 5.0, 3.0};
    simulation.box.shear_rate = shear_rate;
    simulation.particles.resize(180);
    simulation.particles.mass = mass;
    simulation.time_step = time_step;
    simulation.pair_search.order = Order::id;
    randomize(simulation.particles, simulation.box, 1.0, 1);
    return simulation;
}

// Two particles 0.6 apart, oblique, approaching each other. Row 0 is id 0: no sorting comes before.
Simulation<3> two(double time_step, double mass) {
    Simulation<3> simulation;
    simulation.box.length = {4.0, 4.0, 4.0};
    simulation.particles.resize(2);
    simulation.particles.mass = mass;
    simulation.time_step = time_step;
    simulation.pair_search.search = Search::brute;
    simulation.particles.position << 1.0, 1.0, 1.0, 1.36, 1.48, 1.0;
    simulation.particles.velocity << 0.3, 0.2, -0.1, -0.3, -0.2, 0.1;
    return simulation;
}

using Vec3 = Eigen::Array3d;

// r_0 - r_1 and v_0 - v_1, which is all that two particles have.
struct OnePair {
    Vec3 r, v;
    Vec3 e() const { return r / r.matrix().norm(); }
    Vec3 soft_force() const { return 25.0 * (1.0 - r.matrix().norm()) * e(); }
    Vec3 friction(double gamma) const {
        double const w = std::pow(1.0 - r.matrix().norm(), 2);
        return -gamma * w * (v * e()).sum() * e();
    }
};
OnePair pair_of(Simulation<3> const& s) {
    Eigen::Index const first = s.particles.id[0] == 0 ? 0 : 1;
    return {(s.particles.position.row(first) - s.particles.position.row(1 - first)).transpose(),
            (s.particles.velocity.row(first) - s.particles.velocity.row(1 - first)).transpose()};
}

void check_pair(Simulation<3> const& simulation, OnePair const& expected) {
    BOOST_TEST((pair_of(simulation).r - expected.r).abs().maxCoeff() < 1e-14);
    BOOST_TEST((pair_of(simulation).v - expected.v).abs().maxCoeff() < 1e-14);
    BOOST_TEST(total_momentum(simulation.particles, simulation.box).norm() < 1e-15);
}

}  // namespace

BOOST_DATA_TEST_CASE(half_kick_drift_half_kick_is_verlet, data::make({0.0, 0.4}), shear_rate) {
    auto verlet = gas(shear_rate, 0.02), split = verlet;
    verlet.stages = {Verlet{.potential = soft}};
    split.stages = {HalfKick{.potential = soft}, Drift{}, HalfKick{.potential = soft}};
    for (int step = 0; step < 40; ++step) {
        verlet.advance();
        split.advance();
    }
    BOOST_TEST((verlet.particles.position == split.particles.position).all());
    BOOST_TEST((verlet.particles.velocity == split.particles.velocity).all());
    BOOST_TEST(verlet.counters.searches == split.counters.searches);
    BOOST_TEST(verlet.counters.potential_evaluations == split.counters.potential_evaluations);
}

BOOST_DATA_TEST_CASE(two_half_drifts_are_a_drift, data::make({0.0, 0.4}), shear_rate) {
    auto whole = gas(shear_rate, 0.03), halves = whole;
    whole.stages = {Drift{}};
    halves.stages = {HalfDrift{}, HalfDrift{}};
    for (int step = 0; step < 100; ++step) {
        whole.advance();
        halves.advance();
        BOOST_TEST(whole.time == halves.time, tolerance(1e-15));
    }
    BOOST_TEST((whole.particles.velocity - halves.particles.velocity).abs().maxCoeff() < 1e-12);
    BOOST_TEST((whole.particles.position - halves.particles.position).abs().maxCoeff() < 1e-11);
}

// One step of ABOBA without noise: the O part is the pair's friction solved exactly at the middle.
BOOST_AUTO_TEST_CASE(one_aboba_step_by_hand) {
    double const dt = 0.1, m = 1.7, gamma = 4.5;
    auto simulation = two(dt, m);
    simulation.stages = {
        HalfDrift{}, HalfKick{.potential = soft},
        Shardlow{.friction = gamma, .weight = Weight::quadratic, .scheme = Scheme::exponential, .kT = 0.0},
        HalfKick{.potential = soft}, HalfDrift{}};
    OnePair p = pair_of(simulation);
    p.r += 0.5 * dt * p.v;
    p.v += 0.5 * dt / m * 2.0 * p.soft_force();  // both particles feel the force
    // d(v.e)/dt = -(2/m) gamma w (v.e), for a time dt
    double const w = std::pow(1.0 - p.r.matrix().norm(), 2), along = (p.v * p.e()).sum();
    p.v += (std::exp(-2.0 * gamma * w * dt / m) - 1.0) * along * p.e();
    p.v += 0.5 * dt / m * 2.0 * p.soft_force();
    p.r += 0.5 * dt * p.v;
    simulation.advance();
    check_pair(simulation, p);
    BOOST_TEST(simulation.counters.searches == 1u);
}

BOOST_DATA_TEST_CASE(one_euler_step_with_a_force_by_hand, data::make({false, true}), kick_first) {
    double const dt = 0.1, m = 1.7, gamma = 4.5;
    auto simulation = two(dt, m);
    Stage<3> const kick{Kick{}}, drift{Drift{}};
    simulation.stages = {EulerImpulses{.gamma = gamma, .sigma = 0.0, .weight = Weight::quadratic},
                         ForceImpulses{.potential = soft}, kick_first ? kick : drift,
                         kick_first ? drift : kick};
    OnePair p = pair_of(simulation);
    Vec3 const change = 2.0 * dt / m * (p.soft_force() + p.friction(gamma));
    if (kick_first) p.v += change;
    p.r += dt * p.v;
    if (!kick_first) p.v += change;
    simulation.advance();
    check_pair(simulation, p);
}

// The stress of Euler's friction alone, and that the noise has no part in it.
BOOST_DATA_TEST_CASE(friction_stress_of_euler_by_hand, data::make({0.0, 3.0}), sigma) {
    double const m = 1.7, gamma = 4.5;
    auto simulation = two(0.1, m);
    simulation.stage_stress.wanted = true;
    simulation.stages = {EulerImpulses{.gamma = gamma, .sigma = sigma, .weight = Weight::quadratic}};
    OnePair const p = pair_of(simulation);
    simulation.advance();
    // -(1/V) f_x y of the one pair
    double const expected = -p.friction(gamma)[0] * p.r[1] / simulation.box.volume();
    BOOST_TEST(simulation.stage_stress.friction == expected, tolerance(1e-13));
    double const all = collision_stress(simulation.pairs(), m, simulation.box, simulation.time_step);
    BOOST_TEST((std::abs(all / expected - 1.0) < 1e-13) == (sigma == 0.0));
}

// DPD-VV without noise, two steps: the first half kick of the second step has the friction of the velocities
// with which the first step ended.
BOOST_DATA_TEST_CASE(two_dpd_vv_steps_by_hand, data::make({false, true}), again) {
    double const dt = 0.1, m = 1.7, gamma = 4.5;
    auto simulation = two(dt, m);
    ModifiedVerlet stage;
    stage.potential = soft;
    stage.gamma = gamma;
    stage.sigma = 0.0;
    stage.friction_again = again;
    simulation.stage_stress.wanted = simulation.stage_stress.virial_wanted = true;
    simulation.stages = {stage};
    OnePair p = pair_of(simulation);
    Vec3 force = p.soft_force() + p.friction(gamma), seen = force;
    for (int step = 0; step < 2; ++step) {
        p.v += dt / m * force;
        p.r += dt * p.v;
        seen = p.friction(gamma);
        force = p.soft_force() + seen;
        p.v += dt / m * force;
        if (again) force = p.soft_force() + p.friction(gamma);
        simulation.advance();
    }
    check_pair(simulation, p);
    // the friction that is kept for the next step, and its part of the virial
    Vec3 const e = p.e(), kept = p.friction(gamma);
    double const arm = e[0] * e[1] * p.r.matrix().norm();
    if (again) BOOST_TEST(simulation.pair_virials.friction == (kept * e).sum() * arm, tolerance(1e-12));
    // the virial is that of the friction in the middle of the drift, with or without another after it
    BOOST_TEST(simulation.stage_stress.friction_virial == (seen * e).sum() * p.r.matrix().norm(),
               tolerance(1e-12));
}

namespace {

std::vector<std::string> const fluid{"dimension=3",    "box.length=[4, 4, 4]", "particles.density=3",
                                     "time.step=0.05", "time.duration=40",     "time.equilibration=1"};

Scene scene(std::vector<std::string> assignments) {
    assignments.insert(assignments.begin(), fluid.begin(), fluid.end());
    return parse_scene("", "test", assignments);
}

std::string const euler = "euler={gamma=4.5, sigma=3, weight='quadratic'}",
                  shardlow = "shardlow={friction=4.5, weight='quadratic', scheme='exponential'}",
                  force = "force.soft.strength=25", half_kick = "half_kick.soft.strength=25";

void check_refused(std::vector<std::string> const& assignments, std::string const& why) {
    BOOST_CHECK_EXCEPTION(scene(assignments), InputError, [&](InputError const& error) {
        std::string const what = error.what();
        BOOST_TEST_INFO(what);
        return what.find(why) != std::string::npos && what.find("allowed") != std::string::npos;
    });
}

}  // namespace

BOOST_AUTO_TEST_CASE(stage_lists_that_make_no_step_are_refused) {
    check_refused({"stages=['force','euler','kick','drift']", euler, force}, "no euler before force");
    check_refused({"stages=['euler','drift','force','kick']", euler, force}, "moves between");
    check_refused({"stages=['half_drift','half_kick','shardlow','half_kick']", shardlow, half_kick}, "odd");
    check_refused({"stages=['half_drift','half_kick','shardlow','half_drift']", shardlow, half_kick}, "odd");
    check_refused({"stages=['half_drift','half_kick','half_kick','half_drift','drift']", half_kick}, "twice");
    check_refused(
        {"stages=['euler','force','kick','half_kick','drift','half_kick']", euler, force, half_kick},
        "hold a potential");
    std::string const stress = "sample.observables=['stress']";
    check_refused({"stages=['half_drift','half_kick','shardlow','half_kick','sample','half_drift']", shardlow,
                   half_kick, stress},
                  "whole step's stress");
    check_refused(
        {"stages=['half_kick','shardlow','sample','half_kick','drift']", shardlow, half_kick, stress},
        "whole step's stress");
    BOOST_CHECK_NO_THROW(
        scene({"stages=['half_kick','shardlow','half_kick','sample','drift']", shardlow, half_kick, stress}));
    std::string const window = "sample.green_kubo.window=2";
    check_refused({"stages=['euler','sample','drift','kick']", euler, window}, "every step's stress");
    check_refused({"stages=['euler','sample','drift','kick']", euler, window, stress, "sample.interval=2"},
                  "every step's stress");
    check_refused({"stages=['euler','sample','drift','kick']", euler, window, stress, "box.shear_rate=0.1"},
                  "every step's stress");
    check_refused({"stages=['euler','sample','drift','kick']", euler, stress, "sample.green_kubo.window=6"},
                  "an eighth");
}

// Independent stresses of variance s^2 sum to <G^2> = s^2 dt t: the viscosity is V s^2 dt/(2 kT), and a
// stress that lasts k steps has k times that.
BOOST_DATA_TEST_CASE(green_kubo_of_known_noise, data::make({1, 5}), lasting) {
    Scene const s = scene({"stages=['euler','sample','drift','kick']", euler, "sample.observables=['stress']",
                           "sample.green_kubo.window=2", "time.duration=20000"});
    std::mt19937_64 random(1);
    std::normal_distribution<double> normal(0.0, 0.7);
    Record record;
    auto &kinetic = record.series["kinetic_stress"], &collision = record.series["collision_stress"];
    double value = 0.0;
    for (std::uint64_t k = 0; k < s.production_steps; ++k) {
        if (k % std::uint64_t(lasting) == 0) value = normal(random);
        kinetic.push_back(0.25 * value);
        collision.push_back(0.75 * value);
    }
    auto const quantities = analyze(s, {record});
    Estimate const eta = find_quantity(quantities, "green_kubo_viscosity")->estimate;
    double const expected = s.volume() * 0.49 * s.time_step * lasting / 2.0;
    BOOST_TEST(eta.blocks == 8u);
    BOOST_TEST(std::abs(eta.value - expected) < critical_z(1e-5, eta.blocks) * eta.error,
               eta.value << " +- " << eta.error << " is not " << expected);
    BOOST_TEST(eta.error < 0.03 * expected);
}

// A constant stress sums to c t, exactly: <G^2> grows by (3/4) (c t)^2 over the second half of the window t.
BOOST_AUTO_TEST_CASE(green_kubo_of_a_constant) {
    Scene const s = scene({"stages=['euler','sample','drift','kick']", euler, "sample.observables=['stress']",
                           "sample.green_kubo.window=2"});
    Record record;
    record.series["kinetic_stress"].assign(s.production_steps, 0.1);
    record.series["collision_stress"].assign(s.production_steps, 0.2);
    Estimate const eta = find_quantity(analyze(s, {record}), "green_kubo_viscosity")->estimate;
    BOOST_TEST(eta.value == s.volume() * 0.09 * 2.0 * 0.75, tolerance(1e-12));
    BOOST_TEST(eta.error < 1e-12);
}
