#include "measure_answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "answers.hpp"
#include "errors.hpp"
#include "names.hpp"
#include "progress.hpp"
#include "query.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

// Of an unstable fluid: kT over what it is set to.
constexpr double hottest = 10.0;

// What a query asks for, as far as it has to be said; what differs between the state points of one id.
FluidToMeasure fluid_of(Json const& states, std::vector<std::string> const& words, Code const* code) {
    Assignments asked;
    FluidToMeasure fluid;
    if (is_id(words, code)) {
        Json const reduced = parameters_in(state_named(states, words[0])["parameters"], {});
        for (auto const& [key, value] : reduced.items())
            if (!value.is_array() && key != "scheme") asked.emplace_back(key, text_of(value));
        fluid.id = words[0];
    } else {
        asked = read_query(states, words, code).asked;
    }
    auto const number = [&](std::string const& key) {
        auto const text = value_in(asked, key, "");
        if (text.empty())
            throw InputError(fmt::format(
                "answer --measure: {} is missing; allowed: n, a, gamma (or Gamma) and dt, and with them {}",
                key, "weight, exponent, integrator, N, d, shear_rate"));
        return asked_number(key, text);
    };
    auto const refuse = [&](std::string const& key, std::string const& allowed) {
        throw InputError(fmt::format("answer --measure: {}={}: not allowed; allowed: {}", key,
                                     value_in(asked, key, ""), allowed));
    };
    auto const positive_number = [&](std::string const& key) {
        double const value = number(key);
        if (value == 0.0) refuse(key, "a number > 0");
        return value;
    };
    if (!value_in(asked, "scheme", "").empty()) refuse("scheme", "none; it follows from the integrator");
    fluid.rates = !value_in(asked, "Gamma", "").empty();
    if (fluid.rates && !value_in(asked, "gamma", "").empty()) refuse("gamma", "one of gamma, Gamma");
    fluid.integrator = value_in(asked, "integrator", fluid.rates ? "Lowe" : std::string(integrator_of({})));
    fluid.density = positive_number("n");
    fluid.repulsion = number("a");
    fluid.friction = positive_number(fluid.rates ? "Gamma" : "gamma");
    fluid.step = positive_number("dt");
    if (auto const d = value_in(asked, "d", "3"); d == "2" || d == "3")
        fluid.dimension = d == "2" ? 2 : 3;
    else
        refuse("d", "2, 3");
    fluid.weight = value_in(asked, "weight", "");
    if (fluid.weight.empty() && !fluid.rates) fluid.weight = "quadratic";
    if (fluid.rates && !fluid.weight.empty()) refuse("weight", "none with Gamma");
    if (!fluid.weight.empty() && !value_of<Weight::Kind>(fluid.weight))
        refuse("weight", fmt::format("{}", fmt::join(names<Weight::Kind>, ", ")));
    if (fluid.weight == name_of(Weight::power))
        fluid.exponent = positive_number("exponent");
    else if (!value_in(asked, "exponent", "").empty())
        refuse("exponent", "none but with weight=power");
    if (!value_in(asked, "N", "").empty()) {
        double const particles = number("N");
        if (particles != std::floor(particles) || particles < 2.0 || particles > 1e9)
            refuse("N", "an integer, 2 to 10^9");
        fluid.particles = static_cast<std::uint64_t>(particles);
    }
    if (!value_in(asked, "shear_rate", "").empty()) fluid.shear_rate = positive_number("shear_rate");
    return fluid;
}

// The state point whose errors let expect those of the fluid.
std::string like(Json const& states, FluidToMeasure const& fluid) {
    double nearest = INFINITY;
    std::string text;
    for (auto const& state : states) {
        Json const reduced = parameters_in(state["parameters"], {});
        auto const far = [&](char const* key, double value, double floor) {
            return reduced.contains(key)
                       ? std::pow(std::log((floor + value) / (floor + reduced[key].get<double>())), 2)
                       : 1.0;
        };
        double const sum = far("n", fluid.density, 0.0) + far("a", fluid.repulsion, 1.0) +
                           far(fluid.rates ? "Gamma" : "gamma", fluid.friction, 0.0) +
                           far("d", fluid.dimension, 0.0);
        if (sum < nearest) nearest = sum, text = state.dump();
    }
    return text;
}

}  // namespace

std::string measure_answer(std::filesystem::path const& definitions, std::string const& answers,
                           std::vector<std::string> const& words, Code const* code, double within,
                           CampaignOptions const& options) {
    if (words.empty())
        throw InputError("answer --measure: of what? allowed: the id of a state point, or key=value ...");
    Json const json = parse_answers(answers);
    Json const& states = json["states"];
    FluidToMeasure const fluid = fluid_of(states, words, code);
    auto measurement = load_answer(definitions, fluid, within);
    std::set<std::string> keys;
    for (auto const& point : measurement.figure.points)
        for (auto const& scene : point.runs) keys.insert(scene.key());
    auto const begun = [&](std::string const& key) {
        return std::filesystem::exists(options.cache / (key + ".h5"));
    };
    if (!std::ranges::all_of(keys, begun))
        fmt::print(stderr,
                   "dpdref: {} runs, about {} of one core, {} at a time; what is done is kept in {}\n",
                   keys.size(), duration_text(expected_seconds(measurement, like(states, fluid))),
                   options.jobs, options.cache.string());
    std::string const text = *measure(measurement, fmt::format("within {:g} %", 100.0 * within), options);
    Json const measured = Json::parse(text)["states"][0]["quantities"];
    if (double const kT = measured["kinetic_temperature"]["value"]; kT > hottest)
        throw Diverged(fmt::format("kT came out {:.3g} times as high as it is set; try a smaller step", kT));
    for (auto const& [name, share] : errors_wanted_of_answers)
        if (measured.contains(name)) {
            double const error =
                measured[name]["error"].get<double>() / measured[name]["value"].get<double>();
            if (!(error <= share * within))
                warn(fmt::format("{} has an error of {:.2g} %, {:.2g} % was wanted", name, 100.0 * error,
                                 100.0 * share * within));
        }
    return text;
}

}  // namespace dpd
