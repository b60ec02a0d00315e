#include "answer.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "conventions.hpp"
#include "errors.hpp"
#include "names.hpp"
#include "query.hpp"
#include "state_point.hpp"
#include "statistics.hpp"
#include "theory/registry.hpp"
#include "theory_arguments.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

int dimension_of(Json const& parameters) { return parameters["d"].get<int>(); }

// How far a parameter is from what is asked for, both in units of cutoff, mass and kT; infinitely for a text
// that differs.
double distance(Json const& reduced, std::string const& key, std::string const& asked) {
    if (!reduced.contains(key)) return INFINITY;
    if (is_text(key)) return text_of(reduced[key]) == asked ? 0.0 : INFINITY;
    double const value = reduced[key].get<double>(), number = asked_number(key, asked);
    if (std::abs(number - value) <= 1e-6 * value) return 0.0;  // a unit with so many digits
    return number > 0.0 && value > 0.0 ? std::log(number / value) : number - value;
}

// What may differ: first the friction counts, then the step, then box and flow. All else is another fluid or
// another integrator.
constexpr std::array<std::array<std::string_view, 2>, 3> may_differ{
    {{"gamma", "Gamma"}, {"dt", ""}, {"N", "shear_rate"}}};

auto rank_of(std::string_view key) {
    return std::ranges::find_if(may_differ,
                                [&](auto const& keys) { return std::ranges::find(keys, key) != keys.end(); });
}

// Squared distances by what may differ; nothing for another fluid or integrator.
std::optional<std::array<double, 3>> distances(Json const& reduced, Assignments const& asked) {
    std::array<double, 3> sums{};
    for (auto const& [key, value] : asked) {
        double const far = distance(reduced, key, value);
        auto const rank = rank_of(key);
        if (!std::isfinite(far) || (far != 0.0 && rank == may_differ.end())) return {};
        if (rank != may_differ.end()) sums[std::size_t(rank - may_differ.begin())] += far * far;
    }
    return sums;
}

// "dt is 0.02, not 0.03" for each parameter that differs, in the units of the query.
std::vector<std::string> differences(Json const& reduced, Query const& query) {
    std::vector<std::string> texts;
    for (auto const& [key, value] : query.asked) {
        if (distance(reduced, key, value) == 0.0) continue;
        double const unit = parameter_unit(key, query.units, query.d);
        auto const in_units =
            [&, &name = key](std::string const& text) {  // clang 14 captures no binding by itself
                return is_text(name) ? text : fmt::format("{:.6g}", unit * asked_number(name, text));
            };
        texts.push_back(reduced.contains(key) ? fmt::format("{} is {}, not {}", key,
                                                            in_units(text_of(reduced[key])), in_units(value))
                                              : fmt::format("has no {}", key));
    }
    return texts;
}

// Where the step that is asked for is at most half of any that was measured, the limit of a small one is
// nearer.
Json const* limit_for(Json const& states, Query const& query, Json const& nearest) {
    std::string const step = value_in(query.asked, "dt", "");
    if (step.empty()) return nullptr;
    Assignments fluid;
    for (auto const& assignment : query.asked)
        if (assignment.first != "dt" && assignment.first != "integrator" && assignment.first != "scheme")
            fluid.push_back(assignment);
    for (auto const& state : states) {
        if (!state.contains("limit")) continue;
        Json const& reduced = parameters_in(state["parameters"], {});
        auto const far = distances(reduced, fluid);
        double const least = parameters_in((nearest.is_null() ? state : nearest)["parameters"], {})["dt"];
        if (far && (*far)[0] == 0.0 && asked_number("dt", step) <= 0.5 * least) return &state;
    }
    return nullptr;
}

struct Found {
    Json state;
    Query query;
    std::vector<std::string> differences;  // from what was asked for
};

// No state point is that fluid: which comes nearest, and why it is not given.
[[noreturn]] void refuse_other_fluids(Json const& states, Query const& query) {
    Query decisive = query;
    std::erase_if(decisive.asked, [](auto const& one) {
        return rank_of(one.first) != may_differ.end() && one.first != "gamma" && one.first != "Gamma";
    });
    std::vector<std::string> least;
    std::string nearest;
    for (auto const& state : states) {
        auto const these = differences(parameters_in(state["parameters"], {}), decisive);
        if (nearest.empty() || these.size() < least.size()) least = these, nearest = state["id"];
    }
    throw InputError(fmt::format(
        "answer: no state point is that fluid by that integrator: in {} {}; allowed: what `dpdref answer` "
        "lists, and --measure",
        nearest, least.empty() ? "not all of it is known" : fmt::format("{}", fmt::join(least, ", "))));
}

Found look_up(std::string const& answers, std::vector<std::string> const& words, Code const* code) {
    Json const json = parse_answers(answers);
    Json const& states = json["states"];
    if (is_id(words, code)) {
        Json const& state = state_named(states, words[0]);
        Json const& parameters = state["parameters"];
        return {.state = state,
                .query = {.units = units_of(parameters), .d = dimension_of(parameters), .asked = {}},
                .differences = {}};
    }
    Found found{.state = {}, .query = read_query(states, words, code), .differences = {}};
    Query const& query = found.query;
    bool const any = value_in(query.asked, "integrator", "").empty();
    std::array<double, 3> nearest{INFINITY, INFINITY, INFINITY};
    for (auto const& state : states) {
        Json const& parameters = state["parameters"];
        // MY1997's algorithm heats at any step that others would take: it is asked for by name
        if (auto const& stages = parameters["stages"];
            any && std::find(stages.begin(), stages.end(), "euler") != stages.end())
            continue;
        if (auto const far = distances(parameters_in(parameters, {}), query.asked); far && *far < nearest)
            nearest = *far, found.state = state;
    }
    if (Json const* const limit = limit_for(states, query, found.state)) found.state = *limit;
    if (found.state.is_null()) refuse_other_fluids(states, query);
    found.differences = differences(parameters_in(found.state["parameters"], {}), query);
    return found;
}

// A closed form for the state point's parameters and what was asked for instead, in the units of the query.
std::string closed_form_text(std::string const& id, Json const& parameters, Query const& query) {
    std::map<std::string, std::string> arguments;
    for (auto const& [key, value] : parameters.items())
        if (!value.is_array()) arguments[key] = text_of(value);
    if (parameters.contains("L")) {  // of a box that is no cube, the cube of the same volume
        double volume = 1.0;
        for (auto const& side : parameters["L"]) volume *= side.get<double>();
        arguments["box"] =
            fmt::format("{}", std::pow(volume, 1.0 / static_cast<double>(parameters["L"].size())));
    }
    for (auto const& [key, value] : query.asked)
        arguments[key] =
            is_text(key)
                ? value
                : fmt::format("{}", asked_number(key, value) * parameter_unit(key, query.units, query.d));
    if (arguments.contains("sigma"))
        arguments["sigma"] =
            fmt::format("{}", std::sqrt(2.0 * std::stod(arguments["gamma"]) * query.units.energy));
    try {
        return fmt::format("{:.6g}", theory_value(id, arguments));
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
    fluid.lambda = lambda_of(scaled["integrator"].get<std::string>());
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

struct Peak {
    Estimate r, height;
};

// The highest point of g(r), of a parabola through the seven bins about the highest by least squares, errors
// as of independent bins; nothing where g(r) does not rise above 1 or has its highest bin at the end.
std::optional<Peak> peak_of_g(Json const& state) {
    if (!state.contains("curves") || !state["curves"].contains("radial_distribution")) return {};
    Json const& curve = state["curves"]["radial_distribution"];
    auto const x = curve["x"].get<std::vector<double>>(), g = curve["value"].get<std::vector<double>>();
    std::vector<double> error;
    for (auto const& one : curve["error"]) error.push_back(one.is_number() ? one.get<double>() : NAN);
    constexpr std::ptrdiff_t half = 3, bins = 2 * half + 1;
    auto const top = std::max_element(g.begin(), g.end()) - g.begin();
    if (g.size() != x.size() || error.size() != x.size() || top < half || top + half >= std::ssize(g))
        return {};
    double const width = x[1] - x[0];
    Eigen::Matrix<double, bins, 3> powers;
    Eigen::Vector<double, bins> values, weights;
    for (std::ptrdiff_t k = 0; k < bins; ++k) {
        auto const bin = std::size_t(top + k - half);
        double const t = double(k - half);
        powers.row(k) << 1.0, t, t * t;
        values(k) = g[bin];
        weights(k) = 1.0 / (error[bin] * error[bin]);
    }
    Eigen::Matrix3d const covariance = (powers.transpose() * weights.asDiagonal() * powers).inverse();
    Eigen::Vector3d const c = covariance * (powers.transpose() * weights.asDiagonal() * values);
    double const t = -c(1) / (2.0 * c(2)), height = c(0) + c(1) * t + c(2) * t * t;
    Eigen::Vector3d const of_t(0.0, -1.0 / (2.0 * c(2)), c(1) / (2.0 * c(2) * c(2))),
        of_height(1.0, t, t * t);
    auto const spread = [&](Eigen::Vector3d const& gradient) {
        return std::sqrt(gradient.dot(covariance * gradient));
    };
    Peak const peak{.r = {.value = x[std::size_t(top)] + t * width, .error = spread(of_t) * width},
                    .height = {.value = height, .error = spread(of_height)}};
    bool const rises = c(2) < 0.0 && std::abs(t) <= double(half) && height - 1.0 > 5.0 * peak.height.error;
    return rises ? std::optional(peak) : std::nullopt;
}

// A state point in the units of the query, with what differs and the peak of g(r).
Json answer_of(Found const& found) {
    Json state = state_in(found.state, found.query.units);
    if (!found.differences.empty()) state["differs"] = found.differences;
    if (auto const peak = peak_of_g(state))
        state["radial_distribution_peak"] = {{"r", peak->r.value},
                                             {"r_error", peak->r.error},
                                             {"value", peak->height.value},
                                             {"error", peak->height.error}};
    return state;
}

// The state points, a line each, by what distinguishes them.
std::string list_of(Json const& states) {
    std::string text = fmt::format("{:<20} {:>2} {:>3} {:>6} {:>9} {:<10} {:<17} {:<6} title\n",
                                   "state point", "d", "n", "a", "friction", "weight", "integrator", "step");
    for (auto const& state : states) {
        auto const [d, n, a, friction, weight, integrator, step] = naming_cells(state["parameters"]);
        text += fmt::format("{:<20} {:>2} {:>3} {:>6} {:>9} {:<10} {:<17} {:<6} {}\n",
                            state["id"].get<std::string>(), d, n, a, friction, weight, integrator, step,
                            state["title"].get<std::string>());
    }
    return text;
}

}  // namespace

std::string answer_text(std::string const& answers, std::vector<std::string> const& words, Code const* code) {
    if (words.empty()) return list_of(parse_answers(answers)["states"]);
    Found const found = look_up(answers, words, code);
    Query const& query = found.query;
    Json const state = answer_of(found);
    Json const &parameters = state["parameters"], &own = found.state["parameters"];
    std::string text;
    if (!found.differences.empty())
        text = fmt::format(
            "not what was asked for: {}{}\n", fmt::join(found.differences, ", "),
            state.contains("limit")
                ? "; the limit of a small step, which integrators share, at a step that does not show"
                : "; --measure measures what was");
    text += fmt::format("{}: {}\n {}\n", state["id"].get<std::string>(), state["title"].get<std::string>(),
                        parameters_text(own));
    if (code)
        text += fmt::format("  {}\n", parameters_of(*code, query.units, parameters));
    else if (query.units != units_of(own))
        text += fmt::format("  in your units, as all values below:{}\n", parameters_text(parameters));
    for (auto const& [name, quantity] : state["quantities"].items()) {
        text +=
            fmt::format("  {:<30} {:>14.6g} +- {:<9.2g} ({} blocks)", name, quantity["value"].get<double>(),
                        quantity["error"].get<double>(), quantity["blocks"].get<std::uint64_t>());
        if (quantity.contains("closed_form")) {
            auto const& form = quantity["closed_form"];
            auto const id = form["id"].get<std::string>();
            bool const other = !found.differences.empty();
            text += fmt::format("  {} = {:.6g}", id, form["value"].get<double>());
            if (other) text += fmt::format(" (as asked: {})", closed_form_text(id, parameters, query));
            if (auto const with = theory::with_memory(id); !with.empty())
                text +=
                    fmt::format(", {} = {}{}", with, closed_form_text(std::string(with), parameters, query),
                                other ? " (as asked)" : "");
        }
        text += "\n";
    }
    if (auto const peak = peak_of_g(state))
        text += fmt::format("  {:<30} {:>14.6g} +- {:<9.2g} at r = {:.4g} +- {:.1g}\n",
                            "radial_distribution_peak", peak->height.value, peak->height.error, peak->r.value,
                            peak->r.error);
    return text;
}

std::string answer_json(std::string const& answers, std::vector<std::string> const& words, Code const* code) {
    return (words.empty() ? parse_answers(answers) : answer_of(look_up(answers, words, code))).dump(1) + "\n";
}

std::string answer_file(std::string const& answers, std::vector<std::string> const& words, Code const* code) {
    Found const found = look_up(answers, words, code);
    if (!found.differences.empty())
        throw InputError(fmt::format("{}: is not what was asked for: {}; allowed: with --measure",
                                     found.state["id"].get<std::string>(),
                                     fmt::join(found.differences, ", ")));
    Json file = parse_answers(answers);
    file["states"] = Json::array({state_in(found.state, found.query.units)});
    return file.dump();
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
