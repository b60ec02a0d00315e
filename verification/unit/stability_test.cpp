/// @file
/// Stability maps: the search for an edge, the limits it is compared with, storage, bad input.
#define BOOST_TEST_MODULE stability
#include "stability.hpp"

#include <unistd.h>

#include <Eigen/Dense>
#include <boost/math/quadrature/gauss.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <fstream>
#include <numbers>
#include <string>

#include "errors.hpp"
#include "files.hpp"
#include "forces.hpp"
#include "run.hpp"
#include "theory/closed_forms.hpp"
#include "toml_reader.hpp"

using namespace dpd;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Turns hot at one step and diverges at another; counts the trials.
struct Synthetic {
    double hot, diverged;
    int trials = 0;
    Trial operator()(double step) {
        ++trials;
        return {.step = step,
                .outcome = step >= diverged ? Outcome::diverged
                           : step >= hot    ? Outcome::hot
                                            : Outcome::stable};
    }
};

constexpr StepRange search{.smallest = 1e-3, .largest = 10.0, .resolution = 0.1};

void check_edge(Edge const& edge, double at, double resolution) {
    BOOST_TEST(edge.below < at);
    BOOST_TEST(edge.above >= at);
    BOOST_TEST(edge.above <= edge.below * (1.0 + resolution));
    BOOST_TEST(edge.step() > edge.below);
    BOOST_TEST(edge.step() < edge.above);
}

std::string replaced(std::string text, std::string const& from, std::string const& to) {
    auto const at = text.find(from);
    BOOST_REQUIRE_MESSAGE(at != std::string::npos, "there is no " << from);
    return text.replace(at, from.size(), to);
}

/// Two integrators, small and coarse.
std::string const definition = R"(weight = "quadratic"
integrators = ["Euler", "S1"]
[scene]
dimension = 3
[scene.particles]
number = 100
[start]
integrator = "S1"
friction = 25.0
step = 0.01
duration = 0.5
[budget.paper]
smallest = 1e-3
largest = 10.0
resolution = 0.1
time = 2.0
fewest = 300
most = 400
[budget.quick]
smallest = 1e-2
largest = 10.0
resolution = 1.0
time = 1.0
fewest = 20
most = 50
[[map]]
name = "friction"
friction = [4.5, 10.0]
repulsion = [0.0]
density = [3.0]
[map.quick]
friction = [4.5]
[[map]]
name = "repulsion"
friction = [4.5]
repulsion = [0.0, 25.0]
density = [3.0]
)";

std::string const integrators = R"([[integrator]]
name = "Euler"
friction = "euler.gamma"
noise = "euler.sigma"
repulsion = "force.soft.strength"
stages = ["euler", "force", "kick", "drift"]
sheared_stages = []
[integrator.settings]
"euler.weight" = "quadratic"
[[integrator]]
name = "S1"
friction = "shardlow.friction"
largest_friction_step = 20.0
repulsion = "verlet.soft.strength"
stages = ["shardlow", "verlet"]
sheared_stages = []
[integrator.settings]
"shardlow.weight" = "quadratic"
)";

struct Fixture {
    Fixture() { std::filesystem::create_directories(directory); }
    ~Fixture() { std::filesystem::remove_all(directory); }
    std::filesystem::path const directory =
        std::filesystem::temp_directory_path() / ("dpdref_stability_test." + std::to_string(::getpid()));
    std::filesystem::path write(std::string const& text) const {
        auto const file = directory / "stability.toml";
        std::ofstream(file) << text;
        std::ofstream(directory / "integrators.toml") << integrators;
        return file;
    }
};

bool same(Trials const& a, Trials const& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](auto const& x, auto const& y) {
        return x.first == y.first && x.second.outcome == y.second.outcome &&
               x.second.steps == y.second.steps && x.second.trace.size() == y.second.trace.size() &&
               (x.second.outcome == Outcome::diverged ||
                (x.second.kT.value == y.second.kT.value && x.second.kT.error == y.second.kT.error &&
                 x.second.kT.blocks == y.second.kT.blocks && x.second.trace == y.second.trace));
    });
}

/// Of the averages over directions and distances of grad grad U, along the wave, times 1 - cos(k.r).
double frequency_by_angles(theory::Gas const& gas, double a, double k) {
    using Gauss = boost::math::quadrature::gauss<double, 60>;
    auto const along = [&](double r, double cosine) {
        double const bend = a / gas.rc * cosine * cosine,
                     slope = -a * (1.0 - r / gas.rc) / r * (1.0 - cosine * cosine);
        return (bend + slope) * (1.0 - std::cos(k * r * cosine));
    };
    double const sum = Gauss::integrate(
        [&](double r) {
            auto const over_angle = [&](double angle) {
                double const measure = gas.d == 2 ? 2.0 : 2.0 * std::numbers::pi * std::sin(angle);
                return measure * along(r, std::cos(angle));
            };
            return std::pow(r, gas.d - 1) * Gauss::integrate(over_angle, 0.0, std::numbers::pi);
        },
        0.0, gas.rc);
    return std::sqrt(gas.n / gas.m * sum);
}

}  // namespace

BOOST_AUTO_TEST_CASE(bisection_finds_both_edges) {
    Synthetic outcome{.hot = 0.0371, .diverged = 1.234};
    auto const trials = bisect(search, std::ref(outcome));
    check_edge(edge_of(trials, Outcome::stable), outcome.hot, search.resolution);
    check_edge(edge_of(trials, Outcome::hot), outcome.diverged, search.resolution);
    BOOST_TEST(monotonic(trials));
    // log2(ln(range)/ln(1 + resolution)) halvings for each edge, and no step twice
    double const halvings = std::log2(std::log(1e4) / std::log(1.1));
    BOOST_TEST(outcome.trials <= 1 + 2 * int(std::ceil(halvings)));
    BOOST_TEST(std::size_t(outcome.trials) == trials.size());
}

BOOST_AUTO_TEST_CASE(bisection_without_an_edge) {
    Synthetic stable{.hot = 11.0, .diverged = 12.0};
    auto trials = bisect(search, std::ref(stable));
    BOOST_TEST(stable.trials == 1);
    BOOST_TEST(edge_of(trials, Outcome::stable).above == infinity);
    BOOST_TEST(edge_of(trials, Outcome::hot).above == infinity);
    Synthetic hot{.hot = 0.1, .diverged = 12.0};
    trials = bisect(search, std::ref(hot));
    check_edge(edge_of(trials, Outcome::stable), 0.1, search.resolution);
    BOOST_TEST(edge_of(trials, Outcome::hot).above == infinity);
    Synthetic bad{.hot = 1e-4, .diverged = 1e-4};
    trials = bisect(search, std::ref(bad));
    BOOST_TEST(edge_of(trials, Outcome::stable).below == 0.0);
    BOOST_TEST(edge_of(trials, Outcome::stable).above <= search.smallest * 1.1);
    Synthetic sudden{.hot = 0.5, .diverged = 0.5};
    trials = bisect(search, std::ref(sudden));
    BOOST_TEST(edge_of(trials, Outcome::stable).below == edge_of(trials, Outcome::hot).below);
}

BOOST_AUTO_TEST_CASE(a_better_outcome_beyond_a_worse_one_is_noticed) {
    Trials trials;
    for (auto const& [step, outcome] :
         {std::pair{0.1, Outcome::stable}, {0.2, Outcome::hot}, {0.3, Outcome::stable}})
        trials.emplace(step, Trial{.step = step, .outcome = outcome});
    BOOST_TEST(!monotonic(trials));
    BOOST_TEST(edge_of(trials, Outcome::stable).below == 0.1);
    BOOST_TEST(edge_of(trials, Outcome::stable).above == 0.2);
}

BOOST_AUTO_TEST_CASE(trials_have_bounds_and_traces_end_with_them) {
    TrialLength const length{.time = 5.0, .fewest = 100, .most = 1000};
    BOOST_TEST(length.steps(1.0) == 100u);
    BOOST_TEST(length.steps(0.02) == 250u);
    BOOST_TEST(length.steps(1e-4) == 1000u);
    for (std::uint64_t const steps : {1, 2, 30, 1000, 6001}) {
        auto const kept = trace_steps(steps);
        BOOST_TEST(kept.front() == 1u);
        BOOST_TEST(kept.back() == steps);
        BOOST_TEST(std::is_sorted(kept.begin(), kept.end(), std::less_equal<>()));
        BOOST_TEST(kept.size() <= 300u);
    }
    BOOST_TEST(trace_steps(0).empty());
}

BOOST_AUTO_TEST_CASE(harmonic_limit_is_that_of_the_stiffest_density_wave) {
    for (int const d : {2, 3}) {
        theory::Gas const gas{.d = d, .n = 2.7, .m = 1.9, .rc = 1.3};
        double const a = 17.0, limit = theory::harmonic_limit(gas, a);
        // the part without cos(k.r), the Einstein frequency for g = 1, vanishes and need not be left out
        for (double const k : {0.4, 2.9, 7.7})
            BOOST_TEST(theory::random_phase_frequency(gas, a, k) == frequency_by_angles(gas, a, k),
                       boost::test_tools::tolerance(1e-9));
        double largest = 0.0;
        for (double k = 0.1; k < 40.0; k += 0.01)
            largest = std::max(largest, theory::random_phase_frequency(gas, a, k));
        BOOST_TEST(limit <= 2.0 / largest);
        BOOST_TEST(limit == 2.0 / largest, boost::test_tools::tolerance(1e-5));
        double const l = 1.7, t = 0.6, u = 2.9;  // units
        theory::Gas const other{.d = d, .n = gas.n / std::pow(l, d), .m = gas.m * u, .rc = gas.rc * l};
        BOOST_TEST(theory::harmonic_limit(other, a * u * l / (t * t)) == t * limit,
                   boost::test_tools::tolerance(1e-9));
    }
    theory::Gas const gas{.n = 3.0};
    for (double const bad : {0.0, -1.0, infinity}) {
        BOOST_CHECK_THROW(theory::harmonic_limit(gas, bad), std::invalid_argument);
        BOOST_CHECK_THROW(theory::harmonic_limit({.n = bad}, 25.0), std::invalid_argument);
        BOOST_CHECK_THROW(theory::random_phase_frequency(gas, 25.0, bad), std::invalid_argument);
    }
    BOOST_CHECK_THROW(theory::harmonic_limit({.d = 4, .n = 3.0}, 25.0), std::invalid_argument);
}

// The largest eigenvalues against those of matrices that the engine's own stages give, column by column.
BOOST_AUTO_TEST_CASE(frozen_limits_are_those_of_the_engine) {
    constexpr int d = 3;
    double const friction = 4.5, strength = 25.0, dt = 1e-3;
    Scene const scene = parse_scene(
        "dimension = 3\nseed = 5\nstages = ['drift']\n[box]\nlength = [2.0, 2.2, 2.1]\n"
        "[particles]\nnumber = 28\nmass = 1.5\n[time]\nstep = 0.001\nduration = 1.0\n",
        "frozen");
    auto simulation = build<d>(scene, {});
    auto& particles = simulation.particles;
    auto const size = d * particles.size();
    auto const flat = [&](Field<d> const& field) {
        Eigen::VectorXd vector(size);
        for (Eigen::Index p = 0; p < particles.size(); ++p)
            for (int axis = 0; axis < d; ++axis) vector[d * particles.id[p] + axis] = field(p, axis);
        return vector;
    };
    auto const row_of = [&](Eigen::Index id) {
        Eigen::Index p = 0;
        while (particles.id[p] != id) ++p;
        return p;
    };
    auto const limits = frozen_limits(particles, simulation.box, friction, Weight::quadratic, strength);
    Eigen::MatrixXd rates(size, size), hessian(size, size);
    EulerImpulses const impulses{.gamma = friction, .sigma = 0.0, .weight = Weight::quadratic};
    Soft const soft{.strength = strength};
    double const h = 1e-6;
    for (Eigen::Index column = 0; column < size; ++column) {
        particles.velocity.setZero();
        particles.velocity(row_of(column / d), int(column % d)) = 1.0;
        act(impulses, simulation, {});
        rates.col(column) = -flat(simulation.momentum_change) / (particles.mass * dt);
        Eigen::VectorXd change = Eigen::VectorXd::Zero(size);
        for (double const sign : {1.0, -1.0}) {
            particles.position(row_of(column / d), int(column % d)) += sign * h;
            simulation.positions_changed();
            change += sign * flat(forces(simulation, soft));
            particles.position(row_of(column / d), int(column % d)) -= sign * h;
            simulation.positions_changed();
        }
        hessian.col(column) = -change / (2.0 * h * particles.mass);
    }
    auto const largest = [](Eigen::MatrixXd const& matrix) {
        return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(0.5 * (matrix + matrix.transpose()))
            .eigenvalues()
            .maxCoeff();
    };
    BOOST_TEST(limits.friction == 2.0 / largest(rates), boost::test_tools::tolerance(1e-9));
    BOOST_TEST(limits.repulsion == 2.0 / std::sqrt(largest(hessian)), boost::test_tools::tolerance(1e-6));
    auto const none = frozen_limits(particles, simulation.box, 0.0, Weight::quadratic, 0.0);
    BOOST_TEST(none.friction == infinity);
    BOOST_TEST(none.repulsion == infinity);
}

BOOST_FIXTURE_TEST_CASE(points_are_what_the_axes_say, Fixture) {
    auto const maps = load_stability(write(definition), "paper");
    BOOST_REQUIRE(maps.size() == 2);
    BOOST_REQUIRE(maps[0].points.size() == 4);
    for (auto const& map : maps)
        for (auto const& point : map.points) {
            auto const trial = parse_scene(point.scene, "trial", {"time.step=0.01", "time.duration=1"});
            auto const start = parse_scene(point.start, "start");
            for (auto const& scene : {trial, start}) {
                BOOST_TEST(scene.density() == point.density, boost::test_tools::tolerance(1e-12));
                BOOST_TEST(std::get<Soft>(*scene.potential()).strength == point.repulsion);
                BOOST_TEST(scene.thermostat_kT() == 1.0, boost::test_tools::tolerance(1e-12));
            }
            double const friction = point.integrator == "S1" ? trial.stage<Shardlow>()->friction
                                                             : trial.stage<EulerImpulses>()->gamma;
            BOOST_TEST(friction == point.friction);
            BOOST_TEST(start.stage<Shardlow>()->friction == 25.0);
            BOOST_TEST(point.length.fewest == 300u);
        }
    auto const& soft = maps[1].points[1];
    BOOST_TEST(soft.repulsion == 25.0);
    BOOST_TEST(soft.harmonic_limit == theory::harmonic_limit({.n = 3.0}, 25.0),
               boost::test_tools::tolerance(1e-12));
    BOOST_TEST(maps[1].points[0].harmonic_limit == infinity);
    // N = 100: n of eq. 25 is (N-2)/V
    BOOST_TEST(
        soft.critical_step == theory::critical_step({.n = 2.94, .gamma = 4.5, .weight = Weight::quadratic}),
        boost::test_tools::tolerance(1e-12));
}

BOOST_FIXTURE_TEST_CASE(edges_of_the_ideal_gas, Fixture) {
    auto maps = load_stability(write(definition), "paper");
    auto& euler = maps[0].points[0];
    BOOST_TEST(euler.integrator == "Euler");
    find_edges(euler);
    // beyond eq. 25 a hot gas, whose particles meet as strangers, heats without end; 300 steps and 100
    // particles blur that by about the search's resolution
    Edge const bounded = edge_of(euler.trials, Outcome::hot);
    BOOST_TEST(bounded.above > 0.9 * euler.critical_step);
    BOOST_TEST(bounded.below < 1.15 * euler.critical_step);
    Edge const usable = edge_of(euler.trials, Outcome::stable);
    BOOST_TEST(usable.above < bounded.below);
    auto const& best = euler.trials.at(usable.below);
    BOOST_TEST(best.kT.value < 2.0);
    BOOST_TEST(best.kT.error > 0.0);
    BOOST_TEST(euler.trials.at(usable.above).kT.value > 2.0);

    // S1 has none, whatever the step: only the largest was tried, which its friction sets
    auto& s1 = maps[0].points[3];
    BOOST_TEST(s1.integrator == "S1");
    BOOST_TEST(s1.range.largest == 2.0);
    find_edges(s1);
    BOOST_TEST(s1.trials.size() == 1u);
    BOOST_TEST(edge_of(s1.trials, Outcome::stable).above == infinity);
    auto const& kT = s1.trials.at(2.0).kT;
    BOOST_TEST(std::abs(kT.value - 1.0) < 5.0 * kT.error);
    BOOST_TEST(kT.error < 0.02);
}

// Random positions would heat the fluid at first: their energy is some kT per particle above equilibrium.
BOOST_FIXTURE_TEST_CASE(a_trial_starts_relaxed_and_lasts_its_length, Fixture) {
    auto point = load_stability(write(definition), "paper").at(1).points.at(3);
    BOOST_TEST(point.integrator == "S1");
    BOOST_TEST(point.repulsion == 25.0);
    point.range.largest = 0.01;
    find_edges(point);
    BOOST_REQUIRE(point.trials.size() == 1);
    auto const& trial = point.trials.begin()->second;
    BOOST_TEST(trial.steps == 300u);
    BOOST_REQUIRE(trial.trace.size() == trace_steps(300).size());
    double const scatter = std::sqrt(2.0 / (3.0 * 99.0));  // of kT at one instant
    for (double const kT : trial.trace) BOOST_TEST(std::abs(kT - 1.0) < 4.5 * scatter);
    BOOST_TEST(point.frozen.repulsion < point.harmonic_limit);
}

BOOST_FIXTURE_TEST_CASE(a_campaign_resumes_from_its_cache, Fixture) {
    auto const file = write(definition);
    auto first = load_stability(file, "quick");
    BOOST_REQUIRE(first.size() == 1);  // a map without a table quick is left out
    CampaignOptions const options{.cache = directory / "cache", .output = directory, .jobs = 2};
    std::atomic<bool> stop = true;
    auto interrupted = options;
    interrupted.stop = &stop;
    BOOST_CHECK_THROW(find_edges(first, interrupted), Interrupted);
    BOOST_TEST(std::filesystem::is_empty(options.cache));
    find_edges(first, options);
    BOOST_TEST(first[0].points[0].trials.size() > 1u);
    auto second = load_stability(file, "quick");
    find_edges(second, options);  // from the cache: the run times are the same
    for (std::size_t p = 0; p < first[0].points.size(); ++p) {
        auto const &a = first[0].points[p], &b = second[0].points[p];
        BOOST_TEST(same(a.trials, b.trials));
        BOOST_TEST(a.frozen.friction == b.frozen.friction);
        BOOST_TEST(a.seconds == b.seconds);
        auto again = a;
        find_edges(again);
        BOOST_TEST(same(a.trials, again.trials));
        again.length.fewest += 1;
        BOOST_TEST(again.key() != a.key());
    }
    // two shards do all points between them
    auto parts = options;
    parts.cache = directory / "parts";
    for (std::size_t const k : {1u, 2u}) {
        parts.shard = Shard{k, 2};
        auto part = load_stability(file, "quick");
        BOOST_TEST(!find_edges(part, parts));
        std::filesystem::directory_iterator const files(parts.cache);
        if (k == 1)
            BOOST_TEST(std::distance(begin(files), end(files)) ==
                       std::ptrdiff_t(share_of(first[0].points.size(), *parts.shard).size()));
    }
    for (auto const& point : first[0].points)
        BOOST_TEST(std::filesystem::exists(parts.cache / (point.key() + ".json")));
    write_stability(second, "quick", directory, directory / "out");
    auto const data = read_file(directory / "out" / "data" / "friction.dat");
    BOOST_TEST(data.find("# S1:0\n4.5 0 3 4.44444 1 4.44444 1 ") != std::string::npos);
    BOOST_TEST(std::filesystem::exists(directory / "out" / "data" / "friction.json"));

    std::ofstream(options.cache / (first[0].points[0].key() + ".json")) << "{";
    BOOST_CHECK_THROW(find_edges(second, options), InputError);
}

BOOST_FIXTURE_TEST_CASE(bad_definitions_are_refused, Fixture) {
    auto const refused = [&](std::string const& from, std::string const& to, std::string const& part) {
        auto const file = write(replaced(definition, from, to));
        BOOST_CHECK_EXCEPTION(load_stability(file, "paper"), InputError, [&](InputError const& error) {
            std::string const line = error.what();
            BOOST_TEST(line.find(part) != std::string::npos, "'" << line << "' lacks " << part);
            return line.find("stability.toml") != std::string::npos && line.find('\n') == std::string::npos;
        });
    };
    refused("weight = \"quadratic\"", "weight = \"cubic\"", "quadratic");
    refused("[scene]", "[scenery]", "dimension");
    refused("fewest = 300", "fewest = 500", "most");
    refused("smallest = 1e-3", "smallest = 10.0", "largest");
    refused("resolution = 0.1", "resolution = 0", "resolution");
    refused("integrator = \"S1\"", "integrator = \"S2\"", "allowed: Euler, S1");
    refused("integrators = [\"Euler\", \"S1\"]", "integrators = []", "is empty");
    refused("integrators = [\"Euler\", \"S1\"]", "integrators = [\"S2\"]", "a list of Euler, S1");
    refused("friction = 25.0", "friction = -1.0", "start.friction");
    refused("[[map]]\nname = \"friction\"", "[[map]]\nname = \"friction\"\nintegrators = [\"S2\"]", "S1");
    refused("density = [3.0]", "density = [0.0]", "density");
    refused("density = [3.0]", "density = [30.0]", "two cutoffs");
    refused("[map.quick]\nfriction", "[map.quick]\nviscosity", "viscosity");
    BOOST_CHECK_THROW(load_stability(directory / "none.toml", "paper"), InputError);
}

BOOST_AUTO_TEST_CASE(the_definition_of_the_maps_is_valid) {
    std::filesystem::path const file =
        std::filesystem::path(DPDREF_VERIFICATION) / "stability/stability.toml";
    for (std::string const budget : {"quick", "paper"}) {
        auto const maps = load_stability(file, budget);
        for (auto const& map : maps)
            for (auto const& plot : map.plots)
                BOOST_TEST(std::filesystem::exists(file.parent_path() / (plot + ".gp")), plot);
    }
}
