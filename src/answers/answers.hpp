/// @file
/// Reference answers: state points measured so well that another code can be tested against them. Defined by
/// verification/answers/answers.toml, measured by `dpdref answers`, looked up by `dpdref answer`
/// (answer.hpp); docs/answers.md.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "campaign.hpp"
#include "figure.hpp"

namespace dpd {

/// A state point: an integrator, a fluid, a step.
struct StatePoint {
    std::string id;          ///< on the command line
    std::string title;       ///< in the tables
    std::string integrator;  ///< by name
    bool limit = false;      ///< whether its step is so small that it stands for all smaller ones
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

/// A DPD fluid of one species that is to be measured; cutoff, mass and kT are 1.
struct FluidToMeasure {
    std::string id = "measured";     ///< of the state point that it becomes
    std::string integrator;          ///< by name
    int dimension = 3;               ///< 2 or 3
    double density = 0.0;            ///< particles per volume
    double repulsion = 0.0;          ///< a, force at contact
    double friction = 0.0;           ///< gamma, mass/time; or the rate of Lowe-Andersen's updates, 1/time
    bool rates = false;              ///< whether it is such a rate
    double step = 0.0;               ///< time
    std::string weight;              ///< of the friction; empty: that of the integrator
    double exponent = 0.0;           ///< of the weight `power`
    std::uint64_t particles = 3000;  ///< in a square or a cube
    std::optional<double> shear_rate = {};  ///< 1/time; none: that of answers.toml
};

/// What is wanted of a state point that is measured for a query: relative errors, as shares of that of
/// viscosity and diffusion constant. kT and pressure are sharper than these in runs of one length.
inline constexpr std::array<std::pair<char const*, double>, 4> errors_wanted_of_answers{
    {{"kinetic_temperature", 0.2}, {"pressure", 0.2}, {"diffusion_constant", 1.0}, {"viscosity", 1.0}}};

/// The state point of that fluid, of the quick budget's runs, which go on until their relative errors by
/// blocking are small: errors_wanted_of_answers times `within`. InputError as for scenes.
Answers load_answer(std::filesystem::path const& directory, FluidToMeasure const& fluid, double within);

/// Seconds of one core that runs until errors are small will take: from a short timing of each, and as the
/// errors of another fluid let expect, whose state point (a part of answers.json) this is. Diverged.
double expected_seconds(Answers const& answers, std::string const& state);

/// Runs what the cache lacks; the text of answers.json. Nothing if options name a shard.
std::optional<std::string> measure(Answers& answers, std::string const& budget,
                                   CampaignOptions const& options);

/// The tables answers.md of the book, from the text of answers.json.
std::string answer_tables(std::string const& answers);

/// Runs what the cache lacks and writes answers.json, answers.csv and the tables answers.md to
/// options.output; a shard writes nothing.
void measure_answers(Answers& answers, std::string const& budget, CampaignOptions const& options);

}  // namespace dpd
