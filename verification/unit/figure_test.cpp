/// @file
/// Figures: definitions and their mistakes, what points share and join, comparisons and verdicts, files; and
/// the quantities that are derived, from made-up records with known answers.
#define BOOST_TEST_MODULE figure
#include "figure.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "analysis.hpp"
#include "convergence.hpp"
#include "define_figure.hpp"
#include "derived.hpp"
#include "errors.hpp"
#include "files.hpp"
#include "judge_figure.hpp"
#include "report.hpp"
#include "run.hpp"
#include "run_figure.hpp"
#include "theory/closed_forms.hpp"
#include "theory_arguments.hpp"
#include "toml_reader.hpp"
#include "write_figure.hpp"

using namespace dpd;
namespace data = boost::unit_test::data;
using boost::test_tools::tolerance;

namespace {

/// A good definition, by line; a test replaces one line by another.
std::vector<std::string> const good{
    "paper = 'none'",                                // 1
    "figure = '0'",                                  // 2
    "title = 'a title'",                             // 3
    "caption = 'a caption'",                         // 4
    "[scene]",                                       // 5
    "dimension = 2",                                 // 6
    "stages = ['shardlow', 'sample', 'drift']",      // 7
    "box.length = [4.0, 4.0]",                       // 8
    "particles.density = 2.0",                       // 9
    "shardlow.friction = 2.0",                       // 10
    "time.step = 0.1",                               // 11
    "time.duration = 4.0",                           // 12
    "sample.observables = ['kinetic_temperature']",  // 13
    "[budget.quick]",                                // 14
    "seeds = 2",                                     // 15
    "duration_scale = 0.5",                          // 16
    "[budget.paper]",                                // 17
    "seeds = 3",                                     // 18
    "[[curve]]",                                     // 19
    "name = 'gas'",                                  // 20
    "vary = 'shardlow.friction'",                    // 21
    "values = [1.0, 4.0]",                           // 22
    "[[curve.compare]]",                             // 23
    "quantity = 'kinetic_temperature'",              // 24
    "theory = 'value'",                              // 25
    "value = 1.0",                                   // 26
    "[[curve]]",                                     // 27
    "name = 'bins'",                                 // 28
    "record = 'velocity_autocorrelation'",           // 29
};

std::string join(std::vector<std::string> const& lines) {
    std::string text;
    for (auto const& line : lines) text += line + "\n";
    return text;
}

std::string with(std::size_t line, std::string const& replacement) {
    auto lines = good;
    lines.at(line - 1) = replacement;
    return join(lines);
}

/// The good definition with other curves.
std::string with_curves(std::string const& curves) {
    return join({good.begin(), good.begin() + 18}) + curves;
}

struct Fixture {
    Fixture() { std::filesystem::create_directories(directory / "test"); }
    ~Fixture() { std::filesystem::remove_all(directory); }
    Figure load(std::string const& definition, std::string const& budget = "quick",
                std::vector<std::string> const& changes = {}) const {
        std::ofstream(directory / "test" / "figure.toml") << definition;
        return load_figure(directory, "test", budget, changes);
    }
    /// What is complained of; empty if nothing is.
    std::string complaint(std::string const& definition) const {
        try {
            load(definition);
        } catch (InputError const& error) {
            return error.what();
        }
        return "";
    }
    std::filesystem::path const directory =
        std::filesystem::temp_directory_path() / fmt::format("dpdref_figure_test.{}", ::getpid());
    std::string const file = (directory / "test" / "figure.toml").string();
};

Scene scene(std::string const& stages, std::vector<std::string> const& assignments = {}) {
    std::vector<std::string> all{"dimension=3",     "stages=[" + stages + "]", "box.length=[5, 6, 5]",
                                 "time.step=0.1",   "time.duration=20",        "particles.density=3",
                                 "particles.mass=2"};
    if (stages.find("'shardlow'") != std::string::npos) all.push_back("shardlow.friction=4.5");
    if (stages.find("'verlet'") != std::string::npos) all.push_back("verlet.soft.strength=25");
    all.insert(all.end(), assignments.begin(), assignments.end());
    return parse_scene("[time]\n", "figure_test", all);
}

Estimate const& estimate_of(std::vector<Quantity> const& quantities, std::string const& name) {
    Quantity const* const quantity = find_quantity(quantities, name);
    BOOST_REQUIRE_MESSAGE(quantity, "no " << name);
    return quantity->estimate;
}

void check_estimate(std::vector<Quantity> const& quantities, std::string const& name, double value,
                    double error, double within = 1e-12) {
    Estimate const& estimate = estimate_of(quantities, name);
    BOOST_TEST_CONTEXT(name) {
        BOOST_TEST(estimate.value == value, tolerance(within));
        BOOST_TEST(std::abs(estimate.error - error) <= std::max(within * std::abs(error), 1e-14));
    }
}

/// A curve with value(x, block) in `blocks` blocks; the weight of a bin must not matter.
template <class F>
Curve made(std::size_t bins, double first, double spacing, Eigen::Index blocks, F&& value) {
    Curve curve;
    auto const rows = static_cast<Eigen::Index>(bins);
    curve.sum.resize(rows, blocks);
    curve.weight.resize(rows, blocks);
    for (Eigen::Index bin = 0; bin < rows; ++bin) {
        curve.x.push_back(first + spacing * double(bin));
        for (Eigen::Index block = 0; block < blocks; ++block) {
            curve.weight(bin, block) = 3.0 + double(bin % 4) + double(block);
            curve.sum(bin, block) = curve.weight(bin, block) * value(curve.x.back(), block);
        }
    }
    return curve;
}

/// Blocks 0 and 1 lie by a share below and above the mean; then the mean's error is this share.
double scattered(double mean, double share, Eigen::Index block) {
    return mean * (1.0 + (block == 0 ? -share : share));
}

}  // namespace

BOOST_FIXTURE_TEST_SUITE(figures, Fixture)

// --- definitions -----------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(a_definition_is_read_as_written) {
    std::string const definition = with(
        29,
        "record = 'velocity_autocorrelation'\njoin = 'gas'\nfrom = 0.1\nto = 0.7\nevery = 3\nlabel = 'C'\n"
        "[curve.set]\n'sample.velocity_autocorrelation.longest' = 1.0\n'shardlow.friction' = 7\n"
        "[[curve.compare]]\nquantity = 'velocity_autocorrelation'\ntheory = 'quantity:exponential_decay'\n"
        "relation = 'differs'\ntolerance = 0.1\n");
    Figure const figure = load(definition);
    BOOST_TEST(figure.title == "a title");
    BOOST_TEST(figure.curves.size() == 2u);
    FigureCurve const &gas = figure.curves[0], &bins = figure.curves[1];
    BOOST_TEST(gas.label == "gas");
    BOOST_TEST(gas.parameter == "shardlow.friction");
    BOOST_TEST(gas.record == "");
    BOOST_TEST(gas.join == "");
    BOOST_TEST((gas.criteria.at(0).relation == Relation::equal));
    BOOST_TEST(gas.criteria[0].resolution == 0.01);
    BOOST_TEST(bins.label == "C");
    BOOST_TEST(bins.parameter == "");
    BOOST_TEST(bins.record == "velocity_autocorrelation");
    BOOST_TEST(bins.join == "gas");
    BOOST_TEST(bins.from == 0.1);
    BOOST_TEST(bins.to == 0.7);
    BOOST_TEST(bins.every == 3u);
    BOOST_TEST((bins.criteria.at(0).relation == Relation::differs));
    BOOST_TEST(bins.criteria[0].theory == "quantity:exponential_decay");
    BOOST_TEST(bins.criteria[0].tolerance == 0.1);
    // two points, and one whose bins will be
    BOOST_TEST(figure.points.size() == 3u);
    for (std::size_t p = 0; p < 3; ++p) {
        BOOST_TEST(figure.points[p].runs.size() == 2u);
        BOOST_TEST(figure.points[p].runs[1].seed == 2u);
        BOOST_TEST(figure.points[p].runs[0].production_steps == 20u);  // half of the paper's
        BOOST_TEST(figure.points[p].runs[0].stage<Shardlow>()->friction == (std::vector{1.0, 4.0, 7.0})[p]);
    }
    BOOST_TEST(load(definition, "paper").points[0].runs.size() == 3u);
    BOOST_TEST(load(definition, "paper").points[0].runs[0].production_steps == 40u);

    FigureCurve const plain = load(join(good)).curves[1];
    BOOST_TEST(plain.from == 0.0);
    BOOST_TEST(std::isinf(plain.to));
    BOOST_TEST(plain.every == 1u);
}

BOOST_AUTO_TEST_CASE(of_the_keys_that_change_a_scene_the_last_one_counts) {
    // budget, then the curve's set, then along, then the varied parameter
    auto lines = good;
    lines[15] += "\nset = {'particles.mass' = 2.0, 'shardlow.cutoff' = 0.5, 'shardlow.kT' = 3.0}";
    lines[21] =
        "values = [1.0, 4.0, 9.0]\npaper_only = [4.0]\n"
        "along = {'shardlow.cutoff' = [0.7, 0.8, 0.9], 'shardlow.friction' = 5.0}\n"
        "set = {'shardlow.kT' = 1.5, 'shardlow.cutoff' = 0.6}";
    Figure const figure = load(join(lines));
    BOOST_TEST(figure.points.size() == 3u);
    for (std::size_t p : {0, 1}) {
        Scene const& run = figure.points[p].runs[0];
        BOOST_TEST(run.mass == 2.0);
        BOOST_TEST(run.stage<Shardlow>()->kT == 1.5);
        BOOST_TEST(run.stage<Shardlow>()->cutoff == (p == 0 ? 0.7 : 0.9));
        BOOST_TEST(run.stage<Shardlow>()->friction == (p == 0 ? 1.0 : 9.0));
    }
    BOOST_TEST(figure.points[2].runs[0].stage<Shardlow>()->kT == 3.0);
}

BOOST_AUTO_TEST_CASE(changes_count_last_in_the_scenes_that_have_the_table) {
    std::string const curves =
        "[[curve]]\nname = 'a'\nvary = 'time.step'\nvalues = [0.1, 0.2]\n"
        "set = { 'shardlow.friction' = 3.0 }\n"
        "[[curve]]\nname = 'b'\nvary = 'particles.mass'\nvalues = [1.0]\n"
        "set = { 'sample.profile.bins' = 4 }\n";
    Figure const figure = load(with_curves(curves), "quick",
                               {"shardlow.friction=7", "particles.density=4.0", "sample.profile.bins=6"});
    BOOST_REQUIRE(figure.points.size() == 3u);
    for (auto const& point : figure.points) {
        BOOST_TEST(point.runs.front().stage<Shardlow>()->friction == 7.0);
        BOOST_TEST(point.runs.front().particles == 64u);
    }
    BOOST_TEST(figure.caption ==
               "a caption Changed: shardlow.friction=7. Changed: particles.density=4.0. Changed: "
               "sample.profile.bins=6.");
    auto const complains = [&](std::string const& change, std::string const& words) {
        BOOST_CHECK_EXCEPTION(load(with_curves(curves), "quick", {change}), InputError,
                              [&](InputError const& error) {
                                  std::string const message = error.what();
                                  BOOST_TEST_MESSAGE(message);
                                  return message.find(words) != std::string::npos;
                              });
    };
    complains("time.step=0.3", "curve a of ");
    complains("walls.strength=1", "has a table 'walls'");
    complains("particles.densty=4", "densty");
}

BOOST_AUTO_TEST_CASE(seeds_of_points_and_runs) {
    auto const seeds = [](Figure const& figure) {
        std::vector<std::vector<std::uint64_t>> all;
        for (auto const& point : figure.points) {
            all.emplace_back();
            for (Scene const& scene : point.runs) all.back().push_back(scene.seed);
        }
        return all;
    };
    using Seeds = std::vector<std::vector<std::uint64_t>>;
    BOOST_TEST((seeds(load(join(good), "paper")) == Seeds{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}));
    auto lines = good;
    lines[21] = "values = [1.0, 4.0]\npaper_seeds = 5";
    BOOST_TEST((seeds(load(join(lines), "paper")) == Seeds{{1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}, {1, 2, 3}}));
    BOOST_TEST((seeds(load(join(lines))) == Seeds{{1, 2}, {1, 2}, {1, 2}}));
    lines = good;
    lines[5] = "dimension = 2\nseed = 40";
    lines[21] = "values = [1.0, 4.0]\nset = {seed = 7}";
    BOOST_TEST((seeds(load(join(lines))) == Seeds{{7, 8}, {7, 8}, {40, 41}}));
    lines = good;
    lines[20] = "vary = 'seed'";
    lines[21] = "values = [3, 10]";
    Figure const figure = load(join(lines));
    BOOST_TEST((seeds(figure) == Seeds{{3, 4}, {10, 11}, {1, 2}}));
    BOOST_TEST(figure.points[1].x == 10.0);
    // the runs of a point are one scene, and what another seed makes of it
    Scene const& first = figure.points[0].runs[0];
    for (std::size_t p : {0u, 1u})
        for (Scene const& scene : figure.points[p].runs) {
            BOOST_TEST(scene.text == first.text);
            BOOST_TEST(scene.key() == parse_scene(first.text, "figure_test", {}, scene.seed).key());
        }
    BOOST_TEST(first.key() != figure.points[0].runs[1].key());
}

BOOST_AUTO_TEST_CASE(a_budget_scales_the_equilibration) {
    auto lines = good;
    lines[11] = "time.duration = 4.0\ntime.equilibration = 3.0";
    Figure const plain = load(join(lines));
    BOOST_TEST(plain.points[0].runs[0].equilibration_steps == 30u);
    lines[15] = "duration_scale = 0.5\nequilibration_scale = 1.0";
    Figure const same = load(join(lines));
    lines[15] = "duration_scale = 0.5\nequilibration_scale = 0.5";
    Figure const half = load(join(lines));
    for (std::size_t p = 0; p < 3; ++p) {
        Scene const &a = plain.points[p].runs[1], &b = same.points[p].runs[1], &c = half.points[p].runs[1];
        // a factor of one leaves the text as written, and with it what is in the cache
        BOOST_TEST(a.text.find("equilibration = 3.0\n") != std::string::npos, a.text);
        BOOST_TEST(a.text == b.text);
        BOOST_TEST(a.key() == b.key());
        BOOST_TEST(c.equilibration_steps == 15u);
        BOOST_TEST(c.production_steps == 20u);
        BOOST_TEST(a.key() != c.key());
    }
    BOOST_TEST(load(join(lines), "paper").points[0].runs[0].equilibration_steps == 30u);
    // none stays none
    lines[11] = good[11];
    Figure const none = load(join(lines));
    BOOST_TEST(none.points[0].runs[0].equilibration_steps == 0u);
    BOOST_TEST(none.points[0].runs[0].key() == load(join(good)).points[0].runs[0].key());
}

BOOST_AUTO_TEST_CASE(a_budget_scales_the_errors_wanted) {
    auto lines = good;
    lines[11] = "time.duration = 4.0\ntime.until = { kinetic_temperature = 0.01 }";
    lines[21] = "values = [1.0, 4.0]\nset = {'time.until.pressure' = 0.02}";
    lines[15] = "duration_scale = 0.5\nerror_scale = 3.0";
    Figure const quick = load(join(lines)), paper = load(join(lines), "paper");
    using Errors = std::map<std::string, double>;
    BOOST_TEST(
        (paper.points[0].runs[0].until->errors == Errors{{"kinetic_temperature", 0.01}, {"pressure", 0.02}}));
    BOOST_TEST(quick.points[0].runs[0].until->errors.at("kinetic_temperature") == 0.03, tolerance(1e-14));
    BOOST_TEST(quick.points[0].runs[0].until->errors.at("pressure") == 0.06, tolerance(1e-14));
    BOOST_TEST(quick.points[2].runs[0].until->errors.size() == 1u);
    // without errors there is nothing to scale
    lines[11] = good[11];
    lines[21] = good[21];
    BOOST_TEST(!load(join(lines)).points[0].runs[0].until);
}

BOOST_AUTO_TEST_CASE(every_theory_is_known) {
    for (char const* theory : {"ng17", "previous", "curve:gas", "quantity:x", "value"})
        BOOST_TEST(complaint(with(25, fmt::format("theory = '{}'", theory))) == "");
    for (char const* relation : {"equal", "at_most", "at_least", "differs"})
        BOOST_TEST(complaint(with(26, fmt::format("relation = '{}'", relation))) == "");
}

BOOST_AUTO_TEST_CASE(every_mistake_gets_one_line) {
    struct Mistake {
        std::size_t line;         ///< of `good`, to be replaced
        std::string replacement;  ///< by this
        std::string begin;        ///< of the message, after the file's name
        std::vector<std::string> words;
    };
    std::vector<Mistake> const mistakes{
        {25,
         "theory = 'ng99'",
         ":25: curve.compare.theory: ",
         {"no closed form", "allowed", "curve:NAME", "quantity:NAME", "previous", "value"}},
        {25, "theory = 'curve:none'", ": curve gas: theory: ", {"there is no curve none"}},
        {25, "theory = 'previously'", ":25: curve.compare.theory: ", {"allowed"}},
        {25, "", ":23: curve.compare.theory: ", {"is missing", "allowed"}},
        {26, "relation = 'other'", ":26: curve.compare.relation: ", {"other", "allowed", "differs"}},
        {26, "tolerance = -1", ":26: curve.compare.tolerance: ", {"-1", "allowed", ">= 0"}},
        {26, "resolution = 0", ":26: curve.compare.resolution: ", {"0", "allowed", "> 0"}},
        {26, "worth = 1", ":26: curve.compare.worth: ", {"unknown key", "allowed", "value"}},
        {29, "", ":27: curve.vary: ", {"is missing", "allowed"}},
        {29, "record = 1", ":29: curve.record: ", {"1", "allowed", "a string"}},
        {29, "record = 'x'\nvary = 'time.step'", ":30: curve.vary: ", {"own x", "allowed", "one"}},
        {29, "record = 'x'\nevery = 0", ":30: curve.every: ", {"0", "allowed", "an integer >= 1"}},
        {29, "record = 'x'\nvalues = [0.0]", ":30: curve.values: ", {"own x", "allowed: no values"}},
        {29, "record = 'x'\nvalues = [1.0, 2.0]", ":30: curve.values: ", {"own x", "allowed: no values"}},
        {29,
         "record = 'x'\nslope_between = ['gas']",
         ":30: curve.slope_between: ",
         {"allowed", "two curves", "lower", "higher"}},
        {29,
         "record = 'x'\nslope_between = 'gas'",
         ":30: curve.slope_between: ",
         {"gas", "allowed", "a list"}},
        {29,
         "record = 'x'\nslope_between = ['gas', 'none']",
         ": curve bins: slope_between: ",
         {"there is no curve none"}},
        {24, "quantity = 'exponent:x'\nworth = 1", ":25: curve.compare.worth: ", {"unknown key"}},
        {15, "seeds = 2\nequilibration_scale = 0", ":16: budget.quick.equilibration_scale: ", {"0", "> 0"}},
        {29, "record = 'x'\nfrom = 'a'", ":30: curve.from: ", {"allowed", "a finite number"}},
        {29, "record = 'x'\nto = inf", ":30: curve.to: ", {"inf", "allowed", "a finite number"}},
        {29, "record = 'x'\nuntil = 1", ":30: curve.until: ", {"unknown key", "allowed", "to"}},
        {29, "record = 'x'\njoin = 1", ":30: curve.join: ", {"1", "allowed", "a string"}},
        {21, "vary = 'time.step'\nfrom = 1", ":22: curve.from: ", {"unknown key", "allowed"}},
        {22, "", ":19: curve.values: ", {"is missing", "allowed", "a list"}},
        {22, "values = [1.0]\nline = [1.0]", ":23: curve.line: ", {"allowed", "[from, to]"}},
        {22, "values = [1, 2]\nalong = {'time.step' = [0.1]}", ": time.step: ", {"has no value for point 2"}},
        {22, "values = [1]\nset = {'shardlow.fiction' = 1}", " (gas, shardlow.friction = 1):", {"fiction"}},
        {16, "scale = 2", ":16: budget.quick.scale: ", {"unknown key", "allowed", "duration_scale"}},
        {17, "[budget.papers]", ":", {"budget.paper: ", "is missing", "allowed", "a table"}},
        {18, "seeds = 0", ":18: budget.paper.seeds: ", {"0", "allowed", "an integer >= 1"}},
        {5, "[scenes]", ": scene: ", {"is missing", "allowed", "[scene]"}},
        {4, "capture = 1", ": caption: ", {"is missing", "allowed"}},
    };
    BOOST_TEST(complaint(join(good)) == "");
    for (auto const& mistake : mistakes)
        BOOST_TEST_CONTEXT("line " << mistake.line << ": " << mistake.replacement) {
            std::string const message = complaint(with(mistake.line, mistake.replacement));
            BOOST_TEST(message.find('\n') == std::string::npos, message);
            BOOST_TEST(message.starts_with(file), message);
            BOOST_TEST(message.find(mistake.begin) != std::string::npos, message);
            for (auto const& word : mistake.words)
                BOOST_TEST(message.find(word) != std::string::npos, message << " lacks " << word);
        }
    auto lines = good;
    lines[23] = "quantity = 'exponent:kinetic_temperature'";
    BOOST_TEST(complaint(join(lines)) == "");
    lines[24] = "theory = 'previous'";
    std::string const exponent = complaint(join(lines));
    BOOST_TEST(exponent.starts_with(file + ":25: curve.compare.theory: "), exponent);
    BOOST_TEST(exponent.find("a slope from the point before") != std::string::npos, exponent);
    BOOST_TEST(exponent.find('\n') == std::string::npos, exponent);
    BOOST_CHECK_EXCEPTION(load_figure(directory, "none", "quick"), InputError, [](InputError const& error) {
        return std::string(error.what()) == "figure none: unknown; allowed: all, test";
    });
}

// --- comparisons -----------------------------------------------------------------------------------------

namespace {

/// Curves a, b and c: a at 1, 2 and 3, b at 1 and 3, c at 5. Quantity q is 10 x, with error 0.1 x; r is x.
Figure made_figure(Criterion const& criterion) {
    Figure figure;
    figure.id = "made";
    for (char const* name : {"a", "b", "c"}) {
        figure.curves.emplace_back();
        figure.curves.back().name = name;
        figure.curves.back().parameter = "shardlow.friction";
    }
    figure.curves[0].criteria = {criterion};
    std::vector<std::vector<double>> const values{{1, 2, 3}, {1, 3}, {5}};
    for (std::size_t curve = 0; curve < values.size(); ++curve)
        for (double const x : values[curve])
            figure.points.push_back(
                {.curve = curve,
                 .x = x,
                 .runs = {scene("'shardlow', 'drift'", {fmt::format("shardlow.friction={}", x)})},
                 .quantities = {{"q", {.value = 10.0 * x, .error = 0.1 * x, .blocks = 9}},
                                {"r", {.value = x, .error = 0.5, .blocks = 9}}},
                 .configuration = {}});
    return figure;
}

std::string complaint_of_comparing(std::string const& quantity, std::string const& theory) {
    try {
        compare(made_figure({.quantity = quantity, .theory = theory}));
    } catch (InputError const& error) {
        return error.what();
    }
    return "";
}

}  // namespace

BOOST_AUTO_TEST_CASE(what_a_quantity_is_compared_with) {
    struct Reference {
        std::string theory;
        std::vector<double> x, value, error;
    };
    double const value = 4.0;
    std::vector<Reference> const references{
        {"value", {1, 2, 3}, {value, value, value}, {0, 0, 0}},
        {"previous", {2, 3}, {10, 20}, {0.1, 0.2}},             // the first point has none
        {"curve:c", {1, 2, 3}, {50, 50, 50}, {0.5, 0.5, 0.5}},  // one point stands for all x
        {"quantity:r", {1, 2, 3}, {1, 2, 3}, {0.5, 0.5, 0.5}},
        {"curve:a", {1, 2, 3}, {10, 20, 30}, {0.1, 0.2, 0.3}},
    };
    for (auto const& reference : references) BOOST_TEST_CONTEXT(reference.theory) {
            auto const comparisons =
                compare(made_figure({.quantity = "q", .theory = reference.theory, .value = value}));
            BOOST_REQUIRE_EQUAL(comparisons.size(), reference.x.size());
            for (std::size_t k = 0; k < comparisons.size(); ++k) {
                auto const& c = comparisons[k];
                BOOST_TEST(c.curve == "a");
                BOOST_TEST(c.x == reference.x[k]);
                BOOST_TEST(c.estimate.value == 10.0 * c.x);
                BOOST_TEST(c.theory == reference.value[k]);
                BOOST_TEST(c.theory_error == reference.error[k], tolerance(1e-15));
            }
        }
    // a closed form at the parameters of the point's scene: n = 3, m = 2, d = 3
    auto const comparisons = compare(made_figure({.quantity = "q", .theory = "ng-phi"}));
    BOOST_TEST(comparisons.size() == 3u);
    for (auto const& c : comparisons)
        BOOST_TEST(c.theory == 3.0 * c.x * (std::numbers::pi / 3.0) / (3.0 * 2.0), tolerance(1e-12));

    // "previous" is not taken from another curve
    Figure figure = made_figure({});
    figure.curves[0].criteria.clear();
    figure.curves[1].criteria = figure.curves[2].criteria = {{.quantity = "q", .theory = "previous"}};
    BOOST_TEST(compare(figure).size() == 1u);
    BOOST_TEST(compare(figure)[0].x == 3.0);
    BOOST_TEST(compare(figure)[0].theory == 10.0);
}

// q is 10 x, r is x^-2 here: exponents 1 and -2 from the point before, errors from both values'.
BOOST_AUTO_TEST_CASE(exponents_from_the_point_before) {
    for (bool const of_q : {true, false}) {
        Figure figure = made_figure(
            {.quantity = of_q ? "exponent:q" : "exponent:r", .theory = "value", .value = of_q ? 1.0 : -2.0});
        for (auto& point : figure.points)
            point.quantities[1].estimate = {.value = std::pow(point.x, -2),
                                            .error = 0.05 * std::pow(point.x, -1),
                                            .blocks = point.x > 2.5 ? 4u : 9u};
        figure.curves[1].criteria = figure.curves[2].criteria = figure.curves[0].criteria;
        auto const comparisons = compare(figure);
        // a at 2 and 3, b at 3; c has one point only, and no curve begins with the last one's end
        BOOST_REQUIRE_EQUAL(comparisons.size(), 3u);
        for (std::size_t k = 0; k < 3; ++k) {
            auto const& c = comparisons[k];
            double const before = k == 1 ? 2.0 : 1.0, x = k == 0 ? 2.0 : 3.0;
            BOOST_TEST(c.curve == (k == 2 ? "b" : "a"));
            BOOST_TEST(c.x == x);
            BOOST_TEST(c.estimate.value == (of_q ? 1.0 : -2.0), tolerance(1e-13));
            double const relative = of_q ? std::hypot(0.01, 0.01) : std::hypot(0.05 * x, 0.05 * before);
            BOOST_TEST(c.estimate.error == relative / std::log(x / before), tolerance(1e-13));
            BOOST_TEST(c.estimate.blocks == (!of_q && x == 3.0 ? 4u : 9u));
            BOOST_TEST(c.theory == (of_q ? 1.0 : -2.0));
            BOOST_TEST(c.criterion.quantity == (of_q ? "exponent:q" : "exponent:r"));
        }
    }
    // points in falling order have the same slope and a positive error
    Figure figure = made_figure({.quantity = "exponent:q", .theory = "quantity:r"});
    std::swap(figure.points[0], figure.points[2]);
    auto const falling = compare(figure);
    BOOST_REQUIRE_EQUAL(falling.size(), 2u);
    BOOST_TEST(falling[1].estimate.value == 1.0, tolerance(1e-13));
    BOOST_TEST(falling[1].estimate.error == std::hypot(0.01, 0.01) / std::log(2.0), tolerance(1e-13));
    BOOST_TEST(falling[1].theory == 1.0);
    BOOST_TEST(falling[1].theory_error == 0.5);
    // as tall as theory's: a closed form
    for (auto const& c : compare(made_figure({.quantity = "exponent:q", .theory = "ng-phi"})))
        BOOST_TEST(c.theory == 3.0 * c.x * (std::numbers::pi / 3.0) / (3.0 * 2.0), tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(what_is_not_measured_cannot_be_compared) {
    BOOST_TEST(complaint_of_comparing("exponent:s", "value") ==
               "figure made, curve a: its scene does not measure exponent:s");
    BOOST_TEST(complaint_of_comparing("s", "value") == "figure made, curve a: its scene does not measure s");
    BOOST_TEST(complaint_of_comparing("q", "quantity:s") == "figure made, curve a: no quantity:s at 1");
    BOOST_TEST(complaint_of_comparing("q", "curve:b") == "figure made, curve a: curve:b has no q at 2");
    BOOST_TEST(complaint_of_comparing("q", "curve:d") == "figure made, curve a: curve:d has no q at 1");
}

BOOST_AUTO_TEST_CASE(truth_table_of_relations) {
    using enum Verdict;
    // the theory is 1, the interval reaches 2.58 (at 1 %) errors to both sides
    struct Row {
        Relation relation;
        double tolerance, value, error, theory_error;
        Verdict verdict;
    };
    std::vector<Row> const rows{
        {Relation::equal, 0.0, 1.02, 0.009, 0.0, agrees},
        {Relation::equal, 0.0, 1.03, 0.009, 0.0, disagrees},
        {Relation::equal, 0.0, 1.03, 0.009, 0.09, undecided},  // a measured reference has an error, too
        {Relation::at_most, 0.0, 0.5, 0.1, 0.0, agrees},
        {Relation::at_most, 0.0, 0.9, 0.1, 0.0, undecided},
        {Relation::at_most, 0.0, 0.5, 0.1, 0.3, undecided},
        {Relation::at_most, 0.0, 0.99, 0.009, 0.0, agrees},
        {Relation::at_most, 0.0, 1.01, 0.009, 0.0, agrees},
        {Relation::at_most, 0.0, 1.5, 0.1, 0.0, disagrees},
        {Relation::at_most, 0.4, 1.2, 0.05, 0.0, agrees},
        {Relation::at_most, 0.1, 1.5, 0.1, 0.0, disagrees},
        {Relation::at_least, 0.0, 1.5, 0.1, 0.0, agrees},
        {Relation::at_least, 0.0, 1.1, 0.1, 0.0, undecided},
        {Relation::at_least, 0.0, 0.99, 0.009, 0.0, agrees},
        {Relation::at_least, 0.0, 0.5, 0.1, 0.0, disagrees},
        {Relation::differs, 0.0, 1.03, 0.01, 0.0, agrees},
        {Relation::differs, 0.0, 0.97, 0.01, 0.0, agrees},
        {Relation::differs, 0.0, 1.0, 0.001, 0.0, undecided},  // nothing can prove an exact equality
        {Relation::differs, 0.0, 1.03, 0.01, 0.01, undecided},
        {Relation::differs, 0.1, 1.2, 0.03, 0.0, agrees},
        {Relation::differs, 0.1, 1.2, 0.05, 0.0, undecided},
        {Relation::differs, 0.1, 1.05, 0.01, 0.0, disagrees},
    };
    for (auto const& row : rows) {
        Comparison c;
        c.criterion.relation = row.relation;
        c.criterion.tolerance = row.tolerance;
        c.estimate = {.value = row.value, .error = row.error, .blocks = 100'000};
        c.theory = 1.0;
        c.theory_error = row.theory_error;
        c.seconds = 8.0;
        BOOST_TEST_CONTEXT("relation " << int(row.relation) << ", tolerance " << row.tolerance << ": "
                                       << row.value << " +- " << row.error) {
            BOOST_TEST(name_of(judge(c, 1)) == name_of(row.verdict));
            if (row.verdict != undecided) BOOST_TEST(seconds_to_decide(c, 1) == 0.0);
            if (row.verdict == undecided && row.relation != Relation::differs)
                BOOST_TEST(seconds_to_decide(c, 1) > 0.0);
        }
    }
    // four times the time halves the error: then 0.13 is 2.6 errors
    Comparison c;
    c.criterion.relation = Relation::at_least;
    c.estimate = {.value = 1.13, .error = 0.1, .blocks = 100'000};
    c.theory = 1.0;
    c.seconds = 8.0;
    BOOST_TEST(seconds_to_decide(c, 1) == 8.0 * (std::pow(2.5758 / 1.3, 2) - 1.0), tolerance(1e-3));
}

// --- running ---------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(points_share_runs_and_join_curves) {
    std::string const at_rest =
        "[curve.set]\n'sample.mean_square_displacement.longest' = 0.6\n"
        "'sample.velocity_autocorrelation.longest' = 1.0\n";
    std::string const sheared =
        "[curve.set]\n'sample.observables' = ['kinetic_temperature', 'stress']\n'box.shear_rate' = 0.5\n";
    std::string const vary = "vary = 'shardlow.friction'\nvalues = ";
    std::vector<Figure> pair{
        load(with_curves("[[curve]]\nname = 'shear'\njoin = 'rest'\n" + vary + "[1, 2, 5]\n" + sheared +
                         "[[curve]]\nname = 'rest'\n" + vary + "[1, 2]\n" + at_rest +
                         "[[curve]]\nname = 'one'\n" + vary + "[1]\n" + sheared +
                         "[[curve]]\nname = 'bins'\nrecord = 'velocity_autocorrelation'\njoin = 'one'\n"
                         "from = 0.15\nto = 0.65\nevery = 2\n" +
                         at_rest + "'shardlow.friction' = 2\n" +
                         "[[curve]]\nname = 'all bins'\nrecord = 'velocity_autocorrelation'\n" + at_rest +
                         "'shardlow.friction' = 2\n")),
        load(with_curves("[[curve]]\nname = 'again'\n" + vary + "[1]\n" + at_rest))};
    auto const cache = directory / "cache";
    std::vector<Figure const*> finished;
    auto const run_time = run_points(pair, {.cache = cache, .output = directory, .jobs = 2},
                                     [&](Figure const& figure) { finished.push_back(&figure); });
    BOOST_REQUIRE(run_time.has_value());
    std::sort(finished.begin(), finished.end());
    BOOST_TEST((finished == std::vector<Figure const*>{&pair[0], &pair[1]}));
    BOOST_TEST(run_time->runs == 2u * 5u);
    BOOST_TEST(run_time->seconds <
               pair[0].seconds + pair[1].seconds);  // a run that figures share counts once
    auto const count = [&] {
        return std::distance(std::filesystem::directory_iterator(cache),
                             std::filesystem::directory_iterator());
    };
    BOOST_TEST(count() == 2 * 5);  // two seeds; three frictions in shear, two at rest

    auto const& points = pair[0].points;
    auto const on = [&](std::string const& name) {
        std::vector<Point> found;
        for (auto const& point : points)
            if (pair[0].curves[point.curve].name == name) found.push_back(point);
        return found;
    };
    auto const value = [](Point const& point, std::string const& name) {
        return estimate_of(point.quantities, name).value;
    };
    auto const shear = on("shear"), rest = on("rest"), bins = on("bins"), all = on("all bins");
    BOOST_TEST(shear.size() == 3u);
    BOOST_TEST(rest.size() == 2u);
    // joined at the same x; what a point has measured itself it keeps
    for (std::size_t p : {0, 1}) {
        for (char const* name : {"diffusion_constant", "green_kubo_diffusion_constant"})
            BOOST_TEST(value(shear[p], name) == value(rest[p], name));
        BOOST_TEST(value(shear[p], "schmidt_number") ==
                       value(shear[p], "viscosity") / (2.0 * value(rest[p], "diffusion_constant")),
                   tolerance(1e-14));
        BOOST_TEST(value(shear[p], "kinetic_temperature") != value(rest[p], "kinetic_temperature"));
        BOOST_TEST(std::count_if(shear[p].quantities.begin(), shear[p].quantities.end(),
                                 [](auto const& q) { return q.name == "kinetic_temperature"; }) == 1);
        for (char const* name : {"viscosity", "schmidt_number", "exponential_decay"})
            BOOST_TEST((find_quantity(rest[p].quantities, name) == nullptr));
        BOOST_TEST(shear[p].seconds > rest[p].seconds);
    }
    BOOST_TEST(value(rest[0], "diffusion_constant") != value(rest[1], "diffusion_constant"));
    BOOST_TEST((find_quantity(shear[2].quantities, "diffusion_constant") == nullptr));
    BOOST_TEST(value(pair[1].points[0], "diffusion_constant") == value(rest[0], "diffusion_constant"));

    // bins of the record, with the quantities of the only point of the curve they join
    std::vector<Record> records;
    for (Scene const& scene_of_seed : rest[1].runs) records.push_back(run(scene_of_seed).record);
    auto const curve = curve_of(rest[1].runs[0], records, "velocity_autocorrelation");
    BOOST_TEST(curve.x.size() == 11u);
    BOOST_REQUIRE_EQUAL(all.size(), 11u);
    BOOST_REQUIRE_EQUAL(bins.size(), 3u);
    for (std::size_t bin = 0; bin < 11; ++bin) {
        BOOST_TEST(all[bin].x == curve.x[bin]);
        BOOST_TEST(value(all[bin], "velocity_autocorrelation") == curve.y[bin].value);
        BOOST_TEST(estimate_of(all[bin].quantities, "velocity_autocorrelation").error == curve.y[bin].error);
        BOOST_TEST(estimate_of(all[bin].quantities, "velocity_autocorrelation").blocks > 2u);
        BOOST_TEST((find_quantity(all[bin].quantities, "hydrodynamic_tail") == nullptr));
    }
    for (std::size_t k = 0; k < 3; ++k) {
        std::size_t const bin = 2 * (k + 1);
        double const t = 0.1 * double(bin), D = value(rest[1], "green_kubo_diffusion_constant");
        BOOST_TEST(bins[k].x == curve.x[bin]);
        BOOST_TEST(value(bins[k], "velocity_autocorrelation") == curve.y[bin].value);
        BOOST_TEST(value(bins[k], "exponential_decay") == std::exp(-t / D), tolerance(1e-12));
        BOOST_TEST(value(bins[k], "viscosity") == value(shear[0], "viscosity"));
        theory::Gas const gas{.d = 2, .n = 2.0};
        BOOST_TEST(value(bins[k], "hydrodynamic_tail") == theory::velocity_autocorrelation_tail_in_box(
                                                              gas, value(shear[0], "viscosity"), D, 4.0, t),
                   tolerance(1e-12));
    }
    BOOST_TEST(all[0].seconds * 11.0 == rest[1].seconds, tolerance(1e-12));

    // the figure's time counts each run once
    BOOST_TEST(pair[0].seconds == shear[0].seconds + shear[1].seconds + shear[2].seconds, tolerance(1e-12));

    // again: from the cache, the same
    auto const first = on("shear")[0];
    std::vector<Figure> again{load(with_curves("[[curve]]\nname = 'shear'\n" + vary + "[1]\n" + sheared))};
    run_points(again, {.cache = cache, .output = directory});
    BOOST_TEST(count() == 2 * 5);
    BOOST_TEST(value(again[0].points[0], "viscosity") == value(first, "viscosity"));
    BOOST_TEST(again[0].points[0].seconds + rest[0].seconds == first.seconds, tolerance(1e-12));
}

BOOST_AUTO_TEST_CASE(common_noise_is_subtracted) {
    auto const curve = [](std::string const& name, double rate, std::string const& more) {
        return fmt::format(
            "[[curve]]\nname = '{}'\n{}vary = 'shardlow.friction'\nvalues = [1, 5]\n[curve.set]\n"
            "'stages' = ['shardlow', 'sample', 'drift', 'scatter']\n'box.length' = [3.0, 200.0]\n"
            "'time.duration' = 51.2\n'time.equilibration' = 10.0\n'sample.observables' = "
            "['kinetic_temperature', 'friction_stress']\n"
            "'box.shear_rate' = {:.1f}\n",
            name, more, rate);
    };
    std::string const quiet = "common_noise = true\n";
    std::string const still = curve("still", 0.0, "");
    std::vector<Figure> figures{
        load(with_curves(curve("plain", 0.5, "") + curve("quiet", 0.5, quiet) + still))};
    run_points(figures, {.cache = directory / "cache", .output = directory});
    auto const& points = figures[0].points;
    for (std::size_t p : {0u, 1u}) {
        auto const& [plain, less, rest] = std::tie(points[p], points[p + 2], points[p + 4]);
        double mean = 0.0;
        std::size_t count = 0;
        for (std::size_t r = 0; r < plain.runs.size(); ++r) {
            auto const sheared = run(plain.runs[r]).record.series, noise = run(rest.runs[r]).record.series;
            for (std::size_t k = 0; k < sheared.at("kinetic_stress").size(); ++k, ++count)
                mean += (sheared.at("kinetic_stress")[k] - noise.at("kinetic_stress")[k]) / 0.5;
        }
        BOOST_TEST(count == 2u * 256u);
        for (std::size_t r = 0; r < rest.runs.size(); ++r)
            BOOST_TEST(less.at_rest.at(r).key() == rest.runs[r].key());
        BOOST_TEST(plain.at_rest.empty());
        BOOST_TEST(estimate_of(less.quantities, "kinetic_viscosity").value == mean / double(count),
                   tolerance(1e-12));
        for (char const* name : {"kinetic_viscosity", "collision_viscosity"}) {
            Estimate const with = estimate_of(plain.quantities, name),
                           without = estimate_of(less.quantities, name);
            BOOST_TEST(without.error < 0.5 * with.error);
            BOOST_TEST(std::abs(without.value - with.value) < 5.0 * with.error);
        }
        BOOST_TEST(less.seconds == plain.seconds + rest.seconds, tolerance(1e-12));
        BOOST_TEST(estimate_of(less.quantities, "kinetic_temperature").value ==
                   estimate_of(plain.quantities, "kinetic_temperature").value);
    }
    // a run without shear has no noise to lose, and one until errors are small ends when it likes
    std::string const refused = file + ": curve quiet: common_noise is of runs in shear; allowed: ";
    for (std::string const& definition :
         {curve("quiet", 0.0, quiet), curve("quiet", 0.5, quiet) + "'time.until.viscosity' = 0.1\n"})
        BOOST_TEST(complaint(with_curves(definition)).starts_with(refused));
}

BOOST_AUTO_TEST_CASE(points_take_slopes_from_two_densities_and_keep_configurations) {
    auto const curve = [](std::string const& name, double density, std::string const& more,
                          std::string const& values = "[5, 10]", std::string const& observable = "pressure") {
        return fmt::format(
            "[[curve]]\nname = '{}'\nvary = 'verlet.soft.strength'\nvalues = {}\n{}\n[curve.set]\n"
            "'stages' = ['shardlow', 'sample', 'verlet']\n'particles.density' = {}\n"
            "'sample.observables' = ['{}']\n'sample.configuration' = {}\n'particles.mass' = 2\n",
            name, values, more, density, observable, name == "mid" ? "true" : "false");
    };
    std::vector<Figure> figures{load(
        with_curves(curve("mid", 2.0, "slope_between = ['low', 'high']") + curve("low", 1.5, "") +
                    curve("high", 2.5, "") + curve("lonely", 2.0, "slope_between = ['low', 'high']", "[7]") +
                    curve("warm", 2.5, "", "[5]", "kinetic_temperature") +
                    curve("deaf", 2.0, "slope_between = ['low', 'warm']")))};
    run_points(figures, {.cache = directory / "cache", .output = directory});
    auto const& points = figures[0].points;
    BOOST_REQUIRE_EQUAL(points.size(), 10u);
    for (std::size_t p : {0u, 1u}) {
        auto const& [mid, low, high] = std::tie(points[p], points[p + 2], points[p + 4]);
        Estimate const below = estimate_of(low.quantities, "pressure"),
                       above = estimate_of(high.quantities, "pressure");
        BOOST_TEST(above.value > below.value + 1.0);
        // 24 and 40 particles in 4 x 4; kT is 1, the mass 2
        double const slope = above.value - below.value, error = std::hypot(above.error, below.error);
        check_estimate(mid.quantities, "pressure_slope", slope, error, 1e-9);
        check_estimate(mid.quantities, "inverse_compressibility", slope, error, 1e-9);
        BOOST_TEST(estimate_of(mid.quantities, "speed_of_sound").value == std::sqrt(0.5 * slope),
                   tolerance(1e-12));
        BOOST_TEST((find_quantity(mid.quantities, "inverse_compressibility_per_atom") == nullptr));
        for (Point const* const other : {&low, &high})
            BOOST_TEST((find_quantity(other->quantities, "pressure_slope") == nullptr));
        BOOST_TEST(estimate_of(mid.quantities, "pressure").value != below.value);
        BOOST_TEST(mid.seconds > low.seconds + high.seconds);
        // positions of the first run, where they are kept
        BOOST_REQUIRE_EQUAL(mid.configuration.rows(), 32);
        BOOST_REQUIRE_EQUAL(mid.configuration.cols(), 2);
        BOOST_TEST((mid.configuration == run(mid.runs[0]).record.configuration).all());
        BOOST_TEST(!(mid.configuration == run(mid.runs[1]).record.configuration).all());
        BOOST_TEST(low.configuration.size() == 0);
    }
    // no partner at 7, and a partner without a pressure
    for (std::size_t p : {6u, 8u, 9u})
        BOOST_TEST((find_quantity(points[p].quantities, "pressure_slope") == nullptr));
}

// --- convergence -----------------------------------------------------------------------------------------

namespace {

/// Finished runs with made-up records, found by their scenes' keys.
struct MadeRuns {
    template <class F>
    MadeRuns(Figure const& figure, double seconds, F&& record) {
        for (auto const& point : figure.points)
            for (std::size_t r = 0; r < point.runs.size(); ++r) {
                auto& run = runs[point.runs[r].key()];
                run.record = record(point, r);
                run.seconds = seconds;
                run.duration = double(figure.points.front().runs.front().production_steps) *
                               figure.points.front().runs.front().time_step;
            }
        for (auto const& [key, run] : runs) results[key] = &run;
    }
    std::map<std::string, RunResult> runs;
    Results results;
};

/// Eight points of one curve, two runs each, whose temperature is held against 2.
std::string const eight_points = with_curves(
    "[[curve]]\nname = 'gas'\nvary = 'shardlow.friction'\nvalues = [1, 2, 3, 4, 5, 6, 7, 8]\n"
    "set = {'time.equilibration' = 6.0}\n"
    "[[curve.compare]]\nquantity = 'kinetic_temperature'\ntheory = 'value'\nvalue = 2.0\n"
    "[[curve.compare]]\nquantity = 'kinetic_temperature'\ntheory = 'value'\nvalue = 2.0\n"
    "relation = 'at_most'\n");

constexpr std::size_t samples = 1 << 14;
constexpr double noise = 0.3;

/// White noise about a mean.
Record noisy(double mean, std::mt19937_64& generator) {
    std::normal_distribution<double> normal(mean, noise);
    Record record;
    auto& series = record.series["kinetic_temperature"];
    for (std::size_t k = 0; k < samples; ++k) series.push_back(normal(generator));
    return record;
}

Comparison compared(double value, double error, double theory, std::size_t blocks = 9) {
    Comparison c;
    c.estimate = {.value = value, .error = error, .blocks = blocks};
    c.theory = theory;
    return c;
}

}  // namespace

BOOST_AUTO_TEST_CASE(first_parts_of_records) {
    Record record;
    record.series["s"] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    record.curves["c"] = made(3, 0.0, 1.0, 8, [](double x, Eigen::Index block) { return x + double(block); });
    for (auto const& [fraction, length, blocks] : {std::tuple(1.0, 9u, 8), std::tuple(0.5, 4u, 4),
                                                   std::tuple(0.25, 2u, 2), std::tuple(0.0625, 0u, 0)}) {
        Record const part = first_part(record, fraction);
        auto const &series = part.series.at("s"), &whole = record.series.at("s");
        BOOST_TEST(series.size() == length);
        BOOST_TEST(std::equal(series.begin(), series.end(), whole.begin()));
        Curve const &curve = part.curves.at("c"), &full = record.curves.at("c");
        BOOST_TEST((curve.x == full.x));
        BOOST_TEST((curve.sum.leftCols(blocks) == full.sum.leftCols(blocks)).all());
        BOOST_TEST((curve.weight.leftCols(blocks) == full.weight.leftCols(blocks)).all());
        BOOST_TEST((curve.sum.rightCols(8 - blocks) == 0.0).all());
        BOOST_TEST((curve.weight.rightCols(8 - blocks) == 0.0).all());
        BOOST_TEST(curve.block_means(1).size() == std::size_t(blocks));
    }
}

BOOST_AUTO_TEST_CASE(errors_of_white_noise_fall_as_the_root_of_the_time) {
    Figure const figure = load(eight_points);
    std::mt19937_64 generator(1);
    MadeRuns const made_runs(figure, 8.0, [&](Point const&, std::size_t) { return noisy(2.0, generator); });
    auto const all = converge(figure, made_runs.results);
    BOOST_REQUIRE_EQUAL(all.size(), 1u);  // the bound has no deviation
    auto const& states = all[0].states;
    BOOST_REQUIRE_EQUAL(states.size(), 7u);
    for (std::size_t k = 0; k < 7; ++k) {
        double const fraction = std::pow(2.0, double(k) - 6.0), n = 2.0 * fraction * samples;
        // blocks of at most twice (2 n)^(1/3) samples of a run
        double const blocks = n / (2.0 * std::cbrt(n)), unsure = 1.0 / std::sqrt(2.0 * 8.0 * (blocks - 1.0));
        BOOST_TEST_CONTEXT("fraction " << fraction << ", error known to " << unsure) {
            BOOST_TEST(states[k].points == 8u);
            BOOST_TEST(std::abs(states[k].error / (noise / std::sqrt(n) / 2.0) - 1.0) < 4.0 * unsure);
            // chi-square of 8: beyond 27.9 once in 2000, below 0.7 as rarely
            double const chi_square = 8.0 * std::pow(states[k].deviation / states[k].error, 2);
            BOOST_TEST(chi_square < 27.9);
            BOOST_TEST(chi_square > 0.7);
            // 60 steps of equilibration, 20 of production
            BOOST_TEST(states[k].seconds == 16.0 * 8.0 * (60.0 + fraction * 20.0) / 80.0, tolerance(1e-12));
        }
    }
    BOOST_TEST(!all[0].floor_resolved);
    BOOST_TEST(all[0].floor < 2.0 * states.back().error);
}

BOOST_AUTO_TEST_CASE(a_bias_leaves_a_floor) {
    // by 1 % of the theory, which the errors of the last states resolve and those of the first do not
    double const bias = 0.01;
    Figure const figure = load(eight_points);
    std::mt19937_64 generator(2);
    MadeRuns const made_runs(figure, 8.0, [&](Point const& point, std::size_t) {
        return noisy(2.0 * (1.0 + (point.x > 4.0 ? bias : -bias)), generator);
    });
    auto const all = converge(figure, made_runs.results);
    auto const& states = all.at(0).states;
    BOOST_REQUIRE_EQUAL(states.size(), 7u);
    BOOST_TEST(states.back().error < 0.1 * bias);
    BOOST_TEST(std::abs(states.back().deviation / bias - 1.0) < 0.1);
    BOOST_TEST(states[5].deviation / states[6].deviation < 1.1);
    BOOST_TEST(all[0].floor_resolved);
    BOOST_TEST(std::abs(all[0].floor - bias) < 4.0 * all[0].floor_error);
    // eight points of an error of 0.3/(2 sqrt(2^15))
    BOOST_TEST(all[0].floor_error == 0.3 / (2.0 * std::sqrt(32768.0)) / std::sqrt(8.0), tolerance(0.1));
}

BOOST_AUTO_TEST_CASE(floors_by_hand) {
    // deviations 3 and 4 %, errors 1 and 2 %, of a theory of 2; what has no error does not count
    auto const both =
        convergence_of({compared(2.06, 0.02, 2.0), compared(1.92, 0.04, 2.0), compared(5.0, NAN, 2.0),
                        compared(5.0, 0.1, 2.0, 1), compared(NAN, 0.1, 2.0)},
                       7.0);
    BOOST_REQUIRE_EQUAL(both.states.size(), 1u);
    BOOST_TEST(both.states[0].points == 2u);
    BOOST_TEST(both.states[0].seconds == 7.0);
    BOOST_TEST(both.states[0].error == 0.01 * std::sqrt(2.5), tolerance(1e-12));
    BOOST_TEST(both.states[0].deviation == 0.01 * std::sqrt(12.5), tolerance(1e-12));
    BOOST_TEST(both.floor == 0.01 * std::sqrt(10.0), tolerance(1e-12));
    // of deviation^2 - error^2: 4 b^2 s^2 + 2 s^4 (1 + 1/8)
    double const variance = 4.0 * (8.0 * 1.0 + 12.0 * 4.0) + 2.25 * (1.0 + 16.0);
    BOOST_TEST(both.floor_error == 0.01 * std::sqrt(variance) / 2.0 / (2.0 * std::sqrt(10.0)),
               tolerance(1e-12));
    BOOST_TEST(both.floor_resolved);  // 10 exceeds sqrt(2.25*17) = 6.2

    // a measured theory has an error, too; a theory of zero gives absolute numbers
    auto measured_theory = compared(1.0, 0.3, 2.0);
    measured_theory.theory_error = 0.4;
    BOOST_TEST(convergence_of({measured_theory}, 1.0).states.at(0).error == 0.25, tolerance(1e-12));
    BOOST_TEST(convergence_of({compared(-0.5, 0.1, 0.0)}, 1.0).states.at(0).deviation == 0.5);
    BOOST_TEST(convergence_of({compared(-0.5, 0.1, -2.0)}, 1.0).states.at(0).error == 0.05);

    // within the error
    auto const none = convergence_of({compared(2.01, 0.02, 2.0)}, 1.0);
    BOOST_TEST(none.floor == 0.0);
    BOOST_TEST(none.floor_error == 0.01 * std::pow(2.25, 0.25), tolerance(1e-12));
    BOOST_TEST(!none.floor_resolved);
    BOOST_TEST(convergence_of({compared(2.0, NAN, 2.0)}, 1.0).states.empty());
}

// 2000 made-up curves of ten points: the floor's error is its scatter, and few are resolved where there is
// none.
BOOST_DATA_TEST_CASE(floors_have_the_error_that_is_said, data::make({0.0, 2.0, 5.0}), bias) {
    std::mt19937_64 generator(3);
    std::normal_distribution<double> normal;
    std::chi_squared_distribution<double> chi_squared(31);
    constexpr int trials = 2000;
    double sum = 0.0, sum_of_squares = 0.0, said = 0.0, resolved = 0.0;
    for (int trial = 0; trial < trials; ++trial) {
        std::vector<Comparison> comparisons;
        for (int p = 0; p < 10; ++p)
            comparisons.push_back(compared(100.0 + bias + normal(generator),
                                           std::sqrt(chi_squared(generator) / 31.0), 100.0, 32));
        auto const result = convergence_of(comparisons, 1.0);
        sum += result.floor;
        sum_of_squares += result.floor * result.floor;
        said += result.floor_error / trials;
        resolved += double(result.floor_resolved) / trials;
    }
    double const mean = sum / trials, scatter = std::sqrt(sum_of_squares / trials - mean * mean);
    BOOST_TEST_MESSAGE("bias " << bias << ": floor " << mean << " +- " << scatter << ", said " << said
                               << ", resolved " << resolved);
    if (bias == 0.0) {
        BOOST_TEST(resolved < 0.06);
        BOOST_TEST(scatter < 1.1 * said);
    } else {
        BOOST_TEST(resolved > 0.95);
        BOOST_TEST(std::abs(mean / (0.01 * bias) - 1.0) < 0.03);
        // the scatter of 2000 is known to 1.6 %
        BOOST_TEST(std::abs(scatter / said - 1.0) < 0.07);
    }
}

BOOST_AUTO_TEST_CASE(curves_converge_from_two_blocks_on) {
    std::string const definition = with_curves(
        "[[curve]]\nname = 'bins'\nrecord = 'velocity_autocorrelation'\n[[curve.compare]]\n"
        "quantity = 'velocity_autocorrelation'\ntheory = 'value'\nvalue = 1.5\n");
    for (std::size_t seeds : {1u, 2u}) {
        auto lines = definition;
        lines.replace(lines.find("seeds = 2"), 9, fmt::format("seeds = {}", seeds));
        Figure const figure = load(lines);
        MadeRuns const made_runs(figure, 8.0, [&](Point const&, std::size_t r) {
            Record record;
            record.curves["velocity_autocorrelation"] = made(5, 0.0, 0.1, 8, [&](double, Eigen::Index block) {
                return 2.0 * (2.0 + 0.1 * double(block) + double(r));
            });
            return record;
        });
        auto const all = converge(figure, made_runs.results);
        auto const& states = all.at(0).states;
        std::size_t const parts = 2 + seeds;  // from 1/4 on, or from 1/8 on
        BOOST_REQUIRE_EQUAL(states.size(), parts);
        for (std::size_t k = 0; k < parts; ++k) {
            double const fraction = std::pow(2.0, double(k + 1) - double(parts));
            // of blocks 0 to 8 f - 1, and of runs that are one apart; two components
            double const value = 2.0 + 0.1 * 0.5 * (8.0 * fraction - 1.0) + 0.5 * double(seeds - 1);
            BOOST_TEST(states[k].points == 5u);
            BOOST_TEST(states[k].deviation == (value - 1.5) / 1.5, tolerance(1e-12));
            BOOST_TEST(states[k].seconds == double(seeds) * 8.0 * fraction, tolerance(1e-12));
        }
    }
}

BOOST_AUTO_TEST_CASE(the_last_state_is_that_of_the_whole_runs) {
    auto const criterion = [&](std::string const& quantity, std::string const& theory) {
        return fmt::format("[[curve.compare]]\nquantity = '{}'\ntheory = '{}'\nvalue = 0.9\n", quantity,
                           theory);
    };
    std::string const correlation = "'sample.velocity_autocorrelation.longest' = 1.0\n";
    std::vector<Figure> figures{load(with_curves(
        "[[curve]]\nname = 'gas'\njoin = 'one'\nvary = 'shardlow.friction'\nvalues = [1, 2, 5]\n" +
        criterion("kinetic_temperature", "value") + criterion("kinetic_temperature", "curve:one") +
        criterion("green_kubo_diffusion_constant", "ng17") +
        "[[curve]]\nname = 'one'\nvary = 'shardlow.friction'\nvalues = [3]\n[curve.set]\n" + correlation +
        "[[curve]]\nname = 'bins'\nrecord = 'velocity_autocorrelation'\njoin = 'gas'\nto = 0.5\n" +
        criterion("velocity_autocorrelation", "quantity:exponential_decay") + "[curve.set]\n" + correlation +
        "'shardlow.friction' = 3\n"))};
    run_points(figures, {.cache = directory / "cache", .output = directory});
    Figure const& figure = figures[0];
    auto const comparisons = compare(figure);
    BOOST_REQUIRE_EQUAL(figure.convergence.size(), 4u);
    for (auto const& convergence : figure.convergence) {
        auto const& curve = figure.curves[convergence.curve];
        BOOST_TEST_CONTEXT(curve.name << ", " << convergence.criterion.quantity << ", "
                                      << convergence.criterion.theory) {
            std::vector<Comparison> of_curve;
            for (auto const& c : comparisons)
                if (c.curve == curve.name && c.criterion.quantity == convergence.criterion.quantity &&
                    c.criterion.theory == convergence.criterion.theory)
                    of_curve.push_back(c);
            auto const expected = convergence_of(of_curve, curve.seconds);
            BOOST_REQUIRE(!convergence.states.empty());
            auto const &last = convergence.states.back(), &whole = expected.states.at(0);
            BOOST_TEST(last.points == of_curve.size());
            BOOST_TEST(last.error == whole.error);
            BOOST_TEST(last.deviation == whole.deviation);
            BOOST_TEST(last.seconds == whole.seconds);
            BOOST_TEST(convergence.floor == expected.floor);
            BOOST_TEST(convergence.floor_error == expected.floor_error);
            for (std::size_t k = 1; k < convergence.states.size(); ++k)
                BOOST_TEST(convergence.states[k - 1].seconds < convergence.states[k].seconds);
        }
    }
    // three runs of the gas with the one that all of them join; the bins of the same run, once
    auto const seconds_of = [&](std::size_t p) {
        double sum = 0.0;
        for (Scene const& run_scene : figure.points[p].runs) {
            RunOptions options;
            options.output = directory / "cache" / (run_scene.key() + ".h5");
            sum += run(run_scene, options).seconds;
        }
        return sum;
    };
    double const one = seconds_of(3);
    BOOST_TEST(figure.curves[0].seconds == seconds_of(0) + seconds_of(1) + seconds_of(2) + one,
               tolerance(1e-12));
    BOOST_TEST(figure.curves[1].seconds == one);
    BOOST_TEST(figure.curves[2].seconds == one);
}

// --- files -----------------------------------------------------------------------------------------------

BOOST_AUTO_TEST_CASE(files_hold_every_comparison_and_every_quantity) {
    std::ofstream(directory / "style.gp").close();
    std::ofstream(directory / "test" / "plot.gp") << "plot 0\n";
    Figure figure = made_figure({.quantity = "q", .theory = "previous", .relation = Relation::differs});
    figure.directory = directory / "test";
    figure.points[2].quantities[0].estimate.error = NAN;  // a single block
    figure.points[1].configuration.resize(2, 3);
    figure.points[1].configuration << 0.5, 1.25, 2.00004, 4.99996, 0.0, 3.0;
    auto const comparisons = compare(figure);
    auto const output = directory / "output";
    if (std::system("command -v gnuplot >/dev/null") == 0)
        write_figure(figure, comparisons, "quick", output);
    else
        BOOST_CHECK_THROW(write_figure(figure, comparisons, "quick", output), InputError);

    std::ifstream stream(output / "data" / "made.dat");
    std::ostringstream content;
    content << stream.rdbuf();
    std::string const text = content.str();
    for (std::string const part :
         {"# a:q:previous\n2 20 0.2 10 1 ", "# all:a:q\n1 10 0.1\n2 20 0.2\n3 30 nan\n\n\n",
          "# all:b:r\n1 1 0.5\n3 3 0.5\n\n\n", "# all:c:q\n5 50 0.5\n\n\n",
          "# configuration:a:2\n# box 5 6 5\n0.5000 1.2500 2.0000 \n5.0000 0.0000 3.0000 \n\n\n"})
        BOOST_TEST(text.find(part) != std::string::npos, part << " is not in\n" << text);

    BOOST_TEST(text.find("# configuration:") == text.rfind("# configuration:"));  // of nobody else

    auto const loaded = load_comparisons(output);
    BOOST_REQUIRE_EQUAL(loaded.size(), comparisons.size());
    for (std::size_t k = 0; k < loaded.size(); ++k) {
        auto const &a = loaded[k], &b = comparisons[k];
        BOOST_TEST(a.figure == b.figure);
        BOOST_TEST(a.curve == b.curve);
        BOOST_TEST(a.parameter == b.parameter);
        BOOST_TEST(a.x == b.x);
        BOOST_TEST(a.criterion.theory == b.criterion.theory);
        BOOST_TEST((a.criterion.relation == Relation::differs));
        BOOST_TEST(a.estimate.value == b.estimate.value);
        BOOST_TEST((a.estimate.error == b.estimate.error || (k == 1 && std::isnan(a.estimate.error))));
        BOOST_TEST(a.theory == b.theory);
        BOOST_TEST(a.theory_error == b.theory_error);
        BOOST_TEST(name_of(judge(a, 3)) == name_of(judge(b, 3)));
    }
}

// Of comparisons made up so that each is of one kind. Nine blocks, alone in the family: critical t = 3.355.
BOOST_AUTO_TEST_CASE(kinds_and_what_they_would_notice) {
    double const t = critical_z(family_false_alarm, 9);
    auto exact = compared(1.01, 0.01, 1.0);
    exact.criterion.theory = "my22";
    BOOST_TEST((kind_of(exact, 1) == Kind::exact));
    BOOST_TEST(noticeable(exact, 1) == 0.01 * t, boost::test_tools::tolerance(1e-12));
    auto form = exact;
    form.criterion.tolerance = 0.05;
    BOOST_TEST((kind_of(form, 1) == Kind::closed_form));
    BOOST_TEST(noticeable(form, 1) == 0.05 + 0.01 * t, boost::test_tools::tolerance(1e-12));
    for (auto const relation : {Relation::at_most, Relation::at_least, Relation::differs}) {
        auto bound = exact;
        bound.criterion.relation = relation;
        BOOST_TEST((kind_of(bound, 1) == Kind::bound));
    }
    for (char const* const theory : {"curve:other", "quantity:other", "previous"}) {
        auto two = exact;
        two.criterion.theory = theory;
        two.theory_error = 0.01;
        BOOST_TEST((kind_of(two, 1) == Kind::consistency));
        BOOST_TEST(noticeable(two, 1) == std::sqrt(2.0) * 0.01 * t, boost::test_tools::tolerance(1e-12));
    }
    auto blunt_one = form;
    blunt_one.criterion.tolerance = 0.25 - 0.01 * t + 1e-6;
    BOOST_TEST((kind_of(blunt_one, 1) == Kind::description));
    blunt_one.criterion.tolerance -= 2e-6;
    BOOST_TEST((kind_of(blunt_one, 1) == Kind::closed_form));
    form.criterion.description = true;  // set after looking
    BOOST_TEST((kind_of(form, 1) == Kind::description));
    BOOST_TEST((kind_of(compared(1.0, 0.0, 1.0, 1), 1) == Kind::description));  // no error bar
    auto zero = compared(0.001, 0.01, 0.0);
    zero.criterion.theory = "value";
    BOOST_TEST((kind_of(zero, 1) == Kind::exact));
    BOOST_TEST(std::isinf(noticeable(zero, 1)));
    BOOST_TEST(verdict_text(Verdict::agrees, Kind::description) == "described");
    BOOST_TEST(verdict_text(Verdict::disagrees, Kind::description) == "disagrees");
    BOOST_TEST(verdict_text(Verdict::agrees, Kind::bound) == "agrees");
}

namespace {

/// The fields of one line of CSV by the rules of RFC 4180.
std::vector<std::string> csv_fields(std::string const& line) {
    std::vector<std::string> fields(1);
    bool quoted_now = false;
    for (std::size_t k = 0; k < line.size(); ++k) {
        if (line[k] == '"' && quoted_now && k + 1 < line.size() && line[k + 1] == '"')
            fields.back() += line[k++];
        else if (line[k] == '"')
            quoted_now = !quoted_now;
        else if (line[k] == ',' && !quoted_now)
            fields.emplace_back();
        else
            fields.back() += line[k];
    }
    BOOST_TEST(!quoted_now);
    return fields;
}

}  // namespace

// `dpdref figure ng1a` judges ng1a alone, and the table on disk keeps all figures.
BOOST_FIXTURE_TEST_CASE(a_run_of_one_figure_keeps_the_table_of_all, Fixture) {
    auto right = compared(1.0, 0.001, 1.0), wrong = compared(2.0, 0.001, 1.0);
    right.figure = "ng1a";
    wrong.figure = "ng1b";
    BOOST_TEST(!report({right, wrong}, directory));
    std::string const whole = read_file(directory / "report.csv");
    BOOST_TEST(report({right, wrong}, directory, {"ng1a"}));
    BOOST_TEST(read_file(directory / "report.csv") == whole);
    BOOST_TEST(!report({right, wrong}, directory, {"ng1b"}));
    BOOST_TEST(read_file(directory / "report.csv") == whole);
}

// Names with commas and quotes come back as they were; a description is not called agreement.
BOOST_FIXTURE_TEST_CASE(the_table_as_csv_can_be_parsed, Fixture) {
    auto one = compared(1.01, 0.01, 1.0);
    one.figure = "ng1a";
    one.curve = "n=3, \"strong\"";
    one.parameter = "time.step";
    one.criterion.quantity = "viscosity";
    one.criterion.theory = "curve:n=3, at rest";
    one.criterion.relation = Relation::at_most;
    auto other = one;
    other.criterion.relation = Relation::equal;
    other.criterion.tolerance = 0.4;
    report({one, other}, directory);
    std::istringstream csv(read_file(directory / "report.csv"));
    std::string line;
    std::getline(csv, line);
    auto const head = csv_fields(line);
    auto const column = [&](std::string const& name) {
        return std::size_t(std::find(head.begin(), head.end(), name) - head.begin());
    };
    for (auto const& [kind, verdict] : {std::pair{"bound", "agrees"}, {"description", "described"}}) {
        BOOST_REQUIRE(std::getline(csv, line));
        auto const row = csv_fields(line);
        BOOST_REQUIRE(row.size() == head.size());
        BOOST_TEST(row[column("curve")] == one.curve);
        BOOST_TEST(row[column("theory")] == one.criterion.theory);
        BOOST_TEST(row[column("kind")] == kind);
        BOOST_TEST(row[column("verdict")] == verdict);
    }
    BOOST_TEST(!std::getline(csv, line));
    std::string const summary = read_file(directory / "report.md");
    BOOST_TEST(summary.find("| bound | 1 | 1 | 0 | 0 | 1 % |") != std::string::npos);
    BOOST_TEST(summary.find("| description | 1 | - | 0 | 0 | 1 % |") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(companions_show_one_criterion_of_a_curve) {
    if (std::system("command -v gnuplot >/dev/null") != 0) return;
    // the nearest style above the script, not the one above that
    auto const deep = directory / "deep" / "deeper" / "test";
    std::filesystem::create_directories(deep);
    std::ofstream(deep / "plot.gp") << "plot 0\n";
    Figure figure = made_figure({.quantity = "q", .theory = "value", .value = 5.0});
    figure.title = "a title";
    figure.directory = deep;
    auto const output = directory / "output";
    auto const complaint_of_writing = [&] {
        try {
            write_figure(figure, compare(figure), "quick", output);
        } catch (InputError const& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    BOOST_TEST(complaint_of_writing() ==
               fmt::format("{}: there is no style.gp above it", (deep / "plot.gp").string()));
    std::ofstream(directory / "style.gp") << "style = 'far'\n";
    std::ofstream(directory / "deep" / "style.gp") << "style = 'near'\n";
    BOOST_TEST(complaint_of_writing() == "");  // nothing converges, nothing is drawn
    auto const data = output / "data" / "made.convergence.dat";
    BOOST_TEST(!std::filesystem::exists(data));

    auto const add = [&](std::size_t curve, char const* quantity, char const* theory, bool known = true) {
        figure.convergence.emplace_back();
        auto& added = figure.convergence.back();
        added.curve = curve;
        added.criterion = {.quantity = quantity, .theory = theory, .value = 5.0};
        if (known)
            added.states = {{.seconds = 1.0, .error = 0.4, .deviation = 0.5, .points = 2},
                            {.seconds = 4.0, .error = 0.2, .deviation = 0.3, .points = 3}};
    };
    add(0, "kinetic_temperature", "value");
    add(1, "first_viscosity", "quantity:other_viscosity", false);
    add(1, "kinetic_temperature", "value");
    add(1, "bulk_viscosity", "quantity:other_viscosity");
    add(1, "shear_viscosity", "value");
    add(2, "viscosity", "value");
    figure.convergence.back().floor = 0.0123;
    figure.convergence.back().floor_error = 0.0021;
    figure.convergence.back().floor_resolved = true;
    BOOST_TEST(complaint_of_writing() == "");  // data without a picture
    BOOST_TEST(std::filesystem::exists(data));
    BOOST_TEST(!std::filesystem::exists(output / "made.convergence.svg"));
    std::ofstream(directory / "deep" / "convergence.gp")
        << "set print data.'.seen'\nprint style.' '.title_text.sprintf(' %g %g %g', least, first, last)\n"
           "do for [n=1:curves] { print part[n].'|'.legend[n] }\n"
           "plot for [n=1:curves] data index part[n] using 1:3\n";
    BOOST_TEST(complaint_of_writing() == "");
    auto const content = [](std::filesystem::path const& path) {
        std::ostringstream text;
        text << std::ifstream(path).rdbuf();
        return text.str();
    };
    for (char const* ending : {"svg", "png"})
        BOOST_TEST(std::filesystem::exists(output / fmt::format("made.convergence.{}", ending)));
    BOOST_TEST(!std::filesystem::exists(output / "made.convergence.gp"));
    // temperatures last
    BOOST_TEST(content(data.string() + ".seen") ==
               "near a title 0.2 1 4\n"
               "b:bulk_viscosity:quantity:other_viscosity|b: bulk viscosity against other viscosity\n"
               "c:viscosity:value|c: viscosity against 5, floor 1.23 ± 0.21 %\n"
               "a:kinetic_temperature:value|a: kinetic temperature against 5\n");
    std::string const text = content(data);
    for (std::string const part :
         {"# a:kinetic_temperature:value\n1 0.4 0.5 2\n4 0.2 0.3 3\n\n\n",
          "# floor:a:kinetic_temperature:value\n4 0 0 0\n\n\n", "# b:shear_viscosity:value\n1 0.4 ",
          "# floor:c:viscosity:value\n4 0.0123 0.0021 1\n\n\n"})
        BOOST_TEST(text.find(part) != std::string::npos, part << " is not in\n" << text);
    BOOST_TEST(text.find("first_viscosity") == std::string::npos);
    // as many as there are colours
    for (std::size_t curve = 3; curve < 9; ++curve) {
        figure.curves.push_back(figure.curves.back());
        figure.curves.back().name = fmt::format("curve {}", curve);
        add(curve, "viscosity", "value");
    }
    BOOST_TEST(complaint_of_writing() == "");
    std::string const seen = content(data.string() + ".seen");
    BOOST_TEST(std::count(seen.begin(), seen.end(), '\n') == 1 + 7);
    BOOST_TEST(seen.find("curve 7") != std::string::npos);
    BOOST_TEST(seen.find("temperature") == std::string::npos);
    BOOST_TEST(content(data).find("# curve 8:viscosity:value") != std::string::npos);
}

BOOST_AUTO_TEST_SUITE_END()

// --- derived quantities ----------------------------------------------------------------------------------

namespace {

theory::Shardlow thermostat_of(Scene const& scene) {
    return {.gamma = scene.stage<Shardlow>()->friction,
            .weight = scene.stage<Shardlow>()->weight,
            .scheme = scene.stage<Shardlow>()->scheme};
}

}  // namespace

// Friction and potential have ranges of their own.
BOOST_DATA_TEST_CASE(integrals_of_g_are_closed_forms_where_g_is_one,
                     data::make({2, 3}) * data::make({"shardlow.weight=linear", "shardlow.weight=quadratic",
                                                      "shardlow.scheme=exponential"}),
                     d, assignment) {
    Scene const fluid =
        scene("'shardlow', 'verlet', 'sample'",
              {fmt::format("dimension={}", d), d == 2 ? "box.length=[5, 6]" : "seed=1", "shardlow.cutoff=1.2",
               "verlet.soft.cutoff=0.9", "shardlow.kT=0.8", assignment});
    Record record;
    record.curves["radial_distribution"] =
        made(40, 0.025, 0.05, 2, [](double, Eigen::Index block) { return scattered(1.0, 0.1, block); });
    auto const quantities = analyze(fluid, {record});
    theory::Gas const gas{.d = d, .n = 3.0, .m = 2.0, .kT = 0.8, .rc = 1.2};
    double const rate = theory::relaxation_rate(gas, thermostat_of(fluid));
    check_estimate(quantities, "dpd_relaxation_rate", rate, 0.1 * rate, 1e-7);
    double const collision = theory::collision_viscosity(gas, thermostat_of(fluid), 0.1);
    check_estimate(quantities, "collision_viscosity_by_g", collision, 0.1 * collision, 1e-7);
    // m n/(2(d+2)) times [|f| r^2]/[|f|], which is 3/10 or 2/5 of the squared range whatever the level of g
    double const per_rate = 6.0 / (2.0 * (d + 2)) * (d == 2 ? 0.3 : 0.4) * 0.81;
    check_estimate(quantities, "potential_viscosity_per_rate", per_rate, 0.0, 1e-7);
    check_estimate(quantities, "pair_density", 1.0, 0.1);
}

BOOST_AUTO_TEST_CASE(integrals_of_g_by_hand) {
    // no pairs below 1/2, by the record or by bins of it; beyond a record g is one
    Scene const gas = scene("'shardlow', 'sample', 'drift'");
    double const rate = 3.0 * 4.5 * (4.0 * std::numbers::pi * 11.0 / 192.0) / (3.0 * 2.0);
    for (std::size_t bins : {10u, 20u, 40u}) {
        Record record;
        record.curves["radial_distribution"] =
            made(bins, 0.025, 0.05, 2, [](double r, Eigen::Index) { return r < 0.5 ? 0.0 : 1.0; });
        check_estimate(analyze(gas, {record}), "dpd_relaxation_rate", rate, 0.0, 1e-7);
    }
    // what the scene does not have is not derived
    Record record;
    record.curves["radial_distribution"] = made(20, 0.05, 0.1, 2, [](double, Eigen::Index) { return 1.0; });
    for (auto const& [stages, has_friction, has_potential] :
         {std::tuple("'shardlow', 'sample', 'drift'", true, false),
          std::tuple("'verlet', 'sample'", false, false),
          std::tuple("'sample', 'shardlow', 'verlet'", true, true)}) {
        auto const quantities = analyze(scene(stages), {record});
        BOOST_TEST((find_quantity(quantities, "dpd_relaxation_rate") != nullptr) == has_friction);
        BOOST_TEST((find_quantity(quantities, "collision_viscosity_by_g") != nullptr) == has_friction);
        BOOST_TEST((find_quantity(quantities, "potential_viscosity_per_rate") != nullptr) == has_potential);
    }
}

// C(t) of eq. 17: a geometric sequence, summed as free flight in steps asks for.
BOOST_DATA_TEST_CASE(moment_and_integral_of_an_exponential, data::make({0.5, 0.9}) * data::make({0.0, 0.3}),
                     rho, shear_rate) {
    Scene const gas = scene("'shardlow', 'sample', 'drift'", {fmt::format("box.shear_rate={}", shear_rate),
                                                              "sample.mean_square_displacement.longest=2"});
    double const components = shear_rate == 0.0 ? 3.0 : 2.0, dt = 0.1, C0 = 0.5;
    Record record;
    record.curves["velocity_autocorrelation"] = made(501, 0.0, dt, 2, [&](double t, Eigen::Index block) {
        return components * scattered(C0 * std::pow(rho, t / dt), 0.01, block);
    });
    record.curves["mean_square_displacement"] = made(21, 0.0, dt, 2, [&](double t, Eigen::Index block) {
        return scattered(2.0 * components * 0.7 * t, 0.02, block);
    });
    // so many origins that neighbouring blocks share nothing
    record.curves["mean_square_displacement"].sum *= 1e20;
    record.curves["mean_square_displacement"].weight *= 1e20;
    auto quantities = analyze(gas, {record});
    double const D = C0 * dt * (1.0 / (1.0 - rho) - 0.5);
    check_estimate(quantities, "green_kubo_diffusion_constant", D, 0.01 * D, 1e-11);
    check_estimate(quantities, "correlation_moment", 4.0 * rho / std::pow(1.0 + rho, 2), 0.0, 1e-11);
    check_estimate(quantities, "diffusion_constant", 0.7, 0.02 * 0.7, 1e-11);

    auto const curve = curve_of(gas, {record, record}, "velocity_autocorrelation");
    BOOST_TEST(curve.x.size() == 501u);
    BOOST_TEST(curve.x[7] == 0.7, tolerance(1e-15));
    BOOST_TEST(curve.y[7].value == C0 * std::pow(rho, 7), tolerance(1e-12));
    BOOST_TEST(curve.y[7].blocks == 4u);
    BOOST_TEST(curve_of(gas, {record}, "radial_distribution").x.empty());

    // the exponential of the same integral; kT/m is 1/2
    derive_at_lag(gas, quantities, 0.4);
    double const decay = 0.5 * std::exp(-0.4 * 0.5 / D);
    check_estimate(quantities, "exponential_decay", decay, decay * 0.01 * (0.4 * 0.5 / D), 0.05);
    BOOST_TEST(estimate_of(quantities, "exponential_decay").value == decay, tolerance(1e-10));
}

BOOST_AUTO_TEST_CASE(temperature_profile_of_a_made_up_flow) {
    double const L = 6.0, kT = 0.9, share = 0.05, m = 2.0;
    auto const flow = [=](double y) { return 0.3 * std::sin(2.0 * std::numbers::pi * y / L); };
    auto const temperature = [=](double y) {
        return kT * (1.0 + share * std::cos(4.0 * std::numbers::pi * y / L) +
                     0.2 * std::cos(2.0 * std::numbers::pi * y / L));
    };
    for (double const rate : {0.0, 0.4}) {
        Scene const fluid = scene("'shardlow', 'sample', 'drift'", {fmt::format("box.shear_rate={}", rate)});
        Record record;
        // as sampled: the mean velocity, and the square of the velocity relative to the imposed flow
        record.curves["velocity_profile"] =
            made(40, 0.075, 0.15, 3, [&](double y, Eigen::Index) { return rate * (y - 0.5 * L) + flow(y); });
        record.curves["velocity_squared_profile"] =
            made(40, 0.075, 0.15, 3, [&](double y, Eigen::Index block) {
                return 3.0 * scattered(temperature(y), 0.03, block) / m + flow(y) * flow(y);
            });
        // the third block never saw a particle in one bin
        for (auto& [name, curve] : record.curves) curve.sum(7, 2) = curve.weight(7, 2) = 0.0;
        auto const quantities = analyze(fluid, {record});
        check_estimate(quantities, "profile_temperature", kT, 0.03 * kT);
        check_estimate(quantities, "temperature_modulation", share, 0.0);
        if (rate != 0.0)
            check_estimate(quantities, "profile_slope",
                           1.0 - 0.3 / rate * std::pow(std::numbers::pi, -1) * 6.0 / L, 0.0, 2e-3);
        auto const profile = curve_of(fluid, {record}, "temperature_profile");
        BOOST_REQUIRE_EQUAL(profile.x.size(), 40u);
        for (std::size_t bin = 0; bin < 40; ++bin) {
            double const y = 0.075 + 0.15 * double(bin);
            BOOST_TEST(profile.x[bin] == y, tolerance(1e-14));
            BOOST_TEST(profile.y[bin].blocks == (bin == 7 ? 2u : 3u));
            BOOST_TEST(profile.y[bin].value == temperature(y) * (bin == 7 ? 1.0 : 1.01), tolerance(1e-12));
        }
        // a record without squares has no temperature
        record.curves.erase("velocity_squared_profile");
        BOOST_TEST((find_quantity(analyze(fluid, {record}), "profile_temperature") == nullptr));
        BOOST_TEST(curve_of(fluid, {record}, "temperature_profile").x.empty());
    }
}

// The numerator is twice the denominator plus noise; an error of either's mean alone would be much larger.
BOOST_AUTO_TEST_CASE(ratios_of_means_and_their_error) {
    Scene const fluid = scene("'verlet', 'sample'");
    Record record;
    record.series["laplacian"] = {1.0, 2.0, 3.0};
    record.series["force_squared"] = {2.1, 3.8, 6.1};
    check_estimate(analyze(fluid, {record}), "configurational_temperature", 2.0,
                   std::sqrt(0.06 / (3.0 * 2.0)) / 2.0);
    // longer runs count more, unlike in a mean of ratios
    Record other;
    other.series["laplacian"] = {5.0};
    other.series["force_squared"] = {20.0};
    BOOST_TEST(
        estimate_of(analyze(fluid, {record, other}), "configurational_temperature").value == 32.0 / 11.0,
        tolerance(1e-12));
    // an ideal gas has neither
    record.series["laplacian"] = record.series["force_squared"] = {0.0, 0.0};
    BOOST_TEST((find_quantity(analyze(fluid, {record}), "configurational_temperature") == nullptr));
}

BOOST_AUTO_TEST_CASE(viscosities_of_made_up_stresses) {
    double const rate = 0.5;
    Record record;
    record.series["kinetic_stress"] = {1.0, 2.0, 3.0};
    record.series["collision_stress"] = {9.0, 0.0, 0.0};
    for (bool const with_potential : {false, true})
        for (bool const with_friction : {false, true}) {
            record.series.erase("potential_stress");
            record.series.erase("friction_stress");
            if (with_potential) record.series["potential_stress"] = {0.4, 0.9, 1.7};
            if (with_friction) record.series["friction_stress"] = {3.0, 3.3, 2.7};
            double const potential = with_potential ? 1.0 : 0.0,
                         collision_error = with_friction ? std::sqrt(0.18 / 6.0) : 3.0;
            Scene const fluid =
                scene("'shardlow', 'sample', 'drift'", {fmt::format("box.shear_rate={}", rate)});
            auto const quantities = analyze(fluid, {record});
            BOOST_TEST_CONTEXT(with_potential << with_friction) {
                check_estimate(quantities, "kinetic_viscosity", 4.0, std::sqrt(2.0 / 6.0) / rate);
                check_estimate(quantities, "collision_viscosity", 6.0, collision_error / rate);
                BOOST_TEST(estimate_of(quantities, "viscosity").value == 10.0 + potential / rate,
                           tolerance(1e-12));
                BOOST_TEST(estimate_of(quantities, "viscosity_ratio").value == 1.5 + 0.5 * potential,
                           tolerance(1e-12));
                BOOST_TEST((find_quantity(quantities, "potential_viscosity") != nullptr) == with_potential);
                if (with_potential)
                    BOOST_TEST(estimate_of(quantities, "potential_viscosity").value == 2.0, tolerance(1e-12));
            }
            // at rest the stresses themselves
            auto const at_rest = analyze(scene("'shardlow', 'sample', 'drift'"), {record});
            check_estimate(at_rest, "kinetic_stress", 2.0, std::sqrt(2.0 / 6.0));
            check_estimate(at_rest, "collision_stress", 3.0, collision_error);
            BOOST_TEST((find_quantity(at_rest, "viscosity") == nullptr));
            BOOST_TEST((find_quantity(at_rest, "viscosity_ratio") == nullptr));
        }
}

BOOST_AUTO_TEST_CASE(derived_quantities_and_their_errors) {
    Scene const fluid = scene("'shardlow', 'verlet', 'sample'", {"shardlow.kT=0.8"});  // n = 3, m = 2
    std::vector<Quantity> const measured{
        {"viscosity", {.value = 2.0, .error = 0.002, .blocks = 20}},
        {"diffusion_constant", {.value = 0.4, .error = 0.0003, .blocks = 8}},
        {"green_kubo_diffusion_constant", {.value = 0.25, .error = 0.0001, .blocks = 5}},
        {"potential_viscosity", {.value = 0.6, .error = 0.0006, .blocks = 7}},
        {"potential_viscosity_per_rate", {.value = 0.2, .error = 0.0004, .blocks = 9}},
        {"dpd_relaxation_rate", {.value = 1.0, .error = 0.001, .blocks = 30}},
    };
    auto quantities = measured;
    derive(fluid, quantities);
    BOOST_TEST(quantities.size() == measured.size() + 3);
    // relative errors add in squares
    double const within = 2e-3, schmidt = 2.0 / (3.0 * 2.0 * 0.4);
    BOOST_TEST(estimate_of(quantities, "schmidt_number").value == schmidt, tolerance(1e-12));
    check_estimate(quantities, "schmidt_number", schmidt, schmidt * std::hypot(0.001, 0.00075), within);
    BOOST_TEST(estimate_of(quantities, "schmidt_number").blocks == 8u);  // of what is known least
    BOOST_TEST(estimate_of(quantities, "potential_relaxation_rate").value == 3.0, tolerance(1e-12));
    check_estimate(quantities, "potential_relaxation_rate", 3.0, 3.0 * std::hypot(0.001, 0.002), within);
    // eq. 14: n kT/(2 (3 + 1))
    double const phi_error = std::hypot(3.0 * std::hypot(0.001, 0.002), 0.001);
    BOOST_TEST(estimate_of(quantities, "kinetic_viscosity_by_rates").value == 0.3, tolerance(1e-12));
    check_estimate(quantities, "kinetic_viscosity_by_rates", 0.3, 0.3 * phi_error / 4.0, 2.0 * within);
    BOOST_TEST(estimate_of(quantities, "kinetic_viscosity_by_rates").blocks == 7u);

    // the tail: in a cube, after a time, where both transport coefficients are known
    Scene const cube = scene("'shardlow', 'verlet', 'sample'", {"shardlow.kT=0.8", "box.length=[5, 5, 5]"});
    auto at_lag = measured;
    derive_at_lag(cube, at_lag, 3.0);
    theory::Gas const gas{.d = 3, .n = 3.0, .m = 2.0, .kT = 0.8};
    auto const tail = [&](double eta, double D) {
        return theory::velocity_autocorrelation_tail_in_box(gas, eta, D, 5.0, 3.0);
    };
    BOOST_TEST(estimate_of(at_lag, "hydrodynamic_tail").value == tail(2.0, 0.25), tolerance(1e-12));
    check_estimate(at_lag, "hydrodynamic_tail", tail(2.0, 0.25),
                   std::hypot((tail(2.002, 0.25) - tail(1.998, 0.25)) / 2.0,
                              (tail(2.0, 0.2501) - tail(2.0, 0.2499)) / 2.0),
                   within);
    BOOST_TEST(estimate_of(at_lag, "exponential_decay").value == 0.4 * std::exp(-3.0 * 0.4 / 0.25),
               tolerance(1e-12));
    for (auto const& [box, t, known] :
         {std::tuple(&fluid, 3.0, 6u), std::tuple(&cube, 0.0, 6u), std::tuple(&cube, 3.0, 0u)}) {
        std::vector<Quantity> some(measured.begin(), measured.begin() + known);
        derive_at_lag(*box, some, t);
        BOOST_TEST(some.size() == known + (known > 0 ? 1u : 0u));
        BOOST_TEST((find_quantity(some, "hydrodynamic_tail") == nullptr));
    }
    // nothing comes from nothing
    std::vector<Quantity> none;
    derive(fluid, none);
    BOOST_TEST(none.empty());
}
