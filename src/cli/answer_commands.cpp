/// @file
/// The commands that give and compare reference answers.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "answer.hpp"
#include "commands.hpp"
#include "compare.hpp"
#include "conventions.hpp"
#include "errors.hpp"
#include "exact_answers.hpp"
#include "files.hpp"
#include "toml_reader.hpp"

namespace dpd::cli {

Command answer(CLI::App& app) {
    struct Options {
        std::vector<std::string> query;
        std::string file = data_path("figures/answers/answers.json"), code;
        std::optional<std::string> scene;
        bool json = false;
    };
    auto const options = std::make_shared<Options>();
    auto* const command = app.add_subcommand("answer", "reference values of the nearest state point");
    command->add_option("query", options->query, "id of a state point, or key=value ...; nothing lists them");
    command->add_option("--answers", options->file, "file of the reference answers");
    command->add_option("--scene", options->scene, "print the scene of a run: rest, shear, below or above");
    command
        ->add_option("--of", options->code,
                     "code whose parameters the query has, see dpdref convert; values in its units")
        ->excludes("--scene");
    command->add_flag("--json", options->json, "print JSON");
    return {command, [options] {
                auto const& [query, file, code, scene, json] = *options;
                std::string const known = read_file(file);
                fmt::print("{}", scene ? answer_scene(known, query, *scene)
                                 : json
                                     ? answer_json(known, query)
                                     : answer_text(known, query, code.empty() ? nullptr : &find_code(code)));
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
    return {command, [options] {
                auto const all = exact_answers(
                    std::filesystem::path(options->verification) / "answers" / "exact.toml", Search::cell,
                    options->order ? pair_order_from_text(*options->order, "order") : PairOrder{});
                if (options->json)
                    fmt::print("{}", exact_answers_text(all));
                else
                    for (auto const& one : all["cases"])
                        fmt::print("{:<42} {}\n", one["id"].get<std::string>(),
                                   one["source"].get<std::string>());
                return exit_done;
            }};
}

Command compare(CLI::App& app) {
    struct Options {
        std::vector<std::string> files, renamings;
        std::string answers = data_path("figures/answers/answers.json");
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
    auto* const of_answer = command->add_option("--answer", options->state_point, "id of a reference answer");
    command->add_option("--answers", options->answers, "file of the reference answers");
    command->add_option("--reference", options->reference, "result of dpdref run --out")->excludes(of_answer);
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
                if (!options->state_point && !options->reference)
                    throw InputError("compare: no reference; allowed: --answer ID, --reference FILE.h5");
                auto const against = options->state_point
                                         ? answer_reference(options->answers, *options->state_point)
                                         : run_reference(*options->reference);
                std::vector<CodeOutput> outputs;
                std::size_t const table = table_from_text(options->table);
                for (auto const& file : options->files) outputs.push_back(read_output(file, table));
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
