/// @file
/// The ends of every range, thermostat by thermostat: a run ends in a right answer or in one line that
/// refuses it. Statistics with fixed seeds: each of some 45 comparisons raises a false alarm with probability
/// 7e-6, Student's for the number of blocks behind an error.
///
/// Elsewhere: a step of zero and other bad input (scene_test), friction, density, rate and step far from one
/// (soft_test, `extremes`), seeds and files (run_test), Euler beyond its critical step (run_test), walls
/// (soft_test).
#define BOOST_TEST_MODULE extremes
#include <fmt/format.h>

#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "run.hpp"
#include "scene.hpp"
#include "statistics.hpp"
#include "theory/closed_forms.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;

namespace {

constexpr double false_alarm = 7e-6;
constexpr double rounding = 0.5 * std::numeric_limits<double>::epsilon();

// Every pair thermostat: a stage, or a scheme of Shardlow's.
std::vector<std::string> const thermostats{"shardlow", "exponential", "linear",
                                           "lowe",     "euler",       "modified_verlet"};

struct Fluid {
    std::string thermostat;
    double strength = 25.0;  ///< of the soft repulsion; 0: the stage that moves is the drift, if there is one
    double friction = 4.5;   ///< or Lowe's rate
    double kT = 1.0;         ///< of the thermostat
    double step = 0.02;
};

// 192 particles in a box of side 4, unless `more` says otherwise.
Scene scene(Fluid const& fluid, std::vector<std::string> const& more = {}, std::uint64_t seed = 1) {
    auto const set = [](std::string const& key, double value) { return fmt::format("{}={}", key, value); };
    bool const scheme = value_of<Scheme>(fluid.thermostat).has_value();
    std::string const stage = scheme ? "shardlow" : fluid.thermostat;
    bool const modified = stage == "modified_verlet";
    std::string const mover = fluid.strength > 0.0 ? "verlet" : "drift";
    std::vector<std::string> all{"dimension=3",
                                 modified ? "stages=['modified_verlet', 'sample']"
                                 : stage == "euler"
                                     ? fmt::format("stages=['euler', 'kick', 'sample', '{}']", mover)
                                     : fmt::format("stages=['{}', 'sample', '{}']", stage, mover),
                                 "box.length=[4, 4, 4]",
                                 "particles.number=192",
                                 "time.duration=1",
                                 set("time.step", fluid.step)};
    if (modified || mover == "verlet")
        all.push_back(set((modified ? stage : mover) + ".soft.strength", fluid.strength));
    if (modified || stage == "euler") {
        all.push_back(set(stage + ".gamma", fluid.friction));
        all.push_back(set(stage + ".sigma", std::sqrt(2.0 * fluid.friction * fluid.kT)));
    } else {
        all.push_back(set(stage + (scheme ? ".friction" : ".rate"), fluid.friction));
        all.push_back(set(stage + ".kT", fluid.kT));
    }
    if (scheme) all.push_back("shardlow.scheme=" + fluid.thermostat);
    all.insert(all.end(), more.begin(), more.end());
    return parse_scene("[time]\n", "extremes_test", all, seed);
}

void advance(Simulation<3>& simulation, int steps) {
    for (int step = 0; step < steps; ++step) simulation.advance();
}

// What an action is refused with: one line. Empty if it is not refused.
template <class Error, class Action>
std::string refusal(Action const& action) {
    try {
        action();
    } catch (Error const& error) {
        std::string const message = error.what();
        BOOST_TEST(message.find('\n') == std::string::npos, message);
        return message;
    }
    return "";
}

void check_diverges(Simulation<3>& simulation, int steps) {
    auto const message = refusal<Diverged>([&] { advance(simulation, steps); });
    BOOST_TEST(message.starts_with(fmt::format("diverged at step {} ", simulation.step + 1)), message);
    BOOST_TEST(message.ends_with("try a smaller time.step"), message);
}

double kT_of(Simulation<3> const& simulation) {
    return kinetic_temperature(simulation.particles, simulation.box);
}

double momentum_of(Simulation<3> const& simulation) {
    return total_momentum(simulation.particles, simulation.box).norm();
}

double energy_of(Simulation<3>& simulation) {
    return 0.5 * simulation.particles.mass * simulation.particles.velocity.square().sum() +
           simulation.potential_sums(simulation).energy;
}

Field<3> by_id(Particles<3> const& particles, Field<3> const& rows) {
    Field<3> sorted(rows.rows(), 3);
    for (Eigen::Index p = 0; p < rows.rows(); ++p) sorted.row(particles.id[p]) = rows.row(p);
    return sorted;
}

bool same_state(Simulation<3> const& a, Simulation<3> const& b) {
    auto const &p = a.particles, &q = b.particles;
    return (by_id(p, p.position) == by_id(q, q.position)).all() &&
           (by_id(p, p.velocity) == by_id(q, q.velocity)).all();
}

// Within the error, and what a finite step may add.
void check_equal(Estimate const& estimate, double expected, double resolution, double allowed = 0.0) {
    double const critical = critical_z(false_alarm, estimate.blocks);
    BOOST_TEST(std::abs(estimate.value - expected) < critical * estimate.error + allowed,
               estimate.value << " +- " << estimate.error << " is not " << expected << " +- " << allowed);
    BOOST_TEST(estimate.error < resolution);
}

void check_equal(Estimate const& a, Estimate const& b, double resolution) {
    Estimate const difference{.value = a.value - b.value,
                              .error = std::hypot(a.error, b.error),
                              .blocks = std::min(a.blocks, b.blocks)};
    BOOST_TEST_CONTEXT(a.value << " +- " << a.error << " against " << b.value << " +- " << b.error)
    check_equal(difference, 0.0, resolution);
}

}  // namespace

// --- positions -------------------------------------------------------------------------------------------

BOOST_DATA_TEST_CASE(two_particles_at_one_point, data::make(thermostats), thermostat) {
    auto simulation = build<3>(scene({.thermostat = thermostat}, {"particles.number=2"}), {});
    auto& p = simulation.particles;
    p.position.row(1) = p.position.row(0);
    auto together = simulation;
    advance(simulation, 200);  // part, and meet again with a direction
    BOOST_TEST(simulation.counters.coincident_pairs == 1u);
    BOOST_TEST(simulation.counters.pairs_found > 0u);
    BOOST_TEST(momentum_of(simulation) < 200.0 * rounding);
    BOOST_TEST((p.position >= 0.0 && p.position < 4.0).all());
    BOOST_TEST(std::isfinite(kT_of(simulation)));

    // without a relative velocity they stay together
    together.particles.velocity.rowwise() = Eigen::Array3d(0.3, -0.2, 0.1).transpose();
    auto const velocity = together.particles.velocity;
    advance(together, 50);
    BOOST_TEST((together.particles.velocity == velocity).all());
    BOOST_TEST(together.counters.coincident_pairs == together.counters.searches);
    BOOST_TEST(together.counters.pairs_found == 0u);
}

// A hard core throws such pairs out of every box.
BOOST_DATA_TEST_CASE(overlapping_hard_cores_are_refused, data::make({"coincident", "random start"}), start) {
    bool const coincident = start == std::string("coincident");
    auto simulation = build<3>(scene({.thermostat = "shardlow", .step = 0.005},
                                     {"verlet={lennard_jones={}}", "box.length=[6, 6, 6]",
                                      coincident ? "particles.number=2" : "particles.number=173"}),
                               {});
    if (coincident) simulation.particles.position.row(1) = simulation.particles.position.row(0);
    check_diverges(simulation, 100);
}

// The fluid forgets that it started in a hundredth of the box, full of repulsion. Friction at a finite step
// may leave it some per cent off one, the same as from any other start.
BOOST_DATA_TEST_CASE(all_in_a_hundredth_of_the_box, data::make(thermostats), thermostat) {
    struct Sampled {
        Estimate kT, pressure;
    };
    auto const sample = [&](double filled) {
        auto simulation = build<3>(scene({.thermostat = thermostat}), {});
        simulation.particles.position *= std::cbrt(filled);
        if (filled < 1.0) {
            BOOST_TEST(simulation.pairs().count > 0.9 * (192 * 191 / 2));
            BOOST_TEST(energy_of(simulation) > 192.0 * 200.0);
        }
        advance(simulation, 600);
        std::vector<double> kT, pressure;
        for (int step = 0; step < 1600; ++step) {
            simulation.advance();
            kT.push_back(kT_of(simulation));
            if (step % 4) continue;
            double const virial = simulation.potential_sums(simulation).virial;
            pressure.push_back((191.0 * kT.back() + virial / 3.0) / simulation.box.volume());
        }
        return Sampled{blocking(kT), blocking(pressure)};
    };
    Sampled const dense = sample(0.01), random = sample(1.0);
    check_equal(dense.kT, 1.0, 0.02, 0.04);
    check_equal(dense.kT, random.kT, 0.02);
    check_equal(dense.pressure, random.pressure, 0.2);
}

namespace {

// Pairs closer than one, from the sum over all images: no minimum image, no cells.
std::size_t pairs_by_images(Simulation<3> const& simulation) {
    auto const& p = simulation.particles;
    std::size_t count = 0;
    for (Eigen::Index a = 0; a < p.size(); ++a)
        for (Eigen::Index b = 0; b < a; ++b)
            for (int image = 0; image < 27; ++image) {
                Eigen::Array3d const boxes(image % 3 - 1, image / 3 % 3 - 1, image / 9 - 1);
                Eigen::Array3d const separation = (p.position.row(a) - p.position.row(b)).transpose() +
                                                  boxes * simulation.box.length.array();
                count += separation.square().sum() < 1.0;
            }
    return count;
}

}  // namespace

// At exactly two cutoffs the definition itself searches; just above it the cells do.
BOOST_DATA_TEST_CASE(a_box_of_two_cutoffs, data::make(thermostats) * data::make({2.0, 2.0 * (1.0 + 1e-8)}),
                     thermostat, side) {
    std::vector<Simulation<3>> both;
    for (char const* search : {"cell", "brute"}) {
        auto simulation =
            build<3>(scene({.thermostat = thermostat},
                           {fmt::format("box.length=[{0}, {0}, {0}]", side), "particles.number=24",
                            "pairs.order=id", std::string("pairs.search=") + search}),
                     {});
        for (int step = 0; step < 50; ++step) {
            BOOST_REQUIRE_EQUAL(simulation.pairs().count, pairs_by_images(simulation));
            simulation.advance();
        }
        both.push_back(simulation);
    }
    BOOST_TEST((by_id(both[0].particles, both[0].particles.velocity) -
                by_id(both[1].particles, both[1].particles.velocity))
                   .abs()
                   .maxCoeff() < 1e-9);
}

BOOST_DATA_TEST_CASE(a_box_just_below_two_cutoffs_is_refused, data::make(thermostats) * data::xrange(3),
                     thermostat, axis) {
    std::vector<double> length{4.0, 4.0, 4.0};
    length[std::size_t(axis)] = std::nextafter(2.0, 0.0);
    auto const box = fmt::format("box.length=[{}, {}, {}]", length[0], length[1], length[2]);
    auto const message = refusal<InputError>([&] { scene({.thermostat = thermostat}, {box}); });
    BOOST_TEST(
        message.find("box.length: 1.9999999999999998 is too small; allowed: at least two cutoffs, 2") !=
            std::string::npos,
        message);
}

// --- temperature and friction ----------------------------------------------------------------------------

// At kT = 0 noise is drawn and counts for nothing: every step cools, and what is at rest stays there.
BOOST_DATA_TEST_CASE(no_temperature, data::make(thermostats), thermostat) {
    Fluid const cold{.thermostat = thermostat, .strength = 0.0, .kT = 0.0};
    auto simulation = build<3>(scene(cold), {}), at_rest = build<3>(scene(cold, {"particles.kT=0"}), {});
    double const start = kT_of(simulation);
    double kT = start;
    for (int step = 0; step < 200; ++step) {
        simulation.advance();
        double const now = kT_of(simulation);
        BOOST_REQUIRE(now < kT);
        kT = now;
    }
    BOOST_TEST(kT < 0.02 * start);
    BOOST_TEST(momentum_of(simulation) < 1e-12);

    Field<3> const position = by_id(at_rest.particles, at_rest.particles.position);
    advance(at_rest, 20);
    BOOST_TEST(at_rest.counters.random_draws > 0u);
    BOOST_TEST((at_rest.particles.velocity == 0.0).all());
    BOOST_TEST((by_id(at_rest.particles, at_rest.particles.position) == position).all());
}

// Without friction every thermostat leaves velocity-Verlet, whose energy error is of second order. The ratio
// of the errors at two steps is 4 up to a factor of exp(+-0.24) in one run (60 seeds), of exp(+-0.08) from
// ten starts; the bounds, orders 1.5 and 2.5, are more than four of these away. Over a long time the error
// walks at random: its root mean square over 1000 steps of 0.02 was 0.5 to 8.5 kT in 24 runs of 2000 steps,
// 0.2 to 3 % of the kinetic energy of the 192 particles.
BOOST_DATA_TEST_CASE(no_friction, data::make(thermostats), thermostat) {
    auto start = build<3>(scene({.thermostat = "shardlow"}), {});
    advance(start, 300);
    auto const deviations = [&](double step, int steps) {
        auto simulation = build<3>(scene({.thermostat = thermostat, .friction = 0.0, .step = step}), {});
        simulation.particles = start.particles;
        double const before = energy_of(simulation);
        std::vector<double> squares;
        for (int s = 0; s < steps; ++s) {
            simulation.advance();
            squares.push_back(std::pow(energy_of(simulation) - before, 2));
        }
        return squares;
    };
    auto const root_mean = [](std::vector<double> const& squares, std::size_t begin, std::size_t end) {
        double sum = 0.0;
        for (std::size_t k = begin; k < end; ++k) sum += squares[k] / double(end - begin);
        return std::sqrt(sum);
    };
    auto const lasting = deviations(0.02, 2000);
    std::vector<double> coarse, fine;
    for (int another = 0; another < 10; ++another) {
        for (double const square : deviations(0.01, 40)) coarse.push_back(square);
        for (double const square : deviations(0.005, 80)) fine.push_back(square);
        advance(start, 100);
    }
    double const ratio = root_mean(coarse, 0, coarse.size()) / root_mean(fine, 0, fine.size());
    BOOST_TEST(ratio > std::pow(2.0, 1.5));
    BOOST_TEST(ratio < std::pow(2.0, 2.5));
    BOOST_TEST(root_mean(lasting, 0, 2000) < 0.05 * 1.5 * 192.0);
}

// --- the time step ---------------------------------------------------------------------------------------

BOOST_DATA_TEST_CASE(the_shortest_and_the_longest_step, data::make(thermostats), thermostat) {
    auto simulation =
        build<3>(scene({.thermostat = thermostat, .step = 1e-300}, {"time.duration=1e-299"}), {});
    auto const start = simulation;
    advance(simulation, 10);
    BOOST_TEST(simulation.counters.pairs_found > 0u);
    BOOST_TEST(same_state(simulation, start));

    auto const longest = [&] {
        return scene({.thermostat = thermostat, .step = 1e300}, {"time.duration=1e300"});
    };
    if (thermostat == "linear" || thermostat == "lowe") {  // A > 1; more sweeps than anyone wants
        auto const message = refusal<InputError>(longest);
        BOOST_TEST(
            message.find(thermostat == "lowe" ? "lowe.rate: " : "shardlow.friction: ") != std::string::npos,
            message);
    } else {
        auto diverging = build<3>(longest(), {});
        check_diverges(diverging, 10);
    }
}

// --- two particles, many steps ---------------------------------------------------------------------------

// The three degrees of freedom of their relative motion have kT = 1. Explicit friction of rate 2 gamma w/m
// heats by at most 1/(1 - gamma dt/m): theory/MY1997.md, each mode by its rate.
BOOST_DATA_TEST_CASE(two_particles, data::make(thermostats) * data::make({0.0, 5.0}), thermostat, strength) {
    Fluid const fluid{.thermostat = thermostat, .strength = strength, .friction = 9.0, .step = 0.02};
    auto simulation =
        build<3>(scene(fluid, {"particles.number=2", "box.length=[2, 2, 2]", "particles.mass=2"}), {});
    constexpr int steps = 400'000;
    std::vector<double> kT;
    for (int step = 0; step < steps; ++step) {
        simulation.advance();
        kT.push_back(kT_of(simulation));
    }
    bool const explicit_friction = thermostat == "euler" || thermostat == "modified_verlet";
    double const heating = explicit_friction ? 1.0 / (1.0 - fluid.friction * fluid.step / 2.0) - 1.0 : 0.0;
    // the force's finite step: (omega dt)^2/4 at omega^2 = 2 a/m for two particles
    check_equal(blocking(kT), 1.0, 0.06, heating + 0.5 * strength / 2.0 * std::pow(fluid.step, 2));
    // as below, for thermostat and force in every step
    BOOST_TEST(momentum_of(simulation) < 2.0 * 4.0 * rounding * std::sqrt(2.0 * 6.0 * steps));
}

// Rounding is a random walk: one update changes each of two particles' three velocities by numbers that are
// rounded to half a unit in the last place, below 4 in size, so that the sum of the velocities moves by less
// than 4 rounding sqrt(6 updates) in one standard deviation. A bias would grow with the updates themselves.
BOOST_AUTO_TEST_CASE(ten_million_steps) {
    auto simulation = build<3>(scene({.thermostat = "shardlow", .strength = 0.0, .step = 0.1},
                                     {"particles.number=4", "box.length=[2, 2, 2]"}),
                               {});
    constexpr int steps = 10'000'000;
    std::vector<double> kT;
    for (int step = 1; step <= steps; ++step) {
        simulation.advance();
        if (step % 100 == 0) kT.push_back(kT_of(simulation));
        if (step % 1'000'000) continue;
        auto const updates = double(simulation.counters.pair_updates);
        BOOST_TEST(momentum_of(simulation) < 4.0 * rounding * std::sqrt(6.0 * updates));
    }
    BOOST_TEST(simulation.counters.pair_updates > std::uint64_t{steps});
    check_equal(blocking(kT), 1.0, 0.002);
}

// --- seeds -----------------------------------------------------------------------------------------------

BOOST_DATA_TEST_CASE(the_first_and_the_last_seed, data::make(thermostats), thermostat) {
    auto const with = [&](std::uint64_t seed) {
        auto simulation = build<3>(scene({.thermostat = thermostat}, {}, seed), {});
        advance(simulation, 20);
        BOOST_TEST(std::abs(kT_of(simulation) - 1.0) < 1.0);
        return simulation;
    };
    constexpr std::uint64_t last = ~std::uint64_t{0};
    auto const zero = with(0);
    BOOST_TEST(same_state(zero, with(0)));
    BOOST_TEST(same_state(with(last), with(last)));
    BOOST_TEST(!same_state(zero, with(last)));
}

// --- counters --------------------------------------------------------------------------------------------

namespace {

struct Cost {
    char const* what;
    Scene scene;
    std::uint64_t searches;  ///< in 20 steps
    // each per pair found
    double updates, draws, potential;
    bool sheared = false;
};

std::ostream& operator<<(std::ostream& stream, Cost const& cost) { return stream << cost.what; }

std::vector<Cost> costs() {
    Fluid const gas{.thermostat = "shardlow", .strength = 0.0}, fluid{.thermostat = "shardlow"};
    Fluid lowe = gas, euler = gas, modified = fluid;
    lowe.thermostat = "lowe";
    euler.thermostat = "euler";
    modified.thermostat = "modified_verlet";
    // only what the stages name may be given
    auto const other = [](std::string const& stages, std::vector<std::string> more = {}) {
        more.insert(more.begin(), {"dimension=3", "stages=[" + stages + "]", "box.length=[4, 4, 4]",
                                   "particles.number=192", "time.step=0.02", "time.duration=0.4"});
        return parse_scene("[time]\n", "extremes_test", more);
    };
    auto const of = [](Fluid const& f, std::vector<std::string> more = {}) {
        more.push_back("time.duration=0.4");
        return scene(f, more);
    };
    std::string const soft = "verlet.soft.strength=25";
    // with a potential one search more, for the first forces
    return {{"nothing but flight", other("'drift'"), 0, 0, 0, 0},
            {"flight in shear", other("'drift'", {"box.shear_rate=0.5"}), 0, 0, 0, 0},
            {"body force", other("'body_force', 'drift'", {"body_force.acceleration=1"}), 0, 0, 0, 0},
            {"S1", of(gas), 20, 1, 1, 0},
            {"S1 in shear", of(gas, {"box.shear_rate=0.5"}), 20, 1, 1, 0, true},
            {"Lowe, below one update per step", of(lowe), 20, 1, 2, 0},
            {"Euler", of(euler), 20, 1, 1, 0},
            {"soft potential", other("'verlet'", {soft}), 21, 0, 0, 1},
            {"soft potential, ten substeps", other("'verlet'", {soft, "verlet.substeps=10"}), 201, 0, 0, 1},
            {"modified Verlet", of(modified), 21, 1, 1, 1}};
}

// What is measured from the state alone.
std::vector<std::string> const measured{
    "sample.observables=['kinetic_temperature', 'momentum', 'stress']", "sample.profile.temperature=true",
    "sample.mean_square_displacement.longest=0.2", "sample.velocity_autocorrelation.longest=0.2"};

}  // namespace

BOOST_DATA_TEST_CASE(a_scene_has_none_of_what_it_does_not_name, data::make(costs()), cost) {
    auto const counters = run(cost.scene).counters;
    double const found = double(counters.pairs_found);
    BOOST_TEST(counters.steps == 20u);
    BOOST_TEST(counters.searches == cost.searches);
    BOOST_TEST((counters.pairs_found > 0) == (cost.searches > 0));
    BOOST_TEST(double(counters.pair_updates) == cost.updates * found);
    BOOST_TEST(double(counters.random_draws) == cost.draws * found);
    BOOST_TEST(double(counters.potential_evaluations) == cost.potential * found);
    BOOST_TEST((counters.boundary_pairs > 0) == cost.sheared);
}

BOOST_AUTO_TEST_CASE(measuring_evaluates_nothing_but_energies) {
    auto const counters_with = [](std::vector<std::string> more) {
        more.insert(more.end(), {"time.duration=0.4", "time.equilibration=0.02"});
        return run(scene({.thermostat = "shardlow"}, more)).counters;
    };
    Counters const plain = counters_with({}), all = counters_with(measured),
                   pressure = counters_with({"sample.observables=['pressure']"});
    for (Counters const& with : {all, pressure}) {
        BOOST_TEST(with.searches == plain.searches);
        BOOST_TEST(with.pairs_found == plain.pairs_found);
        BOOST_TEST(with.pair_updates == plain.pair_updates);
        BOOST_TEST(with.random_draws == plain.random_draws);
    }
    BOOST_TEST(all.potential_evaluations == plain.potential_evaluations);
    BOOST_TEST(pressure.potential_evaluations > plain.potential_evaluations);
}

// --- hard repulsion --------------------------------------------------------------------------------------

namespace {

// A fluid of PK2006 whose particles stand for so many atoms, at a step that is `stiffness` over the root of
// the repulsion.
Fluid stiff(std::string const& thermostat, double atoms, double stiffness) {
    double const strength = theory::conservative_coefficient({.Nm = atoms}, 1.0);
    return {.thermostat = thermostat,
            .strength = strength,
            .friction = 20.0,
            .step = stiffness / std::sqrt(strength)};
}

struct Temperatures {
    Estimate kinetic, configurational;
};

Temperatures temperatures(Fluid const& fluid, int steps) {
    auto const parsed =
        scene(fluid, {fmt::format("time.equilibration={}", 1000 * fluid.step),
                      fmt::format("time.duration={}", steps * fluid.step),
                      "sample.observables=['kinetic_temperature', 'configurational_temperature']"});
    auto const quantities = analyze(parsed, {run(parsed).record});
    return {find_quantity(quantities, "kinetic_temperature")->estimate,
            find_quantity(quantities, "configurational_temperature")->estimate};
}

}  // namespace

// Twenty and a hundred atoms per particle. The thermostat holds the kinetic temperature; the finite step of
// the force shows in the structure, at second order: a mode of frequency omega is wider by (omega dt)^2/4 and
// by higher orders, so that a ratio of four between two steps is somewhat exceeded.
BOOST_DATA_TEST_CASE(hard_repulsion, data::make({"shardlow", "modified_verlet"}) * data::make({20.0, 100.0}),
                     thermostat, atoms) {
    auto const coarse = temperatures(stiff(thermostat, atoms, 0.45), 3000),
               fine = temperatures(stiff(thermostat, atoms, 0.225), 5000);
    double const ratio = (coarse.configurational.value - 1.0) / (fine.configurational.value - 1.0);
    BOOST_TEST(ratio > 3.0);
    BOOST_TEST(ratio < 8.0);
    for (auto const& at : {coarse, fine}) {
        BOOST_TEST(at.configurational.error < 0.01);
        check_equal(at.kinetic, 1.0, 0.01, 0.2 * (at.configurational.value - 1.0));
    }
}

// Soft forces are bounded, and so is what a step beyond the stable one heats: the run ends, with a
// temperature that says so.
BOOST_DATA_TEST_CASE(hard_repulsion_beyond_the_stable_step,
                     data::make({"shardlow", "modified_verlet"}) * data::make({20.0, 100.0}), thermostat,
                     atoms) {
    auto const reported = temperatures(stiff(thermostat, atoms, 2.25), 16000);
    BOOST_TEST(reported.kinetic.value > 100.0);
    BOOST_TEST(std::isfinite(reported.kinetic.value));
    BOOST_TEST((judge(reported.kinetic, 1.0, 0.0, 0.01, 1e-3) == Verdict::disagrees));
}
