// Work and precision: the fits on made-up data whose answer is known, and a small study from files to
// pictures. Noise has fixed seeds; bounds are 4.5 standard errors (7e-6 each, some 30 comparisons).
#define BOOST_TEST_MODULE work_precision
#include "work_precision.hpp"

#include <unistd.h>

#include <algorithm>
#include <boost/test/data/test_case.hpp>
#include <boost/test/unit_test.hpp>
#include <cmath>
#include <fstream>
#include <random>
#include <sstream>

using namespace dpd;
namespace data = boost::unit_test::data;
using boost::test_tools::tolerance;

namespace {

constexpr double false_alarm_bound = 4.5;
std::vector<double> const steps{0.005, 0.01, 0.02, 0.04, 0.06, 0.1};

std::vector<Deviation> made_up(double c1, double c2, double error, unsigned seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0.0, error);
    std::vector<Deviation> deviations;
    for (double const h : steps)
        deviations.push_back({.step = h, .value = c1 * h + c2 * h * h + normal(random), .error = error});
    return deviations;
}

}  // namespace

BOOST_AUTO_TEST_CASE(limit_of_step_zero_without_noise) {
    std::vector<Estimate> values;
    for (double const h : {0.01, 0.02, 0.03})
        values.push_back({.value = 7.0 - 30.0 * h * h, .error = 0.1, .blocks = 9});
    Limit const limit = limit_of_step_zero({0.01, 0.02, 0.03}, values);
    BOOST_TEST(limit.estimate.value == 7.0, tolerance(1e-13));
    BOOST_TEST(limit.chi_squared < 1e-20);
    BOOST_TEST(limit.degrees_of_freedom == 1u);
    // a straight line through h^2 = 1, 4, 9 (times 1e-4): the variance of its end at zero is sigma^2 sum
    // x^2/(n sum x^2 - (sum x)^2)
    BOOST_TEST(limit.estimate.error == 0.1 * std::sqrt(98.0 / (3 * 98.0 - 196.0)), tolerance(1e-12));
}

// Bins of g(r) near r = 0: a run that found no pair there counts with the error of the others; if no run has
// found one the limit is zero.
BOOST_AUTO_TEST_CASE(limit_of_step_zero_of_empty_bins) {
    auto const limit = [](double error) {
        return limit_of_step_zero({0.01, 0.02, 0.03}, {{.value = 0.0, .error = 0.0, .blocks = 8},
                                                       {.value = error, .error = error, .blocks = 8},
                                                       {.value = 0.0, .error = 0.0, .blocks = 8}});
    };
    BOOST_TEST(limit(0.0).estimate.value == 0.0);
    BOOST_TEST(limit(0.0).estimate.error == 0.0);
    BOOST_TEST(limit(1e-3).estimate.error == 1e-3 * std::sqrt(98.0 / (3 * 98.0 - 196.0)), tolerance(1e-12));
    BOOST_TEST(std::abs(limit(1e-3).estimate.value) < limit(1e-3).estimate.error);
}

// Over many made-up sets the fitted limit scatters as its error says.
BOOST_AUTO_TEST_CASE(error_of_the_limit_is_its_scatter) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> normal;
    constexpr int sets = 2000;
    double squares = 0.0, chi_squared = 0.0;
    for (int set = 0; set < sets; ++set) {
        std::vector<Estimate> values;
        for (double const h : {0.01, 0.02, 0.03})
            values.push_back(
                {.value = 7.0 - 30.0 * h * h + (0.1 + h) * normal(random), .error = 0.1 + h, .blocks = 9});
        Limit const limit = limit_of_step_zero({0.01, 0.02, 0.03}, values);
        squares += std::pow((limit.estimate.value - 7.0) / limit.estimate.error, 2);
        chi_squared += limit.chi_squared;
    }
    // both are chi^2 of one degree of freedom: mean 1, variance 2
    double const error = std::sqrt(2.0 / sets);
    BOOST_TEST(std::abs(squares / sets - 1.0) < false_alarm_bound * error);
    BOOST_TEST(std::abs(chi_squared / sets - 1.0) < false_alarm_bound * error);
}

BOOST_DATA_TEST_CASE(law_and_order_of_made_up_deviations, data::make({1, 2}), order) {
    double const c1 = order == 1 ? 0.3 : 0.0, c2 = order == 2 ? 3.0 : 0.0;
    ErrorLaw const law = fit_error_law(made_up(c1, c2, 1e-5, 1));
    BOOST_TEST(law.coefficients.size() == 3u);
    for (double const h : {0.01, 0.05}) {
        double const exact = c1 * h + c2 * h * h;
        BOOST_TEST(std::abs(law.bias(h) - exact) < 3e-5);
    }
    BOOST_TEST(law.order_points == 4u);
    BOOST_TEST(std::abs(law.order - order) < false_alarm_bound * law.order_error);
    BOOST_TEST(law.order_error < 0.1);
}

// Where nothing is seen the law allows what the noise hides, and there is no order.
BOOST_AUTO_TEST_CASE(law_of_pure_noise) {
    ErrorLaw const law = fit_error_law(made_up(0.0, 0.0, 1e-3, 2));
    BOOST_TEST(law.order_points < 2u);
    for (double const h : {0.02, 0.06, 0.1}) {
        BOOST_TEST(law.bias(h) > 2e-4);
        BOOST_TEST(law.bias(h) < 3e-3);
    }
    BOOST_TEST(fit_error_law({}).bias(0.1) == 0.0);
}

// A deviation that is no longer small takes no part: the law of the small steps stays.
BOOST_AUTO_TEST_CASE(large_deviations_take_no_part) {
    auto deviations = made_up(0.0, 3.0, 1e-5, 4);
    ErrorLaw const before = fit_error_law(deviations);
    deviations.push_back({.step = 0.2, .value = 5.0, .error = 1e-5});
    ErrorLaw const after = fit_error_law(deviations);
    for (double const h : steps) BOOST_TEST(before.bias(h) == after.bias(h));
}

BOOST_AUTO_TEST_CASE(seconds_to_reach_a_target) {
    // 0.01^2 = bias^2 + v/t: t = 0.5/(1e-4 - 0.36e-4), at 2 s per unit of time
    BOOST_TEST(seconds_to_reach(0.01, 0.006, 0.5, 2.0) == 2.0 * 0.5 / 0.64e-4, tolerance(1e-12));
    BOOST_TEST(std::isinf(seconds_to_reach(0.01, 0.01, 0.5, 2.0)));
}

namespace {

struct Directory {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("work_precision_test." + std::to_string(getpid()));
    Directory() { std::filesystem::create_directories(path / "work-precision" / "study"); }
    ~Directory() { std::filesystem::remove_all(path); }
    std::filesystem::path study() const { return path / "work-precision" / "study"; }
    void write(std::string const& name, std::string const& text) const {
        std::ofstream(study() / name) << text;
    }
};

std::string text_of(std::filesystem::path const& file) {
    std::ostringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

char const* const study_text = R"(title = "Test"
integrators = ["S1", "Euler"]
[scene]
dimension = 3
box.length = [3.0, 3.0, 3.0]
particles.density = 3.0
time.equilibration = 1.0
[at_rest]
sample_interval = 0.1
radial_distribution_interval = 0.4
[at_rest.settings]
"sample.observables" = ["kinetic_temperature", "configurational_temperature", "pressure", "potential_energy"]
"sample.radial_distribution.range" = 1.5
"sample.radial_distribution.bins" = 15
"sample.mean_square_displacement" = { spacing = 0.2, longest = 0.4, origins = 0.2 }
[sheared]
sample_interval = 0.1
[sheared.settings]
"box.shear_rate" = 0.5
"sample.observables" = ["friction_stress"]
[budget.paper]
[budget.quick]
duration_scale = 0.5
[[fluid]]
name = "small"
title = "small fluid"
friction = 4.5
repulsion = 25.0
steps = [0.02, 0.04, 0.5]
duration = 16.0
table_step = 0.04
reference = "S1"
reference_steps = [0.02, 0.04]
reference_duration = 32.0
)";

char const* const integrators_text = R"(
[[integrator]]
name = "S1"
friction = "shardlow.friction"
repulsion = "verlet.soft.strength"
stages = ["shardlow", "verlet", "sample"]
sheared_stages = ["shardlow", "sample", "verlet"]
[[integrator]]
name = "Euler"
friction = "euler.gamma"
noise = "euler.sigma"
repulsion = "force.soft.strength"
stages = ["euler", "force", "drift", "kick", "sample"]
sheared_stages = ["euler", "force", "sample", "drift", "kick"]
[integrator.settings]
"particles.mass" = 0.5
)";

}  // namespace

// From files to data: scenes as the file says, a run that diverges is marked and stays so, results and costs
// are taken from the cache.
BOOST_AUTO_TEST_CASE(a_small_study) {
    Directory const directory;
    directory.write("study.toml", study_text);
    directory.write("integrators.toml", integrators_text);
    auto studies = load_studies(directory.study(), "quick");
    BOOST_TEST(studies.size() == 1u);
    BOOST_TEST(studies[0].runs.size() == 2u * (3 + 2 + 3));
    StudyRun const& first = studies[0].runs.front();
    BOOST_TEST(first.scene.stage<Shardlow>()->friction == 4.5);
    BOOST_TEST(first.scene.sample.interval == 5u);
    BOOST_TEST(first.scene.sample.radial_distribution->interval == 20u);
    BOOST_TEST(first.scene.production_steps == 400u);
    BOOST_TEST(studies[0].runs.back().scene.stage<EulerImpulses>()->sigma == 3.0);
    BOOST_TEST(studies[0].runs.back().scene.mass == 0.5);

    CampaignOptions const options{
        .cache = directory.path / "cache", .output = directory.path / "out", .jobs = 2};
    run_studies(studies, options);
    for (auto const& run : studies[0].runs) {
        BOOST_TEST(run.diverged == (run.integrator == "Euler" && run.step == 0.5));
        if (!run.diverged) BOOST_TEST(run.seconds_per_step > 0.0);
    }
    auto again = load_studies(directory.study(), "quick");
    run_studies(again, options);
    for (std::size_t k = 0; k < again[0].runs.size(); ++k) {
        BOOST_TEST(again[0].runs[k].diverged == studies[0].runs[k].diverged);
        BOOST_TEST(again[0].runs[k].seconds_per_step == studies[0].runs[k].seconds_per_step, tolerance(1e-5));
    }
    CampaignOptions part = options;
    part.cache = directory.path / "part";
    part.shard = Shard{.number = 2, .count = 16};
    BOOST_TEST(!run_studies(again, part));
    std::filesystem::directory_iterator const files(part.cache);
    BOOST_TEST(std::count_if(begin(files), end(files),
                             [](auto const& file) { return file.path().extension() == ".h5"; }) == 1);
    // no style and no scripts here: the data are there whole, the pictures are refused
    BOOST_CHECK_THROW(write_study(studies[0], "quick", directory.study(), options.output), InputError);
    std::string const written = text_of(options.output / "data" / "small.dat");
    BOOST_TEST(written.find("# error:S1:pressure:") != std::string::npos);
    BOOST_TEST(written.find("\"Euler\" 0.5 1") != std::string::npos);
    BOOST_TEST(text_of(options.output / "data" / "small.md").find("| viscosity |") != std::string::npos);
}

BOOST_AUTO_TEST_CASE(a_budget_leaves_out_small_steps) {
    Directory const directory;
    std::string text = study_text;
    std::string const budget = "[budget.quick]\n";
    text.insert(text.find(budget) + budget.size(), "smallest_step = 0.04\n");
    directory.write("study.toml", text);
    directory.write("integrators.toml", integrators_text);
    for (auto const& [name, count] : {std::pair{"quick", 2u}, std::pair{"paper", 3u}}) {
        auto const studies = load_studies(directory.study(), name);
        BOOST_TEST(studies.at(0).runs.size() == 2u * (count + 2u + count));
        // those of the reference stay: step zero is extrapolated from them
        BOOST_TEST(std::ranges::any_of(studies[0].runs, [](auto const& run) { return run.step == 0.02; }));
    }
}

BOOST_AUTO_TEST_CASE(mistakes_in_a_study_are_refused) {
    Directory const directory;
    std::string const good = study_text;
    auto const check = [&](std::string const& from, std::string const& to, std::string const& why) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        directory.write("study.toml", text);
        directory.write("integrators.toml", integrators_text);
        BOOST_CHECK_EXCEPTION(load_studies(directory.study(), "quick"), InputError,
                              [&](InputError const& error) {
                                  BOOST_TEST_INFO(error.what());
                                  return std::string(error.what()).find(why) != std::string::npos;
                              });
    };
    check("reference = \"S1\"", "reference = \"S2\"", "S2 is no integrator; allowed: S1, Euler");
    check("friction = 4.5", "friction = -1", "friction: -1 is not allowed");
    check("steps = [0.02", "steps = [0.0", "steps");
    check("table_step = 0.04", "table_step = 0.05", "table_step: is none of the budget's steps");
    check("[budget.quick]\n", "[budget.quick]\nsmallest_step = 0.05\n",
          "table_step: is none of the budget's steps");
    check("[budget.quick]\n", "[budget.quick]\nsmallest_step = -1\n", "smallest_step: -1 is not allowed");
    check("[budget.quick]\n", "[budget.fast]\n", "quick: is missing");
    check("[\"S1\", \"Euler\"]", "[\"S1\", \"S2\"]", "a list of S1, Euler");
    check("[budget.quick]\n", "[budget.other]\n[budget.quick]\n", "budget.other: unknown key");
    check("title = \"Test\"", "title = \"Test\"\ncolour = 1", "colour: unknown key");
}
