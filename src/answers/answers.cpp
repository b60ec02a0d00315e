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
#include "derived.hpp"
#include "errors.hpp"
#include "files.hpp"
#include "integrators.hpp"
#include "picture.hpp"
#include "run.hpp"
#include "run_figure.hpp"
#include "state_point.hpp"
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

// Of --measure: a run is at most so many times as long as the quick budget's.
constexpr double most_growth = 4096.0;

constexpr std::uint64_t steps_of_timing = 100;

// A fluid as a table [[state]].
toml::table state_of(FluidToMeasure const& fluid, std::vector<Integrator> const& integrators) {
    std::vector<std::string> known;
    Integrator const* found = nullptr;
    for (auto const& one : integrators) {
        if (one.friction.empty() || !one.repulsion.ends_with(".soft.strength")) continue;
        known.push_back(one.name);
        if (one.name == fluid.integrator) found = &one;
    }
    if (!found)
        throw InputError(fmt::format("answer: integrator={}: cannot be measured; allowed: {}",
                                     fluid.integrator, fmt::join(known, "; ")));
    if (bool const rates = found->friction.ends_with(".rate"); rates != fluid.rates)
        throw InputError(
            fmt::format("answer: integrator={}: has {}; allowed: {}", found->name,
                        rates ? "a rate of updates, no friction" : "a friction, no rate of updates",
                        rates ? "Gamma" : "gamma"));
    double const volume = double(fluid.particles) / fluid.density,
                 side = fluid.dimension == 2 ? std::sqrt(volume) : std::cbrt(volume);
    toml::array sides;
    for (int axis = 0; axis < fluid.dimension; ++axis) sides.push_back(side);
    toml::table set{{"dimension", fluid.dimension},
                    {"particles.density", fluid.density},
                    {"box.length", sides},
                    {"sample.radial_distribution.range", std::min(2.0, 0.5 * side)}};
    std::string const thermostat = found->friction.substr(0, found->friction.find('.'));
    if (!fluid.weight.empty()) set.insert(thermostat + ".weight", fluid.weight);
    if (fluid.exponent > 0.0) set.insert(thermostat + ".exponent", fluid.exponent);
    toml::table state{{"id", fluid.id},
                      {"title", "measured for this query"},
                      {"integrator", fluid.integrator},
                      {"step", fluid.step},
                      {"friction", fluid.friction / found->friction_scale},
                      {"repulsion", fluid.repulsion},
                      {"set", set}};
    if (fluid.shear_rate) state.insert("shear_rate", *fluid.shear_rate);
    return state;
}

// The state points of a budget, or a single one, to be measured within a relative error.
Answers load(std::filesystem::path const& directory, std::string const& budget, FluidToMeasure const* fluid,
             double within) {
    auto const file = directory / "answers.toml";
    auto integrators = read_integrators(directory / "integrators.toml");
    if (auto const shared = find_above(directory, "integrators.toml"))
        for (auto& integrator : read_integrators(*shared)) integrators.push_back(integrator);
    toml::table document = parse_toml(read_file(file), file.string());
    if (fluid) document.insert_or_assign("state", toml::array{state_of(*fluid, integrators)});
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
    std::string pair_dpd;
    std::vector<std::string> pair_dpd_settings;
    if (auto of_lammps = root.table("pair_dpd")) {
        pair_dpd = of_lammps->text("integrator", std::nullopt);
        pair_dpd_settings = settings_of(*of_lammps, "settings");
        of_lammps->finish();
    }

    struct Effort {
        std::uint64_t seeds = 1;
        double duration_scale = 1.0;
        std::vector<std::string> rest, shear, densities;  // settings
    };
    auto const effort = read_budget(root, budget, [&](TomlReader& table) {
        return Effort{.seeds = table.integer("seeds", std::nullopt, positive_integer),
                      .duration_scale = table.number("duration_scale", 1.0, positive),
                      .rest = settings_of(table, rest.name),
                      .shear = settings_of(table, shear.name),
                      .densities = settings_of(table, densities.name)};
    });
    append(rest.settings, effort.rest);
    append(shear.settings, effort.shear);
    append(densities.settings, effort.densities);

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

    if (fluid)
        for (auto const& [quantity, share] : errors_wanted_of_answers) {
            auto const setting = fmt::format("time.until.{}={}", quantity, share * within);
            bool const of_flow = quantity == std::string_view("viscosity");
            (of_flow ? shear : rest).settings.push_back(setting);
            if (quantity == std::string_view("pressure")) densities.settings.push_back(setting);
        }

    Answers answers;
    answers.figure.id = "answers";
    for (auto& table : root.tables("state")) {
        StatePoint state{.id = table.text("id", std::nullopt),
                         .title = table.text("title", std::nullopt),
                         .integrator = table.text("integrator", std::nullopt),
                         .limit = table.boolean("limit", false),
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
            double const duration = effort.duration_scale * kind.duration / double(effort.seeds);
            append(overrides, {fmt::format("time.step={}", step), fmt::format("time.duration={}", duration),
                               fmt::format("sample.interval={}", in_steps(kind.interval))});
            if (fluid) overrides.push_back(fmt::format("time.longest={}", most_growth * duration));
            append(overrides, kind.settings);
            if (repulsion > 0.0 && &kind == &at_rest)
                append(overrides, state.integrator == pair_dpd ? pair_dpd_settings : interacting_settings);
            if (kind.radial_interval > 0.0)
                overrides.push_back(
                    fmt::format("sample.radial_distribution.interval={}", in_steps(kind.radial_interval)));
            append(overrides, settings);
            append(overrides, more);
            Scene const scene = [&] {
                try {
                    return parse_scene(base.str(), fmt::format("{} ({}{})", file.string(), state.id, suffix),
                                       overrides);
                } catch (InputError const& error) {
                    if (!fluid) throw;
                    throw InputError(fmt::format("answer --measure: its scene: {}", error.what()));
                }
            }();
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
        auto& figure = answers.figure;
        if (!integrator->sheared_stages.empty()) {
            add("/shear", sheared, true, shear_settings);
            figure.curves[first].join = state.id + "/shear";
        }
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

}  // namespace

Answers load_answers(std::filesystem::path const& directory, std::string const& budget) {
    return load(directory, budget, nullptr, 0.0);
}

Answers load_answer(std::filesystem::path const& directory, FluidToMeasure const& fluid, double within) {
    return load(directory, "quick", &fluid, within);
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
std::vector<Quantity> all_quantities(Point const& rest, Point const* shear) {
    auto quantities = rest.quantities;
    Scene const& scene = rest.runs.front();
    if (shear)
        quantities.push_back({"sheared_kinetic_temperature",
                              find_quantity(shear->quantities, "kinetic_temperature")->estimate});
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

Json parameters_of(StatePoint const& state, Scene const& scene, Point const* shear) {
    Json parameters{{"integrator", state.integrator}, {"stages", scene.stage_names()}};
    for (auto const& [name, text] : theory_arguments(scene)) {
        std::istringstream stream(text);
        if (double number; stream >> number)
            parameters[name] = number;
        else
            parameters[name] = text;
    }
    parameters.erase("box");  // L says it
    if (!scene.potential()) parameters["a"] = 0.0;
    parameters["d"] = scene.dimension;
    parameters["n"] = scene.density();
    parameters["N"] = scene.particles;
    parameters["L"] = scene.length;
    if (shear) parameters["shear_rate"] = shear->runs.front().shear_rate;
    return parameters;
}

Json state_json(StatePoint const& state, Figure const& figure) {
    Point const& rest = *points_named(figure, state.id).front();
    auto const sheared = points_named(figure, state.id + "/shear");
    Point const* const shear = sheared.empty() ? nullptr : sheared.front();
    Scene const& scene = rest.runs.front();
    Json json{{"id", state.id}, {"title", state.title}};
    if (state.limit) json["limit"] = true;
    json["parameters"] = parameters_of(state, scene, shear);
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
    json["engine_revision"] = engine_revision;
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

// What the state points are, as a table.
std::string fluids_of(Json const& states) {
    std::string text = fmt::format("| state point | {} |\n|---", fmt::join(naming_columns, " | "));
    for (std::size_t column = 0; column < naming_columns.size(); ++column) text += "|---";
    text += "|\n";
    for (auto const& state : states) {
        text += fmt::format("| `{}` |", state["id"].get<std::string>());
        for (auto const& cell : naming_cells(state["parameters"])) text += fmt::format(" {} |", cell);
        text += "\n";
    }
    return text;
}

std::string tables_of(Json const& states) {
    return fluids_of(states) + "\n" +
           table_of(states, {{"kinetic_temperature", "kT"},
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

double expected_seconds(Answers const& answers, std::string const& state) {
    Json const known = Json::parse(state);
    auto const scene_of = [&](std::string const& name) {
        Json const& scenes = known["scenes"];
        return parse_scene(scenes.value(name, scenes["rest"].get<std::string>()), "answers: " + name);
    };
    Scene const rest = scene_of("rest"), shear = scene_of("shear");
    double seconds = 0.0;
    std::set<std::string> counted;
    for (auto const& point : answers.figure.points)
        for (auto const& scene : point.runs) {
            if (!counted.insert(scene.key()).second) continue;
            Scene timing = scene;
            timing.until.reset();
            timing.equilibration_steps = 0;
            timing.production_steps = steps_of_timing;
            double const per_step = run(timing).seconds / double(steps_of_timing);
            // errors fall with the root of particles and time
            Scene const& like = scene.shear_rate != 0.0 ? shear : rest;
            double const size = double(like.particles) * double(like.production_steps) * like.time_step *
                                known["seeds"].get<double>();
            double needed = 0.0;
            for (auto const& [name, wanted] : scene.until->errors)
                if (known["quantities"].contains(name)) {
                    Json const& quantity = known["quantities"][name];
                    double const error = quantity["error"].get<double>() / quantity["value"].get<double>();
                    needed = std::max(needed, size / double(scene.particles) * std::pow(error / wanted, 2));
                }
            auto end = double(scene.production_steps);
            while (end * scene.time_step < needed && end < double(scene.until->longest)) end *= 2.0;
            seconds += per_step * (double(scene.equilibration_steps) + end);
        }
    return seconds;
}

std::optional<std::string> measure(Answers& answers, std::string const& budget,
                                   CampaignOptions const& options) {
    std::vector<Figure> figures{answers.figure};
    if (!run_points(figures, options)) return {};
    answers.figure = std::move(figures.front());
    Json json{{"schema", "dpdref-answers/1"},
              {"program", fmt::format("dpdref {}", version)},
              {"engine_revision", engine_revision},
              {"budget", budget}};
    for (auto const& state : answers.states) json["states"].push_back(state_json(state, answers.figure));
    return json.dump(1) + "\n";
}

std::string answer_tables(std::string const& answers) { return tables_of(Json::parse(answers)["states"]); }

void measure_answers(Answers& answers, std::string const& budget, CampaignOptions const& options) {
    auto const text = measure(answers, budget, options);
    if (!text) return;
    std::filesystem::create_directories(options.output);
    write_file(options.output / "answers.json", *text);
    write_file(options.output / "answers.csv", csv_of(Json::parse(*text)["states"]));
    write_file(options.output / "answers.md", answer_tables(*text));
}

}  // namespace dpd
