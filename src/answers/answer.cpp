#include "answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "conventions.hpp"
#include "errors.hpp"
#include "names.hpp"
#include "theory_arguments.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

Json parse_answers(std::string const& text) {
    try {
        return Json::parse(text);
    } catch (Json::exception const& error) {
        throw InputError(fmt::format("answers: {}; allowed: a file of `dpdref answers`", error.what()));
    }
}

std::string text_of(Json const& value) {
    return value.is_string() ? value.get<std::string>() : fmt::format("{}", value.get<double>());
}

// How far a state point's parameter is from what is asked for; infinitely for a text that differs.
double distance(Json const& parameters, std::string const& key, std::string const& asked) {
    if (!parameters.contains(key)) return INFINITY;
    if (!parameters[key].is_number() || key == "d") return text_of(parameters[key]) == asked ? 0.0 : INFINITY;
    double number = 0.0;
    std::istringstream stream(asked);
    if (!(stream >> number) || !stream.eof())
        throw InputError(fmt::format("answer: {}={}: not allowed; allowed: a number", key, asked));
    double const value = parameters[key];
    return number > 0.0 && value > 0.0 ? std::log(number / value) : number - value;
}

struct Found {
    Json state;
    Assignments asked;
};

Found look_up(std::string const& answers, std::vector<std::string> const& query) {
    Json const json = parse_answers(answers);
    Json const& states = json["states"];
    if (query.size() == 1 && query[0].find('=') == std::string::npos) {
        std::vector<std::string> ids;
        for (auto const& state : states) {
            ids.push_back(state["id"]);
            if (ids.back() == query[0]) return {state, {}};
        }
        throw InputError(
            fmt::format("answer {}: unknown; allowed: key=value ..., {}", query[0], fmt::join(ids, ", ")));
    }
    Found found;
    std::set<std::string> known;
    for (auto const& state : states)
        for (auto const& [key, value] : state["parameters"].items())
            if (!value.is_array()) known.insert(key);
    for (auto const& word : query) {
        auto const equals = word.find('=');
        std::string const key = word.substr(0, equals);
        if (equals == std::string::npos || !known.contains(key))
            throw InputError(fmt::format(
                "answer: {}: not allowed; allowed: the id of one state point, or key=value with {}", word,
                fmt::join(known, ", ")));
        found.asked.emplace_back(key, word.substr(equals + 1));
    }
    double nearest = INFINITY;
    for (auto const& state : states) {
        double sum = 0.0;
        for (auto const& [key, asked] : found.asked)
            sum += std::pow(distance(state["parameters"], key, asked), 2);
        if (sum < nearest) nearest = sum, found.state = state;
    }
    if (found.state.is_null())
        throw InputError(
            fmt::format("answer: no state point has {}; see dpdref answer", fmt::join(query, ", ")));
    return found;
}

// A closed form for the state point's parameters and what was asked for instead.
std::string closed_form_text(std::string const& id, Json const& parameters, Assignments const& asked,
                             double unit) {
    std::map<std::string, std::string> arguments;
    for (auto const& [key, value] : parameters.items())
        if (!value.is_array()) arguments[key] = text_of(value);
    for (auto const& [key, value] : asked) arguments[key] = value;
    try {
        return fmt::format("{:.6g}", unit * theory_value(id, arguments));
    } catch (std::exception const& error) {
        return error.what();
    }
}

// Another code's units, and what it is asked for in the state points' own: cutoff, mass and kT are 1.
struct Foreign {
    double length = 1.0, mass = 1.0, energy = 1.0;
    std::vector<std::string> query;

    double time() const { return length * std::sqrt(mass / energy); }
};

Foreign reduced(Code const& code, std::vector<std::string> const& words) {
    static constexpr std::array<std::string_view, 3> ours{"n", "d", "integrator"};
    Foreign foreign;
    Assignments given;
    std::map<std::string, std::string> own{{"d", "3"}};
    for (auto const& word : words) {
        auto const equals = std::min(word.find('='), word.size() - 1);
        std::string const key = word.substr(0, equals), value = word.substr(equals + 1);
        if (std::find(ours.begin(), ours.end(), key) != ours.end())
            own[key] = value;
        else
            given.emplace_back(key, value);
    }
    DpdFluid const fluid = read_fluid(code, given);
    if (fluid.kT == 0.0) throw InputError(fmt::format("answer: {}: kT is 0; allowed: above", code.name));
    foreign.length = fluid.rc, foreign.mass = fluid.m, foreign.energy = fluid.kT;
    auto const add = [&](std::string_view key, double value) {
        foreign.query.push_back(fmt::format("{}={}", key, value));
    };
    add("a", fluid.a * foreign.length / foreign.energy);
    add("gamma", fluid.gamma * foreign.time() / foreign.mass);
    if (fluid.dt) add("dt", *fluid.dt / foreign.time());
    for (char const* const unit : {"m", "kT", "rc"}) add(unit, 1.0);
    foreign.query.push_back(fmt::format("weight={}", name_of(fluid.weight)));
    for (auto const& [key, value] : own) {
        double number = 0.0;
        if (key == "n" && std::istringstream(value) >> number)
            add("n", number * std::pow(foreign.length, std::stoi(own["d"])));
        else
            foreign.query.push_back(fmt::format("{}={}", key, value));
    }
    return foreign;
}

// The unit of a quantity; nothing for those that only dpdref derives.
std::optional<double> unit_of(std::string_view quantity, Foreign const& of, int d) {
    if (quantity.ends_with("temperature") || quantity == "potential_energy") return of.energy;
    if (quantity == "pressure") return of.energy / std::pow(of.length, d);
    if (quantity.ends_with("diffusion_constant")) return of.length * of.length / of.time();
    if (quantity == "viscosity" ||
        (quantity.ends_with("_viscosity") && !quantity.starts_with("potential_viscosity_")))
        return of.mass / (std::pow(of.length, d - 2) * of.time());
    if (quantity == "speed_of_sound") return of.length / of.time();
    return {};
}

// The state point in the code's own parameters.
std::string foreign_parameters(Code const& code, Foreign const& of, Json const& parameters) {
    DpdFluid fluid;
    fluid.gamma = parameters["gamma"].get<double>() * of.mass / of.time();
    fluid.a = parameters["a"].get<double>() * of.energy / of.length;
    fluid.dt = parameters["dt"].get<double>() * of.time();
    fluid.rc = of.length, fluid.m = of.mass, fluid.kT = of.energy;
    fluid.weight = *value_of<Weight>(parameters["weight"].get<std::string>());
    std::string text =
        fmt::format("{}: n={:.6g}", code.name,
                    parameters["n"].get<double>() / std::pow(of.length, parameters["d"].get<int>()));
    for (auto const& [key, value] : write_fluid(code, fluid)) text += fmt::format(" {}={}", key, value);
    return text;
}

}  // namespace

std::string answer_text(std::string const& answers, std::vector<std::string> const& words, Code const* code) {
    Foreign const foreign = code ? reduced(*code, words) : Foreign{};
    auto const& query = code ? foreign.query : words;
    std::string text;
    if (query.empty()) {
        Json const json = parse_answers(answers);
        for (auto const& state : json["states"])
            text +=
                fmt::format("{:<22} {}\n", state["id"].get<std::string>(), state["title"].get<std::string>());
        return text;
    }
    auto const [state, asked] = look_up(answers, query);
    Json const& parameters = state["parameters"];
    text = fmt::format("{}: {}\n ", state["id"].get<std::string>(), state["title"].get<std::string>());
    for (auto const& [key, value] : parameters.items())
        text += key == "L" || key == "stages" ? fmt::format(" {}={}", key, value.dump())
                                              : fmt::format(" {}={}", key, text_of(value));
    text += "\n";
    if (code) text += fmt::format("  {}\n", foreign_parameters(*code, foreign, parameters));
    bool other = false;
    for (auto const& [key, value] : asked)
        if (distance(parameters, key, value) != 0.0) {
            other = true;
            text += fmt::format("  asked for {}={}; the nearest state point has {}\n", key, value,
                                text_of(parameters[key]));
        }
    for (auto const& [name, quantity] : state["quantities"].items()) {
        std::optional<double> const unit = code ? unit_of(name, foreign, parameters["d"].get<int>()) : 1.0;
        if (!unit) continue;
        text += fmt::format("  {:<30} {:>14.6g} +- {:<9.2g} ({} blocks)", name,
                            *unit * quantity["value"].get<double>(), *unit * quantity["error"].get<double>(),
                            quantity["blocks"].get<std::uint64_t>());
        if (quantity.contains("closed_form")) {
            auto const& form = quantity["closed_form"];
            text += fmt::format("  {} = {:.6g}", form["id"].get<std::string>(),
                                *unit * form["value"].get<double>());
            if (other)
                text +=
                    fmt::format(" (as asked: {})", closed_form_text(form["id"], parameters, asked, *unit));
        }
        text += "\n";
    }
    return text;
}

std::string answer_json(std::string const& answers, std::vector<std::string> const& query) {
    return (query.empty() ? parse_answers(answers) : look_up(answers, query).state).dump(1) + "\n";
}

std::string answer_scene(std::string const& answers, std::vector<std::string> const& query,
                         std::string const& which) {
    auto const state = look_up(answers, query).state;
    if (!state["scenes"].contains(which))
        throw InputError(fmt::format("answer {}: has no run {}", state["id"].get<std::string>(), which));
    return fmt::format("title = \"{}\"\n{}\n", state["id"].get<std::string>(),
                       state["scenes"][which].get<std::string>());
}

}  // namespace dpd
