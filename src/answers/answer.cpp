#include "answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "conventions.hpp"
#include "errors.hpp"
#include "names.hpp"
#include "theory/registry.hpp"
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

// --- units: what is asked for and what was measured meet where cutoff, mass and kT are 1

struct Units {
    double length = 1.0, mass = 1.0, energy = 1.0;

    double time() const { return length * std::sqrt(mass / energy); }
    bool operator==(Units const&) const = default;
};

// The unit of a parameter in d dimensions; 1 for what has none.
double parameter_unit(std::string_view key, Units const& of, int d) {
    if (key == "n") return std::pow(of.length, -d);
    if (key == "a") return of.energy / of.length;
    if (key == "gamma") return of.mass / of.time();
    if (key == "sigma") return std::sqrt(of.energy * of.mass / of.time());
    if (key == "dt") return of.time();
    if (key == "Gamma" || key == "shear_rate") return 1.0 / of.time();
    if (key == "rc") return of.length;
    if (key == "m") return of.mass;
    if (key == "kT") return of.energy;
    return 1.0;
}

// The unit of a quantity; nothing for those that only dpdref derives.
std::optional<double> unit_of(std::string_view quantity, Units const& of, int d) {
    if (quantity.ends_with("temperature") || quantity == "potential_energy") return of.energy;
    if (quantity == "pressure") return of.energy / std::pow(of.length, d);
    if (quantity.ends_with("diffusion_constant")) return of.length * of.length / of.time();
    if (quantity == "viscosity" ||
        (quantity.ends_with("_viscosity") && !quantity.starts_with("potential_viscosity_")))
        return of.mass / (std::pow(of.length, d - 2) * of.time());
    if (quantity == "speed_of_sound") return of.length / of.time();
    return {};
}

double number_of(Json const& parameters, char const* key, double fallback) {
    return parameters.contains(key) ? parameters[key].get<double>() : fallback;
}

// A state point's own. Without a repulsion of DPD's the cutoff is not what its lengths are measured in.
Units units_of(Json const& parameters) {
    return {.length = parameters.contains("a") ? number_of(parameters, "rc", 1.0) : 1.0,
            .mass = number_of(parameters, "m", 1.0),
            .energy = number_of(parameters, "kT", 1.0)};
}

int dimension_of(Json const& parameters) { return parameters["d"].get<int>(); }

// A state point's parameters in units of its own (cutoff, mass and kT become 1), times those that are given.
Json in_units(Json const& parameters, Units const& units) {
    Json scaled = parameters;
    Units const own = units_of(parameters);
    int const d = dimension_of(parameters);
    for (auto& [key, value] : scaled.items())
        if (value.is_number_float())
            value = value.get<double>() * parameter_unit(key, units, d) / parameter_unit(key, own, d);
        else if (key == "L")
            for (auto& side : value) side = side.get<double>() * units.length / own.length;
    return scaled;
}

// --- queries

double asked_number(std::string const& key, std::string const& text) {
    double number = 0.0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(number) || number < 0.0)
        throw InputError(fmt::format("answer: {}={}: not allowed; allowed: a number >= 0", key, text));
    return number;
}

bool is_text(std::string_view key) {
    return key == "d" || key == "integrator" || key == "scheme" || key == "weight";
}

struct Query {
    Units units;
    int d = 3;
    Assignments asked;       // with cutoff, mass and kT 1
    std::string integrator;  // of the code whose parameters these are: others count as far, not as wrong
};

std::string value_in(Assignments const& assignments, std::string_view key, std::string const& fallback) {
    for (auto const& [name, value] : assignments)
        if (name == key) return value;
    return fallback;
}

// key=value by key; InputError for a word that is none.
Assignments assignments_of(std::vector<std::string> const& words) {
    Assignments assignments;
    for (auto const& word : words) {
        auto const equals = word.find('=');
        std::string const key = word.substr(0, equals);
        if (equals == std::string::npos || !value_in(assignments, key, "").empty())
            throw InputError(fmt::format("answer: {}: not allowed; allowed: key=value, each key once", word));
        assignments.emplace_back(key, word.substr(equals + 1));
    }
    return assignments;
}

// In the closed forms' parameters. Of friction, noise and kT two are enough: kT = sigma^2/(2 gamma).
Query own_query(Json const& states, std::vector<std::string> const& words) {
    std::set<std::string> known;
    for (auto const& state : states)
        for (auto const& [key, value] : state["parameters"].items())
            if (!value.is_array()) known.insert(key);
    if (known.contains("gamma")) known.insert("sigma");
    Assignments const given = assignments_of(words);
    for (auto const& [key, value] : given)
        if (!known.contains(key))
            throw InputError(fmt::format(
                "answer: {}={}: not allowed; allowed: the id of one state point, or key=value with {}", key,
                value, fmt::join(known, ", ")));
    Query query;
    std::map<std::string, double> numbers;
    for (auto const& [key, value] : given)
        if (!is_text(key)) numbers[key] = asked_number(key, value);
    auto const unit = [&](char const* key) {
        double const one = numbers.contains(key) ? numbers[key] : 1.0;
        if (one == 0.0)
            throw InputError(fmt::format("answer: {}=0: not allowed; allowed: a number > 0", key));
        return one;
    };
    if (numbers.contains("sigma")) {
        double const half_square = 0.5 * numbers["sigma"] * numbers["sigma"];
        bool const friction = numbers.contains("gamma"), heat = numbers.contains("kT");
        if (friction && heat && std::abs(half_square - numbers["gamma"] * numbers["kT"]) > 1e-6 * half_square)
            throw InputError(
                fmt::format("answer: sigma={}: is not (2 gamma kT)^(1/2); allowed: two of the three",
                            value_in(given, "sigma", "")));
        if (!heat && friction) numbers["kT"] = half_square / unit("gamma");
        if (!friction) numbers["gamma"] = half_square / unit("kT");
        numbers.erase("sigma");
    }
    query.units = {.length = unit("rc"), .mass = unit("m"), .energy = unit("kT")};
    query.d = value_in(given, "d", "3") == "2" ? 2 : 3;
    for (auto const& [key, value] : given)
        if (is_text(key)) query.asked.emplace_back(key, value);
    for (auto const& [key, number] : numbers)
        if (key != "rc" && key != "m" && key != "kT")
            query.asked.emplace_back(key,
                                     fmt::format("{}", number / parameter_unit(key, query.units, query.d)));
    return query;
}

// What of the state points moves particles as a code does.
std::string_view integrator_of(Mover mover) {
    switch (mover) {
        case Mover::velocity_verlet:
            return "GW 0.5";
        case Mover::s1:
            return "S1";
        case Mover::exponential:
            return "Peters";
        case Mover::middle:
            return "LFMiddle";
        case Mover::euler:
            return "Euler, old";
        case Mover::leapfrog:
            return "Euler, new";
    }
    return "";
}

// In another code's parameters, with density, dimension and integrator by our names.
Query foreign_query(Code const& code, std::vector<std::string> const& words) {
    static constexpr std::array<std::string_view, 3> ours{"n", "d", "integrator"};
    Assignments given, own;
    for (auto const& assignment : assignments_of(words))
        (std::ranges::find(ours, assignment.first) != ours.end() ? own : given).push_back(assignment);
    DpdFluid const fluid = read_fluid(code, given);
    if (fluid.kT == 0.0) throw InputError(fmt::format("answer: {}: kT is 0; allowed: above", code.name));
    Query query;
    query.units = {.length = fluid.rc, .mass = fluid.m, .energy = fluid.kT};
    query.d = value_in(own, "d", "3") == "2" ? 2 : 3;
    auto const ask = [&](std::string const& key, double value) {
        query.asked.emplace_back(key, fmt::format("{}", value / parameter_unit(key, query.units, query.d)));
    };
    query.asked.emplace_back("d", value_in(own, "d", "3"));
    if (auto const density = value_in(own, "n", ""); !density.empty()) ask("n", asked_number("n", density));
    ask("a", fluid.a);
    ask("gamma", fluid.gamma);
    if (fluid.dt) ask("dt", *fluid.dt);
    TheoryArguments weight;
    set_weight_arguments(weight, fluid.weight);
    query.asked.insert(query.asked.end(), weight.begin(), weight.end());
    if (auto const integrator = value_in(own, "integrator", ""); !integrator.empty())
        query.asked.emplace_back("integrator", integrator);
    else
        query.integrator = integrator_of(code.mover);
    return query;
}

// --- the nearest state point

// How far a parameter is from what is asked for, both in units of cutoff, mass and kT; infinitely for a text
// that differs.
double distance(Json const& reduced, std::string const& key, std::string const& asked) {
    if (!reduced.contains(key)) return INFINITY;
    if (is_text(key)) return text_of(reduced[key]) == asked ? 0.0 : INFINITY;
    double const value = reduced[key].get<double>(), number = asked_number(key, asked);
    if (std::abs(number - value) <= 1e-6 * value) return 0.0;  // a unit with so many digits
    return number > 0.0 && value > 0.0 ? std::log(number / value) : number - value;
}

// First the fluid counts, then how it is moved, then box and flow: the nearest step of another fluid is none.
std::size_t rank_of(std::string_view key) {
    if (key == "dt" || key == "integrator" || key == "scheme") return 1;
    return key == "N" || key == "shear_rate" ? 2 : 0;
}

struct Found {
    Json state;
    Query query;
    bool other_fluid = false;
};

Found look_up(std::string const& answers, std::vector<std::string> const& words, Code const* code) {
    Json const json = parse_answers(answers);
    Json const& states = json["states"];
    if (!code && words.size() == 1 && words[0].find('=') == std::string::npos) {
        std::vector<std::string> ids;
        for (auto const& state : states) {
            ids.push_back(state["id"]);
            if (ids.back() != words[0]) continue;
            Json const& parameters = state["parameters"];
            Query const as_it_is{
                .units = units_of(parameters), .d = dimension_of(parameters), .asked = {}, .integrator = {}};
            return {.state = state, .query = as_it_is};
        }
        throw InputError(
            fmt::format("answer {}: unknown; allowed: key=value ..., {}", words[0], fmt::join(ids, ", ")));
    }
    Found found{.state = {}, .query = code ? foreign_query(*code, words) : own_query(states, words)};
    auto const& asked = found.query.asked;
    bool const any = found.query.integrator.empty() && value_in(asked, "integrator", "").empty();
    std::array<double, 3> nearest{INFINITY, INFINITY, INFINITY};
    for (auto const& state : states) {
        Json const& parameters = state["parameters"];
        // MY1997's algorithm heats at any step that others would take: it is asked for by name
        if (auto const& stages = parameters["stages"];
            any && std::find(stages.begin(), stages.end(), "euler") != stages.end())
            continue;
        Json const reduced = in_units(parameters, {});
        std::array<double, 3> sums{};
        if (auto const& its = found.query.integrator;
            !its.empty() && text_of(parameters["integrator"]) != its)
            sums[1] = 1e6;
        for (auto const& [key, value] : asked)
            sums[rank_of(key)] += std::pow(distance(reduced, key, value), 2);
        if (std::isfinite(sums[0] + sums[1] + sums[2]) && sums < nearest) nearest = sums, found.state = state;
    }
    if (found.state.is_null())
        throw InputError(
            fmt::format("answer: no state point has {}; see dpdref answer", fmt::join(words, ", ")));
    found.other_fluid = nearest[0] > 0.0;
    return found;
}

// A closed form for the state point's parameters and what was asked for instead.
std::string closed_form_text(std::string const& id, Json const& reduced, Assignments const& asked,
                             double unit) {
    std::map<std::string, std::string> arguments;
    for (auto const& [key, value] : reduced.items())
        if (!value.is_array()) arguments[key] = text_of(value);
    if (reduced.contains("L")) {  // of a box that is no cube, the cube of the same volume
        double volume = 1.0;
        for (auto const& side : reduced["L"]) volume *= side.get<double>();
        arguments["box"] =
            fmt::format("{}", std::pow(volume, 1.0 / static_cast<double>(reduced["L"].size())));
    }
    for (auto const& [key, value] : asked) arguments[key] = value;
    if (arguments.contains("sigma"))
        arguments["sigma"] = fmt::format("{}", std::sqrt(2.0 * std::stod(arguments["gamma"])));
    try {
        return fmt::format("{:.6g}", unit * theory_value(id, arguments));
    } catch (std::exception const& error) {
        return error.what();
    }
}

// The state point in the parameters of another code.
std::string parameters_of(Code const& code, Units const& units, Json const& scaled) {
    DpdFluid fluid;
    fluid.gamma = scaled["gamma"].get<double>();
    fluid.a = scaled["a"].get<double>();
    fluid.dt = scaled["dt"].get<double>();
    fluid.rc = units.length, fluid.m = units.mass, fluid.kT = units.energy;
    fluid.weight = scaled.contains("exponent")
                       ? power_weight(scaled["exponent"].get<double>())
                       : Weight(*value_of<Weight::Kind>(scaled["weight"].get<std::string>()));
    std::string text = fmt::format("{}: n={:.6g}", code.name, scaled["n"].get<double>());
    for (auto const& [key, value] : write_fluid(code, fluid)) text += fmt::format(" {}={}", key, value);
    return text;
}

std::string parameters_text(Json const& parameters) {
    std::string text;
    for (auto const& [key, value] : parameters.items())
        text += value.is_array()          ? fmt::format(" {}={}", key, value.dump())
                : value.is_number_float() ? fmt::format(" {}={:.6g}", key, value.get<double>())
                                          : fmt::format(" {}={}", key, text_of(value));
    return text;
}

}  // namespace

std::string answer_text(std::string const& answers, std::vector<std::string> const& words, Code const* code) {
    std::string text;
    if (words.empty()) {
        Json const json = parse_answers(answers);
        for (auto const& state : json["states"])
            text +=
                fmt::format("{:<22} {}\n", state["id"].get<std::string>(), state["title"].get<std::string>());
        return text;
    }
    auto const [state, query, other_fluid] = look_up(answers, words, code);
    auto const& [units, d, asked, integrator] = query;
    Json const& parameters = state["parameters"];
    Units const own = units_of(parameters);
    Json const scaled = in_units(parameters, units), reduced = in_units(parameters, {});
    text = fmt::format("{}: {}\n {}\n", state["id"].get<std::string>(), state["title"].get<std::string>(),
                       parameters_text(parameters));
    if (code)
        text += fmt::format("  {}\n", parameters_of(*code, units, scaled));
    else if (units != own)
        text += fmt::format("  in your units, as all values below:{}\n", parameters_text(scaled));
    if (!integrator.empty() && integrator != text_of(parameters["integrator"]))
        text += fmt::format("  moved by {}; {} moves by {}, which was not measured for this fluid\n",
                            text_of(parameters["integrator"]), code->name, integrator);
    if (other_fluid) text += "  not the fluid that was asked for; of all measured ones the nearest\n";
    bool other = false;
    for (auto const& [key, value] : asked)
        if (distance(reduced, key, value) != 0.0) {
            other = true;
            double const unit = parameter_unit(key, units, d);
            text += fmt::format("  asked for {}={:.6g}; the nearest state point has {:.6g}\n", key,
                                unit * asked_number(key, value), unit * reduced[key].get<double>());
        }
    for (auto const& [name, quantity] : state["quantities"].items()) {
        auto const in_own = unit_of(name, own, d), in_asked = unit_of(name, units, d);
        if (units != own && !in_own) continue;
        double const unit = units == own ? 1.0 : *in_asked / *in_own;
        text += fmt::format("  {:<30} {:>14.6g} +- {:<9.2g} ({} blocks)", name,
                            unit * quantity["value"].get<double>(), unit * quantity["error"].get<double>(),
                            quantity["blocks"].get<std::uint64_t>());
        if (quantity.contains("closed_form")) {
            auto const& form = quantity["closed_form"];
            text += fmt::format("  {} = {:.6g}", form["id"].get<std::string>(),
                                unit * form["value"].get<double>());
            if (other)
                text += fmt::format(" (as asked: {})",
                                    closed_form_text(form["id"], reduced, asked, in_asked.value_or(1.0)));
            if (auto const id = theory::with_memory(form["id"].get<std::string>()); !id.empty())
                text += fmt::format(", {} = {}{}", id,
                                    closed_form_text(std::string(id), reduced, asked, in_asked.value_or(1.0)),
                                    other ? " (as asked)" : "");
        }
        text += "\n";
    }
    if (other)
        text += fmt::format(
            "  what was not measured, a run measures: dpdref answer {} --scene rest >scene.toml\n",
            state["id"].get<std::string>());
    return text;
}

std::string answer_json(std::string const& answers, std::vector<std::string> const& words) {
    return (words.empty() ? parse_answers(answers) : look_up(answers, words, nullptr).state).dump(1) + "\n";
}

std::string answer_scene(std::string const& answers, std::vector<std::string> const& words,
                         std::string const& which) {
    auto const state = look_up(answers, words, nullptr).state;
    if (!state["scenes"].contains(which))
        throw InputError(fmt::format("answer {}: has no run {}", state["id"].get<std::string>(), which));
    return fmt::format("title = \"{}\"\n{}\n", state["id"].get<std::string>(),
                       state["scenes"][which].get<std::string>());
}

}  // namespace dpd
