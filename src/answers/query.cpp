#include "query.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "errors.hpp"
#include "names.hpp"
#include "number.hpp"
#include "stages.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

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
    std::set<std::string> known{"N", "exponent", "gamma", "Gamma", "shear_rate", "sigma"};
    for (auto const& state : states)
        for (auto const& [key, value] : state["parameters"].items())
            if (!value.is_array()) known.insert(key);
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
    query.asked.emplace_back("d", value_in(given, "d", "3"));
    for (auto const& [key, value] : given)
        if (is_text(key) && key != "d") query.asked.emplace_back(key, value);
    for (auto const& [key, number] : numbers)
        if (key != "rc" && key != "m" && key != "kT")
            query.asked.emplace_back(key,
                                     fmt::format("{}", number / parameter_unit(key, query.units, query.d)));
    return query;
}

// In another code's parameters, with density, dimension and integrator by our names.
Query foreign_query(Code const& code, std::vector<std::string> const& words) {
    static constexpr std::array<std::string_view, 5> ours{"n", "d", "N", "shear_rate", "integrator"};
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
    for (char const* const key : {"n", "N", "shear_rate"})
        if (auto const number = value_in(own, key, ""); !number.empty()) ask(key, asked_number(key, number));
    ask("a", fluid.a);
    ask("gamma", fluid.gamma);
    if (fluid.dt) ask("dt", *fluid.dt);
    TheoryArguments weight;
    set_weight_arguments(weight, fluid.weight);
    query.asked.insert(query.asked.end(), weight.begin(), weight.end());
    std::string const integrator =
        value_in(own, "integrator", std::string(integrator_of(code.mover, fluid.lambda)));
    if (integrator.empty())
        throw InputError(fmt::format("answer: {}: lambda={}: not allowed; allowed: {}, {}", code.name,
                                     fluid.lambda, lambda_of("GW 0.5"), lambda_of("GW 0.65")));
    query.asked.emplace_back("integrator", integrator);
    return query;
}

}  // namespace

double asked_number(std::string const& key, std::string const& text) {
    auto const number = number_in(text);
    if (!number || !std::isfinite(*number) || *number < 0.0)
        throw InputError(fmt::format("answer: {}={}: not allowed; allowed: a number >= 0", key, text));
    return *number;
}

bool is_text(std::string_view key) {
    return key == "d" || key == "integrator" || key == "scheme" || key == "weight";
}

std::string value_in(Assignments const& assignments, std::string_view key, std::string const& fallback) {
    for (auto const& [name, value] : assignments)
        if (name == key) return value;
    return fallback;
}

double lambda_of(std::string_view integrator) { return integrator == "GW 0.65" ? 0.65 : DpdFluid{}.lambda; }

std::string_view integrator_of(Mover mover, double lambda) {
    switch (mover) {
        case Mover::velocity_verlet:
            for (std::string_view const name : {"GW 0.5", "GW 0.65"})
                if (lambda == lambda_of(name)) return name;
            return "";
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

std::string text_of(Json const& value) {
    return value.is_string() ? value.get<std::string>() : fmt::format("{}", value.get<double>());
}

bool is_id(std::vector<std::string> const& words, Code const* code) {
    return !code && words.size() == 1 && words[0].find('=') == std::string::npos;
}

Json parse_answers(std::string const& text) {
    try {
        return Json::parse(text);
    } catch (Json::exception const& error) {
        throw InputError(fmt::format("answers: {}; allowed: a file of `dpdref answers`", error.what()));
    }
}

Json const& state_named(Json const& states, std::string const& id) {
    std::vector<std::string> ids;
    for (auto const& state : states) {
        ids.push_back(state["id"]);
        if (ids.back() == id) return state;
    }
    throw InputError(fmt::format("answer {}: unknown; allowed: key=value ..., {}", id, fmt::join(ids, ", ")));
}

Query read_query(Json const& states, std::vector<std::string> const& words, Code const* code) {
    return code ? foreign_query(*code, words) : own_query(states, words);
}

}  // namespace dpd
