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
#include "lammps_log.hpp"
#include "run.hpp"
#include "theory/closed_forms.hpp"
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

std::size_t table_from_text(std::string const& text) {
    if (text == "all") return all_runs;
    auto const number = to_number(text);
    if (!number || !(*number >= 0.0 && *number <= 1e9) || *number != std::floor(*number))
        throw InputError(fmt::format("--run: {} is not allowed; allowed: 1, 2, ..., all; 0: the last", text));
    return static_cast<std::size_t>(*number);
}

// --- references ------------------------------------------------------------------------------------------

namespace {

void describe(Reference& reference, Scene const& scene) {
    reference.components = diffusing_components(scene);
    reference.dimension = scene.dimension;
    reference.particles = scene.particles;
    reference.thermostat_forces = scene.stage<ModifiedVerlet>() || scene.stage<EulerImpulses>();
    describe_fluid(reference, scene);
}

}  // namespace

Reference answer_reference(std::filesystem::path const& answers, std::string const& id) {
    return answer_reference(read_file(answers), answers.string(), id);
}

Reference answer_reference(std::string const& answers, std::string const& file, std::string const& id) {
    try {
        Json const json = Json::parse(answers);
        if (json.at("schema") != "dpdref-answers/1")
            throw InputError(
                fmt::format("{}: schema {}; allowed: dpdref-answers/1", file, json.at("schema").dump()));
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
                Scene const scene = parse_scene(text, fmt::format("{}: {} {}", file, id, which));
                if (which == "rest") describe(reference, scene);
                if (which == "shear") reference.shear_rate = scene.shear_rate;
            }
            // in the units of the quantities, which need not be those of the scenes
            Json const parameters = state.value("parameters", Json::object());
            reference.shear_rate = parameters.value("shear_rate", reference.shear_rate);
            for (auto& [fact, value] : reference.facts)
                value = parameters.value(std::string(parameter_of(fact)), value);
            return reference;
        }
        throw InputError(fmt::format("--answer: {} is unknown; allowed: {}", id, fmt::join(ids, ", ")));
    } catch (Json::exception const& error) {
        throw InputError(fmt::format("{}: {}", file, one_line(error.what())));
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

// What other codes call that which dpdref measures, too, and how they define it.
struct Alias {
    enum Of { intensive, per_particle, all_particles };  // per_particle: if a LAMMPS log's energies are
    std::string_view code, column, quantity, definition;
    Of of = intensive;
    double factor = 1.0;
    bool all_degrees = false;  // a temperature over d N degrees of freedom, not d (N - 1)
};

constexpr std::string_view lammps_pressure = "lammps_pressure", temperature = "kinetic_temperature",
                           energy = "potential_energy";
constexpr double bar = 0.0602214076;  // kJ/(mol nm^3)

// OpenMM and GROMACS count energy in kJ/mol; so does their kT, which is then in the unit that the parameters
// have.
constexpr std::array<Alias, 19> foreign_names{
    {{"LAMMPS", "Temp", temperature, "over the d (N - 1) degrees of freedom of compute temp"},
     {"LAMMPS", "c_thermo_temp", temperature, "over the d (N - 1) degrees of freedom of compute temp"},
     {"LAMMPS", "Press", lammps_pressure, "2 K/(d V) and the virial of all forces"},
     {"LAMMPS", "c_thermo_press", lammps_pressure, "2 K/(d V) and the virial of all forces"},
     {"LAMMPS", "PotEng", energy, "", Alias::per_particle},
     {"LAMMPS", "E_pair", energy, "", Alias::per_particle},
     {"LAMMPS", "c_thermo_pe", energy, "of all particles", Alias::all_particles},
     {"LAMMPS ave/chunk", "temp", temperature, "over d N degrees of freedom, brought to d (N - 1)",
      Alias::intensive, 1.0, true},
     {"OpenMM", "Temperature (K)", temperature,
      "over 3 (N - 1) degrees of freedom with a CMMotionRemover, 3 N without", Alias::intensive,
      gas_constant},
     {"OpenMM", "Potential Energy (kJ/mole)", energy, "of all particles", Alias::all_particles},
     {"HOOMD-blue", "ThermodynamicQuantities.kinetic_temperature", temperature,
      "over the d (N - 1) degrees of freedom of its method"},
     {"HOOMD-blue", "ThermodynamicQuantities.pressure", "pressure",
      "2 K/(d V) and the virial of conservative forces"},
     {"HOOMD-blue", "ThermodynamicQuantities.potential_energy", energy, "of all particles",
      Alias::all_particles},
     {"Mirheo", "kBT", temperature, "over 3 N degrees of freedom, the flow among them; brought to 3 (N - 1)",
      Alias::intensive, 1.0, true},
     {"GROMACS", "Temperature", temperature, "in K", Alias::intensive, gas_constant},
     {"GROMACS", "Pressure", "pressure", "in bar", Alias::intensive, bar},
     {"GROMACS", "Potential", energy, "of all particles, in kJ/mol", Alias::all_particles},
     {"H5MD", "temperature", temperature, "as inferred from the kinetic energy"},
     {"H5MD", "density", "number_density", ""}}};

bool is_known(Reference const& reference, std::string_view name) {
    return name == "stress_xy" || find_quantity(reference.quantities, name);
}

std::vector<double> const* find_series(CodeOutput const& output, std::string_view name) {
    for (auto const& [column, samples] : output.series)
        if (column == name) return &samples;
    return nullptr;
}

// Of the output, if it says so; 0 if not.
double particles_of(CodeOutput const& output) {
    if (output.atoms > 0.0) return output.atoms;
    for (auto const* const name : {"num_particles", "particle_number", "Atoms"})
        if (auto const* const number = find_series(output, name); number && !number->empty())
            return number->back();
    return 0.0;
}

// What a column is: a quantity, in its unit after `factor`.
struct Named {
    std::string quantity;
    double factor = 1.0;
    std::string definition = {};  // as the code has it, where that is known
};

// A quantity of the reference by another code's name.
std::optional<Named> foreign(std::string const& column, CodeOutput const& output, LogCheck const& log,
                             Reference const& reference) {
    for (auto const& alias : foreign_names) {
        // a table that does not say whose it is may be cut from a log
        bool const its = output.code == alias.code || (output.code.empty() && alias.code == "LAMMPS");
        if (!its || (column != alias.column && !column.ends_with(fmt::format(".{}", alias.column)))) continue;
        Named named{std::string(alias.quantity), alias.factor, std::string(alias.definition)};
        double const own = particles_of(output), number = own > 0.0 ? own : double(reference.particles);
        // c_thermo_temp is compute temp, whatever the thermo table prints
        bool const of_thermo = column == "Temp" || column == "Press",
                   heat = log.shear_rate != 0.0 && (log.flow_is_heat || !of_thermo);
        if (heat && alias.code.starts_with("LAMMPS") && alias.quantity != energy)
            return Named{column, 1.0, "the flow of fix deform counted as heat: without a reference"};
        bool const sum =
            alias.of == Alias::all_particles || (alias.of == Alias::per_particle && !output.per_particle);
        if (sum && alias.of == Alias::per_particle && own == 0.0) return {};
        if (sum && number > 0.0) {
            named.factor /= number;
            named.definition =
                fmt::format("of {}{:g} particles", own > 0.0 ? "" : "the reference's ", number);
        }
        if (alias.all_degrees && number > 1.0) named.factor *= number / (number - 1.0);
        if (alias.code.starts_with("LAMMPS"))
            named.factor *= alias.quantity == temperature ? log.temperature
                            : alias.quantity == energy    ? log.energy
                                                          : log.pressure;
        if (!std::isfinite(named.factor)) return {};
        // with friction and noise in its virial it is another quantity
        if (alias.quantity == lammps_pressure && !reference.thermostat_forces) named.quantity = "pressure";
        if (alias.quantity != lammps_pressure || named.quantity == "pressure") return named;
        named.definition += ", friction and noise among them";
        return named;
    }
    return {};
}

Named name_of_column(std::string const& column, CodeOutput const& output, LogCheck const& log,
                     Reference const& reference, std::vector<Renaming> const& renamings) {
    for (auto const& renaming : renamings)
        if (renaming.column == column) return {renaming.quantity, renaming.factor};
    if (is_known(reference, column)) return {column};
    if (auto const named = foreign(column, output, log, reference)) return *named;
    if (column.starts_with("v_") || column.starts_with("c_"))
        if (auto const name = column.substr(2); is_known(reference, name)) return {name};
    if (auto const name = bare(column); is_known(reference, name)) return {name};
    return {column};
}

// In a shear flow: the viscosity that a stress is, over the rate.
void make_viscosity(Named& named, double shear_rate) {
    static constexpr std::string_view suffix = "_stress";
    std::string& name = named.quantity;
    if (shear_rate == 0.0) return;
    if (name == "stress_xy")
        name = "viscosity";
    else if (name == "kinetic_stress" || name == "collision_stress" || name == "potential_stress")
        name = name.substr(0, name.size() - suffix.size()) + "_viscosity";
    else
        return;
    named.factor /= shear_rate;
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
    if (size <= 1) return 0;
    if (by_time && (output.axis.empty() || output.at.size() != size))
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

namespace {

double bin_width(CurveEstimate const& c) { return c.x.size() < 2 ? 0.0 : c.x[1] - c.x[0]; }

// Of one quantity: a series for each run.
struct Samples {
    std::vector<std::vector<double>> runs;
    bool independent = false;  // one after the other; else errors are by blocking

    Estimate estimate() const { return independent ? pool(runs) : combine(runs); }
};

// Gathers the averages of one file after the other.
class Averager {
public:
    Averager(Reference const& reference, std::vector<Renaming> const& renamings, Discard const& discard,
             bool sheared)
        : reference_(reference), renamings_(renamings), discard_(discard), sheared_(sheared) {}

    // What logs say, of which the first also holds for LAMMPS' other files.
    void read_logs(std::vector<CodeOutput> const& outputs) {
        for (auto const& output : outputs) {
            if (output.commands.empty()) continue;
            LogCheck check = check_log(output, reference_);
            for (auto const& difference : check.differences)
                averages.differences.push_back(fmt::format("{}: {}", output.file, difference));
            add_notes(check.notes);
            if (logs_.empty()) any_log_ = check;
            logs_.emplace(&output, std::move(check));
        }
    }

    void add(CodeOutput const& output) {
        if (double const rate = rate_of(output);
            (output.shear_rate || logs_.contains(&output)) && rate != 0.0 &&
            std::abs(rate - reference_.shear_rate) > 1e-6 * std::abs(rate)) {
            auto const what = fmt::format("{}: its shear rate is {:g}; allowed: {:g}, the reference's",
                                          output.file, rate, reference_.shear_rate);
            if (output.commands.empty()) throw InputError(what);
            averages.differences.push_back(fmt::format("{}: shear rate {:g} (reference: {:g})", output.file,
                                                       rate, reference_.shear_rate));
        }
        if (double const own = particles_of(output); own > 0.0) averages.particles = own;
        add_notes(output.notes);
        for (auto const& [column, estimate] : output.values) {
            auto const [quantity, factor, definition] = use(output, column);
            add_estimate(quantity,
                         {.value = factor * estimate.value,
                          .error = std::abs(factor) * estimate.error,
                          .blocks = estimate.blocks},
                         output);
        }
        add_series(output);
        add_curve(output);
        for (auto const& more : output.also) add(more);
    }

    void finish() {
        for (auto& [quantity, samples] : samples_)
            if (samples.runs.size() > 1)
                for (auto& known : averages.quantities)
                    if (known.name == quantity) known.estimate = samples.estimate();
        for (auto const& renaming : renamings_)
            if (!columns_.contains(renaming.column))
                throw InputError(fmt::format("--as: there is no column {}; allowed: {}", renaming.column,
                                             fmt::join(columns_, ", ")));
        std::size_t family = 0;
        for (auto const& [quantity, samples] : samples_) family += samples.runs.size();
        for (auto const& [quantity, samples] : samples_)
            for (auto const& run : samples.runs)
                if (drifts(run, family))
                    averages.notes.push_back(
                        fmt::format("{}: its first and second half differ by more than chance: not in "
                                    "equilibrium? (--discard)",
                                    quantity));
        if (auto const known = double(reference_.particles);
            averages.particles > 0.0 && known > 0.0 && std::abs(averages.particles / known - 1.0) > 0.01)
            averages.notes.push_back(fmt::format(
                "{:g} particles, the reference has {:g}: what depends on the box (diffusion most) may differ",
                averages.particles, known));
    }

    Averages averages;

private:
    void add_notes(std::vector<std::string> const& notes) {
        averages.notes.insert(averages.notes.end(), notes.begin(), notes.end());
    }

    LogCheck const& log_of(CodeOutput const& output) const {
        auto const own = logs_.find(&output);
        return own == logs_.end() ? any_log_ : own->second;
    }

    // As the output says it, or the log that comes with it; 0: at rest, or not said.
    double rate_of(CodeOutput const& output) const {
        return output.shear_rate.value_or(log_of(output).shear_rate);
    }

    bool flows(CodeOutput const& output) const { return sheared_ || rate_of(output) != 0.0; }

    bool has_sheared() const {
        return find_quantity(reference_.quantities, "sheared_kinetic_temperature") != nullptr;
    }

    Named use(CodeOutput const& output, std::string const& column) {
        columns_.insert(column);
        Named named = name_of_column(column, output, log_of(output), reference_, renamings_);
        // of two names for one thing in a file, as E_pair and PotEng, the first counts
        if (named.quantity != column && source_.contains(named.quantity) &&
            source_[named.quantity] == &output &&
            std::none_of(renamings_.begin(), renamings_.end(),
                         [&](auto const& r) { return r.column == column; }))
            return {column};
        if (named.quantity == lammps_pressure && column != lammps_pressure &&
            !find_quantity(reference_.quantities, lammps_pressure))
            averages.notes.push_back(fmt::format(
                "{}: LAMMPS counts friction and noise of pair dpd in it, which makes another quantity than "
                "pressure; a reference that samples {} has it; --as {}=pressure compares them all the same",
                column, lammps_pressure, column));
        if (!named.definition.empty())
            averages.definitions.push_back(fmt::format("{}: {}, {} ({})", column, named.quantity,
                                                       named.definition,
                                                       output.code.empty() ? "LAMMPS" : output.code));
        if (!output.shear_rate || flows(output)) make_viscosity(named, reference_.shear_rate);
        // what the flow heats has a reference of its own, or none
        if (flows(output) && has_sheared() && is_known(reference_, named.quantity) &&
            !named.quantity.ends_with("viscosity"))
            named.quantity = "sheared_" + named.quantity;
        return named;
    }

    // Partitions of one run of LAMMPS are independent.
    void add_estimate(std::string const& quantity, Estimate const& estimate, CodeOutput const& from) {
        auto const [other, fresh] = source_.emplace(quantity, &from);
        bool const partitions = !fresh && !from.partition.empty() && !other->second->partition.empty() &&
                                other->second->partition != from.partition;
        if (!fresh && !partitions && is_known(reference_, quantity))
            throw InputError(fmt::format("{}: is in {} and in {}; allowed: once (--as gives another name)",
                                         quantity, other->second->file, from.file));
        if (!partitions) averages.quantities.push_back({quantity, estimate});
    }

    std::vector<double> rest_of(CodeOutput const& output, std::vector<double> const& series,
                                double factor) const {
        std::vector<double> rest;
        for (std::size_t k = discarded(output, series.size(), discard_); k < series.size(); ++k)
            rest.push_back(factor * series[k]);
        return rest;
    }

    void add_samples(std::string const& quantity, std::vector<double> series, CodeOutput const& output,
                     bool independent = false) {
        add_estimate(quantity, Samples{{series}, independent}.estimate(), output);
        auto& known = samples_[quantity];
        known.independent = independent;
        known.runs.push_back(std::move(series));
    }

    void add_series(CodeOutput const& output) {
        std::size_t samples = output.g.empty() ? 0 : output.g.front().size();
        for (auto const& [column, series] : output.series) samples = std::max(samples, series.size());
        std::size_t const first = discarded(output, samples, discard_);
        if (samples > 0) {
            averages.notes.push_back(first == 0 ? fmt::format("{}: nothing was discarded", output.file)
                                                : fmt::format("{}: the first {} of {} samples were discarded",
                                                              output.file, first, samples));
            averages.files.push_back({output.file, output.code, output.series.size(), samples});
            averages.files.back().columns += !output.axis.empty();
        }
        auto const *lag = find_series(output, "lag"),
                   *squares = find_series(output, "mean_square_displacement");
        for (auto const& [column, series] : output.series) {
            if (lag && squares && (&series == lag || &series == squares)) continue;
            auto const [quantity, factor, definition] = use(output, column);
            add_samples(quantity, rest_of(output, series, factor), output);
        }
        if (!lag || !squares) return;
        if (lag->size() != squares->size())
            throw InputError(
                fmt::format("{}: lag has {} values, mean_square_displacement {}; allowed: as many",
                            output.file, lag->size(), squares->size()));
        std::string const name = use(output, "diffusion_constant").quantity;
        columns_.erase("diffusion_constant");
        // an origin begins where the one before ended; blocks of several would leave too few of them
        add_samples(name, diffusion_by_origin(*lag, *squares, first, reference_.components), output, true);
    }

    void add_curve(CodeOutput const& output) {
        if (output.g.empty() && output.curve.x.empty()) return;
        if (has_sheared() && flows(output)) {
            averages.notes.push_back(
                fmt::format("{}: g(r) of a shear flow, which has no reference", output.file));
            return;
        }
        if (auto const [other, fresh] = source_.emplace("radial_distribution", &output); !fresh)
            throw InputError(fmt::format("radial_distribution: is in {} and in {}; allowed: once",
                                         other->second->file, output.file));
        averages.radial_distribution = output.curve;
        if (output.g.empty()) return;
        averages.radial_distribution.x = output.r;
        for (auto const& bin : output.g)
            averages.radial_distribution.y.push_back(blocking(rest_of(output, bin, 1.0)));
    }

    Reference const& reference_;
    std::vector<Renaming> const& renamings_;
    Discard const& discard_;
    bool sheared_;
    LogCheck any_log_;
    std::map<CodeOutput const*, LogCheck> logs_;
    std::map<std::string, CodeOutput const*> source_;  // of each quantity
    std::set<std::string> columns_;
    std::map<std::string, Samples> samples_;  // of each quantity
};

}  // namespace

Averages average(std::vector<CodeOutput> const& outputs, Reference const& reference,
                 std::vector<Renaming> const& renamings, Discard const& discard, bool sheared) {
    Averager averager(reference, renamings, discard, sheared);
    averager.read_logs(outputs);
    for (auto const& output : outputs) averager.add(output);
    averager.finish();
    return averager.averages;
}

// --- verdicts --------------------------------------------------------------------------------------------

namespace {

// The bins that both have, by number.
std::vector<std::pair<std::size_t, std::size_t>> common_bins(CurveEstimate const& curve,
                                                             CurveEstimate const& reference) {
    double const width = bin_width(reference), close = 1e-3 * width;
    std::vector<std::pair<std::size_t, std::size_t>> bins;
    if (std::abs(bin_width(curve) - width) > close) return bins;
    for (std::size_t a = 0; a < curve.x.size(); ++a)
        for (std::size_t b = 0; b < reference.x.size(); ++b)
            if (std::abs(curve.x[a] - reference.x[b]) < close) bins.emplace_back(a, b);
    return bins;
}

// g(r) of `fine` in those bins of `coarse` that it covers: the mean over the parts of shells, by their volume
// in d dimensions. A bin that is cut is taken as linear, and an eighth of its second difference is added to
// the error; errors of bins are added as they are, as if all erred alike.
CurveEstimate rebinned(CurveEstimate const& fine, CurveEstimate const& coarse, int d) {
    double const w = bin_width(fine), half = 0.5 * bin_width(coarse);
    auto const power = [](double a, double b, int p) { return std::pow(b, p) - std::pow(a, p); };
    auto const centre = [&](double a, double b) {  // of the volume between two radii
        return d * power(a, b, d + 1) / ((d + 1) * power(a, b, d));
    };
    auto const centre_of = [&](std::size_t k) {
        return centre(std::max(0.0, fine.x[k] - 0.5 * w), fine.x[k] + 0.5 * w);
    };
    CurveEstimate result;
    for (double const x : coarse.x) {
        double const low = std::max(0.0, x - half), high = x + half;
        if (low < fine.x.front() - 0.501 * w || high > fine.x.back() + 0.501 * w) continue;
        Estimate sum{.blocks = many_blocks};
        for (std::size_t k = 0; k < fine.x.size(); ++k) {
            double const a = std::max(low, fine.x[k] - 0.5 * w), b = std::min(high, fine.x[k] + 0.5 * w);
            if (a >= b) continue;
            std::size_t const below = k == 0 ? 0 : k - 1, above = std::min(k + 1, fine.x.size() - 1);
            Estimate const& here = fine.y[k];
            double const share = power(a, b, d) / power(low, high, d), cut = 1.0 - (b - a) / w,
                         slope = (fine.y[above].value - fine.y[below].value) /
                                 (centre_of(above) - centre_of(below)),
                         bend = std::abs(fine.y[above].value - 2.0 * here.value + fine.y[below].value) / 8.0;
            sum.value += share * (here.value + slope * (centre(a, b) - centre_of(k)));
            sum.error += share * (here.error + std::max(0.0, cut) * bend);
            sum.blocks = std::min(sum.blocks, here.blocks);
        }
        result.x.push_back(x);
        result.y.push_back(sum);
    }
    return result;
}

// The same bins for both: the finer curve in the bins of the coarser one. Nothing if they have none in
// common.
bool share_bins(CurveEstimate& curve, CurveEstimate& reference, int d, std::vector<std::string>& notes) {
    auto const even = [](CurveEstimate const& c) {
        double const w = bin_width(c);
        for (std::size_t k = 1; k < c.x.size(); ++k)
            if (std::abs(c.x[k] - c.x[0] - double(k) * w) > 0.01 * w * double(k)) return false;
        return w > 0.0;
    };
    if (!common_bins(curve, reference).empty()) return true;
    double const width = bin_width(curve), its = bin_width(reference);
    if (even(curve) && even(reference))
        (width < its ? curve : reference) =
            width < its ? rebinned(curve, reference, d) : rebinned(reference, curve, d);
    bool const shared = !common_bins(curve, reference).empty();
    notes.push_back(fmt::format(
        "radial_distribution: its bins of width {:.6g} are not the reference's of {:.6g}; {}", width, its,
        shared ? "the finer ones were put together"
               : "no bin of one covers one of the other: "
                 "left out"));
    return shared;
}

// A bin that was never hit has no scatter to tell its error. Counts are Poisson's: the variance of g is that
// of the nearest bin that was hit, times what is expected over its g, over the ratio of their volumes.
Estimate with_error_of_counts(CurveEstimate const& curve, std::size_t bin, double expected, int d) {
    constexpr double rounding = 1e-12;
    Estimate empty = curve.y[bin];
    if (std::abs(empty.value) > rounding || empty.error > rounding || !(expected > 0.0)) return empty;
    double const half = 0.5 * bin_width(curve);
    auto const volume = [&](std::size_t k) {
        return std::pow(curve.x[k] + half, d) - std::pow(std::max(0.0, curve.x[k] - half), d);
    };
    std::optional<std::size_t> hit;
    for (std::size_t k = 0; k < curve.y.size(); ++k)
        if (curve.y[k].value > rounding && curve.y[k].error > rounding &&
            (!hit || std::abs(curve.x[k] - curve.x[bin]) < std::abs(curve.x[*hit] - curve.x[bin])))
            hit = k;
    if (!hit) return empty;
    Estimate const& its = curve.y[*hit];
    empty.error = its.error * std::sqrt(expected / its.value * volume(*hit) / volume(bin));
    empty.blocks = its.blocks;
    return empty;
}

// The bin that is furthest off, with the verdict on all.
CodeComparison compare_curves(CurveEstimate const& curve, CurveEstimate const& reference, int d,
                              double resolution, double false_alarm) {
    double peak = 0.0;
    for (auto const& y : reference.y) peak = std::max(peak, y.value);
    auto const bins = common_bins(curve, reference);
    CodeComparison worst;
    double furthest = -1.0;
    Verdict verdict = Verdict::agrees;
    for (auto const& [a, b] : bins) {
        CodeComparison bin{.quantity = fmt::format("radial_distribution at {:.4g}", reference.x[b]),
                           .value = with_error_of_counts(curve, a, reference.y[b].value, d),
                           .reference = with_error_of_counts(reference, b, curve.y[a].value, d)};
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

// What a value that disagrees looks like: mistakes whose factor is known and far from 1, within 6 %, since a
// wrong temperature has another error of the finite step; other definitions within the error.
std::vector<std::string> hints(CodeComparison const& comparison, double particles, Reference const& reference,
                               double false_alarm) {
    struct Candidate {
        std::string_view quantity;
        double value;
        bool mistake;
        std::string_view what;
    };
    auto const fact = [&](char const* name) {
        auto const known = reference.facts.find(name);
        return known == reference.facts.end() ? std::nan("") : known->second;
    };
    double const d = reference.dimension, N = particles > 0.0 ? particles : double(reference.particles),
                 dt = fact("timestep"), gamma = fact("gamma"), kT = fact("kT"), n = fact("density"),
                 sigma = std::sqrt(2.0 * gamma * kT), its = comparison.reference.value;
    auto const* const measured = find_quantity(reference.quantities, temperature);
    double const hot = measured ? measured->estimate.value : std::nan("");
    std::array<Candidate, 17> const candidates{
        {{temperature, its * d, true, "not divided by the dimension?"},
         {temperature, its * 0.5 * d, true, "the kinetic energy itself?"},
         {temperature, its / 3.0, true, "even noise from [-1, 1] without sqrt 3?"},
         {temperature, its / 12.0, true, "even noise from [-1/2, 1/2] without sqrt 12?"},
         {temperature, its / dt, true, "noise over dt, not over sqrt dt?"},
         {temperature, its * dt, true, "noise not over sqrt dt?"},
         {temperature, its * dt * dt, true, "noise times sqrt dt, not over it?"},
         {temperature, its * 0.5, true, "sigma^2 = gamma kT, not 2 gamma kT?"},
         {temperature, its * sigma * sigma, true, "sigma^2 for sigma?"},
         {temperature, its * std::pow(gamma / sigma, 3), true, "sigma and gamma swapped?"},
         {temperature, its * (N - 1.0) / N, false, "over d N degrees of freedom, not d (N - 1)?"},
         {"pressure", its + n * hot / N, false, "N kT measured, not (N - 1) kT measured?"},
         {"pressure", its + n * (kT - hot * (N - 1.0) / N), false,
          "N kT of the thermostat, not (N - 1) kT measured?"},
         {energy, its * 2.0, true, "each pair counted twice?"},
         {energy, its * N, true, "not divided by the number of particles?"},
         {"diffusion_constant", its * 2.0, true, "not divided by 2?"},
         {"diffusion_constant", its * d, true, "not divided by the dimension?"}}};
    std::vector<std::string> found;
    for (auto const& [quantity, value, mistake, what] : candidates) {
        if (quantity != comparison.quantity || !std::isfinite(value) || value == its) continue;
        double const off = std::abs(comparison.value.value - value);
        if (mistake && off < 0.06 * std::abs(value))
            found.push_back(fmt::format("{}: {:.4g} times the reference: {}", quantity,
                                        comparison.value.value / its, what));
        if (!mistake &&
            off <= critical_z(false_alarm, comparison.difference.blocks) * comparison.difference.error)
            found.push_back(
                fmt::format("{}: the reference would be {:.6g}, which agrees: {}", quantity, value, what));
    }
    return found;
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
    CurveEstimate curve = averages.radial_distribution, its_curve = reference.radial_distribution;
    bool const curves = !curve.x.empty() && !its_curve.x.empty() &&
                        share_bins(curve, its_curve, reference.dimension, report.notes);
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
        if (c.verdict == Verdict::disagrees)
            for (auto& text : hints(c, averages.particles, reference, share))
                report.hints.push_back(std::move(text));
    }
    if (curves)
        report.comparisons.push_back(
            compare_curves(curve, its_curve, reference.dimension, resolution, share));
    for (auto const& quantity : reference.quantities)
        if (!find_quantity(averages.quantities, quantity.name)) report.not_measured.push_back(quantity.name);
    if (!curves && !reference.radial_distribution.x.empty())
        report.not_measured.emplace_back("radial_distribution");
    return report;
}

Outcome outcome_of(CodeReport const& report, Averages const& averages) {
    if (report.comparisons.empty()) return Outcome::nothing;
    bool const disagrees = std::any_of(report.comparisons.begin(), report.comparisons.end(),
                                       [](auto const& c) { return c.verdict == Verdict::disagrees; });
    return disagrees || !averages.differences.empty() ? Outcome::disagrees : Outcome::agrees;
}

void print(CodeReport const& report, Averages const& averages, Reference const& reference, bool json) {
    std::map<Verdict, std::size_t> count;
    for (auto const& c : report.comparisons) ++count[c.verdict];
    auto notes = averages.notes;
    notes.insert(notes.end(), report.notes.begin(), report.notes.end());
    if (json) {
        Json output{{"reference", reference.name}, {"false_alarm_rate", family_false_alarm}};
        output["differences"] = averages.differences;
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
        output["definitions"] = averages.definitions;
        output["notes"] = notes;
        output["files"] = Json::array();
        for (auto const& [file, code, columns, samples] : averages.files)
            output["files"].push_back(
                {{"file", file}, {"code", code}, {"columns", columns}, {"samples", samples}});
        fmt::print("{}\n", output.dump(1, ' ', false, Json::error_handler_t::replace));
        return;
    }
    if (!averages.differences.empty())
        fmt::print("ANOTHER FLUID than {}: {}\n", reference.name, fmt::join(averages.differences, "; "));
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
    for (auto const& text : averages.definitions) fmt::print("column {}\n", text);
    for (auto const& note : notes) fmt::print("note: {}\n", note);
}

std::string nothing_compared(CodeReport const& report, Reference const& reference) {
    Words columns, quantities;
    for (auto const& [name, estimate] : report.without_reference) columns.push_back(name);
    for (auto const& known : reference.quantities) quantities.push_back(known.name);
    return fmt::format(
        "nothing was compared: no column ({}) has a reference; --as COLUMN=quantity says what it is; "
        "allowed: {}",
        fmt::join(columns, ", "), fmt::join(quantities, ", "));
}

}  // namespace dpd
