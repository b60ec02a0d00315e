#include "compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <span>

#include "archive.hpp"
#include "conventions.hpp"
#include "errors.hpp"
#include "files.hpp"
#include "judge_figure.hpp"
#include "run.hpp"
#include "toml_reader.hpp"

namespace dpd {
namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

}  // namespace

// --- options ---------------------------------------------------------------------------------------------

Renaming renaming_from_text(std::string const& text) {
    auto const equals = text.find('=');
    auto const times = text.find('*', equals == std::string::npos ? 0 : equals);
    Renaming renaming{.column = text.substr(0, equals), .quantity = {}};
    if (equals != std::string::npos) renaming.quantity = text.substr(equals + 1, times - equals - 1);
    auto const factor = times == std::string::npos ? 1.0 : to_number(text.substr(times + 1));
    if (renaming.column.empty() || renaming.quantity.empty() || !factor || !std::isfinite(*factor) ||
        *factor == 0.0)
        throw InputError(
            fmt::format("--as: {} is not allowed; allowed: COLUMN=quantity or COLUMN=quantity*factor", text));
    renaming.factor = *factor;
    return renaming;
}

Discard discard_from_text(std::string const& text) {
    bool const percent = text.ends_with('%');
    auto const amount = to_number(percent ? text.substr(0, text.size() - 1) : text);
    if (!amount || !std::isfinite(*amount) || (percent && !(*amount >= 0.0 && *amount < 100.0)))
        throw InputError(fmt::format(
            "--discard: {} is not allowed; allowed: a time or step of the file, or 0% to 99%", text));
    return {.share = percent ? *amount / 100.0 : 0.0, .before = percent ? -INFINITY : *amount};
}

// --- references ------------------------------------------------------------------------------------------

namespace {

void describe(Reference& reference, Scene const& scene) {
    reference.components = diffusing_components(scene);
    reference.dimension = scene.dimension;
    reference.particles = scene.particles;
    reference.thermostat_forces = scene.stage<ModifiedVerlet>() || scene.stage<EulerImpulses>();
}

}  // namespace

Reference answer_reference(std::filesystem::path const& answers, std::string const& id) {
    try {
        Json const json = Json::parse(read_file(answers));
        if (json.at("schema") != "dpdref-answers/1")
            throw InputError(fmt::format("{}: schema {}; allowed: dpdref-answers/1", answers.string(),
                                         json.at("schema").dump()));
        Words ids;
        for (auto const& state : json.at("states")) {
            ids.push_back(state.at("id"));
            if (ids.back() != id) continue;
            Reference reference{.name = fmt::format("answer {}", id), .quantities = {}};
            auto const estimate = [](Json const& value, Json const& error, Json const& blocks) {
                return Estimate{.value = value,
                                .error = error.is_number() ? error.get<double>() : std::nan(""),
                                .blocks = blocks};
            };
            for (auto const& [name, q] : state.at("quantities").items())
                reference.quantities.push_back(
                    {name, estimate(q.at("value"), q.at("error"), q.at("blocks"))});
            if (state.contains("curves") && state.at("curves").contains("radial_distribution")) {
                auto const& g = state.at("curves").at("radial_distribution");
                reference.radial_distribution.x = g.at("x").get<std::vector<double>>();
                for (std::size_t bin = 0; bin < reference.radial_distribution.x.size(); ++bin)
                    reference.radial_distribution.y.push_back(
                        estimate(g.at("value").at(bin), g.at("error").at(bin),
                                 g.contains("blocks") ? g.at("blocks").at(bin) : Json(many_blocks)));
            }
            for (auto const& [which, text] : state.at("scenes").items()) {
                Scene const scene = parse_scene(text, fmt::format("{}: {} {}", answers.string(), id, which));
                if (which == "rest") describe(reference, scene);
                if (which == "shear") reference.shear_rate = scene.shear_rate;
            }
            return reference;
        }
        throw InputError(fmt::format("--answer: {} is unknown; allowed: {}", id, fmt::join(ids, ", ")));
    } catch (Json::exception const& error) {
        throw InputError(fmt::format("{}: {}", answers.string(), one_line(error.what())));
    }
}

Reference run_reference(std::filesystem::path const& file) {
    std::string text, status;
    std::uint64_t seed = 0;
    {
        Archive archive(file, Archive::Mode::read);
        if (archive.has("dpdref/status")) archive("dpdref/status", status);
        if (status != "complete")
            throw InputError(fmt::format("{}: is not allowed; allowed: a finished result of dpdref run --out",
                                         file.string()));
        archive("dpdref/scene", text);
        archive("dpdref/seed", seed);
    }
    Scene const scene = parse_scene(text, file.string(), {}, seed);
    std::vector<Record> const records{run(scene, {.output = file, .progress = {}}).record};
    Reference reference{.name = file.string(),
                        .quantities = analyze(scene, records),
                        .radial_distribution = curve_of(scene, records, "radial_distribution"),
                        .shear_rate = scene.shear_rate};
    describe(reference, scene);
    return reference;
}

// --- averages --------------------------------------------------------------------------------------------

namespace {

// What other codes call that which dpdref measures, too.
struct Alias {
    enum Of { intensive, per_particle, all_particles };  // per_particle: if a LAMMPS log's energies are
    std::string_view column, quantity;
    Of of = intensive;
    double factor = 1.0;
};

constexpr std::string_view lammps_pressure = "lammps_pressure";

// OpenMM counts energy in kJ/mol; so does its kT, which is then in the unit that its parameters have.
constexpr std::array<Alias, 9> foreign_names{
    {{"Temp", "kinetic_temperature"},
     {"c_thermo_temp", "kinetic_temperature"},
     {"Press", lammps_pressure},
     {"c_thermo_press", lammps_pressure},
     {"PotEng", "potential_energy", Alias::per_particle},
     {"E_pair", "potential_energy", Alias::per_particle},
     {"c_thermo_pe", "potential_energy", Alias::all_particles},
     {"Potential Energy (kJ/mole)", "potential_energy", Alias::all_particles},
     {"Temperature (K)", "kinetic_temperature", Alias::intensive, gas_constant}}};

bool is_known(Reference const& reference, std::string_view name) {
    return name == "stress_xy" || find_quantity(reference.quantities, name);
}

// A column's quantity and factor.
Renaming named(std::string const& column, bool per_particle, Reference const& reference,
               std::vector<Renaming> const& renamings) {
    for (auto const& renaming : renamings)
        if (renaming.column == column) return renaming;
    if (is_known(reference, column)) return {column, column};
    for (auto const& alias : foreign_names) {
        if (alias.column != column || (alias.of == Alias::per_particle && !per_particle)) continue;
        // with friction and noise in its virial it is another quantity
        bool const pressure = alias.quantity == lammps_pressure && !reference.thermostat_forces;
        bool const sum = alias.of == Alias::all_particles && reference.particles > 0;
        return {column, pressure ? "pressure" : std::string(alias.quantity),
                sum ? alias.factor / double(reference.particles) : alias.factor};
    }
    if (column.starts_with("v_") || column.starts_with("c_"))
        if (auto const name = column.substr(2); is_known(reference, name)) return {column, name};
    if (auto const name = bare(column); is_known(reference, name)) return {column, name};
    return {column, column};
}

// In a shear flow: the viscosity that a stress is, over the rate.
void make_viscosity(Renaming& renaming, double shear_rate) {
    static constexpr std::string_view suffix = "_stress";
    std::string& name = renaming.quantity;
    if (shear_rate == 0.0) return;
    if (name == "stress_xy")
        name = "viscosity";
    else if (name == "kinetic_stress" || name == "collision_stress" || name == "potential_stress")
        name = name.substr(0, name.size() - suffix.size()) + "_viscosity";
    else
        return;
    renaming.factor /= shear_rate;
}

std::vector<double> const* find_series(CodeOutput const& output, std::string_view name) {
    for (auto const& [column, samples] : output.series)
        if (column == name) return &samples;
    return nullptr;
}

// One diffusion constant for each origin whose lags are there to the longest: the slope over their second
// half.
std::vector<double> diffusion_by_origin(std::vector<double> const& lag, std::vector<double> const& squares,
                                        std::size_t first, int components) {
    std::vector<double> constants;
    double const longest = lag.empty() ? 0.0 : *std::max_element(lag.begin(), lag.end());
    double const almost = 1.0 - 1e-9;
    std::optional<std::size_t> middle;
    for (std::size_t k = first; k < lag.size(); ++k) {
        if (k > first && lag[k] <= lag[k - 1]) middle.reset();
        if (lag[k] * almost <= 0.5 * longest)
            middle = k;
        else if (middle && lag[k] >= longest * almost)
            constants.push_back((squares[k] - squares[*middle]) /
                                (2.0 * components * (lag[k] - lag[*middle])));
    }
    return constants;
}

// How many of a file's first samples, `size` in all, are left out.
std::size_t discarded(CodeOutput const& output, std::size_t size, Discard const& discard) {
    bool const by_time = discard.before > -INFINITY;
    if (size == 0) return 0;
    if (by_time && output.axis.empty())
        throw InputError(fmt::format(
            "{}: --discard: there is no column of times or steps; allowed: a share, as 20%", output.file));
    auto first = static_cast<std::size_t>(discard.share * double(size));
    while (by_time && first < size && output.at[first] < discard.before) ++first;
    if (first == size)
        throw InputError(fmt::format("{}: --discard: leaves nothing; allowed: less than all", output.file));
    return first;
}

// Whether the halves of a series differ by more than chance allows in one of `family` series.
bool drifts(std::vector<double> const& samples, std::size_t family) {
    std::span<double const> const all(samples);
    auto const gap = difference(blocking(all.first(all.size() / 2)), blocking(all.last(all.size() / 2)));
    double const allowed = critical_z(family_false_alarm / double(family), gap.blocks) * gap.error;
    return std::isfinite(allowed) && std::abs(gap.value) > allowed;
}

}  // namespace

Averages average(std::vector<CodeOutput> const& outputs, Reference const& reference,
                 std::vector<Renaming> const& renamings, Discard const& discard, bool sheared) {
    Averages averages;
    std::map<std::string, CodeOutput const*> source;  // of each quantity
    std::set<std::string> columns;
    std::vector<std::pair<std::string, std::vector<double>>> kept;
    auto const add = [&](std::string const& quantity, Estimate const& estimate, CodeOutput const& from) {
        if (auto const [other, fresh] = source.emplace(quantity, &from);
            !fresh && is_known(reference, quantity))
            throw InputError(fmt::format("{}: is in {} and in {}; allowed: once (--as gives another name)",
                                         quantity, other->second->file, from.file));
        averages.quantities.push_back({quantity, estimate});
    };
    bool const has_sheared = find_quantity(reference.quantities, "sheared_kinetic_temperature");
    auto const use = [&](CodeOutput const& output, std::string const& column) {
        columns.insert(column);
        Renaming renaming = named(column, output.per_particle, reference, renamings);
        // of two names for one thing in a file, as E_pair and PotEng, the first counts
        if (renaming.quantity != column && source.contains(renaming.quantity) &&
            source[renaming.quantity] == &output &&
            std::none_of(renamings.begin(), renamings.end(),
                         [&](auto const& r) { return r.column == column; }))
            return Renaming{column, column};
        if (renaming.quantity == lammps_pressure && column != lammps_pressure)
            averages.notes.push_back(fmt::format(
                "{}: LAMMPS counts friction and noise of pair dpd in it, which makes another quantity than "
                "pressure; --as {}=pressure compares them all the same",
                column, column));
        if (renaming.factor == 1.0 / double(reference.particles))
            averages.notes.push_back(fmt::format("{}: taken for the sum over {} particles, the reference's",
                                                 column, reference.particles));
        bool const flows = sheared || output.shear_rate.value_or(0.0) != 0.0;
        if (!output.shear_rate || flows) make_viscosity(renaming, reference.shear_rate);
        // what the flow heats has a reference of its own, or none
        if (flows && has_sheared && is_known(reference, renaming.quantity) &&
            !renaming.quantity.ends_with("viscosity"))
            renaming.quantity = "sheared_" + renaming.quantity;
        return renaming;
    };
    for (auto const& output : outputs) {
        if (double const rate = output.shear_rate.value_or(0.0);
            rate != 0.0 && std::abs(rate - reference.shear_rate) > 1e-6 * std::abs(rate))
            throw InputError(fmt::format("{}: its shear rate is {:g}; allowed: {:g}, the reference's",
                                         output.file, rate, reference.shear_rate));
        averages.notes.insert(averages.notes.end(), output.notes.begin(), output.notes.end());
        for (auto const& [column, estimate] : output.values) {
            auto const [from, quantity, factor] = use(output, column);
            add(quantity,
                {.value = factor * estimate.value,
                 .error = std::abs(factor) * estimate.error,
                 .blocks = estimate.blocks},
                output);
        }
        std::size_t const samples = !output.g.empty()       ? output.g.front().size()
                                    : output.series.empty() ? 0
                                                            : output.series.front().second.size();
        std::size_t const first = discarded(output, samples, discard);
        if (samples > 0)
            averages.notes.push_back(first == 0 ? fmt::format("{}: nothing was discarded", output.file)
                                                : fmt::format("{}: the first {} of {} samples were discarded",
                                                              output.file, first, samples));
        auto const rest_of = [&](std::vector<double> const& series, double factor) {
            std::vector<double> rest;
            for (std::size_t k = discarded(output, series.size(), discard); k < series.size(); ++k)
                rest.push_back(factor * series[k]);
            return rest;
        };
        auto const *lag = find_series(output, "lag"),
                   *squares = find_series(output, "mean_square_displacement");
        for (auto const& [column, series] : output.series) {
            if (lag && squares && (&series == lag || &series == squares)) continue;
            auto const [from, quantity, factor] = use(output, column);
            auto rest = rest_of(series, factor);
            add(quantity, blocking(rest), output);
            kept.emplace_back(quantity, std::move(rest));
        }
        if (lag && squares) {
            if (lag->size() != squares->size())
                throw InputError(
                    fmt::format("{}: lag has {} values, mean_square_displacement {}; allowed: as many",
                                output.file, lag->size(), squares->size()));
            auto constants = diffusion_by_origin(*lag, *squares, first, reference.components);
            std::string const name = use(output, "diffusion_constant").quantity;
            columns.erase("diffusion_constant");
            add(name, blocking(constants), output);
            kept.emplace_back(name, std::move(constants));
        }
        if (output.g.empty() && output.curve.x.empty()) continue;
        if (has_sheared && (sheared || output.shear_rate.value_or(0.0) != 0.0)) {
            averages.notes.push_back(
                fmt::format("{}: g(r) of a shear flow, which has no reference", output.file));
            continue;
        }
        if (auto const [other, fresh] = source.emplace("radial_distribution", &output); !fresh)
            throw InputError(fmt::format("radial_distribution: is in {} and in {}; allowed: once",
                                         other->second->file, output.file));
        averages.radial_distribution = output.curve;
        if (output.g.empty()) continue;
        averages.radial_distribution.x = output.r;
        for (auto const& bin : output.g)
            averages.radial_distribution.y.push_back(blocking(rest_of(bin, 1.0)));
    }
    for (auto const& renaming : renamings)
        if (!columns.contains(renaming.column))
            throw InputError(fmt::format("--as: there is no column {}; allowed: {}", renaming.column,
                                         fmt::join(columns, ", ")));
    for (auto const& [quantity, samples] : kept)
        if (drifts(samples, kept.size()))
            averages.notes.push_back(fmt::format(
                "{}: its first and second half differ by more than chance: not in equilibrium? (--discard)",
                quantity));
    return averages;
}

// --- verdicts --------------------------------------------------------------------------------------------

namespace {

// The bin that is furthest off, with the verdict on all.
CodeComparison compare_curves(CurveEstimate const& curve, CurveEstimate const& reference, double resolution,
                              double false_alarm) {
    auto const width = [](CurveEstimate const& c) { return c.x.size() < 2 ? 0.0 : c.x[1] - c.x[0]; };
    double const close = 1e-3 * width(reference);
    double peak = 0.0;
    for (auto const& y : reference.y) peak = std::max(peak, y.value);
    std::vector<std::pair<std::size_t, std::size_t>> bins;
    for (std::size_t a = 0; a < curve.x.size(); ++a)
        for (std::size_t b = 0; b < reference.x.size(); ++b)
            if (std::abs(curve.x[a] - reference.x[b]) < close) bins.emplace_back(a, b);
    if (bins.empty() || std::abs(width(curve) - width(reference)) > close)
        throw InputError(
            fmt::format("radial_distribution: bins of width {:g} from {:g} on; allowed: those of the "
                        "reference, width {:g}, "
                        "from {:g} on",
                        width(curve), curve.x.at(0), width(reference), reference.x.at(0)));
    CodeComparison worst;
    double furthest = -1.0;
    Verdict verdict = Verdict::agrees;
    for (auto const& [a, b] : bins) {
        CodeComparison bin{.quantity = fmt::format("radial_distribution at {:.4g}", reference.x[b]),
                           .value = curve.y[a],
                           .reference = reference.y[b]};
        bin.difference = difference(bin.value, bin.reference);
        Estimate above_zero = bin.difference;  // so that the error counts against the peak
        above_zero.value += peak;
        Verdict const its = judge(above_zero, peak, 0.0, resolution, false_alarm / double(bins.size()));
        if (its == Verdict::disagrees || (its == Verdict::undecided && verdict == Verdict::agrees))
            verdict = its;
        double const off = bin.difference.error > 0.0 ? std::abs(bin.z()) : 0.0;
        if (off > furthest) {
            furthest = off;
            worst = bin;
        }
    }
    worst.verdict = verdict;
    return worst;
}

// What the ratio of two values that disagree looks like; empty for none that is known.
std::string hint(CodeComparison const& comparison, Reference const& reference) {
    struct Mistake {
        std::string_view quantity;
        double factor;
        std::string_view what;
    };
    auto const d = double(reference.dimension), N = double(reference.particles);
    std::array<Mistake, 6> const mistakes{{{"kinetic_temperature", d, "not divided by the dimension?"},
                                           {"kinetic_temperature", 0.5 * d, "the kinetic energy itself?"},
                                           {"potential_energy", 2.0, "each pair counted twice?"},
                                           {"potential_energy", N, "not divided by the number of particles?"},
                                           {"diffusion_constant", 2.0, "not divided by 2?"},
                                           {"diffusion_constant", d, "not divided by the dimension?"}}};
    double const ratio = comparison.value.value / comparison.reference.value;
    for (auto const& [quantity, factor, what] : mistakes)
        if (quantity == comparison.quantity && std::abs(ratio / factor - 1.0) < 0.05)
            return fmt::format("{}: {:.4g} times the reference: {}", quantity, ratio, what);
    return {};
}

}  // namespace

CodeReport compare(Averages const& averages, Reference const& reference, double resolution) {
    CodeReport report;
    for (auto const& [name, estimate] : averages.quantities) {
        auto const* const known = find_quantity(reference.quantities, name);
        if (known && known->estimate.blocks > 1)
            report.comparisons.push_back({.quantity = name,
                                          .value = estimate,
                                          .reference = known->estimate,
                                          .difference = difference(estimate, known->estimate)});
        else
            report.without_reference.push_back({name, estimate});
    }
    bool const curves = !averages.radial_distribution.x.empty() && !reference.radial_distribution.x.empty();
    double const share =
        family_false_alarm / double(std::max<std::size_t>(1, report.comparisons.size() + curves));
    for (auto& c : report.comparisons) {
        Estimate value = c.difference;
        value.value = c.value.value;
        c.verdict = judge(value, c.reference.value, 0.0, resolution, share);
        // with few blocks critical t is large: a small error alone does not make the interval narrow
        double const half_width = critical_z(share, value.blocks) * value.error;
        if (c.verdict == Verdict::agrees && half_width > resolution * std::abs(c.reference.value))
            c.verdict = Verdict::undecided;
        if (auto text = hint(c, reference); c.verdict == Verdict::disagrees && !text.empty())
            report.hints.push_back(std::move(text));
    }
    if (curves)
        report.comparisons.push_back(
            compare_curves(averages.radial_distribution, reference.radial_distribution, resolution, share));
    for (auto const& quantity : reference.quantities)
        if (!find_quantity(averages.quantities, quantity.name)) report.not_measured.push_back(quantity.name);
    if (!curves && !reference.radial_distribution.x.empty())
        report.not_measured.emplace_back("radial_distribution");
    return report;
}

bool print(CodeReport const& report, Averages const& averages, Reference const& reference, bool json) {
    std::map<Verdict, std::size_t> count;
    for (auto const& c : report.comparisons) ++count[c.verdict];
    bool const agrees = count[Verdict::disagrees] == 0;
    if (json) {
        Json output{{"reference", reference.name}, {"false_alarm_rate", family_false_alarm}};
        output["comparisons"] = Json::array();
        for (auto const& c : report.comparisons)
            output["comparisons"].push_back({{"quantity", c.quantity},
                                             {"value", c.value.value},
                                             {"error", c.value.error},
                                             {"blocks", c.value.blocks},
                                             {"reference", c.reference.value},
                                             {"reference_error", c.reference.error},
                                             {"combined_error", c.difference.error},
                                             {"degrees_of_freedom", c.difference.blocks - 1},
                                             {"z", c.z()},
                                             {"verdict", name_of(c.verdict)}});
        output["without_reference"] = Json::array();
        for (auto const& [name, estimate] : report.without_reference)
            output["without_reference"].push_back({{"quantity", name},
                                                   {"value", estimate.value},
                                                   {"error", estimate.error},
                                                   {"blocks", estimate.blocks}});
        output["not_measured"] = report.not_measured;
        output["hints"] = report.hints;
        output["notes"] = averages.notes;
        fmt::print("{}\n", output.dump(1, ' ', false, Json::error_handler_t::replace));
        return agrees;
    }
    fmt::print("{:<30} {:>12} {:>9} {:>12} {:>9} {:>9} {:>7}  {}\n", "quantity", "value", "error",
               "reference", "error", "combined", "z", "verdict");
    for (auto const& c : report.comparisons)
        fmt::print("{:<30} {:>12.6g} {:>9.2g} {:>12.6g} {:>9.2g} {:>9.2g} {:>7.2f}  {}\n", c.quantity,
                   c.value.value, c.value.error, c.reference.value, c.reference.error, c.difference.error,
                   c.z(), name_of(c.verdict));
    for (auto const& [name, estimate] : report.without_reference)
        fmt::print("{:<30} {:>12.6g} {:>9.2g} {:>12} {:>9} {:>9} {:>7}  no reference\n", name, estimate.value,
                   estimate.error, "", "", "", "");
    fmt::print(
        "{} comparisons with {}: {} agree, {} disagree, {} undecided; false-alarm rate of the whole table "
        "{} %\n",
        report.comparisons.size(), reference.name, count[Verdict::agrees], count[Verdict::disagrees],
        count[Verdict::undecided], 100.0 * family_false_alarm);
    if (!report.not_measured.empty()) fmt::print("not measured: {}\n", fmt::join(report.not_measured, ", "));
    for (auto const& text : report.hints) fmt::print("hint: {}\n", text);
    for (auto const& note : averages.notes) fmt::print("note: {}\n", note);
    return agrees;
}

}  // namespace dpd
