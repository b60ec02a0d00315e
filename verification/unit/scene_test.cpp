/// @file
/// Reading scenes: what is allowed, and one line (file, line, key, what is allowed) for everything that is
/// not.
#define BOOST_TEST_MODULE scene
#include "scene.hpp"

#include <unistd.h>

#include <boost/test/unit_test.hpp>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "errors.hpp"
#include "size.hpp"

using namespace dpd;

namespace {

/// A good scene, by line; a test replaces one line by another.
std::vector<std::string> const good{
    "title = \"a scene\"",                                  // 1
    "dimension = 3",                                        // 2
    "seed = 5",                                             // 3
    "stages = [\"shardlow\", \"sample\", \"drift\"]",       // 4
    "[box]",                                                // 5
    "length = [4.0, 5.0, 6.0]",                             // 6
    "shear_rate = 0.1",                                     // 7
    "[particles]",                                          // 8
    "density = 3.0",                                        // 9
    "mass = 2.0",                                           // 10
    "[shardlow]",                                           // 11
    "friction = 9.0",                                       // 12
    "weight = \"linear\"",                                  // 13
    "[time]",                                               // 14
    "step = 0.1",                                           // 15
    "duration = 10.0",                                      // 16
    "[sample]",                                             // 17
    "observables = [\"kinetic_temperature\", \"stress\"]",  // 18
    "[sample.radial_distribution]",                         // 19
    "range = 2.0",                                          // 20
    "[sample.mean_square_displacement]",                    // 21
    "longest = 2.0",                                        // 22
    "[pairs]",                                              // 23
    "order = \"cell\"",                                     // 24
    "[trajectory]",                                         // 25
    "interval = 10",                                        // 26
};

/// Another, with the stages of soft fluids.
std::vector<std::string> const soft{
    "dimension = 3",                                                               // 1
    "stages = ['shardlow', 'lowe', 'rescale', 'body_force', 'sample', 'verlet']",  // 2
    "[box]",                                                                       // 3
    "length = [4.0, 6.0, 4.0]",                                                    // 4
    "[particles]",                                                                 // 5
    "number = 100",                                                                // 6
    "[shardlow]",                                                                  // 7
    "friction = 5.0",                                                              // 8
    "scheme = 'linear'",                                                           // 9
    "[lowe]",                                                                      // 10
    "rate = 7.0",                                                                  // 11
    "[rescale]",                                                                   // 12
    "mode = 'layers'",                                                             // 13
    "cell = 0.5",                                                                  // 14
    "[body_force]",                                                                // 15
    "acceleration = -0.3",                                                         // 16
    "[verlet]",                                                                    // 17
    "substeps = 10",                                                               // 18
    "[verlet.soft]",                                                               // 19
    "strength = 25.0",                                                             // 20
    "[time]",                                                                      // 21
    "step = 0.1",                                                                  // 22
    "duration = 10.0",                                                             // 23
    "[sample]",                                                                    // 24
    "observables = ['potential_energy', 'pressure']",                              // 25
    "[sample.profile]",                                                            // 26
    "temperature = true",                                                          // 27
};

std::string join(std::vector<std::string> const& lines) {
    std::string text;
    for (auto const& line : lines) text += line + "\n";
    return text;
}

std::string with(std::size_t line, std::string const& replacement, std::vector<std::string> lines = good) {
    lines.at(line - 1) = replacement;
    return join(lines);
}

/// What an action complains of; empty if it does not.
std::string complaint(std::function<void()> const& action) {
    try {
        action();
    } catch (InputError const& error) {
        return error.what();
    }
    return "";
}

/// One line that begins with `begin` and contains `words`.
void check_message(std::string const& message, std::string const& begin,
                   std::vector<std::string> const& words) {
    BOOST_TEST(message.find('\n') == std::string::npos, "more than one line: " << message);
    BOOST_TEST(message.starts_with(begin), "\"" << message << "\" does not begin with " << begin);
    for (auto const& word : words)
        BOOST_TEST(message.find(word) != std::string::npos, "\"" << message << "\" lacks " << word);
}

struct Mistake {
    std::size_t line;         ///< of a good scene, to be replaced
    std::string replacement;  ///< by this
    std::string begin;        ///< of the message, after "f.toml:"
    std::vector<std::string> words;
};

void check_mistakes(std::vector<Mistake> const& mistakes, std::vector<std::string> const& lines) {
    for (auto const& mistake : mistakes) {
        std::string const message =
            complaint([&] { parse_scene(with(mistake.line, mistake.replacement, lines), "f.toml"); });
        BOOST_TEST_CONTEXT("line " << mistake.line << ": " << mistake.replacement)
        check_message(message, "f.toml:" + mistake.begin, mistake.words);
    }
}

/// A scene of these stages, each with what it needs.
std::string scene_of(std::string const& stages, std::string const& observables = "",
                     std::string const& without_table = "") {
    std::string text = "dimension = 2\nstages = [" + stages +
                       "]\nbox.length = [3, 3]\nparticles.number = 7\n"
                       "time = {step = 0.5, duration = 2}\n";
    for (auto const& [stage, assignments] :
         std::vector<std::pair<std::string, std::string>>{{"shardlow", "friction = 1"},
                                                          {"lowe", "rate = 1"},
                                                          {"euler", "gamma = 1, sigma = 1"},
                                                          {"rescale", ""},
                                                          {"body_force", "acceleration = 1"},
                                                          {"verlet", "soft.strength = 1"}})
        if (stages.find("'" + stage + "'") != std::string::npos && stage != without_table)
            text += stage + " = {" + assignments + "}\n";
    return observables.empty() ? text : text + "sample.observables = [" + observables + "]\n";
}

class Directory {
public:
    Directory() { std::filesystem::create_directories(path); }
    ~Directory() { std::filesystem::remove_all(path); }
    std::filesystem::path const path =
        std::filesystem::temp_directory_path() / ("dpdref_scene_test." + std::to_string(::getpid()));
};

}  // namespace

BOOST_AUTO_TEST_CASE(a_good_scene_is_read_as_written) {
    Scene const scene = parse_scene(join(good), "f.toml");
    BOOST_TEST(scene.title == "a scene");
    BOOST_TEST(scene.dimension == 3);
    BOOST_TEST(scene.seed == 5u);
    BOOST_TEST(scene.stage_names() == (std::vector<std::string>{"shardlow", "sample", "drift"}));
    BOOST_TEST(scene.length == (std::vector<double>{4.0, 5.0, 6.0}));
    BOOST_TEST(scene.volume() == 120.0);
    BOOST_TEST(scene.shear_rate == 0.1);
    BOOST_TEST(scene.particles == 360u);
    BOOST_TEST(scene.density() == 3.0);
    BOOST_TEST(scene.mass == 2.0);
    BOOST_TEST(scene.stage<Shardlow>()->friction == 9.0);
    BOOST_TEST((scene.stage<Shardlow>()->weight == Weight::linear));
    BOOST_TEST(scene.time_step == 0.1);
    BOOST_TEST(scene.production_steps == 100u);
    BOOST_TEST(scene.sample.asks("kinetic_temperature"));
    BOOST_TEST(scene.sample.asks("stress"));
    BOOST_TEST(!scene.sample.asks("momentum"));
    BOOST_TEST(scene.sample.steps == 100u);
    BOOST_TEST(scene.sample.radial_distribution->range == 2.0);
    BOOST_TEST(scene.sample.mean_square_displacement->lags == 20u);
    BOOST_TEST(scene.trajectory_interval == 10u);
}

BOOST_AUTO_TEST_CASE(defaults) {
    Scene const scene = parse_scene(
        "dimension = 2\nstages = [\"drift\"]\n[box]\nlength = [3, 3]\n[particles]\nnumber = 7\n"
        "[time]\nstep = 0.5\nduration = 2\n",
        "f.toml");
    BOOST_TEST(scene.title == "");
    BOOST_TEST(scene.seed == 1u);
    BOOST_TEST(scene.particles == 7u);
    BOOST_TEST(scene.mass == 1.0);
    BOOST_TEST(scene.kT == 1.0);
    BOOST_TEST(scene.shear_rate == 0.0);
    BOOST_TEST(scene.equilibration_steps == 0u);
    BOOST_TEST(scene.production_steps == 4u);
    BOOST_TEST(scene.checkpoint_seconds == 30.0);
    BOOST_TEST((scene.search == Search::cell));
    BOOST_TEST((scene.order == Order::cell));
    BOOST_TEST(scene.trajectory_interval == 0u);
    BOOST_TEST(scene.sample.interval == 1u);
    BOOST_TEST(!scene.sample.asks("kinetic_temperature"));
    BOOST_TEST(!scene.sample.asks("momentum"));
    BOOST_TEST(!scene.sample.asks("stress"));
    BOOST_TEST(!scene.sample.profile.has_value());
    BOOST_TEST(!scene.sample.radial_distribution.has_value());
    BOOST_TEST(!scene.sample.mean_square_displacement.has_value());
    BOOST_TEST(!scene.sample.velocity_autocorrelation.has_value());

    auto lines = good;
    lines[12] = "";
    lines[21] = "longest = 2.0\n[sample.velocity_autocorrelation]\nlongest = 1.0\n[sample.profile]";
    Scene const thermostatted = parse_scene(join(lines), "f.toml");
    BOOST_TEST((thermostatted.stage<Shardlow>()->weight == Weight::linear));
    BOOST_TEST(thermostatted.stage<Shardlow>()->cutoff == 1.0);
    BOOST_TEST(thermostatted.stage<Shardlow>()->kT == 1.0);
    BOOST_TEST(thermostatted.sample.velocity_autocorrelation->spacing == 1u);
    BOOST_TEST(thermostatted.sample.velocity_autocorrelation->origin_spacing == 1u);
    BOOST_TEST(thermostatted.sample.profile->interval == 1u);
    BOOST_TEST(thermostatted.sample.profile->bins == 40u);
    BOOST_TEST(thermostatted.sample.radial_distribution->interval == 100u);
    BOOST_TEST(thermostatted.sample.radial_distribution->bins == 100u);
}

BOOST_AUTO_TEST_CASE(every_mistake_gets_one_line) {
    std::string const number = "a number > 0";
    std::vector<Mistake> const mistakes{
        // unknown keys: in the root, in a table, two levels deep
        {3, "sed = 5", "3: sed: ", {"unknown key", "allowed", "seed"}},
        {13, "wieght = \"linear\"", "13: shardlow.wieght: ", {"unknown key", "allowed", "weight"}},
        {22,
         "longest = 2.0\nlags = 3",
         "23: sample.mean_square_displacement.lags: ",
         {"unknown key", "longest"}},
        {23, "[pears]", "23: pears: ", {"unknown key", "allowed", "pairs"}},
        {1, "\"ti\\ntle\" = 1", "1: ", {"unknown key", "allowed"}},
        // numbers
        {15, "step = -0.1", "15: time.step: ", {"-0.1", "allowed", number}},
        {15, "step = 0.0", "15: time.step: ", {"0", "allowed", number}},
        {15, "step = 0", "15: time.step: ", {"0", "allowed", number}},
        {15, "step = nan", "15: time.step: ", {"nan", "allowed", number}},
        {15, "step = inf", "15: time.step: ", {"inf", "allowed", number}},
        {15, "step = -inf", "15: time.step: ", {"inf", "allowed", number}},
        {15, "step = \"0.1\"", "15: time.step: ", {"0.1", "allowed", number}},
        {15, "step = true", "15: time.step: ", {"true", "allowed", number}},
        {15, "step = [0.1]", "15: time.step: ", {"a list", "allowed", number}},
        {15, "step = {x = 1}", "15: time.step: ", {"a table", "allowed", number}},
        {15, "", "14: time.step: ", {"is missing", "allowed", number}},
        {16, "duration = 0.0", "16: time.duration: ", {"allowed", number}},
        {16, "duration = 1e300", "16: time.duration: ", {"at most 10^14"}},
        {16, "duration = 1.0\nequilibration = -1.0", "17: time.equilibration: ", {"allowed", ">= 0"}},
        {16, "duration = 1.0\ncheckpoint = 0", "17: time.checkpoint: ", {"allowed", number}},
        {7, "shear_rate = nan", "7: box.shear_rate: ", {"nan", "allowed", "finite"}},
        {7, "shear_rate = inf", "7: box.shear_rate: ", {"inf", "allowed", "finite"}},
        {9, "density = 0", "9: particles.density: ", {"allowed", number}},
        {9, "density = nan", "9: particles.density: ", {"allowed", number}},
        {9, "density = 0.01", "9: particles.density: ", {"1 particles", "allowed", "2 to 10^9"}},
        {9, "density = 1e12", "9: particles.density: ", {"particles", "allowed", "2 to 10^9"}},
        {9, "number = 0", "9: particles.number: ", {"allowed", "an integer >= 1"}},
        {9, "number = 1", "9: particles.number: ", {"allowed", "2 to 10^9"}},
        {9, "number = 2.5", "9: particles.number: ", {"2.5", "allowed", "an integer >= 1"}},
        {9, "", "8: particles.density: ", {"particles.number or particles.density"}},
        {9, "density = 1.0\nnumber = 9", "9: particles.density: ", {"particles.number or particles.density"}},
        {10, "mass = 0", "10: particles.mass: ", {"allowed", number}},
        {10, "kT = -1", "10: particles.kT: ", {"allowed", "a number >= 0"}},
        {12, "friction = -1", "12: shardlow.friction: ", {"allowed", "a number >= 0"}},
        {12, "", "11: shardlow.friction: ", {"is missing", "allowed"}},
        {13, "cutoff = 0", "13: shardlow.cutoff: ", {"allowed", number}},
        {13, "kT = nan", "13: shardlow.kT: ", {"nan", "allowed"}},
        // the box
        {6, "length = [1.5, 5.0, 6.0]", "6: box.length: ", {"1.5", "allowed", "two cutoffs, 2"}},
        {13, "cutoff = 2.5", "6: box.length: ", {"4", "allowed", "two cutoffs, 5"}},
        {6, "length = [4.0, 5.0]", "6: box.length: ", {"2 sides", "allowed", "3"}},
        {6, "length = [4.0, 5.0, 6.0, 7.0]", "6: box.length: ", {"4 sides", "allowed", "3"}},
        {6, "length = 4.0", "6: box.length: ", {"4", "allowed", "a list"}},
        {6, "length = [4.0, -5.0, 6.0]", "6: box.length: ", {"-5", "allowed", number}},
        {6, "length = [4.0, \"5\", 6.0]", "6: box.length: ", {"allowed", number}},
        {6, "", "5: box.length: ", {"is missing", "allowed"}},
        {20, "range = 2.1", "20: sample.radial_distribution.range: ", {"half the shortest box side, 2"}},
        // choices
        {2, "dimension = 4", "2: dimension: ", {"4", "allowed", "2 or 3"}},
        {2, "dimension = 3.0", "2: dimension: ", {"allowed", "2 or 3"}},
        {2, "dimension = \"three\"", "2: dimension: ", {"three", "allowed", "2 or 3"}},
        {2, "", "1: dimension: ", {"is missing", "allowed", "2 or 3"}},
        {3, "seed = -1", "3: seed: ", {"-1", "allowed", "an integer >= 0"}},
        {3, "seed = 1.5", "3: seed: ", {"1.5", "allowed", "an integer >= 0"}},
        {1, "title = 3", "1: title: ", {"3", "allowed", "a string"}},
        {4,
         "stages = [\"shardlow\", \"jump\", \"sample\", \"drift\"]",
         "4: stages: ",
         {"jump", "allowed", "drift"}},
        {4, "stages = []", "4: stages: ", {"is empty", "allowed", "drift"}},
        {4, "stages = \"drift\"", "4: stages: ", {"allowed", "a list of", "drift"}},
        {4, "stages = [1]", "4: stages: ", {"1", "allowed", "drift"}},
        {4, "", "1: stages: ", {"is missing", "allowed", "drift"}},
        {13, "weight = \"cubic\"", "13: shardlow.weight: ", {"cubic", "allowed", "quadratic"}},
        {13, "weight = \"li\\nnear\"", "13: shardlow.weight: ", {"allowed", "quadratic"}},
        {13, "weight = 1", "13: shardlow.weight: ", {"1", "allowed", "quadratic"}},
        {18, "observables = [\"entropy\"]", "18: sample.observables: ", {"entropy", "allowed", "stress"}},
        {18, "interval = 0", "18: sample.interval: ", {"0", "allowed", "an integer >= 1"}},
        {24, "order = \"sorted\"", "24: pairs.order: ", {"sorted", "allowed", "random"}},
        {24, "search = \"tree\"", "24: pairs.search: ", {"tree", "allowed", "brute"}},
        {26, "interval = 0", "26: trajectory.interval: ", {"0", "allowed", "an integer >= 1"}},
        {26, "", "25: trajectory.interval: ", {"is missing", "allowed"}},
        // tables and stages that do not belong together
        {26, "interval = 1\n[euler]\ngamma = 1\nsigma = 1", "27: euler: ", {"not among the stages"}},
        {4, "stages = [\"drift\", \"sample\"]", "11: shardlow: ", {"not among the stages"}},
        {4, "stages = [\"shardlow\", \"drift\"]", "17: sample: ", {"not among the stages"}},
        {4,
         "stages = [\"shardlow\", \"euler\", \"sample\", \"drift\"]",
         "1: euler: ",
         {"is missing", "allowed", "[euler]"}},
        {4, "stages = [\"shardlow\", \"kick\", \"sample\", \"drift\"]", "4: stages: ", {"kick", "euler"}},
        // stress needs the impulses of a pair update at the present positions
        {4, "stages = [\"sample\", \"shardlow\", \"drift\"]", "4: stages: ", {"stress", "allowed"}},
        {4, "stages = [\"shardlow\", \"drift\", \"sample\"]", "4: stages: ", {"stress", "allowed"}},
        {4,
         "stages = [\"shardlow\", \"scatter\", \"sample\", \"drift\"]",
         "4: stages: ",
         {"stress", "allowed"}},
        // syntax
        {15, "step = ", "15: ", {}},
        {15, "step 0.1", "15: ", {}},
        {6, "length = [4.0, 5.0, 6.0", "7: ", {}},
        {16, "step = 0.1", "16: ", {"step"}},
    };
    check_mistakes(mistakes, good);
}

BOOST_AUTO_TEST_CASE(a_kick_needs_its_impulses_first) {
    BOOST_TEST(complaint([] { parse_scene(scene_of("'euler', 'drift', 'kick'"), "f.toml"); }) == "");
    check_message(complaint([] { parse_scene(scene_of("'kick', 'drift', 'euler'"), "f.toml"); }),
                  "f.toml:2: stages: ", {"kick", "euler"});
}

// --- sizes -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(a_run_that_does_not_fit_names_its_largest_part) {
    auto const said = [](std::vector<std::string> const& assignments) {
        return complaint([&] {
            parse_scene(scene_of("'shardlow', 'sample', 'drift'", "'kinetic_temperature'"), "f.toml",
                        assignments);
        });
    };
    // lags and samples that take these shares of the memory; the particles take next to nothing
    auto const of_shares = [&](double lags, double samples) {
        std::string const longest = std::to_string(lags * memory_at_hand() / bytes_per_lag);
        return said({"time.step=1",
                     "time.duration=" + std::to_string(samples * memory_at_hand() / sizeof(double)),
                     "sample.mean_square_displacement={longest=" + longest + ", origins=" + longest + "}"});
    };
    std::string const longest =
                          "--set sample.mean_square_displacement: sample.mean_square_displacement.longest: ",
                      interval = "f.toml:7: sample.interval: ";
    BOOST_TEST(of_shares(0.4, 0.3) == "");
    check_message(of_shares(1.1, 1.3), longest, {"lags", "bytes", "allowed"});
    check_message(of_shares(0.3, 1.1), interval, {"samples", "bytes of", "of the whole run", "allowed"});
    // each of them fits
    check_message(of_shares(0.7, 0.5), longest, {"lags", "of the whole run"});
    check_message(of_shares(0.5, 0.7), interval, {"samples", "of the whole run"});
    // more cells than are counted, and sides whose product is no number
    for (char const* length : {"[1e12, 2, 2]", "[2, 2, 1e12]"})
        check_message(said({"dimension=3", std::string("box.length=") + length}),
                      "--set box.length: box.length: ", {"cells", "bytes", "allowed"});
    check_message(said({"dimension=3", "box.length=[1e103, 1e103, 1e103]"}),
                  "--set box.length: box.length: ", {"no number", "allowed"});
}

// --- the stages of soft fluids ---------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(stages_of_soft_fluids_are_read_as_written) {
    Scene const scene = parse_scene(join(soft), "f.toml");
    BOOST_TEST((scene.stage<Shardlow>()->scheme == Scheme::linear));
    BOOST_TEST(scene.stage<Lowe>()->rate == 7.0);
    BOOST_TEST((scene.stage<Rescale>()->mode == Rescaling::layers));
    BOOST_TEST(scene.stage<Rescale>()->cell == 0.5);
    BOOST_TEST(scene.stage<BodyForce>()->acceleration == -0.3);
    BOOST_TEST(scene.stage<Verlet>()->substeps == 10u);
    BOOST_TEST(scene.sample.asks("potential_energy"));
    BOOST_TEST(scene.sample.asks("pressure"));
    BOOST_TEST(!scene.sample.asks("configurational_temperature"));
    BOOST_TEST(!scene.sample.asks("stress"));
    BOOST_TEST(!scene.sample.asks("friction_stress"));
    BOOST_TEST(scene.sample.profile->temperature);
    // defaults
    Scene const plain = parse_scene(
        scene_of("'shardlow', 'lowe', 'rescale', 'body_force', 'sample', 'verlet'") + "sample.profile = {}\n",
        "f.toml");
    BOOST_TEST((plain.stage<Shardlow>()->scheme == Scheme::shardlow));
    BOOST_TEST(plain.stage<Lowe>()->cutoff == 1.0);
    BOOST_TEST(plain.stage<Lowe>()->kT == 1.0);
    BOOST_TEST((plain.stage<Rescale>()->mode == Rescaling::global));
    BOOST_TEST(plain.stage<Rescale>()->kT == 1.0);
    BOOST_TEST(plain.stage<Rescale>()->cell == 1.0);
    BOOST_TEST(plain.stage<Rescale>()->thickness == 1u);
    BOOST_TEST(plain.stage<Rescale>()->amplitude == 0.3);
    BOOST_TEST(!plain.stage<BodyForce>()->opposed);
    BOOST_TEST(plain.stage<Verlet>()->substeps == 1u);
    BOOST_TEST(!plain.sample.profile->temperature);
    // friction_stress is one of the stresses
    Scene const stress = parse_scene(scene_of("'lowe', 'sample', 'drift'", "'friction_stress'"), "f.toml");
    BOOST_TEST(stress.sample.asks("stress"));
    BOOST_TEST(stress.sample.asks("friction_stress"));

    // the longest range and the hottest thermostat count
    BOOST_TEST(plain.cutoff() == 1.0);
    BOOST_TEST(parse_scene(scene_of("'rescale', 'drift'"), "f.toml").cutoff() == 0.0);
    for (char const* stage : {"shardlow", "lowe", "verlet.soft"})
        BOOST_TEST(parse_scene(join(soft), "f.toml", {std::string(stage) + ".cutoff=1.7"}).cutoff() == 1.7);
    for (char const* stage : {"shardlow", "lowe", "rescale"})
        BOOST_TEST(parse_scene(join(soft), "f.toml", {std::string(stage) + ".kT=1.7"}).thermostat_kT() ==
                   1.7);
    BOOST_TEST(parse_scene(scene_of("'verlet'"), "f.toml").thermostat_kT() == 0.0);
}

BOOST_AUTO_TEST_CASE(every_mistake_in_a_soft_fluid_gets_one_line) {
    std::string const above = "a number > 0", zero = "a number >= 0", count = "an integer >= 1";
    check_mistakes(
        {
            {9, "scheme = 'implicit'", "9: shardlow.scheme: ", {"implicit", "allowed", "exponential"}},
            {8,
             "friction = 10.1",
             "8: shardlow.friction: ",
             {"10.1", "mass", "allowed with scheme \"linear\": at most 10"}},
            {11, "rate = -1", "11: lowe.rate: ", {"-1", "allowed", zero}},
            {11, "", "10: lowe.rate: ", {"is missing", "allowed", zero}},
            {11, "rate = 1001", "11: lowe.rate: ", {"1001", "100.1 updates", "allowed", "at most 100"}},
            {11, "rate = 1\ncutoff = 0", "12: lowe.cutoff: ", {"0", "allowed", above}},
            {11, "rate = 1\ncutoff = 2.1", "4: box.length: ", {"4", "allowed", "two cutoffs, 4.2"}},
            {11, "rate = 1\nkT = -1", "12: lowe.kT: ", {"-1", "allowed", zero}},
            {11, "rate = 1\nweight = 'linear'", "12: lowe.weight: ", {"unknown key", "allowed", "rate"}},
            {13, "mode = 'local'", "13: rescale.mode: ", {"local", "allowed", "global, layers, monte_carlo"}},
            {13, "kT = 0", "13: rescale.kT: ", {"0", "allowed", above}},
            {13, "thickness = 0", "13: rescale.thickness: ", {"0", "allowed", count}},
            {13, "amplitude = 0", "13: rescale.amplitude: ", {"0", "allowed", above}},
            {13, "friction = 1", "13: rescale.friction: ", {"unknown key", "allowed", "amplitude"}},
            {14, "cell = 0", "14: rescale.cell: ", {"0", "allowed", above}},
            {14, "cell = 0.7", "14: rescale.cell: ", {"0.7", "box side 4", "allowed", "a whole number"}},
            {14, "cell = 4", "14: rescale.cell: ", {"4", "box side 6", "allowed"}},
            {14, "cell = 8", "14: rescale.cell: ", {"8", "box side 4", "allowed"}},
            {14, "cell = 1e-9", "14: rescale.cell: ", {"1e-09", "box side 4", "allowed"}},
            {16, "", "15: body_force.acceleration: ", {"is missing", "allowed", "a finite number"}},
            {16, "acceleration = inf", "16: body_force.acceleration: ", {"inf", "allowed", "finite"}},
            {16,
             "acceleration = 1\nopposed = 1",
             "17: body_force.opposed: ",
             {"1", "allowed", "true or false"}},
            {18, "substeps = 0", "18: verlet.substeps: ", {"0", "allowed", count}},
            {18, "substeps = 2.5", "18: verlet.substeps: ", {"2.5", "allowed", count}},
            {18, "step = 0.01", "18: verlet.step: ", {"unknown key", "allowed", "substeps"}},
            {19, "", "17: verlet.soft: ", {"a table", "soft"}},
            {20, "", "19: verlet.soft.strength: ", {"is missing", "allowed", zero}},
            {20, "strength = -1", "20: verlet.soft.strength: ", {"-1", "allowed", zero}},
            {20, "strength = 1\ncutoff = 0", "21: verlet.soft.cutoff: ", {"0", "allowed", above}},
            {20, "strength = 1\ncutoff = 2.1", "4: box.length: ", {"4", "allowed", "two cutoffs, 4.2"}},
            {20, "strength = 1\nkT = 1", "21: verlet.soft.kT: ", {"unknown key", "allowed", "cutoff"}},
            {25,
             "observables = ['friction']",
             "25: sample.observables: ",
             {"friction", "allowed", "friction_stress", "potential_energy", "configurational_temperature"}},
            {27, "temperature = 1", "27: sample.profile.temperature: ", {"1", "allowed", "true or false"}},
            // stages that do not go together
            {25, "observables = ['stress']", "2: stages: ", {"several", "allowed with stress", "one"}},
            {25, "observables = ['friction_stress']", "2: stages: ", {"several", "allowed with stress"}},
            {2,
             "stages = ['shardlow', 'lowe', 'rescale', 'body_force', 'sample', 'verlet', 'drift']",
             "2: stages: ",
             {"verlet", "allowed", "one of"}},
        },
        soft);
}

BOOST_AUTO_TEST_CASE(a_stage_and_its_table_belong_together) {
    for (std::string const stage : {"lowe", "rescale", "body_force", "verlet"}) {
        std::string const lists = "'" + stage + "', 'scatter'";
        BOOST_TEST(complaint([&] { parse_scene(scene_of(lists), "f.toml"); }) == "");
        check_message(complaint([&] { parse_scene(scene_of(lists, "", stage), "f.toml"); }),
                      "f.toml:1: " + stage + ": ", {"is missing", "allowed", "[" + stage + "]"});
        check_message(complaint([&] { parse_scene(scene_of("'scatter'") + stage + " = {}\n", "f.toml"); }),
                      "f.toml:6: " + stage + ": ", {"not among the stages"});
    }
}

BOOST_AUTO_TEST_CASE(stress_needs_stages_in_order) {
    auto const message = [](std::string const& stages, std::string const& observables,
                            std::vector<std::string> const& assignments = {}) {
        return complaint([&] { parse_scene(scene_of(stages, observables), "f.toml", assignments); });
    };
    // what goes: one pair thermostat before, or none; several without stress
    for (char const* stages : {"'lowe', 'sample', 'drift'", "'rescale', 'sample', 'drift'",
                               "'sample', 'rescale', 'drift'", "'shardlow', 'rescale', 'sample', 'drift'"})
        BOOST_TEST(message(stages, "'stress'") == "");
    BOOST_TEST(message("'shardlow', 'lowe', 'sample', 'drift'", "'pressure'") == "");
    BOOST_TEST(message("'lowe', 'sample', 'verlet'", "'friction_stress'", {"time.equilibration=0.5"}) == "");

    for (char const* stages : {"'shardlow', 'lowe', 'sample', 'drift'", "'lowe', 'lowe', 'sample', 'drift'",
                               "'shardlow', 'euler', 'sample', 'drift', 'kick'"})
        check_message(message(stages, "'stress'"),
                      "f.toml:2: stages: ", {"several pair thermostats", "allowed with stress: one"});
    for (char const* stages :
         {"'lowe', 'drift', 'sample'", "'sample', 'lowe', 'drift'", "'lowe', 'scatter', 'sample', 'drift'"})
        check_message(message(stages, "'stress'"),
                      "f.toml:2: stages: ", {"no pair impulses", "allowed", "after shardlow, lowe or euler"});
    check_message(message("'lowe', 'verlet', 'sample'", "'stress'", {"time.equilibration=1"}),
                  "f.toml:2: stages: ", {"no pair impulses", "before drift or verlet"});
    BOOST_TEST(message("'euler', 'sample', 'drift', 'kick'", "'friction_stress'", {}) == "");
    for (char const* stages : {"'rescale', 'sample', 'drift'", "'sample', 'drift'"})
        check_message(message(stages, "'friction_stress'"),
                      "f.toml:2: stages: ", {"friction_stress", "allowed: with shardlow"});
    // verlet has measured the step before
    for (std::string const equilibration : {"0", "0.2"})  // less than half a step
        check_message(
            message("'lowe', 'sample', 'verlet'", "'stress'", {"time.equilibration=" + equilibration}),
            "f.toml:5: time: ", {"no equilibration", "allowed with", "and stress"});
    BOOST_TEST(message("'lowe', 'sample', 'verlet'", "'pressure'") == "");
}

// --- the map from atoms to DPD ---------------------------------------------------------------------------

namespace {

/// PK2006's channel between walls.
std::vector<std::string> const mapped{
    "dimension = 3",                               // 1
    "stages = ['modified_verlet', 'body_force']",  // 2
    "[coarse_graining]",                           // 3
    "atoms_per_particle = 5",                      // 4
    "length = [34.2, 68.4, 8.55]",                 // 5
    "force = 0.0085",                              // 6
    "viscosity = 2.117",                           // 7
    "[particles]",                                 // 8
    "density = 3.0",                               // 9
    "[modified_verlet]",                           // 10
    "gamma = 45.0",                                // 11
    "sigma = 3.0",                                 // 12
    "[modified_verlet.soft]",                      // 13
    "cutoff = 1.0",                                // 14
    "[body_force]",                                // 15
    "opposed = false",                             // 16
    "[time]",                                      // 17
    "step = 0.02",                                 // 18
    "duration = 1.0",                              // 19
    "[walls]",                                     // 20
    "thickness = 1.5",                             // 21
    "[box]",                                       // 22
};

double strength_of(Scene const& scene) { return std::get<Soft>(*scene.potential()).strength; }

}  // namespace

BOOST_AUTO_TEST_CASE(a_map_gives_lengths_strength_and_force) {
    using boost::test_tools::tolerance;
    Scene const scene = parse_scene(join(mapped), "f.toml");
    // by hand: rc^3 = 5 * 3/0.8; a = kT (15.36 * 5 - 1)/(2 * 0.101 * 3); f tau^2/rc, tau = (eta/3)/(1.97/0.8)
    // rc^2
    double const rc = std::cbrt(18.75), tau = 2.117 / 3.0 / 2.4625 * rc * rc;
    BOOST_TEST(scene.length.size() == 3u);
    BOOST_TEST(scene.length[0] == 34.2 / rc, tolerance(1e-14));
    BOOST_TEST(scene.length[1] == 68.4 / rc + 3.0, tolerance(1e-14));  // and the walls
    BOOST_TEST(scene.length[2] == 8.55 / rc, tolerance(1e-14));
    BOOST_TEST(scene.wall == 1.5);
    BOOST_TEST(scene.channel_width() == 68.4 / rc, tolerance(1e-14));
    BOOST_TEST(scene.particles == 3200u);  // 16000 atoms
    BOOST_TEST(strength_of(scene) == 0.1 * 75.8 / 0.606, tolerance(1e-13));
    BOOST_TEST(std::get<Soft>(*scene.potential()).cutoff == 1.0);
    BOOST_TEST(scene.stage<BodyForce>()->acceleration == 0.0085 * tau * tau / rc, tolerance(1e-13));
    BOOST_TEST(!scene.stage<BodyForce>()->opposed);
    BOOST_TEST(scene.coarse_graining->atoms_per_particle == 5.0);
    BOOST_TEST(scene.coarse_graining->force == 0.0085);
    BOOST_TEST(scene.coarse_graining->viscosity == 2.117);

    auto const with_set = [&](std::vector<std::string> const& assignments) {
        return parse_scene(join(mapped), "f.toml", assignments);
    };
    // eq. 3 is for density 3, whatever this scene's is; kT is the thermostat's; the cutoff may be named
    BOOST_TEST(strength_of(with_set({"particles.density=2"})) == strength_of(scene));
    BOOST_TEST(with_set({"particles.density=2"}).particles == 2133u);
    BOOST_TEST(strength_of(with_set({"particles.kT=9"})) == strength_of(scene));
    BOOST_TEST(strength_of(with_set({"modified_verlet.gamma=4.5"})) == 10.0 * strength_of(scene),
               tolerance(1e-13));
    BOOST_TEST(strength_of(parse_scene(with(14, "", mapped), "f.toml")) == strength_of(scene));
    // a force on each atom is shared by heavier particles
    BOOST_TEST(with_set({"particles.mass=4"}).stage<BodyForce>()->acceleration ==
                   0.25 * scene.stage<BodyForce>()->acceleration,
               tolerance(1e-14));
    // an acceleration of one's own in place of force and viscosity; a box in place of lengths, with its walls
    auto own = mapped;
    own[5] = own[6] = "";
    own[15] = "acceleration = -0.7";
    Scene const plain = parse_scene(join(own), "f.toml");
    BOOST_TEST(plain.stage<BodyForce>()->acceleration == -0.7);
    BOOST_TEST(plain.coarse_graining->viscosity == 0.0);
    own[4] = "";
    own[21] = "[box]\nlength = [5, 9, 4]";
    Scene const boxed = parse_scene(join(own), "f.toml");
    BOOST_TEST(boxed.length == (std::vector<double>{5, 9, 4}));
    BOOST_TEST(boxed.channel_width() == 6.0);
    BOOST_TEST(strength_of(boxed) == strength_of(scene));
    // without walls and flow; other thermostats and mover
    Scene const lowe = parse_scene(
        "dimension = 3\nstages = ['lowe', 'verlet']\ncoarse_graining = {atoms_per_particle = 1, length = "
        "[10, 12, 8]}\n"
        "particles.density = 3\nbox = {}\nlowe = {rate = 25, kT = 0.3}\nverlet.soft = {}\ntime = {step = "
        "0.02, duration = 1}\n",
        "f.toml");
    BOOST_TEST(lowe.length[1] == 12.0 / std::cbrt(3.75), tolerance(1e-14));
    BOOST_TEST(strength_of(lowe) == 0.3 * 14.36 / 0.606, tolerance(1e-13));
    BOOST_TEST(!lowe.stage<BodyForce>());
    // opposed flows share the box
    auto opposed = mapped;
    opposed[15] = "opposed = true";
    opposed[19] = opposed[20] = "";
    BOOST_TEST(parse_scene(join(opposed), "f.toml").channel_width() == 34.2 / rc, tolerance(1e-14));
    // without a map nothing of it
    BOOST_TEST(!parse_scene(join(good), "f.toml").coarse_graining.has_value());
}

BOOST_AUTO_TEST_CASE(every_mistake_in_a_map_gets_one_line) {
    std::string const above = "a number > 0";
    check_mistakes(
        {
            {4, "", "3: coarse_graining.atoms_per_particle: ", {"is missing", "allowed", above}},
            {4, "atoms_per_particle = 0", "4: coarse_graining.atoms_per_particle: ", {"0", "allowed", above}},
            {4, "atoms_per_particle = -5", "4: coarse_graining.atoms_per_particle: ", {"-5", "allowed"}},
            // 15.36 N_m < 1: no repulsion; the box is large enough
            {4, "atoms_per_particle = 0.06", "3: coarse_graining: ", {"no repulsion", "compressible"}},
            {5, "length = [34.2, 68.4]", "22: box.length: ", {"2 sides", "allowed", "3"}},
            {5, "length = [34.2, 68.4, 0]", "5: coarse_graining.length: ", {"0", "allowed", above}},
            {5, "length = [34.2, 68.4, 5]", "5: coarse_graining.length: ", {"too small", "two cutoffs"}},
            {5, "", "22: box.length: ", {"is missing", "allowed"}},
            {6, "", "7: coarse_graining.viscosity: ", {"unknown key", "allowed", "force"}},
            {6, "force = 0", "6: coarse_graining.force: ", {"0", "allowed", above}},
            {7, "", "3: coarse_graining.viscosity: ", {"is missing", "allowed", above}},
            {7, "viscosity = 0", "7: coarse_graining.viscosity: ", {"0", "allowed", above}},
            {7,
             "viscosity = 1\ntemperature = 1",
             "8: coarse_graining.temperature: ",
             {"unknown key", "length"}},
            {22, "[box]\nlength = [5, 5, 5]", "23: box.length: ", {"coarse_graining", "one of them"}},
            {14,
             "strength = 12.5",
             "14: modified_verlet.soft.strength: ",
             {"coarse_graining", "one of them"}},
            {14,
             "cutoff = 1.1",
             "13: modified_verlet.soft.strength: ",
             {"cutoff", "coarse_graining", "one of them"}},
            {13, "[modified_verlet.lennard_jones]", "3: coarse_graining: ", {"soft potential"}},
            {12, "sigma = 0.0", "3: coarse_graining: ", {"thermostat", "kT > 0"}},
            {11, "gamma = 0.0", "3: coarse_graining: ", {"thermostat", "kT > 0"}},
            {16,
             "acceleration = 1",
             "16: body_force.acceleration: ",
             {"coarse_graining.force", "one of them"}},
            {2,
             "stages = ['modified_verlet']",
             "6: coarse_graining.force: ",
             {"body_force", "both or neither"}},
            {1, "dimension = 2", "4: coarse_graining.atoms_per_particle: ", {"three dimensions"}},
            {21, "thickness = 0.9", "20: walls: ", {"thinner than the cutoff"}},
        },
        mapped);
    // neither force nor acceleration
    auto neither = mapped;
    neither[5] = neither[6] = "";
    check_message(complaint([&] { parse_scene(join(neither), "f.toml"); }),
                  "f.toml:15: body_force.acceleration: ", {"is missing", "allowed", "a finite number"});
    // no potential at all, no thermostat at all
    std::string const head =
        "dimension = 3\ncoarse_graining = {atoms_per_particle = 1, length = [9, 9, 9]}\nparticles.density = "
        "3\nbox = {}\n"
        "time = {step = 0.02, duration = 1}\n";
    check_message(complaint([&] {
                      parse_scene(head + "stages = ['shardlow', 'drift']\nshardlow.friction = 1\n", "f.toml");
                  }),
                  "f.toml:2: coarse_graining: ", {"soft potential"});
    check_message(complaint([&] { parse_scene(head + "stages = ['verlet']\nverlet.soft = {}\n", "f.toml"); }),
                  "f.toml:2: coarse_graining: ", {"thermostat", "kT > 0"});
    // without a map the strength is asked for, with it a stage's table still is
    check_message(complaint([&] {
                      parse_scene(head +
                                      "stages = ['body_force', 'shardlow', 'verlet']\nverlet.soft = {}\n"
                                      "shardlow.friction = 1\n",
                                  "f.toml", {"coarse_graining.force=1", "coarse_graining.viscosity=1"});
                  }),
                  "f.toml:1: body_force: ", {"is missing", "allowed", "[body_force]"});
}

BOOST_AUTO_TEST_CASE(order_and_configuration_are_read_as_written) {
    auto const set = [](std::vector<std::string> const& assignments) {
        return parse_scene(join(good), "f.toml", assignments).sample;
    };
    auto const plain = set({});
    BOOST_TEST(!plain.configuration);
    BOOST_TEST(!plain.bond_order.has_value());
    auto const all = set({"sample.configuration=true", "sample.bond_order={range=1.3, interval=7}"});
    BOOST_TEST(all.configuration);
    BOOST_TEST(all.bond_order->range == 1.3);
    BOOST_TEST(all.bond_order->interval == 7u);
    BOOST_TEST(set({"sample.bond_order.range=2"}).bond_order->interval == 100u);
    for (auto const& [assignment, key, words] :
         std::vector<std::tuple<std::string, std::string, std::vector<std::string>>>{
             {"sample.bond_order.interval=2", "sample.bond_order.range: ", {"is missing", "a number > 0"}},
             {"sample.bond_order.range=0", "sample.bond_order.range: ", {"0", "allowed", "a number > 0"}},
             {"sample.bond_order.range=2.1", "sample.bond_order.range: ", {"half the shortest box side, 2"}},
             {"sample.bond_order={range=1, interval=0}", "sample.bond_order.interval: ", {"an integer >= 1"}},
             {"sample.bond_order={range=1, bins=3}", "sample.bond_order.bins: ", {"unknown key", "interval"}},
             {"sample.configuration=1", "sample.configuration: ", {"1", "allowed", "true or false"}}}) {
        auto const message = complaint([&, &text = assignment] { set({text}); });
        BOOST_TEST(message.find(key) != std::string::npos, message);
        check_message(message, "", words);
    }
    check_message(complaint([] {
                      parse_scene(scene_of("'sample', 'drift'"), "f.toml", {"sample.bond_order.range=1"});
                  }),
                  "--set ", {"sample.bond_order.range: ", "three dimensions"});
}

BOOST_AUTO_TEST_CASE(missing_tables) {
    for (std::string const table : {"box", "particles", "shardlow", "time"}) {
        std::string text;
        bool inside = false;
        for (auto const& line : good) {
            if (line.starts_with("[")) inside = line == "[" + table + "]";
            if (!inside) text += line + "\n";
        }
        check_message(complaint([&] { parse_scene(text, "f.toml"); }), "f.toml:1: " + table + ": ",
                      {"is missing", "allowed", "[" + table + "]"});
    }
    check_message(complaint([] { parse_scene("time = 3\n" + with(14, ""), "f.toml"); }), "f.toml:", {"time"});
    check_message(complaint([] { parse_scene("", "f.toml"); }), "f.toml",
                  {"dimension", "is missing", "2 or 3"});
}

BOOST_AUTO_TEST_CASE(files_that_cannot_be_read) {
    Directory const directory;
    auto const missing = directory.path / "no" / "scene.toml";
    check_message(complaint([&] { load_scene(missing); }), missing.string() + ": ", {"cannot be read"});
    check_message(complaint([&] { load_scene(directory.path); }), directory.path.string() + ": ",
                  {"cannot be read"});
    auto const empty = directory.path / "empty.toml";
    std::ofstream(empty).close();
    check_message(complaint([&] { load_scene(empty); }), empty.string(), {"dimension", "is missing"});
    auto const binary = directory.path / "binary.toml";
    std::ofstream(binary, std::ios::binary) << "\x89HDF\r\n\x1a\n" << std::string(100, '\0');
    check_message(complaint([&] { load_scene(binary); }), binary.string() + ":1: ", {});
    auto const file = directory.path / "good.toml";
    std::ofstream(file) << join(good);
    BOOST_TEST(load_scene(file).particles == 360u);
}

BOOST_AUTO_TEST_CASE(overrides) {
    auto const set = [](std::vector<std::string> const& assignments) {
        return parse_scene(join(good), "f.toml", assignments);
    };
    BOOST_TEST(set({"time.step=0.2"}).time_step == 0.2);
    BOOST_TEST(set({"time.step=0.2", "time.step=0.25"}).time_step == 0.25);  // the last one counts
    BOOST_TEST(set({"dimension=2", "box.length=[4.0, 5.0]"}).length.size() == 2u);
    BOOST_TEST(
        (set({"shardlow.weight=constant"}).stage<Shardlow>()->weight == Weight::constant));  // a bare string
    BOOST_TEST((set({"shardlow.weight=\"constant\""}).stage<Shardlow>()->weight == Weight::constant));
    BOOST_TEST(set({"title=x = y"}).title == "x = y");
    BOOST_TEST(set({"title="}).title == "");
    BOOST_TEST(set({"title=it's \"so\""}).title == "it's \"so\"");
    BOOST_TEST(set({"seed=8"}).seed == 8u);
    BOOST_TEST(set({"sample.profile.bins=8"}).sample.profile->bins == 8u);  // a table the file lacks
    BOOST_TEST(parse_scene(join(good), "f.toml", {"seed=8"}, 9).seed == 9u);

    auto const complaint_of = [&](std::string const& assignment) {
        return complaint([&] { set({assignment}); });
    };
    check_message(complaint_of("time.step"), "--set time.step: ", {"allowed", "table.key=value"});
    check_message(complaint_of(""), "--set ", {"allowed", "table.key=value"});
    check_message(complaint_of("=3"), "--set =3: ", {"allowed", "table.key=value"});
    check_message(complaint_of("time.setp=3"), "--set time.setp: ", {"unknown key", "allowed", "step"});
    check_message(complaint_of("stepp=3"), "--set stepp: ", {"unknown key", "allowed", "stages"});
    check_message(complaint_of("tme.step=3"), "--set tme.step: ", {"tme", "unknown key", "allowed", "time"});
    check_message(complaint_of(".a=3"), "--set .a: ", {"unknown key", "allowed"});
    check_message(complaint_of("time.step=-3"), "--set time.step: ", {"-3", "allowed", "a number > 0"});
    check_message(complaint_of("time.step=fast"), "--set time.step: ", {"fast", "allowed", "a number > 0"});
    check_message(complaint_of("time.step="), "--set time.step: ", {"allowed", "a number > 0"});
    check_message(complaint_of("time.step.x=3"), "--set time.step.x: ", {"step is not a table"});
    check_message(complaint_of("time=3"), "--set time: ", {"3", "allowed", "a table"});
    check_message(complaint_of("shardlow.weight=cubic"),
                  "--set shardlow.weight: ", {"cubic", "allowed", "linear"});
    check_message(complaint_of("shardlow.weight=cu\nbic"), "--set shardlow.weight: ", {"allowed", "linear"});
    check_message(complaint_of("shardlow.weight=c'u\"b"), "--set shardlow.weight: ", {"allowed", "linear"});
    check_message(complaint_of("time.step=1\nmass=3"), "--set time.step: ", {"allowed", "a number > 0"});
}

BOOST_AUTO_TEST_CASE(key_names_what_determines_the_results) {
    auto const key = [](std::string const& text, std::vector<std::string> const& assignments = {},
                        std::optional<std::uint64_t> seed = {}) {
        return parse_scene(text, "f.toml", assignments, seed).key();
    };
    std::string const reference = key(join(good));
    BOOST_TEST(reference.size() == 36u);
    BOOST_TEST(key(join(good)) == reference);
    BOOST_TEST(parse_scene(join(good), "another_name.toml").key() == reference);

    // comments, blank lines and order do not matter
    std::string commented = "# a comment\n\n";
    for (auto const& line : good) commented += line + "  # why\n\n";
    BOOST_TEST(key(commented) == reference);
    std::vector<std::string> reordered(good.begin() + 13, good.end());       // [time] ...
    reordered.insert(reordered.begin(), good.begin(), good.begin() + 4);     // the root
    reordered.insert(reordered.end(), good.begin() + 4, good.begin() + 13);  // [box] ...
    BOOST_TEST(key(join(reordered)) == reference);
    std::swap(reordered[0], reordered[2]);
    BOOST_TEST(key(join(reordered)) == reference);
    BOOST_TEST(key(join(good), {"sample.profile.bins=8"}) ==
               key(with(19, "[sample.profile]\nbins = 8\n" + good[18])));
    BOOST_TEST(key(join(good), {"time.step=0.1"}) == reference);  // an override that changes nothing

    // everything else does: a value, down to its last bit, and the seed, wherever it is given
    BOOST_TEST(key(with(15, "step = 0.2")) != reference);
    BOOST_TEST(key(with(15, "step = 0.10000000000000001")) == reference);  // the same number
    BOOST_TEST(key(with(15, "step = 0.10000000000000002")) != reference);  // the next number
    BOOST_TEST(key(with(10, "mass = 2.000000000000001")) != reference);
    BOOST_TEST(key(with(13, "weight = \"constant\"")) != reference);
    BOOST_TEST(key(with(13, "")) != reference);
    BOOST_TEST(key(join(good), {"shardlow.weight=constant"}) == key(with(13, "weight = \"constant\"")));
    BOOST_TEST(key(with(3, "seed = 6")) != reference);
    BOOST_TEST(key(join(good), {}, 6) == key(with(3, "seed = 6")));
    BOOST_TEST(key(join(good), {"seed=6"}) == key(with(3, "seed = 6")));
    BOOST_TEST(key(join(good), {}, 0) != key(join(good), {}, ~std::uint64_t{0}));
}
