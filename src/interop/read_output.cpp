#include "read_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/algorithm/string.hpp>
#include <boost/tokenizer.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "archive.hpp"
#include "compare.hpp"
#include "errors.hpp"
#include "files.hpp"
#include "number.hpp"

namespace dpd {

std::optional<double> to_number(std::string_view text) {
    std::string number(text.starts_with('+') ? text.substr(1) : text);
    // Fortran's double precision; what is no number otherwise is none with another letter either
    if (auto const d = number.find_first_of("dD"); d != 0 && d != std::string::npos) number[d] = 'e';
    return number_in(number);
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

// Between semicolons, commas, tabs or blanks, whichever the line has first in this order; quotes hold a field
// together. Between semicolons a comma is a decimal point.
Words fields_of(std::string line) {
    std::string separators = " \t";
    for (auto const* const one : {";", ",", "\t"})
        if (line.find(*one) != std::string::npos) {
            separators = one;
            break;
        }
    if (separators == ";") std::replace(line.begin(), line.end(), ',', '.');
    using Separator = boost::escaped_list_separator<char>;
    boost::tokenizer<Separator> const tokens(line, Separator("", separators, "\""));
    Words fields(tokens.begin(), tokens.end());
    for (auto& field : fields) boost::trim(field);
    if (separators == " \t") std::erase(fields, "");
    if (!fields.empty() && fields.back().empty()) fields.pop_back();  // after a separator at the end
    return fields;
}

// Names and numbers in turn, as in "step = 100 T = 1.02" or "Step 100 Temp 1.02"; empty for any other line.
std::vector<std::pair<std::string, std::string>> labelled(std::string const& line) {
    Words words;
    boost::split(words, line, boost::is_any_of(" \t=:,;"), boost::token_compress_on);
    std::erase(words, "");
    std::vector<std::pair<std::string, std::string>> pairs;
    for (std::size_t k = 0; k + 1 < words.size(); k += 2)
        if (!to_number(words[k]) && to_number(words[k + 1])) pairs.emplace_back(words[k], words[k + 1]);
    if (2 * pairs.size() != words.size()) pairs.clear();
    return pairs;
}

bool is_axis(std::string const& name) {
    static std::set<std::string> const axes{"step", "timestep", "time"};
    return axes.contains(boost::to_lower_copy(bare(name)));
}

// Series from columns of samples; the first column of times or steps is the axis, others of them go, and so
// do columns of words.
struct Columns {
    Words names;
    std::vector<std::vector<double>> samples;
    std::set<std::string> words;  // columns whose first entry is no number

    explicit Columns(Words columns) : names(std::move(columns)), samples(names.size()) {}

    std::size_t rows() const { return samples.empty() ? 0 : samples.front().size(); }

    void add(Text const& text, std::size_t line, Words const& row) {
        if (row.size() != names.size())
            text.fail(line,
                      fmt::format("{} columns; allowed: {}, as in the header", row.size(), names.size()));
        bool const first = rows() == 0;
        for (std::size_t c = 0; c < names.size(); ++c) {
            if (first && !to_number(row[c])) words.insert(names[c]);
            samples[c].push_back(words.contains(names[c]) ? 0.0 : text.number(line, row[c]));
        }
    }

    void move_to(CodeOutput& output) {
        for (std::size_t c = 0; c < names.size(); ++c)
            if (words.contains(names[c])) {
                output.notes.push_back(fmt::format("{}: holds no numbers and was left out", names[c]));
            } else if (!is_axis(names[c])) {
                output.series.emplace_back(names[c], std::move(samples[c]));
            } else if (output.axis.empty()) {
                output.axis = names[c];
                output.at = std::move(samples[c]);
            }
    }
};

// --- formats ---------------------------------------------------------------------------------------------

// A number with its error per line: of a quantity, or of a bin of g(r).
void add_estimate(CodeOutput& output, Text const& text, std::size_t line, Words const& row, bool curve) {
    Estimate estimate{.value = text.number(line, row[1]), .error = text.number(line, row[2])};
    double const blocks = row.size() == 4 ? text.number(line, row[3]) : double(many_blocks);
    if (estimate.error < 0.0) text.fail(line, "error is negative; allowed: a number >= 0");
    if (!(blocks >= 2.0 && blocks <= 1e9)) text.fail(line, "blocks: allowed: an integer, 2 to 1e9");
    estimate.blocks = static_cast<std::size_t>(blocks);
    if (curve) {
        output.curve.x.push_back(text.number(line, row[0]));
        output.curve.y.push_back(estimate);
    } else {
        output.values.push_back({row[0], estimate});
    }
}

// GROMACS' .xvg has the names of its columns in lines `@ xaxis label "Time (ps)"`, `@ s0 legend "Pressure"`.
void read_legend(std::string const& line, Words& legends) {
    auto const quote = line.find('"');
    if (quote == std::string::npos) return;
    std::string const text = line.substr(quote + 1, line.rfind('"') - quote - 1);
    if (line.find("xaxis") != std::string::npos) legends.insert(legends.begin(), text);
    if (line.find(" legend ") != std::string::npos) legends.push_back(text);
}

// The header is the first line that is no comment; or, if that holds a number, the last comment above it that
// has as many words; else the columns have no names of their own. Or each line has the names in it.
CodeOutput read_table(Text const& text) {
    static constexpr std::string_view comment_marks = "#%!@&";
    CodeOutput output;
    std::optional<Columns> columns;
    bool values = false, curve = false, labels = false;
    std::vector<Words> comments;
    Words legends;
    for (std::size_t k = 0; k < text.lines.size(); ++k) {
        std::string const& line = text.lines[k];
        if (line.empty()) continue;
        if (comment_marks.find(line.front()) != std::string_view::npos) {
            if (line.front() == '@') read_legend(line, legends);
            comments.push_back(fields_of(boost::trim_left_copy_if(line, boost::is_any_of("#%! \t"))));
            continue;
        }
        Words row = fields_of(line);
        auto const pairs = labelled(line);
        if (!columns && !legends.empty()) {
            output.code = "GROMACS";
            columns.emplace(legends);
        } else if (!columns && !pairs.empty()) {
            labels = true;
            Words names;
            for (auto const& [name, value] : pairs) names.push_back(name);
            columns.emplace(names);
        } else if (!columns &&
                   std::any_of(row.begin(), row.end(), [](auto const& w) { return to_number(w); })) {
            auto const above = std::find_if(comments.rbegin(), comments.rend(), [&](Words const& comment) {
                return comment.size() == row.size() && !to_number(comment[0]);
            });
            Words names;
            for (std::size_t c = 1; c <= row.size(); ++c) names.push_back(fmt::format("column_{}", c));
            if (above == comments.rend())
                output.notes.push_back(fmt::format("{}: no header; the columns are called {} to {}",
                                                   text.file, names.front(), names.back()));
            columns.emplace(above == comments.rend() ? names : *above);
        }
        if (labels) {
            row.clear();
            for (std::size_t c = 0; c < pairs.size(); ++c) {
                if (c >= columns->names.size() || pairs[c].first != columns->names[c])
                    text.fail(k, fmt::format("allowed: {} with a number each, as above",
                                             fmt::join(columns->names, ", ")));
                row.push_back(pairs[c].second);
            }
        }
        if (!columns) {
            columns.emplace(row);
            values = row.size() >= 3 && row[0] == "quantity" && row[1] == "value" && row[2] == "error";
            curve = row.size() >= 3 && row[0] == "r" && row[1] == "radial_distribution" && row[2] == "error";
            if ((values || curve) && (row.size() > 4 || (row.size() == 4 && row[3] != "blocks")))
                text.fail(k, fmt::format("allowed: {},{},error[,blocks]", row[0], row[1]));
        } else if (row == columns->names) {
            continue;  // written once more by a run that went on
        } else if (!values && !curve) {
            columns->add(text, k, row);
        } else if (row.size() != columns->names.size()) {
            text.fail(k, fmt::format("{} columns; allowed: {}", row.size(), columns->names.size()));
        } else {
            add_estimate(output, text, k, row, curve);
        }
    }
    if (columns && !values && !curve) columns->move_to(output);
    return output;
}

// What `fix ID group print N "kT = ${t} at $(step)"` prints: the names of its variables, and how a line
// looks.
struct Printed {
    Words names;
    std::regex line;
};

// The longest line that is held against a pattern: the library's search goes deeper with each character.
constexpr std::size_t longest_line = 2000;

std::optional<Printed> printed_by(std::string const& command) {
    static std::regex const is_print(R"(fix\s+\S+\s+\S+\s+print\s+\S+\s+(["']+)(.*?)\1.*)"),
        variable(R"(\$\{([^}]*)\}|\$\(([^)]*)\)|\$(\w))"), special(R"([.^$|()\[\]{}*+?\\])");
    std::smatch found;
    if (command.size() > longest_line || !std::regex_match(command, found, is_print)) return {};
    std::string const text = found[2];
    Printed printed;
    std::string pattern;
    auto from = text.cbegin();
    for (std::sregex_iterator it(text.begin(), text.end(), variable), end; it != end; ++it) {
        pattern += std::regex_replace(std::string(from, (*it)[0].first), special, R"(\$&)") + R"(([-+.\w]+))";
        from = (*it)[0].second;
        std::string const name = (*it)[1].str() + (*it)[2].str() + (*it)[3].str();
        printed.names.push_back(name.substr(0, name.find(":%")));
    }
    pattern += std::regex_replace(std::string(from, text.cend()), special, R"(\$&)");
    if (printed.names.empty()) return {};
    printed.line = std::regex(R"(\s*)" + boost::trim_copy(pattern) + R"(\s*)");
    return printed;
}

// The table of a run in a LAMMPS log, and what fix print printed meanwhile.
struct RunTable {
    Columns columns;
    std::vector<Columns> printed;
    std::size_t commands;  // how many commands came before
    double atoms = 0.0;
    std::vector<double> box;
};

// Reads line after line. Rows of a table begin with a number (thermo_style one, custom), or are `- [...]`
// (yaml), or blocks of `name = number` after a line with the step (multi); messages of the program may stand
// between.
class LogReader {
public:
    explicit LogReader(Text const& text) : text_(text) {}

    CodeOutput read(std::size_t run) {
        for (line_ = 0; line_ < text_.lines.size(); ++line_) read_line(text_.lines[line_]);
        end_block();
        return choose(run);
    }

private:
    enum class State { outside, before_header, in_table };

    void read_line(std::string const& line) {
        Words const words = words_of(line);
        if (words.empty()) return;
        if (line.starts_with("Per MPI rank memory") || line.starts_with("Memory usage per processor")) {
            state_ = State::before_header;
        } else if (words[0] == "Loop" && words.size() > 2 && words[1] == "time") {
            end_block();
            if (state_ == State::in_table && words.size() > 1 && words.back() == "atoms")
                tables_.back().atoms = to_number(words[words.size() - 2]).value_or(0.0);
            state_ = State::outside;
        } else if (line.starts_with("keywords: [")) {
            begin_table(yaml_words(line));
        } else if (line.starts_with("- [") && state_ == State::in_table) {
            add_row(yaml_words(line));
        } else if (words.size() > 2 && words[1] == "Step" && line.starts_with("------------")) {
            end_block();
            block_.emplace_back("Step", words[2]);
        } else if (!block_.empty() && !labelled(line).empty()) {
            for (auto const& pair : labelled(line)) block_.push_back(pair);
        } else if (line.starts_with("ERROR")) {
            output_.notes.push_back(fmt::format("{}:{}: {}", text_.file, line_ + 1, line));
        } else if (state_ == State::before_header || (state_ == State::outside && words[0] == "Step")) {
            if (is_header(words)) begin_table(words);
        } else if (state_ == State::in_table && is_printed(line)) {
        } else if (state_ == State::in_table && to_number(words[0])) {
            add_row(words);
        } else {
            message_ = line.starts_with("SHAKE stats");  // and numbers in the lines that follow
            read_command(line, words);
        }
    }

    // Whether a row follows, or the run ends at once.
    bool is_header(Words const& words) const {
        if (to_number(words[0]) || line_ + 1 == text_.lines.size()) return false;
        Words const next = words_of(text_.lines[line_ + 1]);
        return !next.empty() && (next[0] == "Loop" || to_number(next[0]));
    }

    void begin_table(Words const& names) {
        state_ = State::in_table;
        tables_.push_back(
            {.columns = Columns(names), .printed = {}, .commands = output_.commands.size(), .box = box_});
        for (auto const& format : formats_) tables_.back().printed.emplace_back(format.names);
    }

    void add_row(Words const& row) {
        Columns& columns = tables_.back().columns;
        bool const numbers = std::all_of(row.begin(), row.end(), [](auto const& w) { return to_number(w); });
        if (!text_.whole && text_.last(line_))
            output_.notes.push_back(
                fmt::format("{}:{}: the line has no end and was left out", text_.file, line_ + 1));
        else if (row.size() != columns.names.size() && (message_ || !numbers || !formats_.empty()))
            ++strange_;
        else
            columns.add(text_, line_, row);
        message_ = message_ && row.size() != columns.names.size();
    }

    // The block of thermo_style multi that ends here.
    void end_block() {
        if (block_.empty()) return;
        Words names, row;
        for (auto const& [name, value] : block_) {
            names.push_back(name);
            row.push_back(value);
        }
        block_.clear();
        if (state_ == State::before_header) begin_table(names);
        if (state_ != State::in_table) return;
        if (row.size() < tables_.back().columns.names.size() && line_ == text_.lines.size())
            output_.notes.push_back(
                fmt::format("{}: the file ends within a block, which was left out", text_.file));
        else
            tables_.back().columns.add(text_, line_ - 1, row);
    }

    static Words yaml_words(std::string const& line) {
        auto const from = line.find('[') + 1;
        Words words;
        boost::split(words, line.substr(from, line.find(']') - from), boost::is_any_of(","));
        for (auto& word : words) boost::trim_if(word, boost::is_any_of(" '\""));
        std::erase(words, "");
        return words;
    }

    bool is_printed(std::string const& line) {
        std::smatch found;
        if (line.size() > longest_line) return false;
        for (std::size_t k = 0; k < tables_.back().printed.size(); ++k)
            if (std::regex_match(line, found, formats_[k].line)) {
                tables_.back().printed[k].add(text_, line_, Words(found.begin() + 1, found.end()));
                return true;
            }
        return false;
    }

    void read_command(std::string const& line, Words words) {
        static std::set<std::string> const names{"units", "timestep",  "pair_style",    "pair_coeff", "mass",
                                                 "fix",   "dimension", "thermo_modify", "unfix",
                                                 "compute"};
        static std::regex const box(R"(.*box = \((\S+) (\S+) (\S+)\) to \((\S+) (\S+) (\S+)\).*)");
        std::smatch found;
        if (names.contains(words[0])) {
            words.erase(std::find_if(words.begin(), words.end(), [](auto const& w) { return w[0] == '#'; }),
                        words.end());
            if (words[0] == "fix")
                if (auto format = printed_by(line)) formats_.push_back(std::move(*format));
            output_.commands.push_back(std::move(words));
        } else if (line.size() <= longest_line && line.find("box = (") != std::string::npos &&
                   std::regex_match(line, found, box)) {
            box_.clear();
            for (std::size_t axis = 1; axis <= 3; ++axis)
                box_.push_back(to_number(found[axis + 3].str()).value_or(0.0) -
                               to_number(found[axis].str()).value_or(0.0));
        } else if (line.starts_with("Processor partition = ")) {
            output_.partition = words.back();
        }
    }

    CodeOutput choose(std::size_t run) {
        if (tables_.empty() || (run > tables_.size() && run != all_runs))
            throw InputError(
                fmt::format("{}: --run {}: allowed: 1 to {}, the thermo tables of the log{}", text_.file,
                            run == all_runs ? "all" : fmt::format("{}", run), tables_.size(),
                            tables_.empty() ? " (of several partitions each has its own log)" : ""));
        RunTable table = run == 0 || run == all_runs ? tables_.back() : tables_[run - 1];
        if (run == all_runs) join(table);
        if (tables_.size() > 1 && run == 0)
            output_.notes.push_back(fmt::format(
                "{}: the last of {} thermo tables was read; --run K reads another, --run all those like it",
                text_.file, tables_.size()));
        if (strange_ > 0)
            output_.notes.push_back(fmt::format(
                "{}: {} lines that begin with a number but are no rows were left out", text_.file, strange_));
        output_.code = "LAMMPS";
        output_.commands.resize(table.commands);
        for (auto const& words : output_.commands) {
            if (words[0] == "units" && words.size() > 1) output_.per_particle = words[1] == "lj";
            if (words[0] != "thermo_modify") continue;
            if (auto const norm = std::find(words.begin(), words.end(), "norm"); words.end() - norm > 1)
                output_.per_particle = norm[1] == "yes";
        }
        output_.atoms = table.atoms;
        output_.box = table.box;
        table.columns.move_to(output_);
        for (auto& lines : table.printed)
            if (lines.rows() > 0) {
                CodeOutput& also = output_.also.emplace_back();
                also.file = text_.file;
                also.code = output_.code;
                lines.move_to(also);
            }
        return output_;
    }

    // The rows of all tables with these columns; the first row of a run is the last of the one before.
    void join(RunTable& table) const {
        Columns all(table.columns.names);
        for (auto const& one : tables_) {
            if (one.columns.names != all.names) continue;
            bool const again = all.rows() > 0 && one.columns.rows() > 0 && is_axis(all.names[0]) &&
                               all.samples[0].back() == one.columns.samples[0].front();
            for (std::size_t c = 0; c < all.names.size(); ++c)
                all.samples[c].insert(all.samples[c].end(), one.columns.samples[c].begin() + again,
                                      one.columns.samples[c].end());
        }
        table.columns = all;
        table.printed.clear();
    }

    Text const& text_;
    std::size_t line_ = 0, strange_ = 0;
    bool message_ = false;
    State state_ = State::outside;
    std::vector<std::pair<std::string, std::string>> block_;
    std::vector<Printed> formats_;
    std::vector<RunTable> tables_;
    std::vector<double> box_;
    CodeOutput output_;
};

// The mean of each column of a block of fix ave/chunk over its chunks, weighted with their numbers of
// particles; of a density, whose chunks are equal volumes, without weights.
Words mean_over_chunks(Columns const& block, std::size_t first) {
    Words row;
    std::vector<double> const& count = block.samples[first - 1];
    for (std::size_t c = first; c < block.names.size(); ++c) {
        bool const density = block.names[c].starts_with("density/");
        double sum = 0.0, weights = 0.0;
        for (std::size_t k = 0; k < count.size(); ++k) {
            double const weight = density ? 1.0 : count[k];
            sum += weight * block.samples[c][k];
            weights += weight;
        }
        row.push_back(fmt::format("{}", weights > 0.0 ? sum / weights : 0.0));
    }
    return row;
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
    // of fix ave/chunk each block becomes a row
    auto const ncount = std::find(columns.names.begin(), columns.names.end(), "Ncount");
    bool const chunks = vector && columns.names[0] == "Chunk" && ncount != columns.names.end();
    output.code = chunks ? "LAMMPS ave/chunk" : "LAMMPS";
    std::size_t const first_value = std::size_t(ncount - columns.names.begin()) + 1;
    Words names{"step"};
    if (chunks) names.insert(names.end(), ncount + 1, columns.names.end());
    Columns means(names);
    static constexpr std::string_view says_rate = "shear rate ";
    if (auto const at = text.lines[0].rfind(says_rate); at != std::string::npos)
        output.shear_rate = text.number(0, text.lines[0].substr(at + says_rate.size()));
    if (vector && columns.names.size() < 3)
        text.fail(k - 1, "allowed: row, r, g(r), and columns that do not count");
    if (vector && !chunks) output.axis = "step";
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
            double const count = row.size() == (chunks ? 3 : 2) ? text.number(k, row[1]) : 0.0;
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
        if (chunks) {
            Words means_row = mean_over_chunks(block, first_value);
            means_row.insert(means_row.begin(), row[0]);
            means.add(text, first, means_row);
            continue;
        }
        if (output.r.empty()) {
            output.r = block.samples[1];
            output.g.resize(output.r.size());
        }
        if (block.samples[1] != output.r) text.fail(first, "other bins than before; allowed: the same");
        for (std::size_t bin = 0; bin < output.r.size(); ++bin)
            output.g[bin].push_back(block.samples[2][bin]);
        output.at.push_back(text.number(first, row[0]));
    }
    if (chunks)
        output.notes.push_back(
            fmt::format("{}: each block is a sample, the mean over its chunks", text.file));
    if (chunks || !vector) (chunks ? means : columns).move_to(output);
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
    auto const paths = archive.observables();
    for (auto const& path : paths) {
        std::string const root = "observables/" + path;
        std::vector<double> samples, at;
        archive(archive.has(root + "/value") ? root + "/value" : root, samples);
        if (!std::all_of(samples.begin(), samples.end(), [](double x) { return std::isfinite(x); }))
            throw InputError(fmt::format("{}: {}: not all are numbers", file.string(), root));
        // a subsystem's name is left out where the observable is of no other
        std::string const name = path.substr(path.rfind('/') + 1);
        auto const same = std::count_if(paths.begin(), paths.end(), [&](auto const& other) {
            return other.substr(other.rfind('/') + 1) == name;
        });
        output.series.emplace_back(same == 1 ? name : path, std::move(samples));
        for (auto const* const axis : {"/time", "/step"})
            if (output.axis.empty() && archive.has(root + axis)) {
                std::size_t const size = output.series.back().second.size();
                archive(root + axis, at);
                if (at.size() == 1 && size > 1) {  // an increment
                    at.resize(size, at[0]);
                    for (std::size_t k = 0; k < size; ++k) at[k] *= double(k);
                }
                if (at.size() == size) {
                    output.axis = axis + 1;
                    output.at = at;
                }
            }
    }
    output.code = "H5MD";
    return output;
}

// The code whose columns these are; empty if no column tells.
std::string code_of(CodeOutput const& output) {
    static constexpr std::array<std::pair<std::string_view, std::string_view>, 4> tells{
        {{"Temperature (K)", "OpenMM"},
         {"Potential Energy (kJ/mole)", "OpenMM"},
         {"ThermodynamicQuantities.", "HOOMD-blue"},
         {"num_particles", "Mirheo"}}};
    for (auto const& [name, samples] : output.series)
        for (auto const& [part, code] : tells)
            if (name.find(part) != std::string::npos) return std::string(code);
    return {};
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
                   line.starts_with("Memory usage per processor") || line.starts_with("Loop time of ") ||
                   line.starts_with("keywords: [");
        });
        auto const is_comment = [](std::string const& line) { return line.empty() || line[0] == '#'; };
        auto const data = std::find_if_not(text.lines.begin(), text.lines.end(), is_comment);
        bool const ave_time = data - text.lines.begin() > 1 && is_comment(text.lines[1]) &&
                              (data == text.lines.end() || data->find_first_of(",\t") == std::string::npos) &&
                              (data == text.lines.end() || to_number(words_of(*data)[0]));
        output = log ? LogReader(text).read(run) : ave_time ? read_ave_time(text) : read_table(text);
    }
    output.file = file.string();
    if (output.code.empty()) output.code = code_of(output);
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
