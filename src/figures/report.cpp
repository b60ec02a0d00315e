#include "report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "comparison_json.hpp"
#include "errors.hpp"
#include "files.hpp"
#include "judge_figure.hpp"
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
