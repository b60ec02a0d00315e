/// @file
/// Exact answers: a few particles, their noise, and the state after one step and after two, for other codes
/// to check in milliseconds.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "pairs.hpp"

namespace dpd {

/// What the engine makes of the cases in `definition`, a TOML file (verification/answers/exact.toml), and its
/// pair functions. Schema, units and formulas: docs/exact.md. The search does not show in the result. Throws
/// InputError.
nlohmann::ordered_json exact_answers(std::filesystem::path const& definition, Search search = Search::cell);

/// The answers as text. Numbers are the shortest decimals that read back to the same double, at most 17
/// digits.
std::string exact_answers_text(nlohmann::ordered_json const& answers);

}  // namespace dpd
