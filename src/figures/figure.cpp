#include "figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <sstream>

#include "derived.hpp"
#include "picture.hpp"
#include "progress.hpp"
#include "theory/closed_forms.hpp"
#include "theory/registry.hpp"
#include "toml_reader.hpp"
#include "version.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;

// --- definition ------------------------------------------------------------------------------------------

constexpr std::array<std::string_view, 4> relation_names{"equal", "at_most", "at_least", "differs"};

Relation relation_from_name(std::string_view name) {
    return static_cast<Relation>(std::find(relation_names.begin(), relation_names.end(), name) -
                                 relation_names.begin());
}

std::string_view name_of(Relation relation) { return relation_names[static_cast<std::size_t>(relation)]; }

constexpr std::string_view exponent_prefix = "exponent:";

std::vector<Criterion> read_criteria(TomlReader& reader) {
    std::vector<Criterion> criteria;
    for (auto& table : reader.tables("compare")) {
        Criterion criterion;
        criterion.quantity = table.text("quantity", std::nullopt);
        criterion.theory = table.text("theory", std::nullopt);
        criterion.value = table.number("value", 0.0, any_number);
        criterion.relation = table.choice<Relation>("relation", "equal", relation_names);
        criterion.tolerance = table.number("tolerance", 0.0, non_negative);
        criterion.resolution = table.number("resolution", 0.01, positive);
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

// Rough cost of a run, in pair and particle visits: good enough to start the longest first and to tell the
// time that is left.
double cost_of(Scene const& scene) {
    double const ball = scene.dimension == 2 ? std::numbers::pi : 4.0 * std::numbers::pi / 3.0;
    double const pairs = 0.5 * scene.density() * ball * std::pow(scene.cutoff(), scene.dimension);
    double const substeps = scene.has_stage("verlet") ? double(scene.substeps) : 1.0;
    return double(scene.steps()) * substeps * double(scene.particles) * (4.0 + pairs);
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

}  // namespace

std::map<std::string, std::string> theory_arguments(Scene const& scene) {
    auto const text = [](double value) { return fmt::format("{}", value); };
    std::map<std::string, std::string> arguments{{"d", fmt::format("{}", scene.dimension)},
                                                 {"n", text(scene.density())},
                                                 {"m", text(scene.mass)},
                                                 {"dt", text(scene.time_step)},
                                                 {"kT", text(scene.kT)}};
    if (scene.has_stage("shardlow")) {
        arguments["gamma"] = text(scene.shardlow.friction);
        arguments["rc"] = text(scene.shardlow.cutoff);
        arguments["kT"] = text(scene.shardlow.kT);
        arguments["weight"] = name_of(scene.shardlow.weight);
        arguments["scheme"] = name_of(scene.shardlow.scheme);
    }
    if (scene.has_stage("lowe")) {
        arguments["Gamma"] = text(scene.lowe.rate);
        arguments["rc"] = text(scene.lowe.cutoff);
        arguments["kT"] = text(scene.lowe.kT);
    }
    if (scene.has_stage("modified_verlet")) {
        arguments["gamma"] = text(scene.modified_verlet.gamma);
        arguments["sigma"] = text(scene.modified_verlet.sigma);
        arguments["rc"] = text(scene.modified_verlet.cutoff);
        arguments["kT"] = text(scene.thermostat_kT());
        arguments["weight"] = name_of(scene.modified_verlet.weight);
    }
    if (auto const* const soft = std::get_if<Soft>(&scene.potential); soft && scene.has_potential())
        arguments["a"] = text(soft->strength / soft->cutoff);
    if (auto const& map = scene.coarse_graining) {
        arguments["Nm"] = text(map->atoms_per_particle);
        if (map->viscosity > 0.0) {
            arguments["eta"] = text(map->viscosity);
            arguments["force_md"] = text(map->force);
            arguments["L_md"] =
                text(scene.channel_width() * theory::cutoff_radius({.Nm = map->atoms_per_particle}));
        }
    }
    if (scene.has_stage("rescale")) arguments["kT"] = text(scene.rescale.kT);
    if (scene.has_stage("euler")) {
        // what eq. 22 calls n is, for N particles, (N-1)(N-2)/V^2 over (N-1)/V: theory/MY1997.md
        arguments["n"] = text((double(scene.particles) - 2.0) / scene.volume());
        arguments["gamma"] = text(scene.euler.gamma);
        arguments["sigma"] = text(scene.euler.sigma);
        arguments["rc"] = text(scene.euler.cutoff);
        arguments["weight"] = name_of(scene.euler.weight);
        if (scene.euler.random_weight) arguments["random_weight"] = name_of(*scene.euler.random_weight);
    }
    return arguments;
}

double theory_value(std::string const& id, std::map<std::string, std::string> const& arguments) {
    theory::ClosedForm const& form = *theory::find(id);
    std::vector<std::pair<std::string, std::string>> given;
    for (auto const& [name, text] : arguments) {
        auto const takes = [&name = name](auto const& names) {
            return std::find(names.begin(), names.end(), name) != names.end();
        };
        if (takes(form.parameters) || takes(form.without_effect)) given.emplace_back(name, text);
    }
    return theory::evaluate(id, given);
}

double theory_for(Scene const& scene, std::string const& id) {
    return theory_value(id, theory_arguments(scene));
}

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
                   std::string const& budget) {
    static constexpr std::array<std::string_view, 2> budgets{"paper", "quick"};
    auto const path = verification / id / "figure.toml";
    if (!std::filesystem::exists(path))
        throw InputError(fmt::format("figure {}: unknown; allowed: all, {}", id,
                                     fmt::join(figure_ids(verification), ", ")));
    toml::table const document = parse_toml(read_file(path), path.string());
    TomlReader root(document, "", path.string());
    Figure figure;
    figure.directory = verification / id;
    figure.id = id;
    figure.paper = root.text("paper", std::nullopt);
    figure.number = root.text("figure", std::nullopt);
    figure.title = root.text("title", std::nullopt);
    figure.caption = root.text("caption", std::nullopt);
    auto const base = root.required_table("scene");

    std::uint64_t seeds = 0;
    double duration_scale = 1.0, equilibration_scale = 1.0;
    toml::table budget_settings;
    auto budget_tables = root.required_table("budget");
    for (auto const name : budgets) {
        auto table = budget_tables.required_table(std::string(name));
        std::uint64_t const count = table.integer("seeds", std::nullopt, positive_integer);
        double const scale = table.number("duration_scale", 1.0, positive);
        double const start_scale = table.number("equilibration_scale", 1.0, positive);
        auto settings = table.table("set");
        table.finish();
        if (name != budget) continue;
        seeds = count;
        duration_scale = scale;
        equilibration_scale = start_scale;
        if (settings) budget_settings = settings->raw();
    }
    budget_tables.finish();

    for (auto& table : root.tables("curve")) {
        FigureCurve curve;
        curve.name = table.text("name", std::nullopt);
        curve.label = table.text("label", curve.name);
        curve.record = table.text("record", "");
        curve.join = table.text("join", "");
        curve.slope_between = table.texts("slope_between", std::vector<std::string>{});
        if (curve.slope_between.size() != 0 && curve.slope_between.size() != 2)
            table.fail("slope_between", "allowed: names of two curves, at a lower and at a higher density");
        bool const varies = curve.record.empty();
        curve.parameter = table.text("vary", varies ? std::nullopt : std::optional<std::string>(""));
        std::optional<std::vector<double>> const single = std::vector<double>{0.0};
        auto const values = table.numbers("values", varies ? std::nullopt : single, any_number);
        if (!varies) {
            if (!curve.parameter.empty())
                table.fail("vary", "a record has its own x; allowed: only one of them");
            if (table.has("values")) table.fail("values", "a record has its own x; allowed: no values");
            curve.from = table.number("from", curve.from, any_number);
            curve.to = table.number("to", curve.to, any_number);
            curve.every = table.integer("every", 1, positive_integer);
        }
        auto const settings = table.table("set"), along = table.table("along");
        std::vector<double> const skip = table.numbers("paper_only", std::vector<double>{}, any_number);
        curve.line = table.numbers("line", std::vector<double>{}, any_number);
        if (curve.line.size() != 0 && curve.line.size() != 2)
            table.fail("line", "allowed: a range [from, to]");
        curve.criteria = read_criteria(table);
        table.finish();
        for (std::size_t v = 0; v < values.size(); ++v) {
            if (budget == "quick" && std::find(skip.begin(), skip.end(), values[v]) != skip.end()) continue;
            toml::table scene = base.raw();
            apply(scene, budget_settings, std::nullopt, path.string());
            if (settings) apply(scene, settings->raw(), std::nullopt, path.string());
            if (along) apply(scene, along->raw(), v, path.string());
            if (varies) override_key(scene, fmt::format("{}={}", curve.parameter, values[v]), path.string());
            auto const rescale = [&](std::string const& key, double factor) {
                if (auto* const node = scene.at_path(key).node())
                    if (auto const time = node->value<double>())
                        override_key(scene, fmt::format("{}={}", key, *time * factor), path.string());
            };
            rescale("time.duration", duration_scale);
            if (equilibration_scale != 1.0) rescale("time.equilibration", equilibration_scale);
            std::ostringstream text;
            text << scene;
            Point point;
            point.curve = figure.curves.size();
            point.x = values[v];
            Scene const first = parse_scene(text.str(), fmt::format("{} ({}, {} = {})", path.string(),
                                                                    curve.name, curve.parameter, values[v]));
            point.runs.assign(seeds, first);
            for (std::uint64_t run = 1; run < seeds; ++run) point.runs[run].seed += run;
            figure.points.push_back(std::move(point));
        }
        figure.curves.push_back(std::move(curve));
    }
    root.finish();
    check_references(figure, path.string());
    return figure;
}

namespace {

// A measured curve as points, one per bin that is asked for. False if there is none.
bool append_bins(std::vector<Point>& points, FigureCurve const& curve, Point const& run,
                 std::vector<Record> const& records) {
    auto const [x, y] = curve_of(run.runs.front(), records, curve.record);
    std::vector<std::size_t> bins;
    for (std::size_t bin = 0; bin < x.size(); bin += curve.every)
        if (x[bin] >= curve.from && x[bin] <= curve.to && y[bin].blocks > 0) bins.push_back(bin);
    for (std::size_t const bin : bins) {
        Point point = run;
        point.x = x[bin];
        point.quantities.push_back({curve.record, y[bin]});
        point.seconds = run.seconds / double(bins.size());
        if (bin != bins.front()) point.configuration.resize(0, 0);
        points.push_back(std::move(point));
    }
    return !bins.empty();
}

// The points of a curve at x; its only point, if it has one, stands for all x.
std::vector<Point const*> points_of(std::string const& name, std::vector<FigureCurve> const& curves,
                                    std::vector<Point> const& points, double x) {
    std::vector<Point const*> found;
    for (auto const& point : points)
        if (!name.empty() && curves[point.curve].name == name) found.push_back(&point);
    if (found.size() > 1) std::erase_if(found, [x](Point const* point) { return point->x != x; });
    return found;
}

// Adds the quantities of the joined curve's point at the same x (or of its only one) that the point lacks.
void join(std::string const& name, std::vector<FigureCurve> const& curves, std::vector<Point> const& points,
          Point& point) {
    for (Point const* const partner : points_of(name, curves, points, point.x)) {
        for (auto const& quantity : partner->quantities)
            if (!find_quantity(point.quantities, quantity.name)) point.quantities.push_back(quantity);
        point.seconds += partner->seconds;
    }
    if (auto const& others = curves[point.curve].slope_between; !others.empty()) {
        auto const below = points_of(others[0], curves, points, point.x),
                   above = points_of(others[1], curves, points, point.x);
        auto const pressure = [](Point const& at) {
            Quantity const* const found = find_quantity(at.quantities, "pressure");
            return found ? found->estimate : Estimate{};
        };
        if (!below.empty() && !above.empty()) {
            derive_from_densities(
                point.runs.front(),
                above.front()->runs.front().density() - below.front()->runs.front().density(),
                pressure(*below.front()), pressure(*above.front()), point.quantities);
            point.seconds += below.front()->seconds + above.front()->seconds;
        }
    }
    derive(point.runs.front(), point.quantities);
    if (curves[point.curve].record == "velocity_autocorrelation")
        derive_at_lag(point.runs.front(), point.quantities, point.x);
}

// Run time up to a fraction of the production: a step costs the same throughout.
double seconds_until(Scene const& scene, RunResult const& result, double fraction) {
    double const steps = double(scene.equilibration_steps) + fraction * double(scene.production_steps);
    return result.seconds * (steps / double(scene.steps()));
}

// Run time behind the points of curve c, of joined points too; each run counts once.
double seconds_of(Figure const& figure, std::size_t c, Results const& results, double fraction) {
    auto const& curve = figure.curves[c];
    std::vector<std::string> joined = curve.slope_between;
    joined.push_back(curve.join);
    std::map<std::string, double> seconds;
    auto const count = [&](Point const& point) {
        for (auto const& scene : point.runs) {
            std::string const key = scene.key();
            seconds[key] = seconds_until(scene, *results.at(key), fraction);
        }
    };
    for (auto const& point : figure.points) {
        if (point.curve != c) continue;
        count(point);
        for (auto const& name : joined)
            for (Point const* const partner : points_of(name, figure.curves, figure.points, point.x))
                count(*partner);
    }
    double sum = 0.0;
    for (auto const& [key, of_run] : seconds) sum += of_run;
    return sum;
}

}  // namespace

Figure measured(Figure const& planned, Results const& results, double fraction) {
    bool const whole = fraction == 1.0;
    Figure figure = planned;
    std::vector<Point> points;
    std::set<std::string> counted;
    for (auto& point : figure.points) {
        std::vector<Record> records;
        for (auto const& scene : point.runs) {
            auto const& result = *results.at(scene.key());
            double const seconds = seconds_until(scene, result, fraction);
            records.push_back(first_part(result.record, fraction));
            point.seconds += seconds;
            if (counted.insert(scene.key()).second) figure.seconds += seconds;
        }
        point.quantities = analyze(point.runs.front(), records);
        point.configuration = records.front().configuration;
        auto const& curve = figure.curves[point.curve];
        if (curve.record.empty())
            points.push_back(point);
        else if (!append_bins(points, curve, point, records) && whole)
            throw InputError(fmt::format("curve {}: its scene does not measure {}, or not from {:g} to {:g}",
                                         curve.name, curve.record, curve.from, curve.to));
    }
    for (auto& point : points) {
        try {
            join(figure.curves[point.curve].join, figure.curves, points, point);
        } catch (std::logic_error const&) {
            // a closed form refuses a viscosity that is not yet positive
            if (whole) throw;
        }
    }
    figure.points = std::move(points);
    for (std::size_t c = 0; c < figure.curves.size(); ++c)
        figure.curves[c].seconds = seconds_of(figure, c, results, fraction);
    return figure;
}

std::optional<RunTime> run_points(std::vector<Figure>& figures, CampaignOptions const& options) {
    std::filesystem::create_directories(options.cache);
    // scenes that several points share run once
    std::map<std::string, Scene const*> scenes;
    for (auto const& figure : figures)
        for (auto const& point : figure.points)
            for (auto const& scene : point.runs) scenes.emplace(scene.key(), &scene);
    std::map<std::string, RunResult> finished;
    std::vector<Job> jobs;
    for (auto const& [key, scene] : scenes) {
        auto const file = options.cache / (key + ".h5");
        jobs.push_back(
            {cost_of(*scene), [&options, file, scene = scene, &result = finished[key]](auto const& report) {
                 result = run(*scene, {.output = file, .stop = options.stop, .progress = report});
                 return result.from_cache;
             }});
    }
    std::stable_sort(jobs.begin(), jobs.end(), [](Job const& a, Job const& b) { return a.cost > b.cost; });
    if (!do_jobs("figures", std::move(jobs), options)) return {};
    Results results;
    RunTime run_time;
    for (auto const& [key, result] : finished) {
        results[key] = &result;
        ++run_time.runs;
        run_time.seconds += result.seconds;
    }
    for (auto& figure : figures) {
        auto convergence = converge(figure, results);
        figure = measured(figure, results);
        figure.convergence = std::move(convergence);
    }
    return run_time;
}

namespace {

// A quantity of point p. An exponent is the slope in logarithms from the point before.
std::optional<Estimate> estimate_at(Figure const& figure, std::size_t p, std::string_view name) {
    auto const& point = figure.points[p];
    bool const exponent = name.starts_with(exponent_prefix);
    if (exponent) name.remove_prefix(exponent_prefix.size());
    Quantity const* const quantity = find_quantity(point.quantities, name);
    if (!quantity) return {};
    if (!exponent) return quantity->estimate;
    auto const before = estimate_at(figure, p - 1, name);
    if (!before) return {};
    Estimate const& here = quantity->estimate;
    double const span = std::log(point.x / figure.points[p - 1].x);
    return Estimate{
        .value = std::log(here.value / before->value) / span,
        .error = std::hypot(here.error / here.value, before->error / before->value) / std::abs(span),
        .blocks = std::min(here.blocks, before->blocks)};
}

}  // namespace

std::optional<Comparison> compare_point(Figure const& figure, std::size_t p, Criterion const& criterion) {
    auto const& point = figure.points[p];
    auto const& curve = figure.curves[point.curve];
    bool const first = p == 0 || figure.points[p - 1].curve != point.curve;
    if (first && (criterion.theory == "previous" || criterion.quantity.starts_with(exponent_prefix)))
        return {};
    auto const estimate = estimate_at(figure, p, criterion.quantity);
    if (!estimate)
        throw InputError(fmt::format("figure {}, curve {}: its scene does not measure {}", figure.id,
                                     curve.name, criterion.quantity));
    Comparison comparison{.figure = figure.id, .curve = curve.name, .parameter = curve.parameter};
    comparison.x = point.x;
    comparison.criterion = criterion;
    comparison.estimate = *estimate;
    comparison.runs = point.runs.size();
    comparison.seconds = point.seconds;
    if (criterion.theory == "previous") {
        auto const previous = *estimate_at(figure, p - 1, criterion.quantity);
        comparison.theory = previous.value;
        comparison.theory_error = previous.error;
    } else if (criterion.theory == "value") {
        comparison.theory = criterion.value;
    } else if (criterion.theory.starts_with("curve:")) {
        auto const others = points_of(criterion.theory.substr(6), figure.curves, figure.points, point.x);
        Quantity const* const reference =
            others.empty() ? nullptr : find_quantity(others.front()->quantities, criterion.quantity);
        if (!reference)
            throw InputError(fmt::format("figure {}, curve {}: {} has no {} at {}", figure.id, curve.name,
                                         criterion.theory, criterion.quantity, point.x));
        comparison.theory = reference->estimate.value;
        comparison.theory_error = reference->estimate.error;
    } else if (criterion.theory.starts_with("quantity:")) {
        Quantity const* const reference =
            find_quantity(point.quantities, std::string_view(criterion.theory).substr(9));
        if (!reference)
            throw InputError(fmt::format("figure {}, curve {}: no {} at {}", figure.id, curve.name,
                                         criterion.theory, point.x));
        comparison.theory = reference->estimate.value;
        comparison.theory_error = reference->estimate.error;
    } else {
        comparison.theory = theory_for(point.runs.front(), criterion.theory);
    }
    return comparison;
}

std::vector<Comparison> compare(Figure const& figure) {
    std::vector<Comparison> comparisons;
    for (std::size_t p = 0; p < figure.points.size(); ++p)
        for (auto const& criterion : figure.curves[figure.points[p].curve].criteria)
            if (auto comparison = compare_point(figure, p, criterion))
                comparisons.push_back(std::move(*comparison));
    return comparisons;
}

namespace {

// The measured value with the error of its difference from the theory (a measured reference has an error
// too).
Estimate against_theory(Comparison const& comparison) {
    Estimate estimate = comparison.estimate;
    estimate.error = std::hypot(estimate.error, comparison.theory_error);
    return estimate;
}

// How far the value lies on the allowed side of a bound, in units of the confidence interval's half width.
double clearance(Comparison const& comparison, double false_alarm) {
    Estimate const estimate = against_theory(comparison);
    double const side = comparison.criterion.relation == Relation::at_least ? 1.0 : -1.0;
    return side * (estimate.value - comparison.theory) /
           (critical_z(false_alarm, estimate.blocks) * estimate.error);
}

double false_alarm_of_one(std::size_t family) {
    return family_false_alarm / double(std::max<std::size_t>(1, family));
}

}  // namespace

Verdict judge(Comparison const& comparison, std::size_t family) {
    auto const& criterion = comparison.criterion;
    double const false_alarm = false_alarm_of_one(family);
    if (criterion.relation == Relation::differs) {
        Verdict const same =
            judge(against_theory(comparison), comparison.theory, criterion.tolerance, 0.0, false_alarm);
        return same == Verdict::disagrees ? Verdict::agrees
               : same == Verdict::agrees  ? Verdict::disagrees
                                          : Verdict::undecided;
    }
    if (criterion.relation != Relation::equal) {
        double const clear = clearance(comparison, false_alarm);
        if (clear > 1.0) return Verdict::agrees;
        // near the bound, or on the wrong side within the error, the sharpness decides as for an equality
        if (clear >= 0.0 &&
            against_theory(comparison).error <= criterion.resolution * std::abs(comparison.theory))
            return Verdict::agrees;
    }
    return judge(against_theory(comparison), comparison.theory, criterion.tolerance, criterion.resolution,
                 false_alarm);
}

double seconds_to_decide(Comparison const& comparison, std::size_t family) {
    auto const& criterion = comparison.criterion;
    double const false_alarm = false_alarm_of_one(family);
    if (judge(comparison, family) != Verdict::undecided) return 0.0;
    double factor = time_factor_to_decide(
        against_theory(comparison), comparison.theory, criterion.tolerance,
        criterion.relation == Relation::differs ? 0.0 : criterion.resolution, false_alarm);
    // a bound is also decided once the value clears it
    if (criterion.relation == Relation::at_most || criterion.relation == Relation::at_least)
        factor = std::min(factor, std::pow(clearance(comparison, false_alarm), -2));
    return comparison.seconds * (factor - 1.0);
}

// --- output ----------------------------------------------------------------------------------------------

namespace {

Json to_json(Comparison const& c) {
    return {{"figure", c.figure},
            {"curve", c.curve},
            {"parameter", c.parameter},
            {"x", c.x},
            {"quantity", c.criterion.quantity},
            {"value", c.estimate.value},
            {"error", c.estimate.error},
            {"blocks", c.estimate.blocks},
            {"inefficiency", c.estimate.inefficiency},
            {"theory", c.criterion.theory},
            {"theory_value", c.theory},
            {"theory_error", c.theory_error},
            {"relation", name_of(c.criterion.relation)},
            {"tolerance", c.criterion.tolerance},
            {"resolution", c.criterion.resolution},
            {"runs", c.runs},
            {"seconds", c.seconds}};
}

// JSON has no NaN and writes null.
double number_or_nan(Json const& json) { return json.is_null() ? std::nan("") : json.get<double>(); }

Comparison from_json(Json const& json) {
    Comparison c;
    c.figure = json.at("figure");
    c.curve = json.at("curve");
    c.parameter = json.at("parameter");
    c.x = json.at("x");
    c.criterion.quantity = json.at("quantity");
    c.estimate.value = json.at("value");
    c.estimate.error = number_or_nan(json.at("error"));
    c.estimate.blocks = json.at("blocks");
    c.estimate.inefficiency = json.at("inefficiency");
    c.criterion.theory = json.at("theory");
    c.theory = json.at("theory_value");
    c.theory_error = number_or_nan(json.at("theory_error"));
    c.criterion.relation = relation_from_name(json.at("relation").get<std::string>());
    c.criterion.tolerance = json.at("tolerance");
    c.criterion.resolution = json.at("resolution");
    c.runs = json.at("runs");
    c.seconds = json.at("seconds");
    return c;
}

// Name of a part of the data files, for gnuplot's `index`.
std::string part_name(std::string const& curve, Criterion const& criterion) {
    return fmt::format("{}:{}:{}", curve, criterion.quantity, criterion.theory);
}

// Closed forms along each curve, for the lines of the plot.
std::string theory_lines(Figure const& figure) {
    constexpr int samples = 100;
    constexpr double logarithmic_from = 8.0;  // ratio of the ends
    std::string text;
    for (std::size_t c = 0; c < figure.curves.size(); ++c) {
        auto const& curve = figure.curves[c];
        Scene const* base = nullptr;
        double low = INFINITY, high = -INFINITY;
        for (auto const& point : figure.points) {
            if (point.curve != c) continue;
            base = &point.runs.front();
            low = std::min(low, point.x);
            high = std::max(high, point.x);
        }
        if (!curve.line.empty()) low = curve.line[0], high = curve.line[1];
        if (!base || !(low < high)) continue;
        bool const logarithmic = low > 0.0 && high / low > logarithmic_from;
        for (auto const& criterion : curve.criteria) {
            if (theory::find(criterion.theory) == nullptr || !curve.record.empty()) continue;
            text += fmt::format("# {}\n", part_name(curve.name, criterion));
            for (int s = 0; s <= samples; ++s) {
                double const t = double(s) / samples;
                double const x = logarithmic ? low * std::pow(high / low, t) : low + (high - low) * t;
                Scene const scene =
                    parse_scene(base->text, "theory line", {fmt::format("{}={}", curve.parameter, x)});
                text += fmt::format("{:.10g} {:.10g}\n", x, theory_for(scene, criterion.theory));
            }
            text += "\n\n";
        }
    }
    return text;
}

// What a figure regenerates: "NG2007 Fig. 2", or what it is about where its number is none.
std::string source_of(Figure const& figure) {
    bool const numbered =
        !figure.number.empty() && figure.number.front() >= '0' && figure.number.front() <= '9';
    return fmt::format("{}{} {}", figure.paper, numbered ? " Fig." : ",", figure.number);
}

// Breaks a caption into lines that fit below the plot.
std::string wrapped(std::string const& text) {
    constexpr std::size_t width = 105;
    std::istringstream words(text);
    std::string word, line, result;
    while (words >> word) {
        if (!line.empty() && line.size() + 1 + word.size() > width) {
            result += line + "\n";
            line.clear();
        }
        line += (line.empty() ? "" : " ") + word;
    }
    return result + line;
}

constexpr std::size_t most_shown = 7;  // colours that stay distinct

// The curves of the companion picture, the most telling ones first.
std::vector<Convergence const*> shown_of(std::vector<Convergence> const& convergence) {
    auto const checks = [](Convergence const* c) {
        return c->criterion.quantity.find("temperature") != std::string::npos;
    };
    // one criterion per curve; a temperature, which most curves check, only where there is nothing else
    std::vector<Convergence const*> shown;
    for (auto const& c : convergence) {
        if (c.states.empty()) continue;
        if (shown.empty() || shown.back()->curve != c.curve)
            shown.push_back(&c);
        else if (checks(shown.back()) && !checks(&c))
            shown.back() = &c;
    }
    std::stable_partition(shown.begin(), shown.end(), [&](auto const* c) { return !checks(c); });
    if (shown.size() > most_shown) shown.resize(most_shown);
    return shown;
}

// What a curve of the companion picture is, in words.
std::string legend(FigureCurve const& curve, Convergence const& c) {
    std::string const& theory = c.criterion.theory;
    std::string text = fmt::format(
        "{}: {} against {}", curve.name, c.criterion.quantity,
        theory == "value" ? fmt::format("{:g}", c.criterion.value) : theory.substr(theory.find(':') + 1));
    std::replace(text.begin(), text.end(), '_', ' ');
    if (c.floor_resolved)
        text += fmt::format(", floor {:.3g} ± {:.2g} %", 100.0 * c.floor, 100.0 * c.floor_error);
    return text;
}

// Data of the errors against the run time; and the picture, where definitions come with a convergence.gp.
void write_convergence(Figure const& figure, std::string const& budget, std::filesystem::path const& output) {
    auto const shown = shown_of(figure.convergence);
    if (shown.empty()) return;
    std::string const name = figure.id + ".convergence";
    auto const data = output / "data" / (name + ".dat");
    std::string text = fmt::format(
        "# {} figure {}, budget {}; dpdref {}, engine revision {}\n"
        "# columns: seconds, rms relative error, rms relative deviation, points; of a floor: seconds, floor, "
        "its standard error, resolved\n\n\n",
        figure.paper, figure.number, budget, version, engine_revision);
    for (auto const& c : figure.convergence) {
        if (c.states.empty()) continue;
        std::string const part = part_name(figure.curves[c.curve].name, c.criterion);
        text += fmt::format("# {}\n", part);
        for (auto const& state : c.states)
            text += fmt::format("{:.6g} {:.4g} {:.4g} {}\n", state.seconds, state.error, state.deviation,
                                state.points);
        text += fmt::format("\n\n# floor:{}\n{:.6g} {:.4g} {:.2g} {:d}\n\n\n", part, c.states.back().seconds,
                            c.floor, c.floor_error, c.floor_resolved);
    }
    write_file(data, text);
    auto const plot = find_above(figure.directory, "convergence.gp");
    if (!plot) return;

    std::vector<std::string> parts, titles;
    double least = INFINITY, first = INFINITY, last = 0.0;  // smallest error; range of the run time
    for (Convergence const* const c : shown) {
        auto const& curve = figure.curves[c->curve];
        parts.push_back(quoted(part_name(curve.name, c->criterion)));
        titles.push_back(quoted(legend(curve, *c)));
        first = std::min(first, c->states.front().seconds);
        last = std::max(last, c->states.back().seconds);
        for (auto const& state : c->states)
            if (state.error > 0.0) least = std::min(least, state.error);
    }
    std::string const caption = fmt::format(
        "{}: error against run time ({} budget). Symbols: root mean square, over a curve's "
        "points, of the relative deviation from the theory; dashed: of the relative standard error; "
        "grey: falling as the inverse root of the run time. Bars at the right: floor, the part of the "
        "deviation that the error does not explain. Of each curve the first criterion, of a temperature "
        "only where there is no other; at most {}; all are in the data.",
        source_of(figure), budget, most_shown);
    draw(output / name, *plot,
         fmt::format("title_text = {}\ndata = {}\ncaption = {}\ncurves = {}\narray part[curves] = [{}]\n"
                     "array legend[curves] = [{}]\nleast = {:g}\nfirst = {:g}\nlast = {:g}\n",
                     quoted(figure.title), quoted(data.string()), quoted(wrapped(caption)), shown.size(),
                     fmt::join(parts, ", "), fmt::join(titles, ", "), least, first, last));
}

}  // namespace

void write_figure(Figure const& figure, std::vector<Comparison> const& comparisons, std::string const& budget,
                  std::filesystem::path const& output) {
    std::filesystem::create_directories(output / "data");
    auto const data = output / "data" / (figure.id + ".dat");
    auto const lines = output / "data" / (figure.id + ".theory.dat");

    double const seconds = figure.seconds;
    std::map<std::string, std::string> blocks;
    std::vector<std::string> order;
    for (auto const& c : comparisons) {
        std::string const name = part_name(c.curve, c.criterion);
        if (!blocks.contains(name)) order.push_back(name);
        double const scale = c.theory != 0.0 ? 1.0 / c.theory : 1.0;
        blocks[name] +=
            fmt::format("{:.10g} {:.10g} {:.4g} {:.10g} {:.6g} {:.4g} {} {} {:.1f}\n", c.x, c.estimate.value,
                        c.estimate.error, c.theory, (c.estimate.value - c.theory) * scale,
                        std::hypot(c.estimate.error, c.theory_error) * std::abs(scale), c.estimate.blocks,
                        name_of(judge(c, comparisons.size())), c.seconds);
    }
    std::string text = fmt::format(
        "# {} figure {}, budget {}; dpdref {}, engine revision {}; run time {:.0f} s\n"
        "# columns: x, value, standard error, theory, relative deviation, its error, blocks, verdict, "
        "seconds\n\n\n",
        figure.paper, figure.number, budget, version, engine_revision, seconds);
    for (auto const& name : order) text += fmt::format("# {}\n{}\n\n", name, blocks[name]);
    // everything measured, compared or not: x, value, standard error
    for (std::size_t c = 0; c < figure.curves.size(); ++c) {
        std::map<std::string, std::string> measured;
        for (auto const& point : figure.points)
            if (point.curve == c)
                for (auto const& [quantity, estimate] : point.quantities)
                    measured[quantity] +=
                        fmt::format("{:.10g} {:.10g} {:.4g}\n", point.x, estimate.value, estimate.error);
        for (auto const& [quantity, rows] : measured)
            text += fmt::format("# all:{}:{}\n{}\n\n", figure.curves[c].name, quantity, rows);
    }
    for (auto const& point : figure.points) {
        if (point.configuration.size() == 0) continue;
        std::string rows = "# box";
        for (double const side : point.runs.front().length) rows += fmt::format(" {:.6g}", side);
        for (Eigen::Index p = 0; p < point.configuration.rows(); ++p) {
            rows += '\n';
            for (double const x : point.configuration.row(p)) rows += fmt::format("{:.4f} ", x);
        }
        text +=
            fmt::format("# configuration:{}:{:g}\n{}\n\n\n", figure.curves[point.curve].name, point.x, rows);
    }
    write_file(data, text);
    write_file(lines, theory_lines(figure));

    Json json{{"figure", figure.id},
              {"paper", figure.paper},
              {"number", figure.number},
              {"budget", budget},
              {"engine_revision", engine_revision},
              {"seconds", seconds}};
    for (auto const& c : comparisons) json["comparisons"].push_back(to_json(c));
    write_file(output / "data" / (figure.id + ".json"), json.dump(1) + "\n");

    draw(output / figure.id, figure.directory / "plot.gp",
         fmt::format("title_text = {}\ndata = {}\nlines = {}\ncaption = {}\n", quoted(figure.title),
                     quoted(data.string()), quoted(lines.string()),
                     quoted(wrapped(fmt::format("{}. {} Run time {} ({} budget).", source_of(figure),
                                                figure.caption, duration_text(seconds), budget)))));
    write_convergence(figure, budget, output);
}

std::vector<Comparison> load_comparisons(std::filesystem::path const& output) {
    std::vector<Comparison> comparisons;
    std::vector<std::filesystem::path> files;
    std::error_code ignored;
    for (auto const& entry : std::filesystem::directory_iterator(output / "data", ignored))
        if (entry.path().extension() == ".json" && entry.path().stem() != "report")
            files.push_back(entry.path());
    // as `figure all` orders them
    std::sort(files.begin(), files.end(), [](auto const& a, auto const& b) { return a.stem() < b.stem(); });
    for (auto const& file : files) {
        try {
            Json const content = Json::parse(read_file(file));
            for (auto const& json : content.at("comparisons")) comparisons.push_back(from_json(json));
        } catch (Json::exception const& error) {
            throw InputError(fmt::format("{}: {}", file.string(), error.what()));
        }
    }
    return comparisons;
}

void write_run_time(RunTime const& run_time, std::string const& budget, std::filesystem::path const& output) {
    Json const json{{"budget", budget}, {"runs", run_time.runs}, {"seconds", run_time.seconds}};
    std::filesystem::create_directories(output);
    write_file(output / "run_time.json", json.dump(1) + "\n");
}

namespace {

void print_run_time(std::filesystem::path const& file) {
    if (!std::filesystem::exists(file)) return;
    try {
        Json const json = Json::parse(read_file(file));
        fmt::print("run time of the {} budget: {} runs, {} on one core\n",
                   json.at("budget").get<std::string>(), json.at("runs").get<std::size_t>(),
                   duration_text(json.at("seconds")));
    } catch (Json::exception const& error) {
        throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    }
}

}  // namespace

bool report(std::vector<Comparison> const& comparisons, std::filesystem::path const& output) {
    std::string csv =
        "figure,curve,parameter,x,quantity,value,error,relation,theory,theory_value,deviation_percent,z,"
        "tolerance,verdict,seconds,seconds_to_1_percent,more_seconds_to_decide\n";
    Json json = Json::array();
    std::map<Verdict, std::size_t> count;
    fmt::print("{:<11} {:<22} {:>8} {:<28} {:>12} {:>10} {:>12} {:>8} {:>7} {:<10} {:>8} {:>8}\n", "figure",
               "curve", "x", "quantity", "value", "error", "theory", "dev. %", "z", "verdict", "time",
               "to 1 %");
    for (auto const& c : comparisons) {
        Verdict const verdict = judge(c, comparisons.size());
        ++count[verdict];
        double const error = std::hypot(c.estimate.error, c.theory_error);
        double const z = error > 0.0 ? (c.estimate.value - c.theory) / error : 0.0;
        double const deviation = c.theory != 0.0 ? 100.0 * (c.estimate.value / c.theory - 1.0) : 0.0;
        double const to_one_percent = c.seconds * std::pow(c.estimate.error / (0.01 * c.estimate.value), 2);
        double const more = seconds_to_decide(c, comparisons.size());
        fmt::print(
            "{:<11} {:<22} {:>8.4g} {:<28} {:>12.6g} {:>10.2g} {:>12.6g} {:>8.2f} {:>7.1f} {:<10} {:>8} "
            "{:>8}\n",
            c.figure, c.curve, c.x, c.criterion.quantity, c.estimate.value, c.estimate.error, c.theory,
            deviation, z, name_of(verdict), duration_text(c.seconds), duration_text(to_one_percent));
        if (verdict == Verdict::undecided)
            fmt::print("{:>11} {} more would decide\n", "",
                       std::isfinite(more) ? duration_text(more) : "no run time");
        csv += fmt::format("{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", c.figure, c.curve,
                           c.parameter, c.x, c.criterion.quantity, c.estimate.value, c.estimate.error,
                           name_of(c.criterion.relation), c.criterion.theory, c.theory, deviation, z,
                           c.criterion.tolerance, name_of(verdict), c.seconds, to_one_percent, more);
        Json row = to_json(c);
        row["z"] = z;
        row["verdict"] = name_of(verdict);
        row["seconds_to_1_percent"] = to_one_percent;
        row["more_seconds_to_decide"] = more;
        json.push_back(std::move(row));
    }
    fmt::print(
        "{} comparisons: {} agree, {} disagree, {} undecided; false-alarm rate of the whole table {} %\n",
        comparisons.size(), count[Verdict::agrees], count[Verdict::disagrees], count[Verdict::undecided],
        100.0 * family_false_alarm);
    print_run_time(output / "run_time.json");
    print_run_time(output / "quick" / "run_time.json");
    write_file(output / "report.csv", csv);
    write_file(output / "report.json", json.dump(1) + "\n");
    return count[Verdict::disagrees] == 0;
}

}  // namespace dpd
