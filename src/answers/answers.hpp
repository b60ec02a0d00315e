/// @file
/// Reference answers: state points measured so well that another code can be tested against them. Defined by
/// verification/answers/answers.toml, measured by `dpdref answers`, looked up by `dpdref answer`;
/// docs/answers.md.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "figure.hpp"

namespace dpd {

struct Code;

/// A state point: an integrator, a fluid, a step.
struct StatePoint {
    std::string id, title, integrator;  ///< of the state point; the integrator by name
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

/// The lines that `dpdref answer` prints from the text of answers.json. `query` is empty (a list of the state
/// points), the id of a state point, or "key=value" of the closed forms' parameters and `integrator`: then
/// the nearest state point, by the root of the summed squares of ln(ratio) of the numbers that are given
/// (differences where one is zero); texts must be equal. Closed forms are evaluated for the parameters of the
/// query. InputError names what is allowed.
std::string answer_text(std::string const& answers, std::vector<std::string> const& query,
                        Code const* code = nullptr);

/// The state point's own part of the file.
std::string answer_json(std::string const& answers, std::vector<std::string> const& query);

/// The scene (TOML) behind a state point: `which` is one of its runs, "rest", "shear", "below" or "above".
std::string answer_scene(std::string const& answers, std::vector<std::string> const& query,
                         std::string const& which);

}  // namespace dpd
