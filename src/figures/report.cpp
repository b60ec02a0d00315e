#include "report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>

#include "comparison_json.hpp"
#include "errors.hpp"
#include "files.hpp"
#include "judge_figure.hpp"
#include "names.hpp"
#include "picture.hpp"
#include "progress.hpp"
#include "toml_reader.hpp"

namespace dpd {

using Json = nlohmann::ordered_json;

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

// A field of a CSV file: quoted where it holds a comma, a quote or a line break (RFC 4180).
std::string csv_field(std::string_view text) {
    if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
    std::string field = "\"";
    for (char const c : text) field.append(c == '"' ? 2 : 1, c);
    return field + '"';
}

double median(std::vector<double> values) {
    if (values.empty()) return std::nan("");
    auto const middle = values.begin() + std::ptrdiff_t(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// One comparison with all that is said of it.
struct Row {
    Comparison const& comparison;
    Verdict verdict;
    Kind kind;
    double deviation_percent, z, noticeable_percent, seconds_to_one_percent, more_seconds;
};

Row row_of(Comparison const& c, std::size_t family) {
    double const error = std::hypot(c.estimate.error, c.theory_error);
    return {.comparison = c,
            .verdict = judge(c, family),
            .kind = kind_of(c, family),
            .deviation_percent = c.theory != 0.0 ? 100.0 * (c.estimate.value / c.theory - 1.0) : 0.0,
            .z = error > 0.0 ? (c.estimate.value - c.theory) / error : 0.0,
            .noticeable_percent = 100.0 * noticeable(c, family),
            .seconds_to_one_percent = c.seconds * std::pow(c.estimate.error / (0.01 * c.estimate.value), 2),
            .more_seconds = seconds_to_decide(c, family)};
}

// A bound prints as one: what is on its right side agrees, however far.
std::string theory_text(Comparison const& c) {
    switch (c.criterion.relation) {
        case Relation::equal:
            return fmt::format("{:.6g}", c.theory);
        case Relation::at_most:
            return fmt::format("<= {:.6g}", c.theory);
        case Relation::at_least:
            return fmt::format(">= {:.6g}", c.theory);
        case Relation::differs:
            return fmt::format("!= {:.6g}", c.theory);
    }
    return {};
}

void print_table(std::vector<Row> const& rows) {
    fmt::print(
        "{:<11} {:<22} {:>8} {:<28} {:>12} {:>10} {:>15} {:>8} {:>7} {:<11} {:>9} {:<10} {:>8} {:>8}\n",
        "figure", "curve", "x", "quantity", "value", "error", "theory", "dev. %", "z", "kind", "noticed %",
        "verdict", "time", "to 1 %");
    for (auto const& row : rows) {
        auto const& c = row.comparison;
        std::string const noticed =
            std::isfinite(row.noticeable_percent) ? fmt::format("{:.3g}", row.noticeable_percent) : "-";
        fmt::print(
            "{:<11} {:<22} {:>8.4g} {:<28} {:>12.6g} {:>10.2g} {:>15} {:>8.2f} {:>7.1f} {:<11} {:>9} {:<10} "
            "{:>8} {:>8}\n",
            c.figure, c.curve, c.x, c.criterion.quantity, c.estimate.value, c.estimate.error, theory_text(c),
            row.deviation_percent, row.z, name_of(row.kind), noticed, verdict_text(row.verdict, row.kind),
            duration_text(c.seconds), duration_text(row.seconds_to_one_percent));
        if (row.verdict == Verdict::undecided)
            fmt::print("{:>11} {} more would decide\n", "",
                       std::isfinite(row.more_seconds) ? duration_text(row.more_seconds) : "no run time");
    }
}

std::string csv_of(std::vector<Row> const& rows) {
    std::string csv =
        "figure,curve,parameter,x,quantity,value,error,relation,theory,theory_value,deviation_percent,z,"
        "tolerance,kind,noticeable_percent,verdict,seconds,seconds_to_1_percent,more_seconds_to_decide\n";
    for (auto const& row : rows) {
        auto const& c = row.comparison;
        csv += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(c.figure),
                           csv_field(c.curve), csv_field(c.parameter), c.x, csv_field(c.criterion.quantity),
                           c.estimate.value, c.estimate.error, name_of(c.criterion.relation),
                           csv_field(c.criterion.theory), c.theory, row.deviation_percent, row.z,
                           c.criterion.tolerance, name_of(row.kind), row.noticeable_percent,
                           verdict_text(row.verdict, row.kind), c.seconds, row.seconds_to_one_percent,
                           row.more_seconds);
    }
    return csv;
}

std::string json_of(std::vector<Row> const& rows) {
    Json json = Json::array();
    for (auto const& row : rows) {
        Json one = to_json(row.comparison);
        one["z"] = row.z;
        one["kind"] = name_of(row.kind);
        one["noticeable_percent"] = row.noticeable_percent;
        one["verdict"] = verdict_text(row.verdict, row.kind);
        one["seconds_to_1_percent"] = row.seconds_to_one_percent;
        one["more_seconds_to_decide"] = row.more_seconds;
        json.push_back(std::move(one));
    }
    return json.dump(1) + "\n";
}

// What the table is worth, kind by kind.
std::string summary_of(std::vector<Row> const& rows) {
    std::string text =
        "| kind | number | agree | disagree | undecided | median deviation | noticed from (median) |\n"
        "|---|---|---|---|---|---|---|\n";
    for (auto const name : names<Kind>) {
        std::map<Verdict, std::size_t> count;
        std::vector<double> deviations, thresholds;
        for (auto const& row : rows) {
            if (name_of(row.kind) != name) continue;
            ++count[row.verdict];
            if (row.comparison.theory == 0.0) continue;
            deviations.push_back(std::abs(row.deviation_percent));
            thresholds.push_back(row.noticeable_percent);
        }
        std::size_t const all =
            count[Verdict::agrees] + count[Verdict::disagrees] + count[Verdict::undecided];
        if (all == 0) continue;
        bool const describes = name == name_of(Kind::description);
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {:.2g} % | {:.2g} % |\n", name, all,
                        describes ? "-" : std::to_string(count[Verdict::agrees]), count[Verdict::disagrees],
                        count[Verdict::undecided], median(deviations), median(thresholds));
    }
    return text;
}

}  // namespace

bool report(std::vector<Comparison> const& comparisons, std::filesystem::path const& output,
            std::vector<std::string> const& ids) {
    std::vector<Row> rows, printed;
    std::map<std::string_view, std::size_t> count;
    std::size_t const family = family_of(comparisons);
    for (auto const& comparison : comparisons) {
        rows.push_back(row_of(comparison, family));
        if (!ids.empty() && std::find(ids.begin(), ids.end(), comparison.figure) == ids.end()) continue;
        printed.push_back(rows.back());
        ++count[verdict_text(rows.back().verdict, rows.back().kind)];
    }
    write_file(output / "report.csv", csv_of(rows));
    write_file(output / "report.json", json_of(rows));
    write_file(output / "report.md", summary_of(rows));
    print_table(printed);
    fmt::print(
        "{}{} comparisons: {} agree, {} disagree, {} undecided, {} described; false-alarm rate of the whole "
        "table "
        "{} %\n",
        summary_of(printed), printed.size(), count["agrees"], count["disagrees"], count["undecided"],
        count["described"], 100.0 * family_false_alarm);
    print_run_time(output / "run_time.json");
    print_run_time(output / "quick" / "run_time.json");
    return count["disagrees"] == 0;
}

}  // namespace dpd
