#include "read_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <boost/algorithm/string.hpp>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "archive.hpp"
#include "compare.hpp"
#include "errors.hpp"
#include "files.hpp"

namespace dpd {

std::optional<double> to_number(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    double number = 0.0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc{} || end != text.data() + text.size()) return {};
    return number;
}

std::string bare(std::string const& name) {
    std::string const last = name.substr(name.rfind('.') + 1);
    return boost::trim_copy(last.substr(0, last.find('(')));
}

namespace {

using Json = nlohmann::ordered_json;
using Words = std::vector<std::string>;

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

}  // namespace dpd
