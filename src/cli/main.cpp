// The command line: theory, run and what measures or judges; `dpdref --help` lists it. Exit
// codes: 0 done, 1 a verdict is "disagrees", 2 bad input, 3 the simulation diverged, 130 interrupted (run
// again to resume).

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "analysis.hpp"
#include "answers.hpp"
#include "compare.hpp"
#include "conventions.hpp"
#include "errors.hpp"
#include "exact_answers.hpp"
#include "figure.hpp"
#include "lammps.hpp"
#include "progress.hpp"
#include "run.hpp"
#include "stability.hpp"
#include "theory/registry.hpp"
#include "toml_reader.hpp"
#include "version.hpp"
#include "work_precision.hpp"

namespace {

using Json = nlohmann::ordered_json;

constexpr int exit_disagrees = 1, exit_bad_input = 2, exit_diverged = 3, exit_interrupted = 130;

std::atomic<bool> stop_requested = false;

extern "C" void request_stop(int) { stop_requested = true; }

// --- theory ----------------------------------------------------------------------------------------------

void list_theory(bool json) {
    namespace theory = dpd::theory;
    Json list = Json::array();
    for (auto const& form : theory::closed_forms()) {
        std::string parameters;
        for (auto const& parameter : theory::parameters())
            if (std::find(form.parameters.begin(), form.parameters.end(), parameter.name) !=
                form.parameters.end()) {
                auto const value = form.default_text(parameter);
                parameters += fmt::format(" {}{}", parameter.name, value ? fmt::format("={}", *value) : "");
            }
        if (json)
            list.push_back({{"id", form.id},
                            {"paper", form.paper},
                            {"equation", form.equation},
                            {"quantity", form.quantity},
                            {"formula", form.formula},
                            {"parameters", form.parameters}});
        else
            fmt::print("{:<16} {:<16} {:<12} {:<40}{}\n", form.id, form.paper, form.equation, form.quantity,
                       parameters);
    }
    if (json) fmt::print("{}\n", list.dump(1));
}

std::vector<std::pair<std::string, std::string>> split(std::vector<std::string> const& assignments) {
    std::vector<std::pair<std::string, std::string>> given;
    for (auto const& assignment : assignments) {
        auto const equals = assignment.find('=');
        if (equals == std::string::npos)
            throw dpd::InputError(fmt::format("{}: not an assignment; allowed: key=value", assignment));
        given.emplace_back(assignment.substr(0, equals), assignment.substr(equals + 1));
    }
    return given;
}

void evaluate_theory(std::string const& id, std::vector<std::string> const& assignments, bool json) {
    auto const given = split(assignments);
    double const value = dpd::theory::evaluate(id, given);
    auto const& form = *dpd::theory::find(id);
    if (json) {
        Json result{
            {"id", id}, {"paper", form.paper}, {"equation", form.equation}, {"quantity", form.quantity}};
        for (auto const& [name, text] : given) result["parameters"][name] = text;
        result["value"] = value;
        fmt::print("{}\n", result.dump());
    } else {
        fmt::print("{}, {} eq. {}: {}\n{:.12g}\n", form.quantity, form.paper, form.equation, form.formula,
                   value);
    }
}

// CLI11 would wrap a negative or too large number silently.
std::optional<std::uint64_t> read_seed(std::optional<std::string> const& text) {
    if (!text) return std::nullopt;
    std::uint64_t seed = 0;
    auto const [end, error] = std::from_chars(text->data(), text->data() + text->size(), seed);
    if (error != std::errc{} || end != text->data() + text->size())
        throw dpd::InputError(
            fmt::format("--seed: {} is not allowed; allowed: an integer, 0 to 2^64-1", *text));
    return seed;
}

// --- convert ---------------------------------------------------------------------------------------------

void list_codes() {
    for (auto const& code : dpd::codes()) {
        fmt::print("{}: {}\n", code.name, code.title);
        for (auto const& key : code.keys)
            fmt::print("    {:<24} {}\n",
                       key.fallback.empty()  ? std::string(key.name)
                       : key.fallback == "-" ? fmt::format("[{}]", key.name)
                                             : fmt::format("{}={}", key.name, key.fallback),
                       key.meaning);
    }
}

// The lines can be the arguments of the way back; a scene has them in its first line.
void convert(std::string const& from, std::string const& to, std::vector<std::string> const& assignments) {
    auto const& source = dpd::find_code(from);
    auto const& target = dpd::find_code(to);
    auto const fluid = dpd::read_fluid(source, split(assignments));
    std::vector<std::string> lines;
    for (auto const& [key, value] : dpd::write_fluid(target, fluid))
        lines.push_back(fmt::format("{}={}", key, value));
    if (to == "dpdref")
        fmt::print("# dpdref {}\n{}", fmt::join(lines, " "), dpd::scene_fragment(fluid, source.mover));
    else
        fmt::print("{}\n", fmt::join(lines, "\n"));
}

// --- run -------------------------------------------------------------------------------------------------

void print_result(dpd::Scene const& scene, dpd::RunResult const& result, bool json) {
    auto const quantities = dpd::analyze(scene, {result.record});
    auto const& counters = result.counters;
    double const cost = 1e9 * result.seconds /
                        (double(std::max<std::uint64_t>(1, counters.steps)) * double(result.particles));
    if (counters.coincident_pairs > 0)
        fmt::print(stderr, "dpdref: warning: {} pairs at r = 0 had no direction and did not interact\n",
                   counters.coincident_pairs);
    // soft forces are bounded: beyond their stable step a run is hot, but ends
    if (double const set = scene.thermostat_kT(); set > 0.0 && result.kinetic_temperature > 10.0 * set)
        fmt::print(stderr,
                   "dpdref: warning: kT ended at {:.3g}, the thermostat is set to {:.3g}; try a smaller "
                   "time.step\n",
                   result.kinetic_temperature, set);
    if (json) {
        Json output{
            {"title", scene.title}, {"key", scene.key()}, {"seed", scene.seed}, {"seconds", result.seconds}};
        for (auto const& q : quantities)
            output["quantities"][q.name] = {
                {"value", q.estimate.value}, {"error", q.estimate.error}, {"blocks", q.estimate.blocks}};
        output["counters"] = {{"steps", counters.steps},
                              {"searches", counters.searches},
                              {"pairs_found", counters.pairs_found},
                              {"pair_updates", counters.pair_updates},
                              {"potential_evaluations", counters.potential_evaluations},
                              {"random_draws", counters.random_draws},
                              {"boundary_pairs", counters.boundary_pairs},
                              {"coincident_pairs", counters.coincident_pairs}};
        output["bytes"] = result.bytes;
        output["nanoseconds_per_particle_and_step"] = cost;
        fmt::print("{}\n", output.dump(1));
        return;
    }
    fmt::print("{}\n{} particles, {} steps, {} ({:.0f} ns per particle and step){}\n", scene.title,
               result.particles, counters.steps, dpd::duration_text(result.seconds), cost,
               result.from_cache ? ", read from file" : "");
    for (auto const& q : quantities) {
        if (std::isfinite(q.estimate.error) && q.estimate.error > 0.0)
            fmt::print("  {:<30} {:>14.6g} +- {:<9.2g} ({} blocks)\n", q.name, q.estimate.value,
                       q.estimate.error, q.estimate.blocks);
        else
            fmt::print("  {:<30} {:>14.6g}\n", q.name, q.estimate.value);
    }
    fmt::print(
        "  pairs found {}, updated {}; random draws {}; potential evaluations {}; coincident pairs {}\n",
        counters.pairs_found, counters.pair_updates, counters.random_draws, counters.potential_evaluations,
        counters.coincident_pairs);
}

// --- figures ---------------------------------------------------------------------------------------------

// Regenerates figures and prints their comparisons; false if one disagrees. A shard only runs.
bool make_figures(std::filesystem::path const& verification, std::vector<std::string> const& ids,
                  std::string const& budget, dpd::CampaignOptions const& options) {
    std::vector<dpd::Figure> figures;
    for (auto const& id : ids) figures.push_back(dpd::load_figure(verification, id, budget));
    auto const run_time = dpd::run_points(figures, options);
    if (!run_time) return true;
    if (ids == dpd::figure_ids(verification)) dpd::write_run_time(*run_time, budget, options.output);
    std::vector<dpd::Comparison> all;
    for (auto const& figure : figures) {
        auto const comparisons = dpd::compare(figure);
        dpd::write_figure(figure, comparisons, budget, options.output);
        all.insert(all.end(), comparisons.begin(), comparisons.end());
    }
    return dpd::report(all, options.output);
}

// The study of the integrators, and the figures that are defined beside it.
bool work_precision(std::filesystem::path const& directory, std::vector<std::string> ids,
                    std::string const& budget, dpd::CampaignOptions const& options) {
    std::string const study = "integrators";
    auto known = dpd::figure_ids(directory);
    known.insert(known.begin(), study);
    if (ids.empty() || ids == std::vector<std::string>{"all"}) ids = known;
    for (auto const& id : ids)
        if (std::find(known.begin(), known.end(), id) == known.end())
            throw dpd::InputError(
                fmt::format("work-precision {}: unknown; allowed: all, {}", id, fmt::join(known, ", ")));
    bool const with_study = std::erase(ids, study) > 0;
    bool const agree = ids.empty() || make_figures(directory, ids, budget, options);
    if (with_study) {
        auto studies = dpd::load_studies(directory / study, budget);
        if (!dpd::run_studies(studies, options)) return agree;
        for (auto const& one : studies) dpd::write_study(one, budget, directory / study, options.output);
    }
    return agree;
}

// Where verification/ and figures/ are: the clone, or else the installed data.
std::filesystem::path data_directory() {
    if (std::filesystem::is_directory("verification")) return ".";
    std::error_code ignored;
    auto const program = std::filesystem::read_symlink("/proc/self/exe", ignored);
    return (program.parent_path() / DPDREF_DATA_DIR).lexically_normal();
}

int dispatch(int argc, char** argv) {
    CLI::App app{"Reference implementation of dissipative particle dynamics at finite time step", "dpdref"};
    app.set_version_flag("--version", fmt::format("dpdref {} (engine revision {}; {} {})", dpd::version,
                                                  dpd::engine_revision, dpd::compiler, dpd::build_flags));
    app.require_subcommand(1);

    bool json = false;
    std::string id;
    std::vector<std::string> assignments;
    auto* const theory = app.add_subcommand("theory", "list the closed forms, or evaluate one");
    theory->add_option("id", id, "id of a closed form");
    theory->add_option("parameters", assignments, "key=value ...");
    theory->add_flag("--json", json, "print JSON");

    std::string from, to;
    auto* const converter = app.add_subcommand("convert", "list codes, or convert parameters between two");
    converter->add_option("from", from, "code or paper that the parameters are of");
    converter->add_option("to", to, "code or paper that wants them; dpdref: a scene's part")->needs("from");
    converter->add_option("parameters", assignments, "key=value ...");

    std::string scene_file;
    std::optional<std::string> out;
    std::vector<std::string> overrides;
    std::optional<std::string> seed;
    auto* const run = app.add_subcommand("run", "run a scene");
    run->add_option("scene", scene_file, "TOML file")->required();
    run->add_option("--set", overrides, "table.key=value, on top of the file")->allow_extra_args(false);
    run->add_option("--seed", seed, "seed of all noise, 0 to 2^64-1");
    run->add_option("--out", out, "HDF5 file of results, checkpoints and provenance");
    run->add_flag("--json", json, "print JSON");

    auto* const exporter = app.add_subcommand("export", "write a scene for another program");
    exporter->require_subcommand(1);
    auto* const lammps = exporter->add_subcommand("lammps", "a directory with an input deck for LAMMPS");
    lammps->add_option("scene", scene_file, "TOML file")->required();
    lammps->add_option("--set", overrides, "table.key=value, on top of the file")->allow_extra_args(false);
    lammps->add_option("--seed", seed, "seed of all noise, 0 to 2^64-1");
    lammps->add_option("--out", out, "directory: new, empty, or of an earlier export")->required();

    std::vector<std::string> ids;
    std::string budget = "quick";
    std::string cache = ".dpdref-cache";
    std::string figures_dir;
    std::string verification = (data_directory() / "verification").lexically_normal().string();
    std::optional<std::string> shard;
    unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
    auto* const figure = app.add_subcommand("figure", "regenerate figures");
    figure->add_option("ids", ids, "figure ids, or all")->required();

    auto* const stability = app.add_subcommand("stability", "largest steps of the integrators, by bisection");

    auto* const work = app.add_subcommand("work-precision", "errors of the integrators against run time");
    work->add_option("ids", ids, "integrators, or one of the maps; default all");

    auto* const measure = app.add_subcommand("answers", "measure the reference answers");

    for (auto* const campaign : {figure, stability, work, measure}) {
        std::string const below = campaign == figure ? "" : "/" + campaign->get_name();
        campaign->add_option("--budget", budget, "quick or paper")->check(CLI::IsMember({"quick", "paper"}));
        campaign->add_option("--jobs", jobs, "runs at a time")->check(CLI::Range(1u, 1024u));
        campaign->add_option("--shard", shard, "k/n: only the k-th of n parts of the runs; draws nothing");
        campaign->add_option("--out", figures_dir,
                             fmt::format("directory (default figures{0}, or figures/quick{0})", below));
        campaign->add_option("--cache", cache, "directory of finished and unfinished runs");
        campaign->add_option("--verification", verification, "directory of the definitions");
    }

    std::vector<std::string> query;
    std::string answers_file =
        (data_directory() / "figures/answers/answers.json").lexically_normal().string();
    std::optional<std::string> scene_of;
    auto* const answer = app.add_subcommand("answer", "reference values of the nearest state point");
    answer->add_option("query", query, "id of a state point, or key=value ...; nothing lists them");
    answer->add_option("--answers", answers_file, "file of the reference answers");
    answer->add_option("--scene", scene_of, "print the scene of a run: rest, shear, below or above");
    answer
        ->add_option("--of", from,
                     "code whose parameters the query has, see dpdref convert; values in its units")
        ->excludes("--scene");
    answer->add_flag("--json", json, "print JSON");
    auto* const exact = app.add_subcommand("exact", "single steps of a few particles with given noise");
    exact->add_flag("--json", json, "print all numbers, as JSON");
    exact->add_option("--verification", verification, "directory of the definitions");
    std::vector<std::string> outputs, renamings;
    std::optional<std::string> state_point, reference, discard;
    std::size_t table = 0;
    double resolution = 0.01;
    auto* const compare = app.add_subcommand("compare", "judge another code's output against a reference");
    compare->add_option("files", outputs, "CSV, LAMMPS log or fix ave/time file, H5MD, result of dpdref run")
        ->required();
    auto* const of_answer = compare->add_option("--answer", state_point, "id of a reference answer");
    compare->add_option("--answers", answers_file, "file of the reference answers");
    compare->add_option("--reference", reference, "result of dpdref run --out")->excludes(of_answer);
    compare->add_option("--as", renamings, "COLUMN=quantity[*factor]")->allow_extra_args(false);
    compare->add_option("--discard", discard, "equilibration: a time or step of the file, or a share as 20%");
    compare->add_option("--run", table, "which thermo table of a log, from 1; default the last");
    compare->add_option("--resolution", resolution, "relative combined error that an agreement needs")
        ->check(CLI::PositiveNumber);
    compare->add_flag("--json", json, "print JSON");

    std::string report_dir = "figures";
    auto* const report =
        app.add_subcommand("report", "print every comparison; write report.csv and report.json");
    report->add_option("--figures", report_dir, "directory of the regenerated figures");

    try {
        app.parse(argc, argv);
    } catch (CLI::ParseError const& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        throw dpd::InputError(fmt::format("{} (see dpdref --help)", error.what()));
    }

    // where a campaign writes, and how it is run
    auto const campaign_options = [&](std::string const& below) {
        std::filesystem::path output = figures_dir;
        if (figures_dir.empty())
            output = std::filesystem::path(budget == "quick" ? "figures/quick" : "figures") / below;
        dpd::CampaignOptions options{.cache = cache, .output = output, .jobs = jobs, .stop = &stop_requested};
        if (shard) options.shard = dpd::shard_from_text(*shard);
        return options;
    };

    if (theory->parsed()) {
        if (id.empty())
            list_theory(json);
        else
            evaluate_theory(id, assignments, json);
    } else if (converter->parsed()) {
        if (from.empty())
            list_codes();
        else
            convert(from, to, assignments);
    } else if (run->parsed()) {
        dpd::Scene const scene = dpd::load_scene(scene_file, overrides, read_seed(seed));
        dpd::RunOptions options;
        if (out) options.output = *out;
        options.stop = &stop_requested;
        dpd::RunResult result;
        {
            dpd::Progress progress(scene.title.empty() ? scene_file : scene.title);
            options.progress = [&](double fraction) { progress(fraction); };
            result = dpd::run(scene, options);
        }
        print_result(scene, result, json);
    } else if (lammps->parsed()) {
        dpd::export_lammps(dpd::load_scene(scene_file, overrides, read_seed(seed)), *out);
        fmt::print("{}: written; next: see {}/README\n", *out, *out);
    } else if (figure->parsed()) {
        if (ids == std::vector<std::string>{"all"}) ids = dpd::figure_ids(verification);
        if (ids.empty()) throw dpd::InputError(fmt::format("{}: holds no figures", verification));
        if (!make_figures(verification, ids, budget, campaign_options(""))) return exit_disagrees;
    } else if (stability->parsed()) {
        auto const definition = std::filesystem::path(verification) / "stability";
        auto maps = dpd::load_stability(definition / "stability.toml", budget);
        auto const options = campaign_options("stability");
        if (dpd::find_edges(maps, options)) dpd::write_stability(maps, budget, definition, options.output);
    } else if (work->parsed()) {
        if (!work_precision(std::filesystem::path(verification) / "work-precision", ids, budget,
                            campaign_options("work-precision")))
            return exit_disagrees;
    } else if (measure->parsed()) {
        auto answers = dpd::load_answers(std::filesystem::path(verification) / "answers", budget);
        dpd::measure_answers(answers, budget, campaign_options("answers"));
    } else if (answer->parsed()) {
        std::string const answers = dpd::read_file(answers_file);
        fmt::print("{}",
                   scene_of ? dpd::answer_scene(answers, query, *scene_of)
                   : json   ? dpd::answer_json(answers, query)
                          : dpd::answer_text(answers, query, from.empty() ? nullptr : &dpd::find_code(from)));
    } else if (exact->parsed()) {
        auto const answers =
            dpd::exact_answers(std::filesystem::path(verification) / "answers" / "exact.toml");
        if (json)
            fmt::print("{}", dpd::exact_answers_text(answers));
        else
            for (auto const& one : answers["cases"])
                fmt::print("{:<42} {}\n", one["id"].get<std::string>(), one["source"].get<std::string>());
    } else if (compare->parsed()) {
        if (!state_point && !reference)
            throw dpd::InputError("compare: no reference; allowed: --answer ID, --reference FILE.h5");
        auto const against =
            state_point ? dpd::answer_reference(answers_file, *state_point) : dpd::run_reference(*reference);
        std::vector<dpd::CodeOutput> files;
        for (auto const& file : outputs) files.push_back(dpd::read_output(file, table));
        std::vector<dpd::Renaming> names;
        for (auto const& text : renamings) names.push_back(dpd::renaming_from_text(text));
        auto const averages =
            dpd::average(files, against, names, discard ? dpd::discard_from_text(*discard) : dpd::Discard{});
        auto const result = dpd::compare(averages, against, resolution);
        if (!dpd::print(result, averages, against, json)) return exit_disagrees;
    } else if (report->parsed()) {
        auto const comparisons = dpd::load_comparisons(report_dir);
        if (comparisons.empty())
            throw dpd::InputError(
                fmt::format("{}: holds no figure data; run dpdref figure first", report_dir));
        if (!dpd::report(comparisons, report_dir)) return exit_disagrees;
    }
    return EXIT_SUCCESS;
}

}  // namespace

int main(int argc, char** argv) {
    std::signal(SIGINT, request_stop);
    std::signal(SIGTERM, request_stop);
    auto const complain = [](char const* what, int code) {
        fmt::print(stderr, "dpdref: {}\n", what);
        return code;
    };
    try {
        return dispatch(argc, argv);
    } catch (dpd::Diverged const& error) {
        return complain(error.what(), exit_diverged);
    } catch (dpd::Interrupted const& error) {
        return complain(error.what(), exit_interrupted);
    } catch (std::exception const& error) {
        // InputError; or the closed forms' invalid_argument and domain_error; or a full disk
        return complain(error.what(), exit_bad_input);
    }
}
