// The engine against exact statements: pair search, one-step updates, conservation laws, noise. Statistical
// checks use fixed seeds and a bound of 4.5 standard errors, false alarms 7e-6 each.
#define BOOST_TEST_MODULE engine
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <bit>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string_view>
#include <tuple>
#include <vector>

#include "sample.hpp"
#include "simulation.hpp"
#include "statistics.hpp"
#include "theory/closed_forms.hpp"
#include "version.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;

namespace {

constexpr double false_alarm_bound = 4.5;

template <int d>
Simulation<d> gas(std::array<double, d> length, Eigen::Index n, double shear_rate, double time_step,
                  std::uint64_t seed = 1) {
    Simulation<d> simulation;
    simulation.box.length = Eigen::Map<Vec<d>>(length.data());
    simulation.box.shear_rate = shear_rate;
    simulation.particles.resize(n);
    simulation.time_step = time_step;
    simulation.seed = seed;
    randomize(simulation.particles, simulation.box, 1.0, seed);
    return simulation;
}

// The pairs by id, with the separation as stored; across a sheared boundary j is the image.
template <int d>
auto pair_set(Simulation<d> const& simulation, Search search, double time) {
    PairSearch<d> finder;
    finder.search = search;
    finder.cutoff = simulation.pair_search.cutoff;
    PairList<d> pairs;
    finder.find(simulation.particles, simulation.box, time, {}, pairs);
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::array<double, d + 1>> found;
    for (std::size_t k = 0; k < pairs.count; ++k) {
        auto i = simulation.particles.id[pairs.i[k]], j = simulation.particles.id[pairs.j[k]];
        std::array<double, d + 1> geometry;
        double const sign = i < j ? 1.0 : -1.0;
        for (int axis = 0; axis < d; ++axis)
            geometry[static_cast<std::size_t>(axis)] = sign * pairs.unit[static_cast<std::size_t>(axis)][k];
        geometry[d] = std::binary_search(pairs.crossing.begin(), pairs.crossing.end(), k)
                          ? sign
                          : 0.0;  // which side the image is on
        bool const added = found.emplace(std::pair{std::min(i, j), std::max(i, j)}, geometry).second;
        BOOST_TEST(added, "pair listed twice");
    }
    return found;
}

template <int d>
void compare_searches(std::array<double, d> length, Eigen::Index n, double shear_rate, double time) {
    auto simulation = gas<d>(length, n, shear_rate, 0.1);
    auto const cells = pair_set(simulation, Search::cell, time),
               brute = pair_set(simulation, Search::brute, time);
    BOOST_TEST(!brute.empty());
    BOOST_REQUIRE_EQUAL(cells.size(), brute.size());
    for (auto const& [pair, geometry] : brute) {
        auto const found = cells.find(pair);
        BOOST_REQUIRE(found != cells.end());
        for (std::size_t c = 0; c <= d; ++c) BOOST_REQUIRE_SMALL(found->second[c] - geometry[c], 1e-12);
    }
}

template <int d>
std::vector<Stage<d>> stages_named(std::string const& method, int weight) {
    auto const w = static_cast<Weight::Kind>(weight);
    Stage<d> const euler{EulerImpulses{.gamma = 1.5, .sigma = 1.2, .weight = w}};
    Stage<d> const kick{Kick{}}, drift{Drift{}};
    if (method == "euler, new momentum") return {euler, kick, drift};
    if (method == "euler, old momentum") return {euler, drift, kick};
    if (method == "scatter") return {Shardlow{.friction = 5.0, .weight = w}, drift, Scatter{}};
    return {Shardlow{.friction = 5.0, .weight = w}, drift};
}

template <int d>
void compare_trajectories(std::string const& method, double shear_rate, int weight) {
    std::array<double, d> length;
    length.fill(5.0);
    length[0] = 4.0;
    std::vector<Simulation<d>> runs;
    for (Search const search : {Search::cell, Search::brute}) {
        auto simulation = gas<d>(length, d == 2 ? 60 : 250, shear_rate, 0.05);
        simulation.pair_search.search = search;
        simulation.pair_search.order = Order::id;
        simulation.stages = stages_named<d>(method, weight);
        for (int step = 0; step < 100; ++step) simulation.advance();
        runs.push_back(std::move(simulation));
    }
    auto const by_id = [](Simulation<d> const& simulation, auto const& field) {
        Field<d> sorted(field.rows(), d);
        for (Eigen::Index p = 0; p < field.rows(); ++p) sorted.row(simulation.particles.id[p]) = field.row(p);
        return sorted;
    };
    BOOST_TEST(
        (by_id(runs[0], runs[0].particles.velocity) == by_id(runs[1], runs[1].particles.velocity)).all());
    BOOST_TEST(
        (by_id(runs[0], runs[0].particles.position) == by_id(runs[1], runs[1].particles.position)).all());
    BOOST_TEST(runs[0].counters.pairs_found == runs[1].counters.pairs_found);
    BOOST_TEST((runs[0].counters.boundary_pairs > 0) == (shear_rate != 0.0));
}

}  // namespace

// --- pair search -----------------------------------------------------------------------------------------

BOOST_DATA_TEST_CASE(cell_search_finds_what_brute_force_finds_in_3d,
                     data::make({0.0, 0.3}) * data::make({0.0, 0.7, 13.1, 1000.3}), shear_rate, time) {
    compare_searches<3>({5.0, 6.3, 4.1}, 400, shear_rate, time);
    compare_searches<3>({2.0, 2.0, 2.0}, 40, shear_rate, time);  // the smallest box
    compare_searches<3>({2.0, 7.9, 3.0}, 100, shear_rate, time);
    compare_searches<3>({12.0, 11.0, 10.0}, 150, shear_rate, time);  // dilute
}

BOOST_DATA_TEST_CASE(cell_search_finds_what_brute_force_finds_in_2d,
                     data::make({0.0, 0.3}) * data::make({0.0, 0.7, 13.1, 1000.3}), shear_rate, time) {
    compare_searches<2>({5.0, 6.3}, 100, shear_rate, time);
    compare_searches<2>({2.0, 2.0}, 20, shear_rate, time);
    compare_searches<2>({30.0, 31.0}, 100, shear_rate, time);
}

BOOST_AUTO_TEST_CASE(dense_clump_and_empty_space) {
    auto simulation = gas<3>({8.0, 8.0, 8.0}, 300, 0.2, 0.1);
    simulation.particles.position *= 0.2;
    auto const cells = pair_set(simulation, Search::cell, 3.3),
               brute = pair_set(simulation, Search::brute, 3.3);
    BOOST_TEST(cells.size() == brute.size());
    BOOST_TEST(cells.size() > 10000u);
}

BOOST_DATA_TEST_CASE(both_searches_give_one_trajectory,
                     data::make({"shardlow", "euler, new momentum", "euler, old momentum", "scatter"}) *
                         data::make({0.0, 0.5}) * data::xrange(5),
                     method, shear_rate, weight) {
    compare_trajectories<2>(method, shear_rate, weight);
    compare_trajectories<3>(method, shear_rate, weight);
}

BOOST_AUTO_TEST_CASE(random_order_is_a_permutation_that_changes_with_the_step) {
    auto simulation = gas<3>({5.0, 5.0, 5.0}, 375, 0.0, 0.1);
    PairSearch<3> finder;
    PairList<3> found, shuffled, again;
    finder.find(simulation.particles, simulation.box, 0.0, {}, found);
    finder.order = Order::random;
    finder.find(simulation.particles, simulation.box, 0.0, {1, 0, 0}, shuffled);
    finder.find(simulation.particles, simulation.box, 0.0, {1, 1, 0}, again);
    auto const listed = [](PairList<3> const& list) {
        std::vector<std::tuple<std::uint32_t, std::uint32_t, double>> all;
        for (std::size_t k = 0; k < list.count; ++k) all.emplace_back(list.i[k], list.j[k], list.distance[k]);
        return all;
    };
    auto a = listed(found), b = listed(shuffled), c = listed(again);
    BOOST_TEST((a != b && b != c));
    // the rank correlation of the new with the old order is zero within its standard error 1/sqrt(n)
    std::map<std::tuple<std::uint32_t, std::uint32_t, double>, double> rank;
    for (std::size_t k = 0; k < a.size(); ++k) rank[a[k]] = double(k);
    double correlation = 0.0;
    double const n = double(a.size()), middle = (n - 1.0) / 2.0;
    for (std::size_t k = 0; k < b.size(); ++k) correlation += (rank.at(b[k]) - middle) * (double(k) - middle);
    correlation /= n * (n * n - 1.0) / 12.0;
    BOOST_TEST(std::abs(correlation) < false_alarm_bound / std::sqrt(n));
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    BOOST_TEST((a == b));
}

BOOST_AUTO_TEST_CASE(too_small_a_box_is_refused) {
    auto simulation = gas<3>({5.0, 1.99, 5.0}, 10, 0.0, 0.1);
    BOOST_CHECK_THROW(simulation.pair_search.check(simulation.box), InputError);
}

BOOST_AUTO_TEST_CASE(coincident_particles_do_not_interact_and_are_counted) {
    auto simulation = gas<3>({4.0, 4.0, 4.0}, 2, 0.0, 0.1);
    simulation.particles.position.row(1) = simulation.particles.position.row(0);
    simulation.stages = {Shardlow{.friction = 5.0}};
    Field<3> const before = simulation.particles.velocity;
    simulation.advance();
    BOOST_TEST((simulation.particles.velocity == before).all());
    BOOST_TEST(simulation.counters.coincident_pairs == 1u);
}

// --- one step, by hand -----------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(one_shardlow_update_of_two_particles) {
    double const m = 2.5, gamma = 3.0, dt = 0.7, kT = 1.7, cutoff = 1.6;
    auto simulation = gas<3>({5.0, 5.0, 5.0}, 2, 0.0, dt, 77);
    auto& p = simulation.particles;
    p.mass = m;
    p.position << 0.2, 1.0, 1.0, 4.7, 1.6, 1.5;  // across the boundary: r_01 = (0.5, -0.6, -0.5)
    p.velocity << 1.0, 2.0, -0.5, 0.3, -1.0, 0.25;
    simulation.pair_search.cutoff = cutoff;
    simulation.stages = {{"drift-free", {[](Simulation<3>&, NoiseKey) {}}},
                         Shardlow{.friction = gamma, .cutoff = cutoff, .kT = kT}};
    double const r = std::sqrt(0.5 * 0.5 + 0.6 * 0.6 + 0.5 * 0.5);
    Eigen::Array3d const e = Eigen::Array3d(0.5, -0.6, -0.5) / r;
    Eigen::Array3d const v0 = p.velocity.row(0), v1 = p.velocity.row(1);
    double const w = gamma * (1.0 - r / cutoff) * dt / m;
    double const a = w / (1.0 + w), b = std::sqrt(a * (1.0 - a) / m);
    double const xi = std::sqrt(2.0 * kT) * normal({77, 0, 1}, 0, 1);  // second stage: stream 1
    double const change = -a * ((v0 - v1) * e).sum() + b * xi;
    simulation.advance();
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        BOOST_TEST(p.velocity(0, axis) == v0[axis] + change * e[axis], boost::test_tools::tolerance(1e-14));
        BOOST_TEST(p.velocity(1, axis) == v1[axis] - change * e[axis], boost::test_tools::tolerance(1e-14));
    }
}

BOOST_DATA_TEST_CASE(one_euler_step_of_two_particles, data::make({true, false}), old_momentum) {
    double const m = 2.5, gamma = 3.0, sigma = 0.8, dt = 0.2;
    auto simulation = gas<2>({5.0, 5.0}, 2, 0.0, dt, 5);
    auto& p = simulation.particles;
    p.mass = m;
    p.position << 1.0, 1.0, 1.3, 1.4;
    p.velocity << 1.0, 2.0, 0.3, -1.0;
    Stage<2> const euler{EulerImpulses{
        .gamma = gamma, .sigma = sigma, .weight = Weight::quadratic, .random_weight = Weight::linear}};
    Stage<2> const kick{Kick{}}, drift{Drift{}};
    simulation.stages = old_momentum ? std::vector{euler, drift, kick} : std::vector{euler, kick, drift};
    double const r = 0.5;
    Eigen::Array2d const e(-0.6, -0.8), x0 = p.position.row(0), v0 = p.velocity.row(0),
                                        v1 = p.velocity.row(1);
    double const momentum = -gamma * 0.25 * ((v0 - v1) * e).sum() * dt +
                            sigma * (1.0 - r) * normal({5, 0, 0}, 0, 1) * std::sqrt(dt);
    simulation.advance();
    for (Eigen::Index axis = 0; axis < 2; ++axis) {
        double const v = v0[axis] + momentum * e[axis] / m;
        BOOST_TEST(p.velocity(0, axis) == v, boost::test_tools::tolerance(1e-14));
        BOOST_TEST(p.velocity(1, axis) == v1[axis] - momentum * e[axis] / m,
                   boost::test_tools::tolerance(1e-14));
        BOOST_TEST(p.position(0, axis) == x0[axis] + (old_momentum ? v0[axis] : v) * dt,
                   boost::test_tools::tolerance(1e-14));
    }
}

// A pair at rest relative to the flow on either side of the Lees-Edwards boundary sees the shear and nothing
// else.
BOOST_AUTO_TEST_CASE(friction_across_the_sheared_boundary_sees_the_images_velocity) {
    double const rate = 0.3, L = 6.0;
    auto simulation = gas<2>({L, L}, 2, rate, 0.1);
    auto& p = simulation.particles;
    simulation.time = 2.0;             // the image above is displaced by 0.3*6*2 = 3.6
    p.position << 1.0, 5.8, 3.6, 0.2;  // the image of particle 1: (1.2, 6.2), at velocity u(6.2)
    for (Eigen::Index i = 0; i < 2; ++i)
        p.velocity.row(i) << simulation.box.flow_velocity(p.position(i, 1)), 0.0;
    p.position(1, 0) = 3.6;
    p.position(1, 0) = std::fmod(1.2 - 3.6 + L, L);
    simulation.stages = {Shardlow{.friction = 2.0, .kT = 0.0}};
    auto const& pairs = simulation.pairs();
    BOOST_REQUIRE_EQUAL(pairs.count, 1u);
    BOOST_TEST(pairs.crossing.size() == 1u);
    double const r = std::hypot(0.2, 0.4), w = 0.2 * (1.0 - r), a = w / (1.0 + w);
    // v_i - v_image = rate*(5.8 - 6.2) along x; e = (-0.2, -0.4)/r
    double const change = -a * (rate * -0.4) * (-0.2 / r);
    double const before = p.velocity(pairs.i[0], 0);
    Eigen::Index const i = pairs.i[0];
    simulation.advance();
    BOOST_TEST(p.velocity(i, 0) - before == change * (-0.2 / r), boost::test_tools::tolerance(1e-12));
}

// --- conservation ----------------------------------------------------------------------------------------

BOOST_DATA_TEST_CASE(momentum_is_conserved_to_rounding,
                     data::make({"shardlow", "euler, new momentum", "euler, old momentum"}) *
                         data::make({0.0, 0.2}),
                     method, shear_rate) {
    auto simulation = gas<3>({6.0, 8.0, 6.0}, 860, shear_rate, 0.02);
    simulation.stages = stages_named<3>(method, 1);
    Vec<3> const start = total_momentum(simulation.particles, simulation.box);
    for (int step = 0; step < 500; ++step) simulation.advance();
    // 500 steps of ~5000 impulses of order 0.1, each rounded to 1e-16: a random walk of 1e-13
    BOOST_TEST((total_momentum(simulation.particles, simulation.box) - start).norm() < 2e-11);
}

BOOST_AUTO_TEST_CASE(drift_in_shear_carries_peculiar_velocities_and_images_along) {
    auto simulation = gas<2>({5.0, 7.0}, 50, 0.4, 0.3);
    simulation.stages = {Drift{}};
    auto const& p = simulation.particles;
    std::vector<double> free_velocity, start_y, start_peculiar;
    for (Eigen::Index i = 0; i < 50; ++i) {
        free_velocity.push_back(p.velocity(i, 1));
        start_y.push_back(p.position(i, 1));
        start_peculiar.push_back(p.velocity(i, 0) - simulation.box.flow_velocity(p.position(i, 1)));
    }
    for (int step = 0; step < 200; ++step) simulation.advance();
    for (Eigen::Index i = 0; i < 50; ++i) {
        auto const k = static_cast<std::size_t>(i);
        double const travelled = free_velocity[k] * 60.0;
        BOOST_TEST(p.position(i, 1) + 7.0 * p.image(i, 1) == start_y[k] + travelled,
                   boost::test_tools::tolerance(1e-10));
        // a free particle keeps its laboratory velocity; its peculiar one changes by the flow it leaves
        // behind
        double const now = p.velocity(i, 0) - simulation.box.flow_velocity(p.position(i, 1));
        BOOST_TEST(now - start_peculiar[k] == -0.4 * travelled, boost::test_tools::tolerance(1e-9));
    }
}

// --- noise -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(batch_noise_equals_scalar_noise) {
    std::vector<std::uint32_t> id(1000), i, j;
    for (std::uint32_t k = 0; k < 1000; ++k) id[k] = (k * 7919u) % 1000u;
    for (std::uint32_t k = 0; k < 997; ++k) {
        i.push_back(k);
        j.push_back((k * 31u + 5u) % 1000u);
    }
    std::vector<double> batch(i.size());
    for (std::uint64_t const seed : {std::uint64_t{0}, std::uint64_t{42}, ~std::uint64_t{0}}) {
        NoiseKey const key{seed, (std::uint64_t{1} << 40) + 3, 7};
        pair_normals(key, i, j, id.data(), batch);
        for (std::size_t k = 0; k < i.size(); ++k) {
            auto const a = id[i[k]], b = id[j[k]];
            BOOST_TEST(batch[k] == normal(key, std::min(a, b), std::max(a, b)),
                       boost::test_tools::tolerance(1e-13));
        }
    }
}

BOOST_AUTO_TEST_CASE(noise_is_standard_normal_and_independent) {
    constexpr std::size_t n = 1'000'000;
    std::vector<std::uint32_t> id(n + 1), i(n), j(n);
    for (std::uint32_t k = 0; k <= n; ++k) id[k] = k;
    for (std::uint32_t k = 0; k < n; ++k) i[k] = k, j[k] = k + 1;
    std::vector<double> x(n), other(n);
    pair_normals({1, 0, 0}, i, j, id.data(), x);
    for (auto const key : {NoiseKey{1, 1, 0}, NoiseKey{2, 0, 0}, NoiseKey{1, 0, 1}}) {
        pair_normals(key, i, j, id.data(), other);
        double correlation = 0.0;
        for (std::size_t k = 0; k < n; ++k) correlation += x[k] * other[k];
        BOOST_TEST(std::abs(correlation) / std::sqrt(double(n)) < false_alarm_bound);
    }
    std::array<double, 7> moment{};
    double tail = 0.0, neighbours = 0.0;
    for (std::size_t k = 0; k < n; ++k) {
        double power = 1.0;
        for (std::size_t q = 0; q < 7; ++q, power *= x[k]) moment[q] += power / double(n);
        tail += std::abs(x[k]) > 4.0;
        if (k > 0) neighbours += x[k] * x[k - 1];
    }
    // variance of x^q under the normal: <x^2q> - <x^q>^2
    double const sigma = 1.0 / std::sqrt(double(n));
    BOOST_TEST(std::abs(moment[1]) < false_alarm_bound * sigma);
    BOOST_TEST(std::abs(moment[2] - 1.0) < false_alarm_bound * sigma * std::sqrt(2.0));
    BOOST_TEST(std::abs(moment[3]) < false_alarm_bound * sigma * std::sqrt(15.0));
    BOOST_TEST(std::abs(moment[4] - 3.0) < false_alarm_bound * sigma * std::sqrt(96.0));
    BOOST_TEST(std::abs(moment[6] - 15.0) < false_alarm_bound * sigma * std::sqrt(10170.0));
    double const expected = double(n) * std::erfc(4.0 / std::numbers::sqrt2);
    BOOST_TEST(std::abs(tail - expected) < false_alarm_bound * std::sqrt(expected));
    BOOST_TEST(std::abs(neighbours) * sigma < false_alarm_bound);
}

// --- stress against counted momentum ---------------------------------------------------------------------

// Counts the x momentum that really passes planes of constant y, in the frame of the flow there, and compares
// its mean over steps and planes with the estimators. Forgetting the streaming term would shift the kinetic
// stress by n kT rate dt/2 = 0.225, fifty standard errors.
BOOST_AUTO_TEST_CASE(stress_estimators_equal_the_momentum_through_planes) {
    double const rate = 0.3, dt = 0.5, L = 8.0, area = 25.0;
    constexpr int planes = 16, steps = 1500;
    auto simulation = gas<3>({5.0, L, 5.0}, 600, rate, dt);
    Shardlow const thermostat{.friction = 4.0};
    Drift const drift;
    std::vector<double> kinetic_difference, collision_difference;
    for (int step = 0; step < steps; ++step) {
        auto const s = static_cast<std::uint64_t>(step);
        auto& p = simulation.particles;
        act(thermostat, simulation, {1, s, 0});
        auto const& pairs = simulation.pairs();
        double flux = 0.0;
        for (std::size_t k = 0; k < pairs.count; ++k) {
            double const y_i = p.position(pairs.i[k], 1), y_j = y_i - pairs.unit[1][k] * pairs.distance[k];
            for (int turn = -1; turn <= 1; ++turn)
                for (int plane = 0; plane < planes; ++plane) {
                    double const y = (plane + 0.5) * L / planes + turn * L;
                    if ((y_i > y) == (y_j > y)) continue;
                    flux += (y_i > y ? 1.0 : -1.0) * pairs.impulse[k] * pairs.unit[0][k];
                }
        }
        double const counted_collision = -flux / (planes * area * dt);
        collision_difference.push_back(collision_stress(pairs, 1.0, simulation.box, dt) - counted_collision);

        flux = 0.0;
        for (Eigen::Index i = 0; i < p.size(); ++i) {
            double const from = p.position(i, 1), to = from + p.velocity(i, 1) * dt;
            for (int turn = -2; turn <= 2; ++turn)
                for (int plane = 0; plane < planes; ++plane) {
                    double const y = (plane + 0.5) * L / planes + turn * L;
                    if ((from > y) == (to > y)) continue;
                    flux += (to > y ? 1.0 : -1.0) * (p.velocity(i, 0) - simulation.box.flow_velocity(y));
                }
        }
        double const counted_kinetic = -flux / (planes * area * dt);
        kinetic_difference.push_back(kinetic_stress(p, simulation.box, dt) - counted_kinetic);
        act(drift, simulation, {});
        simulation.step = s + 1;
    }
    for (auto const* difference : {&kinetic_difference, &collision_difference}) {
        Estimate const estimate = blocking(*difference);
        BOOST_TEST(std::abs(estimate.value) < false_alarm_bound * estimate.error);
        BOOST_TEST(estimate.error < 0.005);
    }
}

// Exactly, step by step: free streaming in the sheared frame gains peculiar energy, stress * rate * V * dt.
BOOST_AUTO_TEST_CASE(drift_gains_the_work_of_the_kinetic_stress) {
    double const rate = 0.4, dt = 0.1;
    auto simulation = gas<3>({6.0, 8.0, 6.0}, 864, rate, dt);
    auto const energy = [&] {
        return 0.5 * kinetic_temperature(simulation.particles, simulation.box) * 3.0 * 863.0;
    };
    for (std::uint64_t step = 0; step < 300; ++step) {
        act(Shardlow{.friction = 3.0}, simulation, {1, step, 0});
        double const before = energy(), stress = kinetic_stress(simulation.particles, simulation.box, dt);
        act(Drift{}, simulation, {});
        simulation.step = step + 1;
        BOOST_REQUIRE_SMALL(energy() - before - stress * rate * simulation.box.volume() * dt, 1e-9);
    }
}

// --- equilibrium -----------------------------------------------------------------------------------------

// S1 keeps kT and g(r) = 1 at any step: no tolerance but the error bar.
BOOST_DATA_TEST_CASE(shardlow_keeps_temperature_and_structure_at_any_step,
                     data::make({0.001, 0.1, 1.0, 10.0}) * data::make({1.0, 1000.0}), time_step, friction) {
    double const m = 2.0, kT = 1.5;
    auto simulation = gas<3>({8.0, 8.0, 8.0}, 1536, 0.0, time_step);
    simulation.particles.mass = m;
    randomize(simulation.particles, simulation.box, kT, 3);
    simulation.stages = {Shardlow{.friction = friction, .kT = kT}, Drift{}};
    std::vector<double> temperature, pairs;
    double const ball = 4.0 * std::numbers::pi / 3.0;
    double const expected = 0.5 * 1536.0 * 1535.0 * ball / simulation.box.volume();
    for (int step = 0; step < 400; ++step) {
        simulation.advance();
        temperature.push_back(kinetic_temperature(simulation.particles, simulation.box) / kT);
        pairs.push_back(double(simulation.pairs().count) / expected);
    }
    // Short runs at a small step, or of a gas that friction freezes in place, are hardly longer than their
    // correlation; since the start is already in equilibrium, the spread of one sample bounds their error:
    // sqrt(2/(3N)) for kT, 1/sqrt(pairs) for the number of pairs.
    double const single_kT = std::sqrt(2.0 / (3.0 * 1536.0)), single_pairs = 1.0 / std::sqrt(expected);
    Estimate const t = blocking(temperature), g = blocking(pairs);
    BOOST_TEST(std::abs(t.value - 1.0) < false_alarm_bound * (time_step < 0.1 ? single_kT : t.error));
    BOOST_TEST(std::abs(g.value - 1.0) < false_alarm_bound * (time_step < 1.0 ? single_pairs : g.error));
}

// With frozen positions each normal mode of the Euler friction settles at kT/(1 - rate dt/2):
// theory/MY1997.md.
BOOST_AUTO_TEST_CASE(euler_with_frozen_neighbours_heats_each_mode_by_its_rate) {
    double const dt = 0.1, m = 1.4, gamma = 0.9, sigma = 0.8;
    constexpr Eigen::Index n = 24;
    auto simulation = gas<2>({4.0, 4.0}, n, 0.0, dt, 9);
    simulation.particles.mass = m;
    simulation.pair_search.cutoff = 2.0;
    simulation.stages = {
        EulerImpulses{.gamma = gamma, .sigma = sigma, .weight = Weight::parabolic, .cutoff = 2.0}, Kick{}};
    Eigen::MatrixXd friction = Eigen::MatrixXd::Zero(2 * n, 2 * n);
    auto const& pairs = simulation.pairs();
    for (std::size_t k = 0; k < pairs.count; ++k) {
        Eigen::VectorXd e = Eigen::VectorXd::Zero(2 * n);
        for (Eigen::Index axis = 0; axis < 2; ++axis) {
            e[2 * pairs.i[k] + axis] = pairs.unit[static_cast<std::size_t>(axis)][k];
            e[2 * pairs.j[k] + axis] = -e[2 * pairs.i[k] + axis];
        }
        friction += gamma / m * (1.0 - std::pow(pairs.distance[k] / 2.0, 2)) * e * e.transpose();
    }
    Eigen::VectorXd const rate = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(friction).eigenvalues();
    BOOST_TEST_REQUIRE(rate.maxCoeff() * dt < 1.5);
    // the two modes of the total momentum stay at rest; kT counts the other 2(n-1)
    double expected = 0.0;
    for (Eigen::Index k = 2; k < 2 * n; ++k)
        expected += sigma * sigma / (2.0 * gamma) / (1.0 - 0.5 * rate[k] * dt);
    expected /= double(2 * (n - 1));
    BOOST_TEST(expected > 1.05 * sigma * sigma / (2.0 * gamma));
    std::vector<double> temperature;
    for (int step = 0; step < 200'000; ++step) {
        simulation.advance();
        if (step > 2000) temperature.push_back(kinetic_temperature(simulation.particles, simulation.box));
    }
    Estimate const estimate = blocking(temperature);
    BOOST_TEST(std::abs(estimate.value - expected) < false_alarm_bound * estimate.error);
    BOOST_TEST(estimate.error < 0.005 * expected);
}

BOOST_AUTO_TEST_CASE(no_friction_changes_nothing) {
    auto simulation = gas<3>({6.0, 6.0, 6.0}, 648, 0.0, 0.5);
    simulation.stages = {Shardlow{.friction = 0.0}};
    Field<3> const before = simulation.particles.velocity;
    simulation.advance();
    std::map<std::uint32_t, Eigen::Index> row;
    for (Eigen::Index p = 0; p < 648; ++p) row[simulation.particles.id[p]] = p;
    for (std::uint32_t id = 0; id < 648; ++id)
        BOOST_REQUIRE((simulation.particles.velocity.row(row.at(id)) == before.row(id)).all());
}

// Eqs. 9 and 17 of NG2007 are exact if every partner is a stranger: pairs, directions and distances drawn at
// random, as many as an ideal gas has. What a simulation with redrawn positions still differs by at long
// steps is then due to correlations within one step.
BOOST_AUTO_TEST_CASE(retention_factors_are_exact_for_random_partners) {
    constexpr std::size_t n = 10'000;
    constexpr int repetitions = 60;
    double const density = 3.0, gamma = 9.0, dt = 0.2, correlation = 0.6;
    theory::Gas const gas{.d = 3, .n = density};
    theory::Shardlow const thermostat{.gamma = gamma};
    std::mt19937_64 random(7);
    std::normal_distribution<double> gauss;
    std::uniform_real_distribution<double> flat;
    std::poisson_distribution<int> pair_count(0.5 * double(n) * density * 4.0 * std::numbers::pi / 3.0);
    std::vector<double> velocity_kept, stress_kept;
    for (int repetition = 0; repetition < repetitions; ++repetition) {
        std::vector<Eigen::Vector3d> v(n);
        for (auto& u : v) {
            u = {gauss(random), gauss(random), gauss(random)};
            u[1] = correlation * u[0] + std::sqrt(1.0 - correlation * correlation) * u[1];
        }
        auto const before = v;
        for (int pair = pair_count(random); pair > 0; --pair) {
            auto const i = static_cast<std::size_t>(flat(random) * n),
                       j = static_cast<std::size_t>(flat(random) * n);
            if (i == j) continue;
            Eigen::Vector3d e(gauss(random), gauss(random), gauss(random));
            e.normalize();
            double const w = gamma * (1.0 - std::cbrt(flat(random))), a = update_a<Scheme::shardlow>(w * dt);
            double const change =
                -a * (v[i] - v[j]).dot(e) + update_b(a, 1.0) * std::sqrt(2.0) * gauss(random);
            v[i] += change * e;
            v[j] -= change * e;
        }
        double product = 0.0, square = 0.0, stress_before = 0.0, stress_after = 0.0;
        for (std::size_t p = 0; p < n; ++p) {
            product += v[p][2] * before[p][2];
            square += before[p][2] * before[p][2];
            stress_before += before[p][0] * before[p][1];
            stress_after += v[p][0] * v[p][1];
        }
        velocity_kept.push_back(product / square);
        stress_kept.push_back(stress_after / stress_before);
    }
    Estimate const velocity = independent(velocity_kept), stress = independent(stress_kept);
    BOOST_TEST(std::abs(velocity.value - theory::velocity_retention(gas, thermostat, dt)) <
               false_alarm_bound * velocity.error);
    BOOST_TEST(std::abs(stress.value - theory::stress_retention(gas, thermostat, dt)) <
               false_alarm_bound * stress.error);
    BOOST_TEST(velocity.error < 0.003);
    BOOST_TEST(stress.error < 0.005);
}

// Euler beyond its critical step ends with the step's number, not with NaN.
BOOST_AUTO_TEST_CASE(divergence_is_reported_with_its_step) {
    auto simulation = gas<2>({20.0, 20.0}, 80, 0.0, 2.0);
    simulation.pair_search.cutoff = 4.0;
    simulation.hottest = 1e6;
    simulation.stages = {EulerImpulses{.cutoff = 4.0}, Kick{}, Drift{}};
    auto const go = [&] {
        for (int step = 0; step < 1000; ++step) simulation.advance();
    };
    BOOST_CHECK_EXCEPTION(go(), Diverged, [&](Diverged const& divergence) {
        return std::string(divergence.what()).find("step " + std::to_string(simulation.step + 1)) !=
               std::string::npos;
    });
    BOOST_TEST(simulation.step < 999u);
}

// In free flight at a step of zero nothing moves: a limit just below the temperature ends the run, one just
// above does not. In shear the flow is allowed for.
BOOST_AUTO_TEST_CASE(divergence_is_seen_just_beyond_the_limit) {
    for (double const rate : {0.0, 0.4}) {
        auto simulation = gas<2>({20.0, 20.0}, 80, rate, 0.0);
        simulation.stages = {Drift{}};
        double const flow = std::pow(simulation.box.image_speed(), 2), kT = flow + 2.0;
        auto& velocity = simulation.particles.velocity;
        velocity *= std::sqrt(kT * double(velocity.size()) / velocity.square().sum());
        simulation.hottest = kT * (1.0 + 1e-12) - flow;
        simulation.advance();
        simulation.hottest = kT * (1.0 - 1e-12) - flow;
        BOOST_CHECK_THROW(simulation.advance(), Diverged);
    }
}

BOOST_AUTO_TEST_CASE(a_position_that_is_no_number_is_refused) {
    auto simulation = gas<2>({20.0, 20.0}, 80, 0.0, 0.1);
    simulation.particles.velocity(3, 1) = std::nan("");
    simulation.stages = {Drift{}};
    BOOST_CHECK_THROW(simulation.advance(), Diverged);
}

// --- results of the engine's revision ---------------------------------------------------------------------

// FNV-1a of the bits of all velocities, by id.
template <int d>
std::uint64_t fingerprint(Particles<d> const& particles) {
    std::vector<Eigen::Index> row(static_cast<std::size_t>(particles.size()));
    for (Eigen::Index p = 0; p < particles.size(); ++p) row[particles.id[p]] = p;
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (Eigen::Index const p : row)
        for (int axis = 0; axis < d; ++axis) {
            auto const bits = std::bit_cast<std::uint64_t>(particles.velocity(p, axis));
            for (int byte = 0; byte < 8; ++byte) hash = (hash ^ (bits >> 8 * byte & 0xff)) * 0x100000001b3u;
        }
    return hash;
}

template <int d>
void check_fingerprint(std::array<double, d> length, double density, double shear_rate,
                       std::uint64_t expected) {
    double volume = density;
    for (double const side : length) volume *= side;
    auto simulation = gas<d>(length, static_cast<Eigen::Index>(volume), shear_rate, 0.05);
    simulation.stages = {Shardlow{.friction = 4.5}, Verlet{.potential = Soft{.strength = 25.0}}};
    for (int step = 0; step < 400; ++step) simulation.advance();
    BOOST_TEST(fingerprint(simulation.particles) == expected);
}

// An engine that is faster must not order updates or sums in another way: what is in caches and in figures
// would no longer be its results. A change that means to raises engine_revision, and these numbers change.
// The boxes have sides of more than three cutoffs, of two to three, and of just two.
BOOST_AUTO_TEST_CASE(
    trajectories_have_the_bits_of_this_revision,
    *boost::unit_test::enable_if<std::string_view(build_flags).find("native") == std::string_view::npos>()) {
    BOOST_TEST(engine_revision == 2);
    check_fingerprint<3>({8.0, 9.0, 7.0}, 3.0, 0.0, 9022893653780782198u);
    check_fingerprint<3>({8.0, 9.0, 7.0}, 3.0, 0.1, 3393816861165886521u);
    check_fingerprint<3>({2.5, 9.0, 7.0}, 3.0, 0.1, 16934750259854406030u);
    check_fingerprint<3>({7.0, 2.5, 3.5}, 3.0, 0.0, 3613597330962874905u);
    check_fingerprint<3>({7.0, 3.5, 2.5}, 1.0, 0.1, 14511043868650684351u);
    check_fingerprint<3>({2.0, 2.5, 2.2}, 8.0, 0.0, 18083791436276472124u);
    check_fingerprint<2>({12.0, 9.0}, 3.0, 0.1, 13259042830041303842u);
    check_fingerprint<2>({2.6, 2.1}, 6.0, 0.0, 6653940592827652788u);
}
