/// @file
/// Exact answers: a few particles, their noise, and the state after one step and after two, for other codes
/// to check in milliseconds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pairs.hpp"

namespace dpd {

/// The order in which a code visits the pairs of particles, which count from 0; the smaller one first.
using PairOrder = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The order in a text as "1-2,0-1,...", separated by commas or blanks, or in a file of that name. InputError
/// for what is no pair, or comes twice; `origin` names it in messages.
PairOrder pair_order_from_text(std::string const& text, std::string const& origin);

/// What the engine makes of the cases in `definition`, a TOML file (verification/answers/exact.toml), and its
/// pair functions. Sequential updates visit the pairs in the given order, which must have every pair of the
/// largest case; empty: by ids. Schema, units and formulas: docs/exact.md. The search does not show in the
/// result. Throws InputError.
nlohmann::ordered_json exact_answers(std::filesystem::path const& definition, Search search = Search::cell,
                                     PairOrder const& order = {});

/// The answers as text. Numbers are the shortest decimals that read back to the same double, at most 17
/// digits.
std::string exact_answers_text(nlohmann::ordered_json const& answers);

}  // namespace dpd
