// The plain engine is the definition, the fast one its twin. What is compared: all numbers that a stage
// leaves, after every stage, as numbers (only 0 and -0 count as one). To the last bit agree, in the order of
// ids: positions, velocities, images, forces, waiting impulses, the pairs with their directions and impulses,
// time and counters; where the fast engine searches by the definition, too, and so keeps its rows in the
// order of ids, also the stresses and virials, which are sums over rows. Rescaling sums over rows in every
// cell: it is compared there.
#define BOOST_TEST_MODULE plain
#include "plain.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <boost/test/unit_test.hpp>
#include <random>

#include "noise.hpp"
#include "run.hpp"
#include "version.hpp"

using namespace dpd;

namespace {

struct Numbers {
    std::vector<std::string> what;
    std::vector<double> value;
    void add(std::string const& name, double x) {
        what.push_back(name);
        value.push_back(x);
    }
};

// All that the state holds, by id; sums over rows only where these are in the order of ids.
template <int d>
Numbers numbers_of(Simulation<d>& simulation, bool rows_by_id) {
    Numbers all;
    auto const& particles = simulation.particles;
    auto const add_field = [&](std::string const& name, auto const& field) {
        if (field.rows() != particles.size()) return;
        std::vector<Eigen::Index> row(static_cast<std::size_t>(particles.size()));
        for (Eigen::Index p = 0; p < particles.size(); ++p) row[particles.id[p]] = p;
        for (auto const p : row)
            for (int axis = 0; axis < d; ++axis) all.add(name, double(field(p, axis)));
    };
    add_field("position", particles.position);
    add_field("velocity", particles.velocity);
    add_field("image", particles.image);
    if (simulation.forces_valid()) add_field("force", simulation.force);
    if (simulation.pair_list.updated) add_field("momentum change", simulation.momentum_change);
    all.add("time", simulation.time);
    bool const pairs = simulation.pairs_of_step().has_value();
    all.add("pairs", pairs);
    if (pairs) {
        auto const& list = simulation.pair_list;
        all.add("pairs updated", list.updated);
        for (std::size_t k = 0; k < list.count; ++k) {
            auto const pair = list.pair(k);
            all.add("i", particles.id[pair.i]);
            all.add("j", particles.id[pair.j]);
            all.add("distance", pair.r);
            all.add("crossing", pair.crossing);
            for (int axis = 0; axis < d; ++axis) all.add("unit vector", pair.e[axis]);
            if (list.updated) all.add("impulse", list.impulse[k]);
        }
    }
    if (simulation.potential_sums) {
        auto const sums = simulation.potential_sums(simulation);
        all.add("energy", sums.energy);
        all.add("virial", sums.virial);
        all.add("laplacian", sums.laplacian);
        if (rows_by_id) all.add("force squared", sums.force_squared);
    }
    auto const& stress = simulation.stage_stress;
    auto const& virials = simulation.pair_virials;
    if (rows_by_id) all.add("kinetic stress", stress.kinetic);
    for (double const x :
         {double(stress.streamed), stress.potential, stress.collision, stress.rescaling, stress.friction,
          stress.friction_virial, virials.potential, virials.thermostat, virials.friction})
        all.add("stress", x);
    auto const& counters = simulation.counters;
    for (std::uint64_t const n : {counters.steps, counters.searches, counters.pairs_found,
                                  counters.pair_updates, counters.potential_evaluations,
                                  counters.random_draws, counters.boundary_pairs, counters.coincident_pairs})
        all.add("counter", double(n));
    return all;
}

// What is left after each "sample" of the scene, over some steps in the middle of a run.
template <int d>
std::vector<Numbers> run_by(Engine engine, Scene scene, int steps) {
    scene.use(engine);
    std::vector<Numbers> found;
    auto simulation = build<d>(
        scene, [&](Simulation<d>& s) { found.push_back(numbers_of(s, scene.search == Search::brute)); });
    constexpr std::uint64_t earlier_steps = 1013;
    simulation.step = earlier_steps;
    simulation.time = double(earlier_steps) * simulation.time_step;
    simulation.stage_stress.wanted = simulation.stage_stress.virial_wanted = true;
    if (!scene.potential() || scene.soft())  // a pair without direction
        simulation.particles.position.row(1) = simulation.particles.position.row(0);
    for (int s = 0; s < steps; ++s) simulation.advance();
    return found;
}

struct Comparisons {
    std::uint64_t scenes = 0, numbers = 0;
};

template <int d>
void compare(std::string const& text, int steps, Comparisons& done) {
    Scene const scene = parse_scene(text, "scene");
    auto const plain = run_by<d>(Engine::plain, scene, steps), fast = run_by<d>(Engine::fast, scene, steps);
    BOOST_REQUIRE(plain.size() == fast.size());
    for (std::size_t s = 0; s < plain.size(); ++s) {
        BOOST_REQUIRE_MESSAGE(plain[s].what == fast[s].what, text);
        for (std::size_t k = 0; k < plain[s].value.size(); ++k)
            if (!(plain[s].value[k] == fast[s].value[k]))
                BOOST_FAIL(
                    fmt::format("{}\n{} (number {} of sample {}): {} by the plain engine, {} by the fast one",
                                text, plain[s].what[k], k, s, plain[s].value[k], fast[s].value[k]));
        done.numbers += plain[s].value.size();
    }
    ++done.scenes;
}

std::string const soft = "soft.strength = 12.5\nsoft.cutoff = 0.9\n",
                  lennard_jones =
                      "lennard_jones.epsilon = 0.7\nlennard_jones.sigma = 0.6\nlennard_jones.cutoff = 1.3\n";

// Every weight, as the lines of a stage's table; two of the powers.
std::vector<std::string> const weights = [] {
    std::vector<std::string> lines;
    for (auto const kind : names<Weight::Kind>)
        if (kind != name_of(Weight::power)) lines.push_back(fmt::format("weight = \"{}\"\n", kind));
    for (double const exponent : {0.3, 3.0})
        lines.push_back(fmt::format("weight = \"power\"\nexponent = {}\n", exponent));
    return lines;
}();

// Stage lists with their parameters; a sample after each stage.
std::vector<std::string> stage_lists(bool walls) {
    std::vector<std::string> lists;
    auto const add = [&](std::vector<std::string> const& stages, std::string const& parameters) {
        lists.push_back(fmt::format("stages = [\"{}\", \"sample\"]\n{}",
                                    fmt::join(stages, "\", \"sample\", \""), parameters));
    };
    auto const forces = [&](std::string const& stage, std::string const& keys, std::string const& potential) {
        return fmt::format("[{}]\n{}{}", stage, keys, potential);
    };
    std::vector<std::string> const potentials = walls ? std::vector{soft} : std::vector{soft, lennard_jones};
    for (auto const& potential : potentials)
        for (auto const& weight : weights)
            for (char const* options :
                 {"", "lambda = 0.65\n", "friction_again = true\n", "lambda = 0.3\nfriction_again = true\n"})
                add({"modified_verlet", "body_force"},
                    forces("modified_verlet",
                           fmt::format("gamma = 4.5\nsigma = 3.0\ncutoff = 1.1\n{}{}", weight, options),
                           potential) +
                        "[body_force]\nacceleration = 0.3\n");
    if (walls) return lists;
    for (auto const& weight : weights)
        for (auto const scheme : names<Scheme>)
            for (double const cutoff : {1.0, 0.7})
                add({"shardlow", "drift"}, fmt::format("[shardlow]\nfriction = 6.5\nkT = 0.8\n"
                                                       "{}scheme = \"{}\"\ncutoff = {}\n",
                                                       weight, scheme, cutoff));
    for (double const rate : {0.0, 9.0, 20.0, 37.0, 60.0}) {  // 0, 0.45, 1, 1.85 and 3 per step
        add({"lowe", "drift"}, fmt::format("[lowe]\nrate = {}\nkT = 1.3\ncutoff = 0.9\n", rate));
        add({"lowe", "verlet"},
            fmt::format("[lowe]\nrate = {}\ncutoff = 0.6\n[verlet]\nsubsteps = 2\n{}", rate, soft));
    }
    for (auto const& weight : weights) {
        std::string const euler = fmt::format("[euler]\ngamma = 4.0\nsigma = 2.5\n{}", weight);
        add({"euler", "kick", "drift"}, euler);
        add({"euler", "drift", "kick"}, euler);
        for (auto const random : names<Weight::Kind>) {
            if (random == name_of(Weight::power)) continue;
            add({"euler", "drift", "kick"},
                euler + fmt::format("cutoff = 1.2\nrandom_weight = \"{}\"\n", random));
        }
        for (auto const& potential : potentials)
            add({"euler", "force", "drift", "kick"}, euler + forces("force", "", potential));
        std::string const shardlow = fmt::format("[shardlow]\nfriction = 6.5\n{}", weight);
        for (auto const& potential : potentials) {
            for (int const substeps : {1, 3})
                add({"shardlow", "verlet"},
                    shardlow + forces("verlet", fmt::format("substeps = {}\n", substeps), potential));
            add({"half_kick", "shardlow", "half_kick", "drift"},
                shardlow + forces("half_kick", "", potential));
            add({"half_drift", "half_kick", "shardlow", "half_kick", "half_drift"},
                shardlow + forces("half_kick", "", potential));
        }
    }
    add({"drift"}, "");
    add({"half_drift", "half_drift"}, "");
    add({"shardlow", "scatter", "lowe", "drift"}, "[shardlow]\nfriction = 1.0\n[lowe]\nrate = 9.0\n");
    for (char const* opposed : {"false", "true"})
        add({"body_force", "drift"},
            fmt::format("[body_force]\nacceleration = -0.7\nopposed = {}\n", opposed));
    for (char const* mode : {"mode = \"global\"", "mode = \"layers\"\nthickness = 1",
                             "mode = \"layers\"\nthickness = 2", "mode = \"monte_carlo\"\namplitude = 0.8"})
        for (double const cell : {1.0, 0.5}) {
            std::string const rescale = fmt::format("[rescale]\n{}\nkT = 1.1\ncell = {}\n", mode, cell);
            add({"rescale", "drift"}, rescale);
            for (auto const& potential : potentials)
                add({"rescale", "verlet"}, rescale + forces("verlet", "", potential));
        }
    return lists;
}

// The steep potential starts from a lattice and takes small steps.
std::string scene_text(int d, std::string const& stages, std::string const& box, char const* search) {
    auto const table = std::min(stages.size(), stages.find('[', stages.find(']')));
    bool const steep = stages.find("lennard_jones") != std::string::npos;
    return fmt::format(
        "dimension = {}\n{}\n{}\n[particles]\ndensity = 2.5\nmass = 1.3\nkT = 0.9\nstart = \"{}\"\n"
        "[time]\nstep = {}\nduration = 1\n[pairs]\norder = \"id\"\nsearch = \"{}\"\n{}",
        d, stages.substr(0, table), box, steep ? "lattice" : "random", steep ? 0.004 : 0.05, search,
        stages.substr(table));
}

}  // namespace

BOOST_AUTO_TEST_CASE(the_noise_of_both_engines_has_the_same_bits) {
    for (std::uint64_t k = 0; k < 200000; ++k) {
        NoiseKey const key{k * 0x9e3779b97f4a7c15u, k * 1234567891u % (std::uint64_t{1} << 48),
                           static_cast<std::uint8_t>(k), static_cast<std::uint8_t>(k >> 3)};
        auto const a = static_cast<std::uint32_t>(k * 2654435761u),
                   b = static_cast<std::uint32_t>(k * k + 17);
        BOOST_REQUIRE(plain::normal_noise(key, a, b) == normal(key, std::min(a, b), std::max(a, b)));
        BOOST_REQUIRE(plain::normal_noise(key, b, a) == plain::normal_noise(key, a, b));
        BOOST_REQUIRE(plain::uniform_noise(key, a, b) == uniform(key, a, b));
    }
}

// A fused multiplication and addition, which the build for one processor may use, rounds otherwise.
BOOST_AUTO_TEST_CASE(
    the_fast_engine_has_the_plain_ones_bits,
    *boost::unit_test::enable_if<std::string_view(build_flags).find("native") == std::string_view::npos>()) {
    Comparisons done;
    std::vector<std::pair<std::string, bool>> lists;
    for (bool const walls : {false, true})
        for (auto const& stages : stage_lists(walls)) lists.emplace_back(stages, walls);
    std::shuffle(lists.begin(), lists.end(), std::mt19937{});  // what is wrong shows early
    for (auto const& [stages, walls] : lists)
        for (double const shear_rate : {0.0, 0.4}) {
            if (walls && shear_rate != 0.0) continue;  // a scene has either
            bool const rescales = stages.find("rescale") != std::string::npos;
            for (char const* search : {"cell", "brute"}) {
                if (rescales && std::string_view(search) == "cell") continue;
                std::string const more = walls ? "\n[walls]\nthickness = 1.3\nstrength = 5.0"
                                               : fmt::format("\nshear_rate = {}", shear_rate);
                compare<2>(scene_text(2, stages, "[box]\nlength = [5, 6]" + more, search), 4, done);
                compare<3>(scene_text(3, stages, "[box]\nlength = [4, 5, 3]" + more, search), 4, done);
            }
        }
    // an error of one per cent in the weight of a proposal changes one decision in some hundred
    compare<3>(scene_text(3,
                          "stages = [\"rescale\", \"sample\", \"drift\"]\n[rescale]\nmode = \"monte_carlo\"\n"
                          "amplitude = 0.8\nkT = 1.1\n",
                          "[box]\nlength = [12, 12, 12]", "brute"),
               10, done);
    fmt::print("{} scenes by both engines, {} numbers compared, all equal\n", done.scenes, done.numbers);
}

// long enough for the fast engine to sort its rows several times
BOOST_AUTO_TEST_CASE(
    the_engines_stay_together,
    *boost::unit_test::enable_if<std::string_view(build_flags).find("native") == std::string_view::npos>()) {
    Comparisons done;
    std::string const stages =
        "stages = [\"shardlow\", \"sample\", \"verlet\", \"sample\"]\n[shardlow]\nfriction = "
        "4.5\n[verlet]\n" +
        soft;
    for (char const* box :
         {"[box]\nlength = [4.0, 5.0, 3.0]\nshear_rate = 0.4\n", "[box]\nlength = [2.5, 2.1, 2.2]\n"})
        compare<3>(scene_text(3, stages, box, "cell"), 200, done);
    fmt::print("{} numbers compared over 200 steps, all equal\n", done.numbers);
}

// --- runs ------------------------------------------------------------------------------------------------

namespace {

Scene sheared_fluid(Engine engine) {
    Scene scene = parse_scene(
        "dimension = 3\nstages = ['shardlow', 'sample', 'verlet']\n[box]\nlength = [3, 4, 3]\nshear_rate = "
        "0.3\n"
        "[particles]\ndensity = 2\n[time]\nstep = 0.05\nduration = 2\nequilibration = 0.1\n[shardlow]\n"
        "friction = 4.5\n[verlet]\nsoft.strength = 10\nsubsteps = 2\n[pairs]\norder = 'id'\nsearch = "
        "'brute'\n"
        "[sample]\nobservables = ['kinetic_temperature', 'momentum', 'stress', 'friction_stress', "
        "'potential_energy', 'pressure', 'configurational_temperature']\nprofile.interval = 2\n"
        "radial_distribution.range = 1.4\nradial_distribution.interval = 5\n"
        "mean_square_displacement.longest = 0.5\nvelocity_autocorrelation.longest = 0.5\n",
        "plain_test");
    scene.use(engine);
    return scene;
}

// Numbers that the two records do not share, out of all.
std::pair<std::uint64_t, std::uint64_t> difference(Record const& a, Record const& b) {
    std::uint64_t different = 0, all = 0;
    auto const count = [&](bool same) {
        ++all;
        different += !same;
    };
    count(a.series.size() == b.series.size() && a.curves.size() == b.curves.size());
    for (auto const& [name, values] : a.series)
        for (std::size_t k = 0; k < values.size(); ++k) count(values[k] == b.series.at(name).at(k));
    for (auto const& [name, curve] : a.curves) {
        count((curve.sum == b.curves.at(name).sum).all());
        count((curve.weight == b.curves.at(name).weight).all());
    }
    return {different, all};
}

}  // namespace

BOOST_AUTO_TEST_CASE(
    a_run_has_the_same_record_by_either_engine,
    *boost::unit_test::enable_if<std::string_view(build_flags).find("native") == std::string_view::npos>()) {
    auto const plain = run(sheared_fluid(Engine::plain)), fast = run(sheared_fluid(Engine::fast));
    auto const [different, all] = difference(plain.record, fast.record);
    BOOST_TEST(different == 0u);
    BOOST_TEST(all > 400u);
    BOOST_TEST(plain.counters.random_draws == fast.counters.random_draws);
    BOOST_TEST(plain.counters.pairs_found == fast.counters.pairs_found);
    BOOST_TEST(plain.kinetic_temperature == fast.kinetic_temperature);
}

BOOST_AUTO_TEST_CASE(a_plain_run_resumes_and_is_not_taken_for_a_fast_one) {
    Scene const scene = sheared_fluid(Engine::plain);
    auto const whole = run(scene);
    auto const output = std::filesystem::temp_directory_path() /
                        fmt::format("dpdref_plain_test_{}.h5", static_cast<long>(getpid()));
    std::filesystem::remove(output);
    std::atomic<bool> const stop = true;
    RunResult pieces;
    int interruptions = 0;
    for (bool complete = false; !complete;) try {
            pieces = run(scene, {.output = output, .stop = &stop, .progress = {}});
            complete = true;
        } catch (Interrupted const&) {
            ++interruptions;
        }
    BOOST_TEST(interruptions == int(scene.steps()) - 1);
    BOOST_TEST(difference(pieces.record, whole.record).first == 0u);
    BOOST_TEST(pieces.counters.searches == whole.counters.searches);
    BOOST_CHECK_THROW(run(sheared_fluid(Engine::fast), {.output = output, .stop = {}, .progress = {}}),
                      InputError);
    std::filesystem::remove(output);
}

BOOST_AUTO_TEST_CASE(the_plain_engine_refuses_a_random_order) {
    Scene scene = sheared_fluid(Engine::fast);
    scene.order = Order::random;
    BOOST_CHECK_THROW(scene.use(Engine::plain), InputError);
}
