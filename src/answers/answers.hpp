/// @file
/// Reference answers: state points measured so well that another code can be tested against them. Defined by
/// verification/answers/answers.toml, measured by `dpdref answers`, looked up by `dpdref answer`
/// (answer.hpp); docs/answers.md.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "figure.hpp"

namespace dpd {

/// A state point: an integrator, a fluid, a step.
struct StatePoint {
    std::string id;                                                 ///< on the command line
    std::string title;                                              ///< in the tables
    std::string integrator;                                         ///< by name
    std::vector<std::pair<std::string, std::string>> closed_forms;  ///< quantity, id of `dpdref theory`
};

/// State points, and the runs behind them as curves of a figure: ID (at rest), ID/shear, ID/below and
/// ID/above (in density, of interacting fluids), ID/g (its radial distribution function).
struct Answers {
    std::vector<StatePoint> states;  ///< in the order of the file
    Figure figure;                   ///< the runs, one curve per state and kind of run
};

/// Reads the state points of a budget ("quick" or "paper"). InputError as for scenes.
Answers load_answers(std::filesystem::path const& directory, std::string const& budget);

/// Runs what the cache lacks and writes answers.json, answers.csv and the tables answers.md to
/// options.output; a shard writes nothing.
void measure_answers(Answers& answers, std::string const& budget, CampaignOptions const& options);

}  // namespace dpd
