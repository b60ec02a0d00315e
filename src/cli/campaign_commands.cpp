/// @file
/// The commands that make figures, studies and reference answers.
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <thread>

#include "answers.hpp"
#include "budget.hpp"
#include "campaign.hpp"
#include "commands.hpp"
#include "define_figure.hpp"
#include "errors.hpp"
#include "judge_figure.hpp"
#include "redraw_figure.hpp"
#include "report.hpp"
#include "run_figure.hpp"
#include "signals.hpp"
#include "stability.hpp"
#include "work_precision.hpp"
#include "write_figure.hpp"

namespace dpd::cli {
namespace {

// What all campaigns have in common; `below` is the directory under figures/ that is theirs.
struct CampaignChoice {
    std::string below, budget = "quick", cache = ".dpdref-cache", output;
    std::string verification = data_path("verification");
    std::optional<std::string> shard;
    unsigned jobs = std::max(1u, std::thread::hardware_concurrency());

    void add_to(CLI::App& command) {
        std::string const under = below.empty() ? "" : "/" + below;
        command.add_option("--budget", budget, "quick or paper")
            ->check(CLI::IsMember(std::vector<std::string>(budget_names.begin(), budget_names.end())));
        command.add_option("--jobs", jobs, "runs at a time")->check(CLI::Range(1u, 1024u));
        command.add_option("--shard", shard, "k/n: only the k-th of n parts of the runs; draws nothing");
        command.add_option("--out", output,
                           fmt::format("directory (default figures{0}, or figures/quick{0})", under));
        command.add_option("--cache", cache, "directory of finished and unfinished runs");
        command.add_option("--verification", verification, "directory of the definitions");
    }

    std::filesystem::path definitions() const { return present(verification, "--verification"); }

    // where the campaign writes, and how it is run
    CampaignOptions options() const {
        std::filesystem::path directory = output;
        if (output.empty())
            directory = std::filesystem::path(budget == "quick" ? "figures/quick" : "figures") / below;
        CampaignOptions options{.cache = cache, .output = directory, .jobs = jobs, .stop = &stop_requested()};
        if (shard) options.shard = shard_from_text(*shard);
        return options;
    }
};

// Prints the table of the figures, where they are, and which to look at first: one that disagrees, or else
// one that is undecided. The table on disk is of all figures that are there. False if one of `ids` disagrees.
bool report_of(std::vector<std::string> const& ids, std::filesystem::path const& output) {
    auto const all = load_comparisons(output);
    bool const agree = dpd::report(all, output, ids);
    std::map<Verdict, std::vector<std::string>> figures;
    std::size_t const family = family_of(all);
    for (auto const& one : all) {
        if (std::find(ids.begin(), ids.end(), one.figure) == ids.end()) continue;
        auto& of_verdict = figures[judge(one, family)];
        if (of_verdict.empty() || of_verdict.back() != one.figure) of_verdict.push_back(one.figure);
    }
    fmt::print("pictures: {}; all numbers: {}\n", (output / "*.png").string(),
               (output / "report.csv").string());
    for (Verdict const verdict : {Verdict::disagrees, Verdict::undecided})
        if (auto const& found = figures[verdict]; !found.empty()) {
            fmt::print("look first at {}: a comparison {}\n", fmt::join(found, ", "),
                       verdict == Verdict::disagrees ? "disagrees" : "is undecided");
            break;
        }
    return agree;
}

// Regenerates figures and prints their comparisons; false if one disagrees. A shard only runs.
bool make_figures(std::filesystem::path const& verification, std::vector<std::string> const& ids,
                  std::string const& budget, CampaignOptions const& options,
                  std::vector<std::string> const& changes = {}) {
    std::vector<Figure> figures;
    for (auto const& id : ids) figures.push_back(load_figure(verification, id, budget, changes));
    auto const run_time = run_points(figures, options, [&](Figure const& one) {
        write_figure(one, dpd::compare(one), budget, options.output);
    });
    if (!run_time) return true;
    if (ids == figure_ids(verification)) write_run_time(*run_time, budget, options.output);
    return report_of(ids, options.output);
}

// Judges and draws what is on disk, without a run.
bool redraw_figures(std::filesystem::path const& verification, std::vector<std::string> const& ids,
                    std::string const& budget, CampaignOptions const& options) {
    for (auto const& id : ids) redraw_figure(load_figure(verification, id, budget), options.output);
    return report_of(ids, options.output);
}

// The study of the integrators, and the figures that are defined beside it.
bool make_studies(std::filesystem::path const& directory, std::vector<std::string> ids,
                  std::string const& budget, bool redraw, CampaignOptions const& options) {
    std::string const study = "integrators";
    auto known = figure_ids(directory);
    known.insert(known.begin(), study);
    if (ids.empty() || ids == std::vector<std::string>{"all"}) ids = known;
    for (auto const& id : ids)
        if (std::find(known.begin(), known.end(), id) == known.end())
            throw InputError(
                fmt::format("work-precision {}: unknown; allowed: all, {}", id, fmt::join(known, ", ")));
    bool const with_study = std::erase(ids, study) > 0;
    bool const agree = ids.empty() || (redraw ? redraw_figures(directory, ids, budget, options)
                                              : make_figures(directory, ids, budget, options));
    if (with_study) {
        auto studies = load_studies(directory / study, budget);
        if (redraw)
            for (auto const& one : studies) draw_study(one, directory / study, options.output);
        if (redraw || !run_studies(studies, options)) return agree;
        for (auto const& one : studies) write_study(one, budget, directory / study, options.output);
    }
    return agree;
}

struct FigureChoice {
    std::vector<std::string> ids, changes;
    bool redraw = false;
    CampaignChoice campaign;
};

}  // namespace

Command figure(CLI::App& app) {
    auto const chosen = std::make_shared<FigureChoice>();
    auto* const command = app.add_subcommand("figure", "regenerate figures");
    command->add_option("ids", chosen->ids, "figure ids, or all")->required();
    command
        ->add_option(
            "--set", chosen->changes,
            "table.key=value, on top of the definition; into figures/changed unless --out says where")
        ->allow_extra_args(false);
    command
        ->add_flag("--redraw", chosen->redraw,
                   "judge and draw again what is on disk, by the definition as it is now; runs nothing")
        ->excludes("--set");
    chosen->campaign.add_to(*command);
    return {command, [chosen] {
                auto& [ids, changes, redraw, campaign] = *chosen;
                if (!changes.empty() && campaign.output.empty()) campaign.output = "figures/changed";
                auto const which =
                    ids == std::vector<std::string>{"all"} ? figure_ids(campaign.definitions()) : ids;
                if (which.empty())
                    throw InputError(fmt::format("{}: holds no figures", campaign.verification));
                if (redraw)
                    return redraw_figures(campaign.definitions(), which, campaign.budget, campaign.options())
                               ? exit_done
                               : exit_disagrees;
                return make_figures(campaign.definitions(), which, campaign.budget, campaign.options(),
                                    changes)
                           ? exit_done
                           : exit_disagrees;
            }};
}

Command stability(CLI::App& app) {
    auto const campaign = std::make_shared<CampaignChoice>();
    campaign->below = "stability";
    auto const redraw = std::make_shared<bool>(false);
    auto* const command = app.add_subcommand("stability", "largest steps of the integrators, by bisection");
    command->add_flag("--redraw", *redraw, "draw again what is on disk; runs nothing");
    campaign->add_to(*command);
    return {command, [campaign, redraw] {
                auto const definition = campaign->definitions() / "stability";
                auto maps = load_stability(definition / "stability.toml", campaign->budget);
                auto const options = campaign->options();
                if (*redraw)
                    draw_stability(maps, definition, options.output);
                else if (find_edges(maps, options))
                    write_stability(maps, campaign->budget, definition, options.output);
                return exit_done;
            }};
}

Command work_precision(CLI::App& app) {
    auto const chosen = std::make_shared<FigureChoice>();
    chosen->campaign.below = "work-precision";
    auto* const command = app.add_subcommand("work-precision", "errors of the integrators against run time");
    command->add_option("ids", chosen->ids, "integrators, or one of the maps; default all");
    command->add_flag("--redraw", chosen->redraw, "judge and draw again what is on disk; runs nothing");
    chosen->campaign.add_to(*command);
    return {command, [chosen] {
                auto const& campaign = chosen->campaign;
                return make_studies(campaign.definitions() / "work-precision", chosen->ids, campaign.budget,
                                    chosen->redraw, campaign.options())
                           ? exit_done
                           : exit_disagrees;
            }};
}

Command answers(CLI::App& app) {
    auto const campaign = std::make_shared<CampaignChoice>();
    campaign->below = "answers";
    auto* const command = app.add_subcommand("answers", "measure the reference answers");
    campaign->add_to(*command);
    return {command, [campaign] {
                auto all = load_answers(campaign->definitions() / "answers", campaign->budget);
                measure_answers(all, campaign->budget, campaign->options());
                return exit_done;
            }};
}

Command report(CLI::App& app) {
    auto const directory = std::make_shared<std::string>("figures");
    auto* const command =
        app.add_subcommand("report", "print every comparison; write report.csv and report.json");
    command->add_option("--figures", *directory, "directory of the regenerated figures");
    return {command, [directory] {
                auto const comparisons = load_comparisons(*directory);
                if (comparisons.empty())
                    throw InputError(
                        fmt::format("{}: holds no figure data; run dpdref figure first", *directory));
                return dpd::report(comparisons, *directory) ? exit_done : exit_disagrees;
            }};
}

}  // namespace dpd::cli
