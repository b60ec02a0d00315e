#include "compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string.hpp>
#include <charconv>
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

// An error that comes without its number of blocks is taken as exact.
constexpr std::size_t many_blocks = 1'000'000;

std::optional<double> to_number(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double number = 0.0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return {};
    return number;
}

// --- text ------------------------------------------------------------------------------------------------

// The lines of a file and where they came from.
struct Text {
    std::string file;
    std::vector<std::string> lines;
    bool whole = true;  // whether the last line has its end

    Text(std::filesystem::path const& path, std::string const& content) : file(path.string()) {
        boost::split(lines, content, boost::is_any_of("\n"));
        whole = lines.back().empty();
        if (whole) lines.pop_back();
        for (auto& line : lines) boost::trim(line);
    }

    [[noreturn]] void fail(std::size_t line, std::string const& what) const {
        throw InputError(fmt::format("{}:{}: {}", file, line + 1, what));
    }

    double number(std::size_t line, std::string const& word) const {
        auto const value = to_number(word);
        if (!value || !std::isfinite(*value))
            fail(line, fmt::format("{} is not allowed; allowed: a number", word));
        return *value;
    }

    bool last(std::size_t line) const { return line + 1 == lines.size(); }
};

Words words_of(std::string const& line) {
    Words words;
    boost::split(words, line, boost::is_space(), boost::token_compress_on);
    std::erase(words, "");
    return words;
}

// Between commas, tabs or blanks, whichever the line has first in this order.
Words fields_of(std::string const& line) {
    char const* const separators = line.find(',') != std::string::npos ? "," : "\t";
    if (line.find_first_of(separators) == std::string::npos) return words_of(line);
    Words fields;
    boost::split(fields, line, boost::is_any_of(separators));
    for (auto& field : fields) boost::trim_if(field, boost::is_any_of(" \t\""));
    return fields;
}

// A name without its unit, as OpenMM's `Time (ps)`, and without the object that it is of, as HOOMD-blue's
// `Simulation.timestep`.
std::string bare(std::string const& name) {
    std::string const last = name.substr(name.rfind('.') + 1);
    return boost::trim_copy(last.substr(0, last.find('(')));
}

bool is_axis(std::string const& name) {
    static std::set<std::string> const axes{"step", "timestep", "time"};
    return axes.contains(boost::to_lower_copy(bare(name)));
}

// Series from columns of samples; the first column of times or steps is the axis, others of them go.
struct Columns {
    Words names;
    std::vector<std::vector<double>> samples;

    explicit Columns(Words columns) : names(std::move(columns)), samples(names.size()) {}

    void add(Text const& text, std::size_t line, Words const& row) {
        if (row.size() != names.size())
            text.fail(line,
                      fmt::format("{} columns; allowed: {}, as in the header", row.size(), names.size()));
        for (std::size_t c = 0; c < names.size(); ++c) samples[c].push_back(text.number(line, row[c]));
    }

    void move_to(CodeOutput& output) {
        for (std::size_t c = 0; c < names.size(); ++c)
            if (!is_axis(names[c])) {
                output.series.emplace_back(names[c], std::move(samples[c]));
            } else if (output.axis.empty()) {
                output.axis = names[c];
                output.at = std::move(samples[c]);
            }
    }
};

// --- formats ---------------------------------------------------------------------------------------------

// The header is the first line that is no comment, or, if that holds numbers, the comment above it.
CodeOutput read_table(Text const& text) {
    CodeOutput output;
    std::optional<Columns> columns;
    bool values = false, curve = false;
    std::string comment;
    for (std::size_t k = 0; k < text.lines.size(); ++k) {
        if (text.lines[k].empty()) continue;
        if (text.lines[k].front() == '#') {
            comment = boost::trim_left_copy_if(text.lines[k], boost::is_any_of("# \t"));
            continue;
        }
        Words row = fields_of(text.lines[k]);
        if (!columns && to_number(row[0])) {
            columns.emplace(fields_of(comment));
            if (comment.empty() || to_number(columns->names[0]))
                text.fail(k, "no header; allowed: names of the columns");
        }
        if (!columns) {
            columns.emplace(row);
            values = row.size() >= 3 && row[0] == "quantity" && row[1] == "value" && row[2] == "error";
            curve = row.size() >= 3 && row[0] == "r" && row[1] == "radial_distribution" && row[2] == "error";
            if ((values || curve) && (row.size() > 4 || (row.size() == 4 && row[3] != "blocks")))
                text.fail(k, fmt::format("allowed: {},{},error[,blocks]", row[0], row[1]));
        } else if (!values && !curve) {
            columns->add(text, k, row);
        } else {
            if (row.size() != columns->names.size())
                text.fail(k, fmt::format("{} columns; allowed: {}", row.size(), columns->names.size()));
            Estimate estimate{.value = text.number(k, row[1]), .error = text.number(k, row[2])};
            double const blocks = row.size() == 4 ? text.number(k, row[3]) : double(many_blocks);
            if (estimate.error < 0.0) text.fail(k, "error is negative; allowed: a number >= 0");
            if (!(blocks >= 2.0 && blocks <= 1e9)) text.fail(k, "blocks: allowed: an integer, 2 to 1e9");
            estimate.blocks = static_cast<std::size_t>(blocks);
            if (values) {
                output.values.push_back({row[0], estimate});
            } else {
                output.curve.x.push_back(text.number(k, row[0]));
                output.curve.y.push_back(estimate);
            }
        }
    }
    if (columns && !values && !curve) columns->move_to(output);
    return output;
}

// Lines of a thermo table are those that begin with a number; messages of the program may stand between.
CodeOutput read_log(Text const& text, std::size_t run) {
    CodeOutput output;
    std::vector<Columns> tables;
    bool in_table = false;
    for (std::size_t k = 0; k < text.lines.size(); ++k) {
        std::string const& line = text.lines[k];
        Words const words = words_of(line);
        if (words.empty()) continue;
        if (line.starts_with("Per MPI rank memory") || line.starts_with("Memory usage per processor")) {
            if (text.last(k)) break;
            Words const names = words_of(text.lines[++k]);
            if (names.empty() || names[0].starts_with("-"))
                text.fail(k, "no header of a thermo table; allowed: thermo_style one or custom");
            tables.emplace_back(names);
            in_table = true;
        } else if (line.starts_with("Loop time of")) {
            in_table = false;
        } else if (words[0] == "units" && words.size() > 1) {
            output.per_particle = words[1] == "lj";
        } else if (words[0] == "thermo_modify") {
            if (auto const norm = std::find(words.begin(), words.end(), "norm"); words.end() - norm > 1)
                output.per_particle = norm[1] == "yes";
        } else if (words[0] == "ERROR:" || words[0] == "ERROR") {
            output.notes.push_back(fmt::format("{}:{}: {}", text.file, k + 1, line));
        } else if (in_table && to_number(words[0])) {
            if (!text.whole && text.last(k))
                output.notes.push_back(
                    fmt::format("{}:{}: the line has no end and was left out", text.file, k + 1));
            else
                tables.back().add(text, k, words);
        }
    }
    if (tables.empty() || run > tables.size())
        throw InputError(fmt::format("{}: --run {}: allowed: 1 to {}, the thermo tables of the log",
                                     text.file, run, tables.size()));
    (run == 0 ? tables.back() : tables[run - 1]).move_to(output);
    return output;
}

// Two lines of header before rows of scalars; three before blocks of rows, each after a line of its own.
CodeOutput read_ave_time(Text const& text) {
    CodeOutput output;
    std::size_t k = 0;
    while (k < text.lines.size() && text.lines[k].starts_with("#")) ++k;
    bool const vector = k == 3;
    if (k < 2 || k > 3)
        text.fail(k, fmt::format("{} lines of header; allowed: 2 or 3, as fix ave/time writes them", k));
    Columns columns(words_of(text.lines[k - 1].substr(1)));
    static constexpr std::string_view says_rate = "shear rate ";
    if (auto const at = text.lines[0].rfind(says_rate); at != std::string::npos)
        output.shear_rate = text.number(0, text.lines[0].substr(at + says_rate.size()));
    if (vector && columns.names.size() < 3)
        text.fail(k - 1, "allowed: row, r, g(r), and columns that do not count");
    if (vector) output.axis = "step";
    auto const cut = [&](std::size_t line) {
        output.notes.push_back(fmt::format("{}:{}: the file ends within a line or block, which was left out",
                                           text.file, line + 1));
    };
    while (k < text.lines.size()) {
        if (text.lines[k].empty() || text.lines[k].front() == '#') {
            ++k;
            continue;
        }
        Words const row = words_of(text.lines[k]);
        std::size_t const first = k;
        std::size_t rows = 1;
        if (vector) {
            double const count = row.size() == 2 ? text.number(k, row[1]) : 0.0;
            if (!(count >= 1.0 && count <= 1e9 && count == std::floor(count)))
                text.fail(k, "no head of a block; allowed: step and number of rows");
            rows = static_cast<std::size_t>(count) + 1;
        }
        if (rows > text.lines.size() - first || (rows == text.lines.size() - first && !text.whole)) {
            cut(first);
            break;
        }
        k += rows;
        if (!vector) {
            columns.add(text, first, row);
            continue;
        }
        Columns block(columns.names);
        for (std::size_t line = first + 1; line < k; ++line)
            block.add(text, line, words_of(text.lines[line]));
        if (output.r.empty()) {
            output.r = block.samples[1];
            output.g.resize(output.r.size());
        }
        if (block.samples[1] != output.r) text.fail(first, "other bins than before; allowed: the same");
        for (std::size_t bin = 0; bin < output.r.size(); ++bin)
            output.g[bin].push_back(block.samples[2][bin]);
        output.at.push_back(text.number(first, row[0]));
    }
    if (!vector) columns.move_to(output);
    return output;
}

CodeOutput read_hdf5(std::filesystem::path const& file) {
    CodeOutput output;
    Archive archive(file, Archive::Mode::read);
    if (archive.has("dpdref/scene")) {
        auto const result = run_reference(file);
        output.values = result.quantities;
        output.curve = result.radial_distribution;
        return output;
    }
    for (auto const& name : archive.observables()) {
        std::vector<double> samples;
        archive(fmt::format("observables/{}/value", name), samples);
        if (!std::all_of(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); }))
            throw InputError(fmt::format("{}: observables/{}: not all are numbers", file.string(), name));
        output.series.emplace_back(name, std::move(samples));
    }
    return output;
}

// What stands in tables and in JSON.
void check_name(std::string const& file, std::string const& name) {
    bool good = one_line(name) == name;
    try {
        static_cast<void>(Json(name).dump());
    } catch (Json::exception const&) {
        good = false;  // not UTF-8
    }
    if (!good)
        throw InputError(fmt::format("{}: a column is called {}; allowed: a name of UTF-8 on one line", file,
                                     Json(name).dump(-1, ' ', true, Json::error_handler_t::replace)));
}

}  // namespace

CodeOutput read_output(std::filesystem::path const& file, std::size_t run) {
    std::string const content = read_file(file);
    CodeOutput output;
    if (content.starts_with("\x89HDF")) {
        output = read_hdf5(file);
    } else {
        Text const text(file, content);
        bool const log = std::any_of(text.lines.begin(), text.lines.end(), [](auto const& line) {
            return line.starts_with("LAMMPS (") || line.starts_with("Per MPI rank memory") ||
                   line.starts_with("Memory usage per processor");
        });
        auto const is_comment = [](std::string const& line) { return line.empty() || line[0] == '#'; };
        auto const data = std::find_if_not(text.lines.begin(), text.lines.end(), is_comment);
        bool const ave_time = data - text.lines.begin() > 1 && is_comment(text.lines[1]) &&
                              (data == text.lines.end() || data->find_first_of(",\t") == std::string::npos) &&
                              (data == text.lines.end() || to_number(words_of(*data)[0]));
        output = log ? read_log(text, run) : ave_time ? read_ave_time(text) : read_table(text);
    }
    output.file = file.string();
    for (auto const& [name, values] : output.series) check_name(output.file, name);
    for (auto const& [name, estimate] : output.values) check_name(output.file, name);
    bool const samples = std::any_of(output.series.begin(), output.series.end(),
                                     [](auto const& series) { return !series.second.empty(); });
    if (output.values.empty() && output.curve.x.empty() && output.g.empty() && !samples)
        throw InputError(
            fmt::format("{}: holds no samples; allowed: a table, a LAMMPS log, a file of fix ave/time, H5MD "
                        "(observables/NAME/value)",
                        output.file));
    return output;
}

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
