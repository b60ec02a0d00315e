#include "answers.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "budget.hpp"
#include "conventions.hpp"
#include "derived.hpp"
#include "files.hpp"
#include "integrators.hpp"
#include "picture.hpp"
#include "run_figure.hpp"
#include "theory/closed_forms.hpp"
#include "theory/registry.hpp"
#include "theory_arguments.hpp"
#include "toml_reader.hpp"
#include "version.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

// --- definition ------------------------------------------------------------------------------------------

// How one kind of run measures.
struct Kind {
    std::string name;
    double duration = 0.0, interval = 0.0, radial_interval = 0.0;  // times
    std::vector<std::string> settings;
};

struct AppliesTo {
    std::string quantity, id, stage;
    bool interacting = false;
};

void append(std::vector<std::string>& to, std::vector<std::string> const& more) {
    to.insert(to.end(), more.begin(), more.end());
}

}  // namespace

Answers load_answers(std::filesystem::path const& directory, std::string const& budget) {
    auto const file = directory / "answers.toml";
    toml::table const document = parse_toml(read_file(file), file.string());
    TomlReader root(document, "", file.string());
    std::ostringstream base;
    base << root.required_table("scene").raw();

    Kind rest{.name = "at_rest", .settings = {}}, shear{.name = "sheared", .settings = {}},
        densities{.name = "densities", .settings = {}};
    double shear_rate = 0.0, change = 0.0;
    for (Kind* const kind : {&rest, &shear, &densities}) {
        auto table = root.required_table(kind->name);
        kind->duration = table.number("duration", std::nullopt, positive);
        kind->interval = table.number("sample_interval", std::nullopt, positive);
        if (kind == &rest)
            kind->radial_interval = table.number("radial_distribution_interval", std::nullopt, positive);
        if (kind == &shear) shear_rate = table.number("shear_rate", std::nullopt, positive);
        if (kind == &densities) change = table.number("change", std::nullopt, positive);
        kind->settings = settings_of(table, "settings");
        table.finish();
    }
    auto interacting_table = root.required_table("interacting");
    auto const interacting_settings = settings_of(interacting_table, "settings");
    interacting_table.finish();

    struct Effort {
        std::uint64_t seeds = 1;
        double duration_scale = 1.0;
    };
    auto const effort = read_budget(root, budget, [](TomlReader& table) {
        return Effort{.seeds = table.integer("seeds", std::nullopt, positive_integer),
                      .duration_scale = table.number("duration_scale", 1.0, positive)};
    });

    std::vector<AppliesTo> closed_forms;
    for (auto& table : root.tables("closed_form")) {
        AppliesTo form;
        form.quantity = table.text("quantity", std::nullopt);
        form.id = table.text("id", std::nullopt);
        form.stage = table.text("stage", "");
        form.interacting = table.boolean("interacting", false);
        table.finish();
        if (!theory::find(form.id)) table.fail("id", "is no closed form; allowed: an id of `dpdref theory`");
        closed_forms.push_back(form);
    }

    auto integrators = read_integrators(directory / "integrators.toml");
    if (auto const shared = find_above(directory, "integrators.toml"))
        for (auto& integrator : read_integrators(*shared)) integrators.push_back(integrator);

    Answers answers;
    answers.figure.id = "answers";
    for (auto& table : root.tables("state")) {
        StatePoint state{.id = table.text("id", std::nullopt),
                         .title = table.text("title", std::nullopt),
                         .integrator = table.text("integrator", std::nullopt),
                         .closed_forms = {}};
        double const step = table.number("step", std::nullopt, positive),
                     friction = table.number("friction", std::nullopt, non_negative),
                     repulsion = table.number("repulsion", std::nullopt, non_negative),
                     kT = table.number("kT", 1.0, positive);
        double const rate = table.number("shear_rate", shear_rate, positive);
        auto const with_duration = [&](Kind kind, std::string const& key) {
            kind.duration = table.number(key, kind.duration, positive);
            return kind;
        };
        Kind const at_rest = with_duration(rest, "duration"),
                   sheared = with_duration(shear, "shear_duration"),
                   dense = with_duration(densities, "densities_duration");
        auto const settings = settings_of(table, "set");
        auto shear_settings = settings_of(table, "shear_set");
        shear_settings.push_back(fmt::format("box.shear_rate={}", rate));
        table.finish();
        auto const integrator = std::find_if(integrators.begin(), integrators.end(),
                                             [&](auto const& one) { return one.name == state.integrator; });
        if (integrator == integrators.end())
            table.fail("integrator", "is in no integrators.toml; allowed: the name of one");

        auto const add = [&](std::string const& suffix, Kind const& kind, bool flows,
                             std::vector<std::string> const& more) {
            auto const in_steps = [&](double time) { return std::max(1L, std::lround(time / step)); };
            auto overrides = scene_settings(*integrator, flows, friction, repulsion, kT);
            append(overrides, {fmt::format("time.step={}", step),
                               fmt::format("time.duration={}",
                                           effort.duration_scale * kind.duration / double(effort.seeds)),
                               fmt::format("sample.interval={}", in_steps(kind.interval))});
            append(overrides, kind.settings);
            if (repulsion > 0.0 && &kind == &at_rest) append(overrides, interacting_settings);
            if (kind.radial_interval > 0.0)
                overrides.push_back(
                    fmt::format("sample.radial_distribution.interval={}", in_steps(kind.radial_interval)));
            append(overrides, settings);
            append(overrides, more);
            Scene const scene =
                parse_scene(base.str(), fmt::format("{} ({}{})", file.string(), state.id, suffix), overrides);
            Point point;
            point.curve = answers.figure.curves.size();
            point.runs.assign(effort.seeds, scene);
            for (std::uint64_t run = 1; run < effort.seeds; ++run) point.runs[run].seed += run;
            FigureCurve curve;
            curve.name = state.id + suffix;
            answers.figure.curves.push_back(curve);
            answers.figure.points.push_back(point);
            return scene;
        };
        std::size_t const first = answers.figure.curves.size();
        Scene const scene = add("", at_rest, false, {});
        add("/shear", sheared, true, shear_settings);
        auto& figure = answers.figure;
        figure.curves[first].join = state.id + "/shear";
        if (repulsion > 0.0) {
            for (auto const& [suffix, sign] : {std::pair{"/below", -1.0}, std::pair{"/above", 1.0}})
                add(suffix, dense, false,
                    {fmt::format("particles.density={}", scene.density() * (1.0 + sign * change))});
            figure.curves[first].slope_between = {state.id + "/below", state.id + "/above"};
        }
        // the same runs again, for their radial distribution function
        FigureCurve radial;
        radial.name = state.id + "/g";
        radial.record = "radial_distribution";
        Point point = figure.points[first];
        point.curve = figure.curves.size();
        figure.curves.push_back(radial);
        figure.points.push_back(point);

        for (auto const& form : closed_forms)
            if (form.interacting == (repulsion > 0.0) &&
                (form.stage.empty() || scene.has_stage(form.stage)) && (!form.interacting || scene.soft()))
                state.closed_forms.emplace_back(form.quantity, form.id);
        answers.states.push_back(std::move(state));
    }
    root.finish();
    return answers;
}

// --- measuring -------------------------------------------------------------------------------------------

namespace {

std::vector<Point const*> points_named(Figure const& figure, std::string const& name) {
    std::vector<Point const*> found;
    for (auto const& point : figure.points)
        if (figure.curves[point.curve].name == name) found.push_back(&point);
    return found;
}

constexpr std::array<std::pair<char const*, char const*>, 4> run_names{
    {{"rest", ""}, {"shear", "/shear"}, {"below", "/below"}, {"above", "/above"}}};

// What only several runs of a state point together tell.
std::vector<Quantity> all_quantities(Point const& rest, Point const& shear) {
    auto quantities = rest.quantities;
    Scene const& scene = rest.runs.front();
    quantities.push_back(
        {"sheared_kinetic_temperature", find_quantity(shear.quantities, "kinetic_temperature")->estimate});
    bool const cube =
        scene.dimension == 3 && scene.length[0] == scene.length[1] && scene.length[1] == scene.length[2];
    if (cube)
        // the fluid's momentum spreads with nu, the particle with D: theory/NG2007.md
        add_function(quantities, "infinite_diffusion_constant", {"diffusion_constant", "viscosity"},
                     [&](std::vector<double> const& x) {
                         return x[0] + theory::diffusion_finite_size_correction(
                                           scene.thermostat_kT(), x[1] + scene.density() * scene.mass * x[0],
                                           scene.length[0]);
                     });
    // an ideal gas: its pressure is n kT
    add_function(quantities, "speed_of_sound", {"kinetic_temperature"},
                 [&](std::vector<double> const& x) { return std::sqrt(x[0] / scene.mass); });
    std::erase_if(quantities, [](Quantity const& quantity) { return !(quantity.estimate.error > 0.0); });
    return quantities;
}

Json parameters_of(StatePoint const& state, Scene const& scene, Scene const& sheared) {
    Json parameters{{"integrator", state.integrator}, {"stages", scene.stage_names()}};
    for (auto const& [name, text] : theory_arguments(scene)) {
        std::istringstream stream(text);
        if (double number; stream >> number)
            parameters[name] = number;
        else
            parameters[name] = text;
    }
    if (!scene.potential()) parameters["a"] = 0.0;
    parameters["d"] = scene.dimension;
    parameters["n"] = scene.density();
    parameters["N"] = scene.particles;
    parameters["L"] = scene.length;
    parameters["shear_rate"] = sheared.shear_rate;
    return parameters;
}

Json state_json(StatePoint const& state, Figure const& figure) {
    Point const& rest = *points_named(figure, state.id).front();
    Point const& shear = *points_named(figure, state.id + "/shear").front();
    Scene const& scene = rest.runs.front();
    Json json{{"id", state.id}, {"title", state.title}};
    json["parameters"] = parameters_of(state, scene, shear.runs.front());
    for (auto const& quantity : all_quantities(rest, shear)) {
        auto const& estimate = quantity.estimate;
        json["quantities"][quantity.name] = {
            {"value", estimate.value}, {"error", estimate.error}, {"blocks", estimate.blocks}};
    }
    for (auto const& [quantity, id] : state.closed_forms)
        json["quantities"].at(quantity)["closed_form"] = {{"id", id}, {"value", theory_for(scene, id)}};
    Json& curve = json["curves"]["radial_distribution"];
    for (Point const* const point : points_named(figure, state.id + "/g")) {
        auto const& estimate = find_quantity(point->quantities, "radial_distribution")->estimate;
        curve["x"].push_back(point->x);
        curve["value"].push_back(estimate.value);
        curve["error"].push_back(estimate.error);
        curve["blocks"].push_back(estimate.blocks);
    }
    for (auto const& [name, suffix] : run_names)
        for (Point const* const point : points_named(figure, state.id + suffix)) {
            json["scenes"][name] = point->runs.front().text;
            json["seeds"] = point->runs.size();
        }
    json["seconds"] = rest.seconds;
    return json;
}

// 0.8532(35): the error in units of the last digit, two digits of it.
std::string concise(Json const& quantity) {
    double const value = quantity["value"], error = quantity["error"];
    int const digits = std::max(0, 1 - static_cast<int>(std::floor(std::log10(error))));
    return fmt::format("{:.{}f}({:.0f})", value, digits, error * std::pow(10.0, digits));
}

using Columns = std::vector<std::pair<char const*, char const*>>;

// A table of the book, one row per state point.
std::string table_of(Json const& states, Columns const& columns) {
    std::string text = "| state point | L |", rule = "|---|---|";
    for (auto const& [name, label] : columns) text += fmt::format(" {} |", label), rule += "---|";
    text += "\n" + rule + "\n";
    for (auto const& state : states) {
        text += fmt::format("| `{}` | {:g} |", state["id"].get<std::string>(),
                            state["parameters"]["L"][0].get<double>());
        for (auto const& [name, label] : columns)
            text += state["quantities"].contains(name)
                        ? fmt::format(" {} |", concise(state["quantities"][name]))
                        : " |";
        text += "\n";
    }
    return text;
}

std::string tables_of(Json const& states) {
    return table_of(states, {{"kinetic_temperature", "kT"},
                             {"configurational_temperature", "kT of forces"},
                             {"pressure", "pressure"},
                             {"potential_energy", "energy"},
                             {"speed_of_sound", "sound"}}) +
           "\n" +
           table_of(states, {{"diffusion_constant", "D"},
                             {"infinite_diffusion_constant", "D, L infinite"},
                             {"viscosity", "viscosity"},
                             {"kinetic_viscosity", "kinetic"},
                             {"collision_viscosity", "collision"},
                             {"potential_viscosity", "potential"}});
}

std::string csv_of(Json const& states) {
    std::string text = "state,quantity,value,error,blocks,closed_form,closed_form_value\n";
    for (auto const& state : states)
        for (auto const& [name, quantity] : state["quantities"].items()) {
            text += fmt::format("{},{},{},{},{}", state["id"].get<std::string>(), name,
                                quantity["value"].get<double>(), quantity["error"].get<double>(),
                                quantity["blocks"].get<std::uint64_t>());
            if (quantity.contains("closed_form"))
                text += fmt::format(",{},{}\n", quantity["closed_form"]["id"].get<std::string>(),
                                    quantity["closed_form"]["value"].get<double>());
            else
                text += ",,\n";
        }
    return text;
}

}  // namespace

void measure_answers(Answers& answers, std::string const& budget, CampaignOptions const& options) {
    std::vector<Figure> figures{answers.figure};
    if (!run_points(figures, options)) return;
    answers.figure = std::move(figures.front());
    Json json{{"schema", "dpdref-answers/1"},
              {"program", fmt::format("dpdref {}", version)},
              {"engine_revision", engine_revision},
              {"budget", budget}};
    for (auto const& state : answers.states) json["states"].push_back(state_json(state, answers.figure));
    std::filesystem::create_directories(options.output);
    write_file(options.output / "answers.json", json.dump(1) + "\n");
    write_file(options.output / "answers.csv", csv_of(json["states"]));
    write_file(options.output / "answers.md", tables_of(json["states"]));
}

// --- looking up ------------------------------------------------------------------------------------------

namespace {

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
