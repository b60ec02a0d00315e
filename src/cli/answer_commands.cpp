/// @file
/// The commands that give and compare reference answers.
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "answer.hpp"
#include "commands.hpp"
#include "compare.hpp"
#include "conventions.hpp"
#include "errors.hpp"
#include "exact_answers.hpp"
#include "files.hpp"
#include "measure_answer.hpp"
#include "signals.hpp"
#include "toml_reader.hpp"

namespace dpd::cli {
namespace {

// A query of `dpdref answer`, and how it is measured.
struct QueryChoice {
    std::vector<std::string> query;
    std::string file = data_path("figures/answers/answers.json"), code, within = "0.5%";
    std::string cache = ".dpdref-cache", verification = data_path("verification");
    unsigned jobs = std::max(1u, std::thread::hardware_concurrency());
    bool measured = false;
    CLI::Option *of = nullptr, *measure = nullptr;

    void add_to(CLI::App& command) {
        command.add_option("--answers", file, "file of the reference answers");
        of = command.add_option(
            "--of", code, "code whose parameters the query has, see dpdref convert; values in its units");
        measure = command.add_flag("--measure", measured,
                                   "run that fluid until errors are small; goes on where it was interrupted");
        command
            .add_option("--within", within,
                        "relative error of viscosity and diffusion constant, of kT and pressure a fifth")
            ->needs(measure);
        command.add_option("--cache", cache, "directory of finished and unfinished runs")->needs(measure);
        command.add_option("--jobs", jobs, "runs at a time")->check(CLI::Range(1u, 1024u))->needs(measure);
        command.add_option("--verification", verification, "directory of the definitions")->needs(measure);
    }

    Code const* convention() const { return code.empty() ? nullptr : &find_code(code); }

    // the file's text, or that of a file with the measured state point alone
    std::string answers() const {
        std::string known = read_file(present(file, "--answers"));
        if (!measured) return known;
        auto const error = relative_error(within);
        if (!error)
            throw InputError(
                fmt::format("--within {}: is not allowed; allowed: above 0 and below 1 or 100%", within));
        return measure_answer(std::filesystem::path(present(verification, "--verification")) / "answers",
                              known, query, convention(), *error,
                              {.cache = cache, .output = {}, .jobs = jobs, .stop = &stop_requested()});
    }
};

// What `act` makes of the file of answers, which may be damaged.
template <class Act>
auto with_answers(QueryChoice const& choice, Act const& act) {
    try {
        return act(choice.answers(), choice.query, choice.convention());
    } catch (nlohmann::json::exception const& error) {
        throw InputError(
            fmt::format("{}: {}; allowed: a file of `dpdref answers`", choice.file, error.what()));
    }
}

// The state point that is asked for, in the units of the query.
Reference reference_of(QueryChoice const& choice) {
    return with_answers(choice, [&](auto const& known, auto const& query, Code const* code) {
        auto const text = answer_file(known, query, code);
        return answer_reference(text, choice.file, nlohmann::json::parse(text)["states"][0]["id"]);
    });
}

}  // namespace

Command answer(CLI::App& app) {
    struct Options {
        QueryChoice choice;
        std::optional<std::string> scene;
        bool json = false;
    };
    auto const options = std::make_shared<Options>();
    auto& choice = options->choice;
    auto* const command = app.add_subcommand("answer", "reference values of a state point");
    command->add_option("query", choice.query, "id of a state point, or key=value ...; nothing lists them");
    choice.add_to(*command);
    command->add_option("--scene", options->scene, "print the scene of a run: rest, shear, below or above")
        ->excludes(choice.of)
        ->excludes(choice.measure);
    command->add_flag("--json", options->json, "print JSON");
    return {command, [options] {
                auto const text = [&](auto const& known, auto const& query, Code const* code) {
                    return options->scene  ? answer_scene(known, query, *options->scene)
                           : options->json ? answer_json(known, query, code)
                                           : answer_text(known, query, code);
                };
                fmt::print("{}", with_answers(options->choice, text));
                return exit_done;
            }};
}

Command exact(CLI::App& app) {
    struct Options {
        std::string verification = data_path("verification");
        std::optional<std::string> order;
        bool json = false;
    };
    auto const options = std::make_shared<Options>();
    auto* const command = app.add_subcommand("exact", "single steps of a few particles with given noise");
    command->add_flag("--json", options->json, "print all numbers, as JSON");
    command->add_option("--order", options->order,
                        "in which your code visits the pairs: 1-2,0-1,... with all six, or a file of them");
    command->add_option("--verification", options->verification, "directory of the definitions");
    return {
        command, [options] {
            auto const all = exact_answers(
                std::filesystem::path(present(options->verification, "--verification")) / "answers" /
                    "exact.toml",
                Search::cell, options->order ? pair_order_from_text(*options->order, "order") : PairOrder{});
            if (options->json)
                fmt::print("{}", exact_answers_text(all));
            else
                for (auto const& one : all["cases"])
                    fmt::print("{:<42} {}\n", one["id"].get<std::string>(), one["source"].get<std::string>());
            return exit_done;
        }};
}

Command compare(CLI::App& app) {
    struct Options {
        std::vector<std::string> files, renamings;
        QueryChoice answer;
        std::optional<std::string> state_point, reference, discard;
        std::string table = "0";
        double resolution = 0.01;
        bool sheared = false, json = false;
    };
    auto const options = std::make_shared<Options>();
    auto* const command = app.add_subcommand("compare", "judge another code's output against a reference");
    command
        ->add_option("files", options->files,
                     "table, LAMMPS log, file of fix ave/time or ave/chunk, xvg, H5MD, result of dpdref run")
        ->required();
    auto* const of_answer = command->add_option(
        "--answer", options->state_point,
        "id of a reference answer; or, beside the files, key=value of a query of dpdref answer");
    options->answer.add_to(*command);
    command->add_option("--reference", options->reference, "result of dpdref run --out")
        ->excludes(of_answer)
        ->excludes(options->answer.of)
        ->excludes(options->answer.measure);
    command->add_option("--as", options->renamings, "COLUMN=quantity[*factor]")->allow_extra_args(false);
    command->add_option("--discard", options->discard,
                        "equilibration: a time or step of the file, or a share as 20%");
    command->add_flag("--sheared", options->sheared, "the files are of the reference's shear flow");
    command->add_option("--run", options->table,
                        "which thermo table of a log, from 1, or all; default the last");
    command
        ->add_option("--resolution", options->resolution, "relative combined error that an agreement needs")
        ->check(CLI::PositiveNumber);
    command->add_flag("--json", options->json, "print JSON");
    return {command, [options] {
                auto const is_file = [](std::string const& word) {
                    return word.find('=') == std::string::npos || std::filesystem::exists(word);
                };
                auto& files = options->files;
                auto& query = options->answer.query;
                std::ranges::copy_if(files, std::back_inserter(query), std::not_fn(is_file));
                std::erase_if(files, std::not_fn(is_file));
                if (options->state_point) query.push_back(*options->state_point);
                if (query.empty() != options->reference.has_value())
                    throw InputError(
                        "compare: one reference is needed; allowed: --answer ID, key=value ..., --reference "
                        "FILE.h5");
                auto const against =
                    options->reference ? run_reference(*options->reference) : reference_of(options->answer);
                std::vector<CodeOutput> outputs;
                std::size_t const table = table_from_text(options->table);
                for (auto const& file : files) outputs.push_back(read_output(file, table));
                std::vector<Renaming> names;
                for (auto const& text : options->renamings) names.push_back(renaming_from_text(text));
                auto const averages = average(
                    outputs, against, names,
                    options->discard ? discard_from_text(*options->discard) : Discard{}, options->sheared);
                auto const result = dpd::compare(averages, against, options->resolution);
                print(result, averages, against, options->json);
                switch (outcome_of(result, averages)) {
                    case Outcome::agrees:
                        return exit_done;
                    case Outcome::disagrees:
                        return exit_disagrees;
                    case Outcome::nothing:
                        break;
                }
                fmt::print(stderr, "dpdref: {}\n", nothing_compared(result, against));
                return exit_not_compared;
            }};
}

}  // namespace dpd::cli
