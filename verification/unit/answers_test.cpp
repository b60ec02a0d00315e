#define BOOST_TEST_MODULE answers
#include "answers.hpp"

#include <unistd.h>

#include <atomic>
#include <boost/test/unit_test.hpp>
#include <chrono>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "answer.hpp"
#include "conventions.hpp"
#include "integrators.hpp"
#include "measure_answer.hpp"
#include "run.hpp"
#include "theory/closed_forms.hpp"
#include "theory_arguments.hpp"

using namespace dpd;
using boost::test_tools::tolerance;
using Json = nlohmann::ordered_json;

namespace {

struct Directory {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("dpdref_answers_" + std::to_string(getpid()));
    Directory() { std::filesystem::create_directories(path / "answers"); }
    ~Directory() { std::filesystem::remove_all(path); }
    void write(std::string const& name, std::string const& text) const { std::ofstream(path / name) << text; }
};

char const* const shared_integrators = R"(
[[integrator]]
name = "S1"
friction = "shardlow.friction"
repulsion = "verlet.soft.strength"
stages = ["shardlow", "verlet", "sample"]
sheared_stages = ["shardlow", "sample", "verlet"]
)";

char const* const own_integrators = R"(
[[integrator]]
name = "GW"
friction = "modified_verlet.gamma"
noise = "modified_verlet.sigma"
repulsion = "modified_verlet.soft.strength"
stages = ["modified_verlet", "sample"]
sheared_stages = ["modified_verlet", "sample"]
)";

char const* const definition = R"(
[scene]
dimension = 3
[scene.box]
length = [4.0, 4.0, 4.0]
[scene.particles]
density = 3.0
[scene.time]
equilibration = 0.4
[at_rest]
duration = 16.0
sample_interval = 0.04
radial_distribution_interval = 0.4
[at_rest.settings]
"sample.observables" = ["kinetic_temperature", "pressure"]
"sample.radial_distribution.range" = 2.0
"sample.radial_distribution.bins" = 10
"sample.mean_square_displacement" = { spacing = 0.2, longest = 0.8, origins = 0.4 }
[interacting.settings]
"sample.observables" = ["kinetic_temperature", "pressure", "potential_energy", "configurational_temperature"]
[sheared]
duration = 8.0
sample_interval = 0.04
shear_rate = 0.5
[sheared.settings]
"sample.observables" = ["kinetic_temperature", "friction_stress"]
[densities]
duration = 8.0
sample_interval = 0.04
change = 0.125
[densities.settings]
"sample.observables" = ["pressure"]
[budget.paper]
seeds = 2
[budget.quick]
seeds = 2
duration_scale = 0.5
[[closed_form]]
quantity = "kinetic_viscosity"
id = "ng8"
stage = "shardlow"
[[closed_form]]
quantity = "speed_of_sound"
id = "pk-sound"
interacting = true
[[state]]
id = "soft"
title = "soft fluid"
integrator = "GW"
step = 0.04
friction = 4.5
repulsion = 25.0
[[state]]
id = "ideal"
title = "ideal gas"
integrator = "S1"
step = 0.02
friction = 3.0
repulsion = 0.0
duration = 12.0
shear_rate = 0.25
set = { "particles.mass" = 2.0, "shardlow.weight" = "quadratic" }
shear_set = { "sample.observables" = ["kinetic_temperature", "stress"] }
)";

Point const& point_of(Figure const& figure, std::string const& name) {
    for (auto const& point : figure.points)
        if (figure.curves[point.curve].name == name) return point;
    throw std::out_of_range(name);
}

std::string text_of(std::filesystem::path const& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// A file of two state points whose numbers are known.
std::string small_file() {
    auto const state = [](char const* id, double dt, char const* weight) {
        return Json{{"id", id},
                    {"title", id},
                    {"parameters",
                     {{"integrator", "S1"},
                      {"stages", {"shardlow"}},
                      {"d", 3},
                      {"n", 3.0},
                      {"gamma", 9.0},
                      {"dt", dt},
                      {"a", 0.0},
                      {"weight", weight},
                      {"kT", 1.0},
                      {"m", 1.0},
                      {"rc", 1.0},
                      {"L", {10.0, 10.0, 10.0}}}},
                    {"quantities",
                     {{"kinetic_viscosity",
                       {{"value", 0.4},
                        {"error", 0.01},
                        {"blocks", 64},
                        {"closed_form", {{"id", "ng8"}, {"value", 0.39}}}}}}},
                    {"scenes", {{"rest", "dimension = 3"}}}};
    };
    return Json{
        {"schema", "dpdref-answers/1"},
        {"states",
         {state("fine", 0.01, "linear"), state("coarse", 0.1, "linear"), state("other", 0.1, "quadratic")}}}
        .dump();
}

bool starts_with(std::string const& text, std::string const& what) { return text.rfind(what, 0) == 0; }

}  // namespace

// What makes an integrator's scene of a fluid, with a repulsion and without.
BOOST_AUTO_TEST_CASE(settings_of_integrators) {
    Directory const directory;
    directory.write("integrators.toml", std::string(shared_integrators) + own_integrators + R"(
[[integrator]]
name = "Euler"
friction = "euler.gamma"
friction_scale = 2.0
noise = "euler.sigma"
repulsion = "force.soft.strength"
stages = ["euler", "force", "drift", "kick", "sample"]
sheared_stages = ["euler", "force", "sample", "drift", "kick"]
[integrator.settings]
"verlet.substeps" = 5
"euler.weight" = "quadratic"
)");
    auto const all = read_integrators(directory.path / "integrators.toml");
    using List = std::vector<std::string>;
    BOOST_TEST(
        scene_settings(all[0], true, 4.5, 25.0) == (List{"stages=['shardlow','sample','verlet']",
                                                         "shardlow.friction=4.5", "verlet.soft.strength=25"}),
        boost::test_tools::per_element());
    BOOST_TEST(scene_settings(all[0], false, 4.5, 0.0) ==
                   (List{"stages=['shardlow','drift','sample']", "shardlow.friction=4.5"}),
               boost::test_tools::per_element());
    // moves the particles itself, with or without a repulsion; sigma = sqrt(2 gamma kT)
    BOOST_TEST(scene_settings(all[1], false, 2.0, 0.0, 4.0) ==
                   (List{"stages=['modified_verlet','sample']", "modified_verlet.gamma=2",
                         "modified_verlet.soft.strength=0", "modified_verlet.sigma=4"}),
               boost::test_tools::per_element());
    BOOST_TEST(scene_settings(all[2], false, 2.0, 0.0) ==
                   (List{"stages=['euler','drift','kick','sample']", "euler.gamma=4", "euler.sigma=2",
                         "euler.weight='quadratic'"}),
               boost::test_tools::per_element());
}

// From the definition to the file: scenes as it says, and quantities as the runs gave them.
BOOST_AUTO_TEST_CASE(a_small_set_of_answers) {
    Directory const directory;
    directory.write("integrators.toml", shared_integrators);
    directory.write("answers/integrators.toml", own_integrators);
    directory.write("answers/answers.toml", definition);
    auto answers = load_answers(directory.path / "answers", "quick");
    BOOST_TEST(answers.states.size() == 2u);
    BOOST_TEST(answers.figure.curves.size() == 5u + 3u);  // an ideal gas needs no other densities
    auto const& rest = point_of(answers.figure, "soft").runs;
    BOOST_TEST(rest.size() == 2u);
    BOOST_TEST(rest[1].seed == 2u);
    BOOST_TEST(rest[0].stage<ModifiedVerlet>()->sigma == 3.0, tolerance(1e-15));
    BOOST_TEST(rest[0].production_steps == 100u);  // half of 16 for two runs, in steps of 0.04
    BOOST_TEST(rest[0].sample.asks("configurational_temperature"));
    BOOST_TEST(rest[0].sample.radial_distribution->interval == 10u);
    BOOST_TEST(point_of(answers.figure, "soft/shear").runs[0].shear_rate == 0.5);
    BOOST_TEST(point_of(answers.figure, "soft/below").runs[0].particles == 168u);
    BOOST_TEST(point_of(answers.figure, "soft/above").runs[0].particles == 216u);
    auto const& ideal = point_of(answers.figure, "ideal/shear").runs[0];
    BOOST_TEST(ideal.stage_names() == (std::vector<std::string>{"shardlow", "sample", "drift"}),
               boost::test_tools::per_element());
    BOOST_TEST(ideal.shear_rate == 0.25);
    BOOST_TEST(!ideal.sample.asks("friction_stress"));
    BOOST_TEST(point_of(answers.figure, "ideal").runs[0].production_steps == 150u);
    BOOST_TEST(!point_of(answers.figure, "ideal").runs[0].sample.asks("configurational_temperature"));

    CampaignOptions const options{
        .cache = directory.path / "cache", .output = directory.path / "out", .jobs = 2};
    measure_answers(answers, "quick", options);
    Json const file = Json::parse(text_of(options.output / "answers.json"));
    BOOST_TEST(file["schema"].get<std::string>() == "dpdref-answers/1");
    Json const& soft = file["states"][0]["quantities"];
    auto const value = [](Json const& quantities, char const* name) {
        return quantities.at(name)["value"].get<double>();
    };
    auto const measured = [&](std::string const& curve, std::string const& name) {
        return find_quantity(point_of(answers.figure, curve).quantities, name)->estimate.value;
    };
    BOOST_TEST(value(soft, "kinetic_temperature") == measured("soft", "kinetic_temperature"));
    BOOST_TEST(value(soft, "sheared_kinetic_temperature") == measured("soft/shear", "kinetic_temperature"));
    BOOST_TEST(value(soft, "sheared_kinetic_temperature") != value(soft, "kinetic_temperature"));
    BOOST_TEST(value(soft, "viscosity") == measured("soft/shear", "viscosity"));
    double const slope = (measured("soft/above", "pressure") - measured("soft/below", "pressure")) / 0.75;
    BOOST_TEST(value(soft, "speed_of_sound") == std::sqrt(slope), tolerance(1e-12));
    BOOST_TEST(soft["speed_of_sound"]["closed_form"]["id"].get<std::string>() == "pk-sound");
    double const D = value(soft, "diffusion_constant"), viscosity = value(soft, "viscosity");
    BOOST_TEST(value(soft, "infinite_diffusion_constant") ==
                   D + theory::diffusion_finite_size_correction(1.0, viscosity + 3.0 * D, 4.0),
               tolerance(1e-12));
    Json const& gas = file["states"][1]["quantities"];
    BOOST_TEST(value(gas, "speed_of_sound") == std::sqrt(0.5 * value(gas, "kinetic_temperature")),
               tolerance(1e-12));
    BOOST_TEST(gas["kinetic_viscosity"]["closed_form"]["value"].get<double>() ==
                   theory_for(point_of(answers.figure, "ideal").runs[0], "ng8"),
               tolerance(1e-12));
    BOOST_TEST(!gas.contains("potential_viscosity"));
    BOOST_TEST(file["states"][1]["parameters"]["a"].get<double>() == 0.0);
    BOOST_TEST(file["states"][0]["curves"]["radial_distribution"]["x"].size() == 10u);
    BOOST_TEST(starts_with(
        text_of(options.output / "answers.csv"),
        "state,quantity,value,error,blocks,closed_form,closed_form_value\nsoft,kinetic_temperature,"));
    BOOST_TEST(text_of(options.output / "answers.md").find("| `ideal` | 4 |") != std::string::npos);
    // friction and step in units of mass 2
    BOOST_TEST(text_of(options.output / "answers.md")
                   .find("| `ideal` | 3 | 3 | 0 | 2.12132 | quadratic | S1 | 0.0141421 |") !=
               std::string::npos);

    // the scene that is printed is the scene that was run
    Scene const again =
        parse_scene(answer_scene(text_of(options.output / "answers.json"), {"soft"}, "shear"), "again");
    BOOST_TEST(again.key() == point_of(answers.figure, "soft/shear").runs[0].key());
}

// The id of the state point that answers.
std::string found(std::string const& file, std::vector<std::string> const& query,
                  Code const* code = nullptr) {
    return Json::parse(answer_json(file, query, code))["id"];
}

// Calls what must be refused, in one line with these words.
template <class Call>
void refuses(Call const& call, std::string const& why) {
    BOOST_CHECK_EXCEPTION(call(), InputError, [&](InputError const& error) {
        BOOST_TEST_INFO(error.what());
        return std::string(error.what()).find(why) != std::string::npos;
    });
}

BOOST_AUTO_TEST_CASE(nearest_state_point) {
    std::string const file = small_file();
    BOOST_TEST(starts_with(answer_text(file, {"coarse"}), "coarse: "));
    // on a scale of ratios 0.04 is nearer to 0.1 than to 0.01
    BOOST_TEST(found(file, {"dt=0.04"}) == "coarse");
    BOOST_TEST(found(file, {"dt=0.03"}) == "fine");
    BOOST_TEST(found(file, {"weight=quadratic", "dt=0.01"}) == "other");
    std::string const text = answer_text(file, {"dt=0.2", "gamma=9"});
    BOOST_TEST(
        starts_with(text, "not what was asked for: dt is 0.1, not 0.2; --measure measures what was\n"));
    BOOST_TEST(
        text.find("ng8 = 0.39 (as asked: " +
                  fmt::format("{:.6g})", theory_value("ng8", {{"n", "3"}, {"gamma", "9"}, {"dt", "0.2"}}))) !=
        std::string::npos);
    BOOST_TEST(answer_scene(file, {"fine"}, "rest") == "title = \"fine\"\ndimension = 3\n");
    Json const other = Json::parse(answer_json(file, {"weight=quadratic", "dt=0.01"}));
    BOOST_TEST(other["parameters"]["weight"].get<std::string>() == "quadratic");
    BOOST_TEST(other["differs"].dump() == R"(["dt is 0.1, not 0.01"])");
    BOOST_TEST(!Json::parse(answer_json(file, {"other"})).contains("differs"));
}

// The list names each state point by all that makes it another one.
BOOST_AUTO_TEST_CASE(the_list_names_fluids_and_integrators) {
    std::string const list = answer_text(small_file(), {});
    BOOST_TEST(starts_with(list, "state point "));
    BOOST_TEST(
        list.find(
            "fine                  3   3      0         9 linear     S1                0.01   fine\n") !=
        std::string::npos);
}

// Where the step is far below all that were measured, the limit of a small one, and no other fluid's.
BOOST_AUTO_TEST_CASE(the_limit_of_a_small_step) {
    Json file = Json::parse(small_file());
    Json limit = file["states"][0];
    limit["id"] = "limit";
    limit["limit"] = true;
    limit["parameters"]["integrator"] = "another";
    limit["parameters"]["dt"] = 0.002;
    file["states"].push_back(limit);
    std::string const text = file.dump();
    std::string const small =
        answer_text(text, {"n=3", "gamma=9", "weight=linear", "dt=0.001", "integrator=S1"});
    BOOST_TEST(small.find("\nlimit: ") != std::string::npos);
    BOOST_TEST(starts_with(
        small, "not what was asked for: integrator is another, not S1, dt is 0.002, not 0.001; the limit"));
    BOOST_TEST(found(text, {"n=3", "gamma=9", "dt=0.006", "integrator=S1"}) == "fine");
    BOOST_TEST(found(text, {"n=3", "gamma=8", "dt=0.001", "integrator=S1"}) == "fine");
    BOOST_TEST(found(text, {"weight=quadratic", "dt=0.001"}) == "other");
    refuses([&] { answer_text(text, {"n=2", "gamma=9", "dt=0.001"}); }, "n is 3, not 2");
}

// A query in the parameters of another code, with units of length 2, mass 8, kT 0.5: its unit of time is 8.
BOOST_AUTO_TEST_CASE(answers_in_the_units_of_another_code) {
    std::string const file = small_file();
    // gamma* = 9 is 9 mass/time = 9, and sigma^2 = 2 gamma kT; dt* = 0.1 is 0.8; n* = 3 is 3/8
    std::vector<std::string> const query{"n=0.375", "T=0.5", "sigma=3", "cutoff=2", "mass=8", "timestep=0.8"};
    std::string const text = answer_text(file, query, &find_code("lammps-dpd-fdt"));
    BOOST_TEST_INFO(text);
    BOOST_TEST(starts_with(text, "other: "));  // the one with the quadratic weight
    BOOST_TEST(text.find("lammps-dpd-fdt: n=0.375 T=0.5 A=0 sigma=3 cutoff=2 mass=8 timestep=0.8\n") !=
               std::string::npos);
    // viscosity: mass/(length time) = 0.5
    BOOST_TEST(text.find("kinetic_viscosity                         0.2 +- 0.005") != std::string::npos);
    BOOST_TEST(text.find("ng8 = 0.195") != std::string::npos);
    Json const json = Json::parse(answer_json(file, query, &find_code("lammps-dpd-fdt")));
    BOOST_TEST(json["quantities"]["kinetic_viscosity"]["value"].get<double>() == 0.2);
    BOOST_TEST(json["parameters"]["L"][0].get<double>() == 20.0);
    // S1 was measured, and pair dpd is moved by velocity-Verlet
    refuses(
        [&] {
            answer_text(file, {"n=3", "T=1", "gamma=9", "timestep=0.1"}, &find_code("lammps-dpd"));
        },
        "in other integrator is S1, not GW 0.5");
    BOOST_CHECK_THROW(answer_text(file, {"weight=linear"}, &find_code("lammps-dpd")), InputError);
}

// Whose kT, mass and cutoff are others has the same fluid where these are 1, and all values in its units.
BOOST_AUTO_TEST_CASE(a_query_may_have_its_own_units) {
    std::string const file = small_file();
    // mass 8, kT 0.5, cutoff 2: the unit of time is 8
    std::string const text = answer_text(file, {"n=0.375", "gamma=9", "dt=0.8", "m=8", "kT=0.5", "rc=2"});
    BOOST_TEST_INFO(text);
    BOOST_TEST(starts_with(text, "coarse: "));
    BOOST_TEST(text.find("in your units, as all values below:") != std::string::npos);
    BOOST_TEST(text.find("L=[20.0,20.0,20.0]") != std::string::npos);
    BOOST_TEST(text.find("kinetic_viscosity                         0.2 +- 0.005") != std::string::npos);
    // of friction, noise and kT two are enough, and three may not contradict each other
    std::string const noise = answer_text(file, {"n=0.375", "gamma=9", "dt=0.8", "m=8", "sigma=3", "rc=2"});
    BOOST_TEST(noise == text);
    BOOST_CHECK_THROW(answer_text(file, {"gamma=9", "sigma=3", "kT=1"}), InputError);
    BOOST_CHECK_THROW(answer_text(file, {"gamma=9", "kT=0"}), InputError);
    // closed forms for what was asked, in its units: 2 gamma* is 18, and the viscosity's unit 0.5
    std::string const other = answer_text(file, {"n=0.375", "gamma=18", "dt=0.8", "m=8", "kT=0.5", "rc=2"});
    BOOST_TEST(starts_with(other, "not what was asked for: gamma is 9, not 18;"));
    double const form = 0.5 * theory_value("ng8", {{"n", "3"}, {"gamma", "18"}, {"dt", "0.1"}});
    BOOST_TEST(other.find(fmt::format("(as asked: {:.6g})", form)) != std::string::npos);
}

// A step or a number of particles that was not measured is no reason for another fluid, and another fluid is
// no answer.
BOOST_AUTO_TEST_CASE(another_fluid_is_no_answer) {
    Json file = Json::parse(small_file());
    for (auto& state : file["states"]) state["parameters"]["N"] = 3000;
    Json dilute = file["states"][0], euler = file["states"][0];
    dilute["id"] = "dilute";
    dilute["parameters"]["n"] = 1.0;
    dilute["parameters"]["dt"] = 0.001;
    dilute["parameters"]["N"] = 100;
    euler["id"] = "euler";
    euler["parameters"]["stages"] = {"euler"};
    euler["parameters"]["integrator"] = "Euler";
    euler["parameters"]["dt"] = 0.001;
    file["states"].push_back(dilute);
    file["states"].push_back(euler);
    std::string const text = file.dump();
    BOOST_TEST(found(text, {"n=3", "gamma=9", "dt=0.001"}) == "fine");
    BOOST_TEST(found(text, {"n=3", "gamma=9", "dt=0.1", "N=100"}) == "coarse");
    BOOST_TEST(found(text, {"n=3", "gamma=9", "dt=0.001", "integrator=Euler"}) == "euler");
    refuses(
        [&] {
            answer_text(text, {"n=1.2", "gamma=9", "dt=0.1"});
        },
        "no state point is that fluid by that integrator: in fine n is 3, not 1.2; allowed: what `dpdref "
        "answer` lists, and "
        "--measure");
    refuses([&] { answer_text(text, {"n=3", "a=1", "gamma=9", "dt=0.1"}); }, "a is 0, not 1");
    refuses([&] { answer_text(text, {"n=3", "Gamma=9", "dt=0.1"}); }, "has no Gamma");
    refuses([&] { answer_text(text, {"n=3", "gamma=9", "dt=0.1", "integrator=Lowe"}); }, "not Lowe");
    refuses([&] { answer_text(text, {"d=2"}); }, "d is 3, not 2");
    // a reference for another code's output has nothing that differs
    refuses(
        [&] {
            answer_file(text, {"n=3", "gamma=9", "dt=0.05"});
        },
        "coarse: is not what was asked for: dt is 0.1");
    Json const alone = Json::parse(answer_file(text, {"n=3", "gamma=9", "dt=0.1", "weight=quadratic"}));
    BOOST_TEST(alone["states"].size() == 1u);
    BOOST_TEST(alone["states"][0]["id"].get<std::string>() == "other");
}

// The peak of g(r): a parabola is found exactly, at its place between the bins, in the units of the query.
BOOST_AUTO_TEST_CASE(the_peak_of_g) {
    Json file = Json::parse(small_file());
    Json& g = file["states"][0]["curves"]["radial_distribution"];
    for (int bin = 0; bin < 100; ++bin) {
        double const r = 0.02 * (bin + 0.5);
        g["x"].push_back(r);
        g["value"].push_back(1.2 - 3.0 * (r - 0.863) * (r - 0.863));
        g["error"].push_back(0.01);
    }
    Json const peak =
        Json::parse(answer_json(file.dump(), {"dt=0.02", "n=0.375", "rc=2"}))["radial_distribution_peak"];
    BOOST_TEST(peak["r"].get<double>() == 2.0 * 0.863, tolerance(1e-9));
    BOOST_TEST(peak["value"].get<double>() == 1.2, tolerance(1e-9));
    // covariance of a parabola through seven independent bins, 0.35 bins from the middle one
    double const t2 = 0.35 * 0.35;
    BOOST_TEST(peak["error"].get<double>() ==
                   0.01 * std::sqrt(1.0 / 3.0 + t2 / 28.0 + t2 * t2 / 84.0 - 2.0 * t2 / 21.0),
               tolerance(1e-9));
    BOOST_TEST(answer_text(file.dump(), {"fine"})
                   .find("radial_distribution_peak                  1.2 +- 0.0057    at r = 0.863") !=
               std::string::npos);
    // a gas has none
    for (auto& value : g["value"]) value = 1.0;
    BOOST_TEST(answer_text(file.dump(), {"fine"}).find("radial_distribution_peak") == std::string::npos);
}

// --- measured for a query

namespace {

// Definitions, a file of answers by which the price is known, and a cache.
struct Measuring : Directory {
    CampaignOptions options{.cache = path / "cache", .output = path / "out", .jobs = 2};
    std::string answers;

    Measuring() {
        write("integrators.toml", shared_integrators);
        std::string gw = own_integrators;
        write("answers/integrators.toml", gw.replace(gw.find("\"GW\""), 4, "\"GW 0.5\""));
        std::string text = definition;
        write("answers/answers.toml", text.replace(text.find("\"GW\""), 4, "\"GW 0.5\""));
        auto all = load_answers(path / "answers", "quick");
        answers = *measure(all, "quick", options);
    }
    std::string measured(std::vector<std::string> const& query, Code const* code = nullptr) const {
        return measure_answer(path / "answers", answers, query, code, 0.05, options);
    }
    // name and time of all files of the cache
    std::map<std::string, std::filesystem::file_time_type> files() const {
        std::map<std::string, std::filesystem::file_time_type> times;
        for (auto const& file : std::filesystem::directory_iterator(options.cache))
            times[file.path().filename().string()] = file.last_write_time();
        return times;
    }
};

double quantity(std::string const& file, char const* name) {
    return Json::parse(file)["states"][0]["quantities"].at(name)["value"].get<double>();
}

// n = 3, a = 20, friction 6 and step 0.05, where cutoff, mass and kT are 1; fifty particles
std::vector<std::string> const small_fluid{"n=3",  "a=20",          "gamma=6",      "dt=0.05",
                                           "N=50", "weight=quadratic", "integrator=S1"};

}  // namespace

// What is measured is what its scenes give when they are run by hand, and it is not run twice.
BOOST_AUTO_TEST_CASE(a_fluid_is_measured_as_by_hand) {
    Measuring const measuring;
    std::string const first = measuring.measured(small_fluid);
    Json const state = Json::parse(first)["states"][0];
    BOOST_TEST(state["parameters"]["N"].get<int>() == 50);
    BOOST_TEST(state["parameters"]["weight"].get<std::string>() == "quadratic");
    BOOST_TEST(state["parameters"]["gamma"].get<double>() == 6.0);
    BOOST_TEST(state["parameters"]["a"].get<double>() == 20.0);
    BOOST_TEST(state["parameters"]["dt"].get<double>() == 0.05);
    for (auto const& [run_name, name] :
         {std::pair{"rest", "kinetic_temperature"}, std::pair{"rest", "diffusion_constant"},
          std::pair{"rest", "pressure"}, std::pair{"shear", "viscosity"}}) {
        Scene scene = parse_scene(state["scenes"][run_name].get<std::string>(), run_name);
        BOOST_TEST(bool(scene.until));
        std::vector<Record> records;
        for (std::uint64_t seed = 1; seed <= 2; ++seed) {
            scene.seed = seed;
            auto const result = run(scene);
            for (auto const& wanted : result.errors) BOOST_TEST(wanted.reached(), wanted.text());
            records.push_back(result.record);
        }
        BOOST_TEST(quantity(first, name) == find_quantity(analyze(scene, records), name)->estimate.value,
                   name);
    }
    for (auto const& [name, share] : errors_wanted_of_answers) {
        Json const& its = state["quantities"][name];
        BOOST_TEST(its["error"].get<double>() < 0.05 * share * its["value"].get<double>(), name);
    }
    BOOST_TEST(starts_with(answer_text(first, small_fluid), "measured: measured for this query\n"));

    auto const files = measuring.files();
    BOOST_TEST(measuring.measured(small_fluid) == first);  // run times, too
    BOOST_TEST((measuring.files() == files));
}

// The same fluid in the units of a code: nothing is run again, and the values are scaled.
BOOST_AUTO_TEST_CASE(a_fluid_is_measured_in_the_units_of_a_code) {
    Measuring const measuring;
    std::string const own = measuring.measured({"n=3", "a=20", "gamma=6", "dt=0.05", "N=50"});
    auto const files = measuring.files();
    // length 2, mass 8, energy 0.5: time 8, pressure 1/16, viscosity 1/2, D 1/2
    Code const& code = find_code("lammps-dpd");
    std::vector<std::string> const query{"n=0.375", "N=50",     "T=0.5",  "A=5",
                                         "gamma=6", "cutoff=2", "mass=8", "timestep=0.4"};
    std::string const theirs = measuring.measured(query, &code);
    BOOST_TEST((measuring.files() == files));
    Json const scaled = Json::parse(answer_json(theirs, query, &code))["quantities"];
    for (auto const& [name, factor] : {std::pair{"kinetic_temperature", 0.5}, std::pair{"pressure", 0.0625},
                                       std::pair{"viscosity", 0.5}, std::pair{"diffusion_constant", 0.5}})
        BOOST_TEST(scaled[name]["value"].get<double>() == factor * quantity(own, name), tolerance(1e-14));
    BOOST_TEST(!scaled.contains("schmidt_number"));
    // and of the state point of that name
    BOOST_TEST(
        starts_with(answer_text(measuring.measured({"soft"}), {"soft"}), "soft: measured for this query\n"));
}

// Interrupted again and again it ends with the same bits.
BOOST_AUTO_TEST_CASE(a_measurement_goes_on_where_it_was_interrupted) {
    Measuring const measuring;
    std::atomic<bool> stop = false;
    CampaignOptions const other{.cache = measuring.path / "other", .output = {}, .jobs = 2, .stop = &stop};
    std::string text;
    int interruptions = 0;
    while (text.empty()) {
        stop = false;
        std::jthread const alarm([&] {
            std::this_thread::sleep_for(std::chrono::milliseconds(20 + 10 * interruptions));
            stop = true;
        });
        try {
            text = measure_answer(measuring.path / "answers", measuring.answers, small_fluid, nullptr, 0.05,
                                  other);
        } catch (Interrupted const&) {
            ++interruptions;
        }
    }
    BOOST_TEST(interruptions > 0);
    auto const quantities = [](std::string const& file) {
        return Json::parse(file)["states"][0]["quantities"].dump();
    };
    BOOST_TEST(quantities(text) == quantities(measuring.measured(small_fluid)));
}

BOOST_AUTO_TEST_CASE(what_cannot_be_measured_is_refused) {
    Measuring const measuring;
    auto const with = [&](std::string const& key, std::string const& value) {
        auto query = small_fluid;
        std::erase_if(query, [&](auto const& word) { return word.starts_with(key + "="); });
        if (!value.empty()) query.push_back(key + "=" + value);
        return [&measuring, query] { measuring.measured(query); };
    };
    refuses(with("a", ""), "a is missing; allowed: n, a, gamma");
    refuses(with("dt", "0"), "dt=0: not allowed; allowed: a number > 0");
    refuses(with("weight", "root3"), "weight=root3: not allowed; allowed: constant, linear");
    refuses(with("integrator", "Verlet"), "integrator=Verlet: cannot be measured; allowed: GW 0.5; S1");
    refuses(with("d", "4"), "d=4: not allowed; allowed: 2, 3");
    refuses(with("N", "1.5"), "N=1.5: not allowed; allowed: an integer");
    refuses(with("N", "9"), "box.length: 1.4422495703074083 is too small");
    refuses(with("Gamma", "1"), "gamma=6: not allowed; allowed: one of gamma, Gamma");
    refuses([&] { measuring.measured({}); }, "of what?");
    refuses([&] { measuring.measured({"gone"}); }, "gone: unknown");
    // an unstable fluid: at once, or when it came out
    BOOST_CHECK_EXCEPTION(with("a", "1e7")(), Diverged, [](auto const& error) {
        return std::string(error.what()).find("diverged at step") == 0;
    });
    BOOST_CHECK_EXCEPTION(with("dt", "0.35")(), Diverged, [](auto const& error) {
        return std::string(error.what()).find("kT came out") == 0;
    });
}

// The committed file: inputs that were once answered with another fluid.
BOOST_AUTO_TEST_CASE(known_inputs_get_their_own_fluid) {
    std::string const file = text_of(DPDREF_ANSWERS);
    auto const answers = [&](std::vector<std::string> const& query, std::string const& id,
                             Code const* code = nullptr) {
        std::string const text = answer_text(file, query, code);
        BOOST_TEST_INFO(text);
        BOOST_TEST(found(file, query, code) == id);
        return text;
    };
    std::string const hot =
        answers({"n=3", "a=100", "gamma=9", "dt=0.01", "kT=4", "integrator=S1"}, "s1-0.02");
    BOOST_TEST(hot.find("pressure                              94.6") != std::string::npos);
    BOOST_TEST(starts_with(hot, "s1-0.02"));
    std::string const cold =
        answers({"n=3", "a=12.5", "gamma=4.5", "dt=0.02", "kT=0.5", "integrator=S1"}, "s1-0.02");
    BOOST_TEST(
        starts_with(cold, "not what was asked for: dt is 0.0282843, not 0.02, gamma is 3.18198, not 4.5;"));
    BOOST_TEST(cold.find("pressure                              11.8") != std::string::npos);
    answers({"n=3", "a=25", "gamma=4.5", "dt=0.001"}, "limit");
    answers({"n=3", "a=25", "gamma=4.5", "dt=0.04", "N=100"}, "gw-0.04");
    answers({"m=2", "kT=0.5", "a=25", "n=3", "gamma=4.5"}, "s1-mass");
    std::string const openmm =
        answers({"temperature=120.27236", "friction=4.5", "mass=1", "A=25", "stepSize=0.04", "n=3"},
                "openmm-0.04", &find_code("openmm"));
    BOOST_TEST(starts_with(openmm, "openmm-0.04"));
}

// In the limit both temperatures are exact, and S1's state points at 0.04 and 0.02 go there as the square of
// the step.
BOOST_AUTO_TEST_CASE(the_committed_limit_is_one) {
    Json const file = Json::parse(text_of(DPDREF_ANSWERS));
    auto const state = [&](std::string const& id) {
        for (auto const& one : file["states"])
            if (one["id"] == id) return one["quantities"];
        throw std::out_of_range(id);
    };
    Json const limit = state("limit"), coarse = state("s1-0.04"), fine = state("s1-0.02");
    auto const value = [](Json const& of, char const* name) { return of[name]["value"].get<double>(); };
    auto const error = [](Json const& of, char const* name) { return of[name]["error"].get<double>(); };
    // eight comparisons at four errors: one false alarm in 2000 such tests
    for (char const* const name : {"kinetic_temperature", "configurational_temperature"})
        BOOST_TEST(std::abs(value(limit, name) - 1.0) < 4.0 * error(limit, name), name);
    for (char const* const name : {"kinetic_temperature", "configurational_temperature", "pressure",
                                   "potential_energy", "diffusion_constant", "viscosity"}) {
        double const extrapolated = (4.0 * value(fine, name) - value(coarse, name)) / 3.0,
                     its_error = std::hypot(4.0 * error(fine, name), error(coarse, name)) / 3.0;
        BOOST_TEST(
            std::abs(value(limit, name) - extrapolated) < 4.0 * std::hypot(its_error, error(limit, name)),
            name);
    }
}

// The tables of the book are those of the committed file.
BOOST_AUTO_TEST_CASE(the_committed_tables_are_of_the_committed_file) {
    BOOST_TEST(answer_tables(text_of(DPDREF_ANSWERS)) == text_of(DPDREF_ANSWER_TABLES));
}

BOOST_AUTO_TEST_CASE(mistakes_are_refused) {
    std::string const file = small_file();
    refuses([&] { answer_text(file, {"gone"}); },
            "answer gone: unknown; allowed: key=value ..., fine, coarse, other");
    refuses([&] { answer_text(file, {"colour=1"}); },
            "colour=1: not allowed; allowed: the id of one state point, or key=value with Gamma, N, a, d");
    refuses([&] { answer_text(file, {"dt=soon"}); }, "dt=soon: not allowed; allowed: a number");
    refuses([&] { answer_text(file, {"weight=root"}); }, "weight is linear, not root");
    refuses([&] { answer_scene(file, {"fine"}, "shear"); }, "has no run shear");
    refuses([&] { answer_text("{", {}); }, "allowed: a file of `dpdref answers`");

    Directory const directory;
    directory.write("integrators.toml", shared_integrators);
    directory.write("answers/integrators.toml", own_integrators);
    auto const check = [&](std::string const& from, std::string const& to, std::string const& why) {
        std::string text = definition;
        text.replace(text.find(from), from.size(), to);
        directory.write("answers/answers.toml", text);
        refuses([&] { load_answers(directory.path / "answers", "quick"); }, why);
    };
    check("integrator = \"GW\"", "integrator = \"GV\"", "integrator: is in no integrators.toml");
    check("id = \"ng8\"", "id = \"ng88\"", "id: is no closed form");
    check("[densities]\n", "[density]\n", "densities.duration: is missing");
    check("repulsion = 25.0", "repulsion = -1", "repulsion: -1 is not allowed");
    check("title = \"soft fluid\"", "title = \"soft fluid\"\ncolour = 1", "colour: unknown key");
}
// The committed answers are as many and as sharp as docs/answers.md says.
BOOST_AUTO_TEST_CASE(the_committed_answers_are_sharp) {
    Json const file = Json::parse(text_of(DPDREF_ANSWERS));
    BOOST_TEST(file["budget"].get<std::string>() == "paper");
    BOOST_TEST(file["states"].size() >= 30u);
    for (auto const& state : file["states"])
        for (auto const& [names, most] : {std::pair{std::vector{"viscosity", "diffusion_constant"}, 0.005},
                                          std::pair{std::vector{"kinetic_temperature", "pressure"}, 0.0005}})
            for (char const* const name : names) {
                // of OpenMM's integrator no step's stress is known, so that it was not sheared
                if (name == std::string("viscosity") && state["id"] == "openmm-0.04") continue;
                Json const& quantity = state["quantities"].at(name);
                BOOST_TEST_CONTEXT(state["id"] << " " << name)
                BOOST_TEST(quantity["error"].get<double>() <= most * quantity["value"].get<double>());
            }
}
