/// @file
/// Looking up a reference answer, `dpdref answer`; docs/answers.md.
#pragma once

#include <string>
#include <vector>

namespace dpd {

struct Code;

/// The lines that `dpdref answer` prints from the text of answers.json. `query` is empty (a list of the state
/// points), the id of a state point, or "key=value" of the closed forms' parameters and `integrator`, or of
/// those of a code, whose integrator is meant then. Such a query is answered, in its units, by a state point
/// of that fluid (density, repulsion, weight, kind of thermostat) and that integrator; of several by the one
/// of the nearest friction, then step, then box and shear rate, by the root of the summed squares of
/// ln(ratio); what differs is said in the first line. Where the step is far below all others, it is the limit
/// of a small one, if the fluid has that. Closed forms are evaluated for the parameters of the query.
/// InputError names what is allowed, or how the state points differ.
std::string answer_text(std::string const& answers, std::vector<std::string> const& query,
                        Code const* code = nullptr);

/// The same as JSON: the state point's own part of the file, in the units of the query, with the list
/// `differs` of what is not as asked, and `radial_distribution_peak`. For an empty query the file.
std::string answer_json(std::string const& answers, std::vector<std::string> const& query,
                        Code const* code = nullptr);

/// A file of answers that holds this state point alone, in the units of the query. InputError where anything
/// differs.
std::string answer_file(std::string const& answers, std::vector<std::string> const& query,
                        Code const* code = nullptr);

/// The scene (TOML) behind a state point: `which` is one of its runs, "rest", "shear", "below" or "above".
std::string answer_scene(std::string const& answers, std::vector<std::string> const& query,
                         std::string const& which);

}  // namespace dpd
