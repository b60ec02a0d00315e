#include "define_figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "budget.hpp"
#include "files.hpp"
#include "theory/registry.hpp"
#include "toml_reader.hpp"

namespace dpd {
namespace {

std::vector<Criterion> read_criteria(TomlReader& reader) {
    std::vector<Criterion> criteria;
    for (auto& table : reader.tables("compare")) {
        Criterion criterion;
        criterion.quantity = table.text("quantity", std::nullopt);
        criterion.theory = table.text("theory", std::nullopt);
        criterion.value = table.number("value", 0.0, any_number);
        criterion.relation = table.choice<Relation>("relation", "equal");
        criterion.tolerance = table.number("tolerance", 0.0, non_negative);
        criterion.resolution = table.number("resolution", 0.01, positive);
        criterion.description = table.boolean("description", false);
        table.finish();
        bool const known = criterion.theory == "value" || criterion.theory.starts_with("curve:") ||
                           criterion.theory.starts_with("quantity:") || criterion.theory == "previous" ||
                           theory::find(criterion.theory) != nullptr;
        if (!known)
            table.fail("theory",
                       "is no closed form; allowed: an id of `dpdref theory`, curve:NAME, quantity:NAME, "
                       "previous, value");
        if (criterion.quantity.starts_with(exponent_prefix) && criterion.theory != "value")
            table.fail("theory", "is for a slope from the point before; allowed: value");
        criteria.push_back(criterion);
    }
    return criteria;
}

// Applies the keys of a table { "table.key" = value, ... } to a scene; `index` picks from lists where given.
void apply(toml::table& scene, toml::table const& settings, std::optional<std::size_t> index,
           std::string const& origin) {
    for (auto const& [key, node] : settings) {
        std::ostringstream value;
        toml::node const* chosen = &node;
        if (index && node.is_array()) chosen = node.as_array()->get(*index);
        if (!chosen)
            throw InputError(fmt::format("{}: {}: has no value for point {}", origin, key.str(), *index + 1));
        chosen->visit([&](auto const& element) {
            if constexpr (toml::is_value<decltype(element)> || toml::is_array<decltype(element)>)
                value << element;
        });
        override_key(scene, fmt::format("{}={}", key.str(), value.str()), origin);
    }
}
// Curves that others refer to have to be there before anything runs.
void check_references(Figure const& figure, std::string const& file) {
    auto const check = [&](std::string const& curve, std::string const& key, std::string const& name) {
        bool const known = std::any_of(figure.curves.begin(), figure.curves.end(),
                                       [&](FigureCurve const& other) { return other.name == name; });
        if (!known)
            throw InputError(fmt::format("{}: curve {}: {}: there is no curve {}", file, curve, key, name));
    };
    for (auto const& curve : figure.curves) {
        if (!curve.join.empty()) check(curve.name, "join", curve.join);
        for (auto const& other : curve.slope_between) check(curve.name, "slope_between", other);
        for (auto const& criterion : curve.criteria)
            if (criterion.theory.starts_with("curve:"))
                check(curve.name, "theory", criterion.theory.substr(6));
    }
}

// What a budget makes of a figure's scenes.
struct Budget {
    std::string name;
    std::uint64_t seeds = 1;
    double duration_scale = 1.0, equilibration_scale = 1.0, error_scale = 1.0;
    toml::table settings{};
};

Budget read_figure_budget(TomlReader& root, std::string const& name) {
    Budget budget = read_budget(root, name, [](TomlReader& table) {
        Budget its{.name = {},
                   .seeds = table.integer("seeds", std::nullopt, positive_integer),
                   .duration_scale = table.number("duration_scale", 1.0, positive),
                   .equilibration_scale = table.number("equilibration_scale", 1.0, positive),
                   .error_scale = table.number("error_scale", 1.0, positive)};
        if (auto const settings = table.table("set")) its.settings = settings->raw();
        return its;
    });
    budget.name = name;
    return budget;
}

// Where the points of a curve are, and what makes their scenes.
struct Variation {
    std::vector<double> values, paper_only;
    std::optional<std::uint64_t> paper_seeds{};  // in place of the budget's
    toml::table settings{}, along{};             // the latter picks from lists by the point's place
    bool common_noise = false;
};

// A table [[curve]].
std::pair<FigureCurve, Variation> read_curve(TomlReader& table) {
    FigureCurve curve;
    Variation variation;
    curve.name = table.text("name", std::nullopt);
    curve.label = table.text("label", curve.name);
    curve.record = table.text("record", "");
    curve.join = table.text("join", "");
    curve.slope_between = table.texts("slope_between", std::vector<std::string>{});
    if (curve.slope_between.size() != 0 && curve.slope_between.size() != 2)
        table.fail("slope_between", "allowed: names of two curves, at a lower and at a higher density");
    variation.common_noise = table.boolean("common_noise", false);
    bool const varies = curve.record.empty();
    curve.parameter = table.text("vary", varies ? std::nullopt : std::optional<std::string>(""));
    std::optional<std::vector<double>> const single = std::vector<double>{0.0};
    variation.values = table.numbers("values", varies ? std::nullopt : single, any_number);
    if (!varies) {
        if (!curve.parameter.empty()) table.fail("vary", "a record has its own x; allowed: only one of them");
        if (table.has("values")) table.fail("values", "a record has its own x; allowed: no values");
        curve.from = table.number("from", curve.from, any_number);
        curve.to = table.number("to", curve.to, any_number);
        curve.every = table.integer("every", 1, positive_integer);
    }
    if (auto const settings = table.table("set")) variation.settings = settings->raw();
    if (auto const along = table.table("along")) variation.along = along->raw();
    variation.paper_only = table.numbers("paper_only", std::vector<double>{}, any_number);
    if (table.has("paper_seeds"))
        variation.paper_seeds = table.integer("paper_seeds", std::nullopt, positive_integer);
    curve.line = table.numbers("line", std::vector<double>{}, any_number);
    if (curve.line.size() != 0 && curve.line.size() != 2) table.fail("line", "allowed: a range [from, to]");
    curve.criteria = read_criteria(table);
    table.finish();
    return {std::move(curve), std::move(variation)};
}

// What --set changes in a figure, and in how many scenes it could.
struct Change {
    std::string assignment, table, key;  // "time.step=0.1", "time", "time.step"
    std::size_t scenes = 0;
};

std::vector<Change> read_changes(std::vector<std::string> const& assignments) {
    std::vector<Change> changes;
    for (auto const& assignment : assignments) {
        std::string const key = assignment.substr(0, assignment.find('='));
        changes.push_back({assignment, key.substr(0, key.rfind('.')), key});
    }
    return changes;
}

// The scene of point v of a curve, as text.
std::string scene_text(toml::table scene, Budget const& budget, FigureCurve const& curve,
                       Variation const& variation, std::size_t v, std::vector<Change>& changes,
                       std::string const& origin) {
    apply(scene, budget.settings, std::nullopt, origin);
    apply(scene, variation.settings, std::nullopt, origin);
    apply(scene, variation.along, v, origin);
    if (curve.record.empty())
        override_key(scene, fmt::format("{}={}", curve.parameter, variation.values[v]), origin);
    for (auto& change : changes) {
        if (!scene.at_path(change.table).is_table() && !scene.contains(change.key)) continue;
        if (change.key == curve.parameter || variation.along.contains(change.key))
            throw InputError(fmt::format("--set {}: curve {} of {} varies it along x; allowed: another key",
                                         change.assignment, curve.name, origin));
        override_key(scene, change.assignment, "--set");
        ++change.scenes;
    }
    auto const rescale = [&](std::string const& key, double factor) {
        if (auto* const node = scene.at_path(key).node())
            if (auto const time = node->value<double>())
                override_key(scene, fmt::format("{}={}", key, *time * factor), origin);
    };
    rescale("time.duration", budget.duration_scale);
    if (budget.equilibration_scale != 1.0) rescale("time.equilibration", budget.equilibration_scale);
    if (toml::table const* const until = scene.at_path("time.until").as_table();
        until && budget.error_scale != 1.0)
        for (auto const& [quantity, error] : toml::table(*until))
            rescale(fmt::format("time.until.{}", quantity.str()), budget.error_scale);
    std::ostringstream text;
    text << scene;
    return text.str();
}

// The same runs at rest, which draw the same random numbers.
std::vector<Scene> without_shear(std::vector<Scene> const& runs, std::string const& file,
                                 std::string const& curve) {
    if (runs.front().shear_rate == 0.0 || runs.front().until)
        throw InputError(fmt::format(
            "{}: curve {}: common_noise is of runs in shear; allowed: a box.shear_rate, and no time.until",
            file, curve));
    std::vector<Scene> at_rest;
    for (Scene const& scene : runs)
        at_rest.push_back(parse_scene(scene.text, file, {"box.shear_rate=0.0"}, scene.seed));
    return at_rest;
}

}  // namespace

std::vector<std::string> figure_ids(std::filesystem::path const& verification) {
    std::vector<std::string> ids;
    std::error_code ignored;
    for (auto const& entry : std::filesystem::directory_iterator(verification, ignored))
        if (std::filesystem::exists(entry.path() / "figure.toml"))
            ids.push_back(entry.path().filename().string());
    std::sort(ids.begin(), ids.end());
    return ids;
}

Figure load_figure(std::filesystem::path const& verification, std::string const& id,
                   std::string const& budget_name, std::vector<std::string> const& assignments) {
    auto const path = verification / id / "figure.toml";
    if (!std::filesystem::exists(path))
        throw InputError(fmt::format("figure {}: unknown; allowed: all, {}", id,
                                     fmt::join(figure_ids(verification), ", ")));
    std::string const file = path.string();
    toml::table const document = parse_toml(read_file(path), file);
    TomlReader root(document, "", file);
    Figure figure;
    figure.directory = verification / id;
    figure.id = id;
    figure.paper = root.text("paper", std::nullopt);
    figure.number = root.text("figure", std::nullopt);
    figure.title = root.text("title", std::nullopt);
    figure.caption = root.text("caption", std::nullopt);
    auto const base = root.required_table("scene");
    Budget const budget = read_figure_budget(root, budget_name);
    std::vector<Change> changes = read_changes(assignments);
    for (auto& table : root.tables("curve")) {
        auto [curve, variation] = read_curve(table);
        auto const& values = variation.values;
        auto const& skip = variation.paper_only;
        for (std::size_t v = 0; v < values.size(); ++v) {
            if (budget.name == "quick" && std::find(skip.begin(), skip.end(), values[v]) != skip.end())
                continue;
            Scene const scene =
                parse_scene(scene_text(base.raw(), budget, curve, variation, v, changes, file),
                            fmt::format("{} ({}, {} = {})", file, curve.name, curve.parameter, values[v]));
            Point point;
            point.curve = figure.curves.size();
            point.x = values[v];
            std::uint64_t const seeds =
                budget.name == "paper" ? variation.paper_seeds.value_or(budget.seeds) : budget.seeds;
            point.runs.assign(seeds, scene);
            for (std::uint64_t run = 1; run < seeds; ++run) point.runs[run].seed += run;
            if (variation.common_noise) point.at_rest = without_shear(point.runs, file, curve.name);
            figure.points.push_back(std::move(point));
        }
        figure.curves.push_back(std::move(curve));
    }
    root.finish();
    for (auto const& change : changes) {
        if (change.scenes == 0)
            throw InputError(
                fmt::format("--set {}: no curve of {} has a table '{}'; allowed: keys of its scenes",
                            change.assignment, file, change.table));
        figure.caption += fmt::format(" Changed: {}.", change.assignment);
    }
    check_references(figure, file);
    return figure;
}

}  // namespace dpd
