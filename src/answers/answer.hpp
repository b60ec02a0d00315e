/// @file
/// Looking up a reference answer, `dpdref answer`; docs/answers.md.
#pragma once

#include <string>
#include <vector>

namespace dpd {

struct Code;

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
